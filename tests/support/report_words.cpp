#include "support/report_words.hpp"

#include <bit>
#include <span>

#include "support/particle_checks.hpp"

namespace dartcast::test {

namespace {

void append(Words& words, const Vec3& p) {
  const auto b = bits(p);
  words.insert(words.end(), b.begin(), b.end());
}

void append(Words& words, const Contact& c) {
  words.insert(words.end(),
               {c.particle, static_cast<std::uint64_t>(c.kind), c.dart.cell.value, c.dart.number, c.wall_count,
                c.earlier, c.together, c.last ? 1U : 0U, std::bit_cast<std::uint64_t>(c.time_of_impact)});
  for (const Vec3& v : {c.point, c.wall_displacement, c.displacement, c.unused}) append(words, v);
}

void append(Words& words, std::span<const WallHit> walls) {
  for (const WallHit& w : walls) {
    words.insert(words.end(), {w.face.cell.value, w.face.face, w.triangle, w.patch.value});
    append(words, w.normal);
  }
}

}  // namespace

Words words_of(const ContactList& list) {
  Words words;
  for (const Contact& c : list.contacts) {
    words.push_back(c.first_wall);
    append(words, c);
  }
  append(words, list.walls);
  return words;
}

Words words_of(const ContactList& list, const Contact& c) {
  Words words;
  append(words, c);
  append(words, list.walls_of(c));
  append(words, list.earlier_walls_of(c));
  return words;
}

Words words_of(const StepReport& report) {
  Words words = words_of(report.contacts);
  for (const HeldParticle& held : report.held) words.insert(words.end(), {held.particle, held.cell.value});
  for (const StoppedParticle& stopped : report.stopped) {
    words.push_back(stopped.particle);
    append(words, stopped.unused);
  }
  return words;
}

Words words_of(const Counters& c) {
  Words words = {c.particle_steps,         c.orientation.tests, c.orientation.exact, c.forecast_kept,
                 c.updated_by_deformation, c.steps_split,       c.unfinished};
  words.insert(words.end(), c.histogram.begin(), c.histogram.end());
  words.insert(words.end(), c.contacts.begin(), c.contacts.end());
  return words;
}

}  // namespace dartcast::test
