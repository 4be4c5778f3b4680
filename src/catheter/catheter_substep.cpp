// One substep of a catheter: points follow its own path, then rounds of solving and walking.
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/elementary.hpp"
#include "catheter/catheter_impl.hpp"
#include "catheter/transport.hpp"
#include "dartcast/response.hpp"
#include "tracking/representable_point.hpp"

namespace dartcast {

namespace {

constexpr double settled_share = 0.03;  // of the spacing: points that move less have arrived
constexpr double length_share = 0.05;   // of the tolerance: smaller errors of lengths end the rounds

}  // namespace

AfterContact Catheter::Impl::slide_at_walls(const Contact& contact, std::span<const WallHit> walls,
                                            std::span<const WallHit> earlier) {
  return {slid(contact.unused, walls, earlier), true};
}

Catheter::Impl::Outcome Catheter::Impl::substep(const CatheterInput& piece, double share, Bending bending) {
  const double h = options_.spacing;
  inserted_before_ = inserted_points();
  inserted_ = std::clamp(inserted_ + piece.push, 0.0, total_length());
  turned_ += piece.turn;
  const std::size_t free = free_points();
  for (std::size_t i = 0; i <= count_; ++i) start_[i] = particles_[i].position;
  before_ = start_;
  follow_path(piece.push, free);
  for (std::size_t i = 0; i < free; ++i) wanted_[i] = targets_[i] + piece.load;
  const double stiffness = bending == Bending::stiff ? options_.stiffness * share / (h * h * h * h) : 0.0;
  const ChainWeights weights = {h, stiffness, options_.friction, reach * h};
  Outcome outcome;
  if (options_.edges) outcome.worst = std::numeric_limits<double>::infinity();
  while (outcome.rounds < options_.rounds) {
    ++outcome.rounds;
    bend_tip(free);
    solver_.solve({{targets_.data(), count_}, free, wanted_, start_, bends_}, weights, walls_);
    const double moved = options_.edges ? look_ahead(free, outcome) : walk(free, outcome);
    if (!options_.edges) outcome.worst = outcome.now = worst_segment();
    if (outcome.now <= length_share * options_.tolerance && moved <= settled_share * h) break;
  }
  const bool goes = options_.edges && std::isfinite(outcome.worst);
  if (goes && !go_ahead(outcome)) outcome.worst = std::numeric_limits<double>::infinity();
  return outcome;
}

// Each point moves towards the place of the one before it (in a pull: after it), as far as the push goes.
void Catheter::Impl::follow_path(double push, std::size_t free) {
  const double share = std::abs(push) / options_.spacing;
  for (std::size_t i = 0; i < free; ++i) {
    const Vec3 ahead =
        i == 0 ? unit_or(start_[0] - start_[1], direction_) * options_.spacing : start_[i - 1] - start_[i];
    targets_[i] = start_[i] + (push > 0.0 ? ahead : start_[i + 1] - start_[i]) * share;
  }
  for (std::size_t i = free; i < count_; ++i) targets_[i] = base(i);
}

// Sets the second differences of the tip at rest: along its frame's normal at each point.
void Catheter::Impl::bend_tip(std::size_t free) {
  const double h = options_.spacing;
  const double bend = 2.0 * h * sine_cosine(0.5 * options_.tip_curvature * h).sine;
  std::fill_n(bends_.begin(), std::min(free + 2, bends_.size()), Vec3{});
  Vec3 tangent = direction_;
  Vec3 normal = base_normal();
  for (std::size_t i = free; i > 0; --i) {  // point i, between the segments from i + 1 and to i - 1
    const Vec3 next = unit_or(targets_[i - 1] - targets_[i], tangent);
    const Vec3 turned = transported(normal, tangent, next);
    const bool in_tip = static_cast<double>(i) * h <= options_.tip_length;
    if (in_tip) bends_[i] = unit_or(normal + turned, normal) * bend;
    tangent = next;
    normal = turned;
  }
}

// Walks the points to the solver's targets. Returns the largest displacement of a free one.
double Catheter::Impl::walk(std::size_t free, Outcome& outcome) {
  const std::size_t inserted = inserted_points();
  for (std::size_t i = 0; i <= count_; ++i) targets_[i] = i < inserted ? flushed(targets_[i]) : entry();
  double moved = 0.0;
  for (std::size_t i = 0; i < free; ++i) before_[i] = particles_[i].position;
  const StepReport report = environment_.advance(particles_, targets_, slide_at_walls);
  for (std::size_t i = 0; i < free; ++i) {
    moved = std::max(moved, norm(particles_[i].position - before_[i]));
    targets_[i] = particles_[i].position;
  }
  for (std::size_t i = free; i < count_; ++i) targets_[i] = base(i);
  outcome.contacts += report.contacts.contacts.size();
  outcome.held = static_cast<std::uint32_t>(report.held.size());
  keep_walls(report.contacts);
  return moved;
}

// Keeps walls that points have met, as planes, while the points are near the place of contact and meet them again.
void Catheter::Impl::keep_walls(const ContactList& contacts) {
  const std::size_t free = free_points();
  const double far = reach * options_.spacing;
  for (ChainWall& w : walls_) ++w.idle;
  for (const Contact& c : contacts.contacts) {
    if (c.particle >= free) continue;
    for (const WallHit& hit : contacts.walls_of(c)) {
      const auto same = std::find_if(walls_.begin(), walls_.end(), [&](const ChainWall& w) {
        return w.index == c.particle && dot(w.normal, hit.normal) > same_wall;
      });
      const double pressure = same == walls_.end() ? 0.0 : same->pressure;
      const ChainWall met = {c.particle, 0.0, hit.normal, c.point, pressure, 0};
      if (same == walls_.end())
        walls_.push_back(met);
      else
        *same = met;
    }
  }
  std::erase_if(walls_, [&](const ChainWall& w) {
    return w.index >= free || w.idle > max_idle || norm(particles_[w.index].position - w.point) > far;
  });
}

double Catheter::Impl::worst_segment() const {
  std::vector<Vec3> all;
  for (std::size_t i = 0; i <= count_; ++i) all.push_back(particles_[i].position);
  return worst_segment(all);
}

// With the entry as the last of all points.
double Catheter::Impl::worst_segment(std::span<const Vec3> all) const {
  const std::size_t inserted = inserted_points();
  const double h = options_.spacing;
  double worst = 0.0;
  for (std::size_t i = 0; i < inserted; ++i) {
    const bool last = i + 1 == inserted;
    const Vec3& next = last ? all[count_] : all[i + 1];
    const double wanted = last ? inserted_ - static_cast<double>(i) * h : h;
    worst = std::max(worst, std::abs(norm(all[i] - next) - wanted) / h);
  }
  return worst;
}

std::uint32_t Catheter::Impl::points_at_walls() const {
  std::uint32_t count = 0;
  for (std::size_t k = 0; k < walls_.size(); ++k) {
    const bool first = std::none_of(walls_.begin(), walls_.begin() + static_cast<std::ptrdiff_t>(k),
                                    [&](const ChainWall& w) { return w.index == walls_[k].index && w.pressure > 0.0; });
    if (first && walls_[k].pressure > 0.0) ++count;
  }
  return count;
}

}  // namespace dartcast
