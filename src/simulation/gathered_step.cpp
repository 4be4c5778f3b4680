// Sends what happened in a step to the first rank, which puts it in the order of one process: by id.
//
// Phases: counts are summed, and entries of lists counted. If there are any, each rank packs its own. The first unpacks
// all and merges them, contacts with their walls first, because particles that left name their last contact.
#include "simulation/gathered_step.hpp"

#include <array>
#include <bit>
#include <cstdint>
#include <numeric>
#include <span>

#include "simulation/particle_system.hpp"
#include "simulation/statistics_component.hpp"

namespace dartcast {

namespace {

constexpr std::uint32_t of_another_rank = 0xffffffffU;

struct RankStep {
  SimulationStep step;
  std::vector<PlanePassage> passages;
  std::vector<PathPoint> points;
  std::vector<Leaving> leavings;
};

// Words whose sums are those of all ranks.
struct SummedStep {
  Counters counters;
  std::uint64_t absorbed = 0;
  std::uint64_t escaped = 0;
  std::uint64_t entries = 0;  // of lists that the first rank needs

  using Words = std::array<std::uint64_t, sizeof(Counters) / sizeof(std::uint64_t) + 3>;
};
static_assert(sizeof(SummedStep) == sizeof(SummedStep::Words));

std::uint64_t entries(const SimulationStep& s, const StatisticsComponent& statistics, bool with_contacts) {
  return (with_contacts ? s.contact_ids.size() : 0) + s.report.held.size() + s.report.stopped.size() + s.left.size() +
         s.overlaps.size() + statistics.statistics().passages.size() + statistics.statistics().path_points.size() +
         statistics.leavings().size();
}

std::string packed(const SimulationStep& s, const StatisticsComponent& statistics, bool with_contacts) {
  const SimulationStep none;
  const SimulationStep& met = with_contacts ? s : none;
  ByteWriter out;
  out.put(met.report.contacts.contacts);
  out.put(met.report.contacts.walls);
  out.put(s.report.held);
  out.put(s.report.stopped);
  out.put(met.contact_ids);
  out.put(met.contact_sources);
  out.put(met.parcels);
  out.put(s.left);
  out.put(s.overlaps);
  out.put(statistics.statistics().passages);
  out.put(statistics.statistics().path_points);
  out.put(statistics.leavings());
  return out.bytes();
}

RankStep unpacked(const std::string& bytes) {
  ByteReader in(bytes);
  RankStep r;
  r.step.report.contacts.contacts = in.take_list<Contact>();
  r.step.report.contacts.walls = in.take_list<WallHit>();
  r.step.report.held = in.take_list<HeldParticle>();
  r.step.report.stopped = in.take_list<StoppedParticle>();
  r.step.contact_ids = in.take_list<std::uint64_t>();
  r.step.contact_sources = in.take_list<std::uint32_t>();
  r.step.parcels = in.take_list<Parcel>();
  r.step.left = in.take_list<LeftParticle>();
  r.step.overlaps = in.take_list<SphereOverlap>();
  r.passages = in.take_list<PlanePassage>();
  r.points = in.take_list<PathPoint>();
  r.leavings = in.take_list<Leaving>();
  return r;
}

// Particles of other ranks have no index here.
template <class T>
void forget_indices(std::vector<T>& entries) {
  for (T& e : entries) e.particle = of_another_rank;
}

// The contacts of one particle on one rank: consecutive, as are their walls. If the environment is spread over ranks, it
// may have had others before, whose walls are in front of the first.
struct ContactRun {
  std::uint64_t id;
  std::uint32_t earlier;  // walls
  std::size_t rank;
  std::size_t begin, end;
};

std::vector<ContactRun> runs_of(std::span<const RankStep> ranks) {
  std::vector<ContactRun> runs;
  for (std::size_t r = 0; r < ranks.size(); ++r) {
    const std::vector<std::uint64_t>& ids = ranks[r].step.contact_ids;
    const std::vector<Contact>& contacts = ranks[r].step.report.contacts.contacts;
    for (std::size_t begin = 0, end = 0; begin < ids.size(); begin = end) {
      while (end < ids.size() && contacts[end].particle == contacts[begin].particle) ++end;
      runs.push_back({ids[begin], contacts[begin].earlier, r, begin, end});
    }
  }
  std::sort(runs.begin(), runs.end(), [](const ContactRun& a, const ContactRun& b) {
    return std::pair{a.id, a.earlier} < std::pair{b.id, b.earlier};
  });
  return runs;
}

void add_run(const ContactRun& run, const SimulationStep& from, SimulationStep& to) {
  const ContactList& theirs = from.report.contacts;
  ContactList& all = to.report.contacts;
  const Contact& first = theirs.contacts[run.begin];
  const Contact& last = theirs.contacts[run.end - 1];
  const std::uint32_t walls_begin = first.first_wall - first.earlier;
  const std::uint32_t walls_end = last.first_wall + last.wall_count;
  const auto shift = static_cast<std::uint32_t>(all.walls.size()) - walls_begin;
  all.walls.insert(all.walls.end(), theirs.walls.begin() + walls_begin, theirs.walls.begin() + walls_end);
  for (std::size_t i = run.begin; i < run.end; ++i) {
    Contact c = theirs.contacts[i];
    c.first_wall += shift;
    if (run.rank > 0) c.particle = of_another_rank;
    all.contacts.push_back(c);
    to.contact_ids.push_back(run.id);
    to.contact_sources.push_back(from.contact_sources[i]);
    if (!from.parcels.empty()) to.parcels.push_back(from.parcels[i]);
  }
}

// The contacts of all, and those of each rank in their new places.
void merge_contacts(std::span<RankStep> ranks, SimulationStep& all) {
  std::vector<std::vector<std::uint32_t>> place(ranks.size());
  for (std::size_t r = 0; r < ranks.size(); ++r) place[r].resize(ranks[r].step.contact_ids.size());
  for (const ContactRun& run : runs_of(ranks)) {
    const std::size_t first = all.contact_ids.size();
    add_run(run, ranks[run.rank].step, all);
    for (std::size_t i = run.begin; i < run.end; ++i)
      place[run.rank][i] = static_cast<std::uint32_t>(first + (i - run.begin));
  }
  for (std::size_t r = 0; r < ranks.size(); ++r) {
    for (LeftParticle& p : ranks[r].step.left) p.contact = place[r][p.contact];
  }
}

// The first rank's own alone.
void keep_contacts(std::span<RankStep> ranks, const SimulationStep& own, SimulationStep& all) {
  all.report.contacts = own.report.contacts;
  all.contact_ids = own.contact_ids;
  all.contact_sources = own.contact_sources;
  all.parcels = own.parcels;
  for (RankStep& r : ranks.subspan(1)) {
    for (LeftParticle& p : r.step.left) p.contact = of_another_rank;
  }
}

template <class T>
void append(const std::vector<T>& from, std::vector<T>& to) {
  to.insert(to.end(), from.begin(), from.end());
}

SimulationStep merged(std::span<RankStep> ranks, const SimulationStep& own, bool with_contacts) {
  SimulationStep all;
  all.duration = own.duration;
  all.injected = own.injected;
  all.absorbed = own.absorbed;
  all.escaped = own.escaped;
  all.report.counters = own.report.counters;
  if (with_contacts)
    merge_contacts(ranks, all);
  else
    keep_contacts(ranks, own, all);
  std::vector<std::vector<LeftParticle>> left;
  for (std::size_t r = 0; r < ranks.size(); ++r) {
    SimulationStep& s = ranks[r].step;
    if (r > 0) {
      forget_indices(s.report.held);
      forget_indices(s.report.stopped);
      forget_indices(s.overlaps);
    }
    append(s.report.held, all.report.held);
    append(s.report.stopped, all.report.stopped);
    append(s.overlaps, all.overlaps);
    left.push_back(s.left);
  }
  all.left = merged_by_id(left);
  return all;
}

template <class T>
std::vector<T> merged_member(std::span<const RankStep> ranks, std::vector<T> RankStep::*member) {
  std::vector<std::vector<T>> lists;
  for (const RankStep& r : ranks) lists.push_back(r.*member);
  return merged_by_id(lists);
}

}  // namespace

void gather_step(Ranks& ranks, ParticleSystem& particles, StatisticsComponent& statistics, bool with_contacts) {
  SimulationStep own = particles.last_step();
  SummedStep sums{own.report.counters, own.absorbed, own.escaped, entries(own, statistics, with_contacts)};
  auto words = std::bit_cast<SummedStep::Words>(sums);
  ranks.sum(words);
  sums = std::bit_cast<SummedStep>(words);
  std::vector<std::string> bytes;
  if (sums.entries > 0) bytes = ranks.gather(packed(own, statistics, with_contacts));
  if (ranks.rank() != 0) return;
  own.report.counters = sums.counters;
  own.absorbed = sums.absorbed;
  own.escaped = sums.escaped;
  if (sums.entries == 0) return particles.set_last_step(std::move(own));
  std::vector<RankStep> all;
  for (const std::string& b : bytes) all.push_back(unpacked(b));
  particles.set_last_step(merged(all, own, with_contacts));
  statistics.set_found(merged_member(all, &RankStep::passages), merged_member(all, &RankStep::points),
                       merged_member(all, &RankStep::leavings));
}

}  // namespace dartcast
