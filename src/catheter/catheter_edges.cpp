// The segments of a catheter among walls. A step looks ahead. Each solve gives places to go to, and all touches of points
// and segments on the straight way there become walls of the next solve. The points go only once that way is proved free.
//
// While walls move, the catheter is a partner of a joint move (solids/joint_move.hpp):
//  1. plan()         the vessel carries the points; what touches then is solved for, as in a substep
//  2. shorten()      if that does not free the way, walls and catheter make one share of theirs
//  3. after_move()   the points get there
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "catheter/catheter_impl.hpp"
#include "catheter/catheter_moves.hpp"
#include "catheter/transport.hpp"
#include "dartcast/error.hpp"
#include "dartcast/predicates.hpp"
#include "dynamics/flat_cells.hpp"
#include "solids/audit_solids.hpp"
#include "solids/solid_constraint.hpp"
#include "solids/solid_refusal.hpp"

namespace dartcast {

namespace {

constexpr double same_place = 0.125;  // of a segment: touches with one normal that are no farther apart are of one wall

SolidElement point(std::uint32_t i) { return {{i, i, i}, 1, 1, 0}; }

}  // namespace

// From the tip to the entry. Points that wait there have no segments.
std::size_t Catheter::Impl::segments() const { return std::max(inserted_points(), inserted_before_); }

// All touches on the way from start_ to ends_ among walls at rest. Returns whether it is free.
bool Catheter::Impl::find_touches() {
  touches_.clear();
  return surroundings_.find(environment_.complex(), particles_, segments(), {start_, ends_}, touches_) &&
         touches_.empty();
}

// The same among moving walls. Returns the time up to which the way is free; above 1: all of it is. Segments share most of
// the cells that they reach.
double Catheter::Impl::find_touches(const VertexMotion& walls) {
  touches_.clear();
  cells_.clear();
  const auto look_at = [&](const SolidElement& e) {
    const Cell cell = particles_[e.vertex[0]].cell;
    finder_.find_touches(environment_.complex(), cell, e, {start_, ends_}, walls, touches_);
    cells_.insert(cells_.end(), finder_.cells_reached().begin(), finder_.cells_reached().end());
  };
  for (std::uint32_t i = 0; i < segments(); ++i) look_at(chain_segment(i));
  look_at(point(static_cast<std::uint32_t>(count_)));
  std::sort(cells_.begin(), cells_.end());
  cells_.erase(std::unique(cells_.begin(), cells_.end()), cells_.end());
  double free_until = first_flat_time(environment_.complex(), cells_, walls).value_or(2.0);
  for (const ElementTouch& t : touches_) free_until = std::min(free_until, t.time);
  return free_until;
}

// The walls that were touched, as planes for the next solve.
void Catheter::Impl::add_touched_walls(std::size_t free) {
  for (const ElementTouch& touch : touches_) {
    const SolidConstraint c = constraint_of(touch, {start_, ends_}, 0.0, options_.spacing);
    if (touch.vertices[0] >= free || c.is_exit || c.normal == Vec3{}) continue;
    ChainWall met = {touch.vertices[0], c.weights[1], c.normal, c.wall_point + c.normal * c.separation, 0.0, 0};
    const auto same = std::find_if(walls_.begin(), walls_.end(), [&](const ChainWall& w) {
      return w.index == met.index && std::abs(w.weight - met.weight) <= same_place &&
             (w.weight > 0.0) == (met.weight > 0.0) && dot(w.normal, met.normal) > same_wall;
    });
    if (same == walls_.end()) {
      walls_.push_back(met);
    } else {
      met.pressure = same->pressure;
      *same = met;
    }
  }
}

// Looks at the way to the solver's targets, and keeps it if it is free and its lengths are good enough. Returns the
// largest displacement of a free point since the last look.
double Catheter::Impl::look_ahead(std::size_t free, Outcome& outcome) {
  const std::size_t inserted = inserted_points();
  for (std::size_t i = 0; i <= count_; ++i) ends_[i] = i < inserted ? flushed(targets_[i]) : entry();
  constexpr double infinite = std::numeric_limits<double>::infinity();
  outcome.now = infinite;
  if (!std::all_of(ends_.begin(), ends_.end(), in_exact_range)) return infinite;
  double moved = 0.0;
  for (std::size_t i = 0; i < free; ++i) moved = std::max(moved, norm(ends_[i] - before_[i]));
  before_ = ends_;
  const bool is_free = find_touches();
  outcome.contacts += touches_.size();
  add_touched_walls(free);
  if (!is_free) return moved;
  outcome.now = worst_segment(ends_);
  if (outcome.now > options_.tolerance && outcome.now > outcome.worst) return moved;
  outcome.worst = outcome.now;
  planned_ = ends_;
  return moved;
}

// Goes the last way that was kept. Returns whether the points got there: those in a cell that is not valid do not.
bool Catheter::Impl::go_ahead(Outcome& outcome) {
  const StepReport report = environment_.advance(particles_, planned_);
  outcome.held = static_cast<std::uint32_t>(report.held.size());
  for (std::size_t i = 0; i <= count_; ++i) {
    if (particles_[i].position != planned_[i]) return false;
  }
  const std::size_t free = free_points();
  for (ChainWall& w : walls_) w.idle = w.pressure > 0.0 ? 0 : w.idle + 1;
  std::erase_if(walls_, [&](const ChainWall& w) {
    return w.index >= free || w.idle > max_idle || norm(place_on(w, planned_) - w.point) > reach * options_.spacing;
  });
  return true;
}

// The way on which the cells of the vessel carry the points.
void Catheter::Impl::carry_along(const VertexMotion& walls) {
  const CellComplex& complex = environment_.complex();
  const std::size_t inserted = inserted_points();
  for (std::size_t i = 0; i <= count_; ++i) start_[i] = particles_[i].position;
  ends_[count_] = carried_by_cell(complex, particles_[count_], walls);
  for (std::size_t i = 0; i < count_; ++i)
    ends_[i] = i < inserted ? carried_by_cell(complex, particles_[i], walls) : ends_[count_];
}

double Catheter::Impl::plan(const VertexMotion& walls) {
  inserted_before_ = 0;
  carry_along(walls);
  const std::vector<ChainWall> met_before = walls_;
  double free_until = is_stuck() ? 2.0 : find_touches(walls);
  if (!(free_until > 1.0)) free_until = solve_way(walls);
  planned_ = ends_;
  walls_ = met_before;
  return free_until > 1.0 ? 1.0 : cut_share * free_until;
}

// Bends the carried points away from the walls that they touch. Returns the time up to which their way is free.
double Catheter::Impl::solve_way(const VertexMotion& walls) {
  const std::size_t free = free_points();
  const double h = options_.spacing;
  const ChainWeights weights = {h, options_.stiffness / (h * h * h * h), 0.0, reach * h};
  for (ChainWall& w : walls_) w.point += place_on(w, ends_) - place_on(w, start_);
  targets_ = ends_;
  wanted_.assign(ends_.begin(), ends_.end());
  double free_until = 0.0;
  for (unsigned round = 0; round < options_.rounds && !(free_until > 1.0); ++round) {
    add_touched_walls(free);
    bend_tip(free);
    solver_.solve({{targets_.data(), count_}, free, wanted_, wanted_, bends_}, weights, walls_);
    if (!std::all_of(targets_.begin(), targets_.end(), in_exact_range)) break;
    for (std::size_t i = 0; i < free; ++i) ends_[i] = flushed(targets_[i]);
    free_until = find_touches(walls);
  }
  return free_until;
}

bool Catheter::Impl::shorten(double share, const VertexMotion& walls) {
  for (std::size_t i = 0; i <= count_; ++i)
    ends_[i] = share == 0.0 ? start_[i] : share == 1.0 ? planned_[i] : on_way(start_[i], planned_[i], share);
  return share == 0.0 || is_stuck() || find_touches(walls) > 1.0;
}

// Walls that were met before are near the points still: they moved as these did.
void Catheter::Impl::after_move() {
  const SimplexId at = particles_[count_].at();
  const CellComplex& complex = environment_.complex();
  turn_with_vessel(complex.previous_corners(at), complex.corners(at));
  if (is_stuck()) {
    environment_.advance(particles_, ends_);
    return;
  }
  follow_move(environment_, particles_, ends_);
  for (ChainWall& w : walls_) w.point += place_on(w, ends_) - place_on(w, start_);
}

double Catheter::Impl::move_with(std::span<const Vec3> positions) {
  check_current("move_with");
  if (!options_.edges) {
    environment_.move(positions);
    return 1.0;
  }
  MovePartner* const self = this;
  return move_together(environment_, {&self, 1}, positions);
}

// After an edit or from a checkpoint: whether walls leave the points and segments their places.
void Catheter::Impl::find_stuck() {
  stuck_ = false;
  if (!options_.edges) return;
  const CombinatorialMap& map = environment_.map();
  const auto inserted = static_cast<std::uint32_t>(inserted_points());
  std::vector<Vec3> all;
  std::vector<Cell> cells;
  std::vector<SolidElement> elements;
  for (std::uint32_t i = 0; i <= count_; ++i) {
    const ParticleState& s = particles_[i];
    all.push_back(s.position);
    cells.push_back(map.is_free(s.cell) && !s.held ? s.cell : Cell{});
    if (i < inserted) elements.push_back(chain_segment(i));
  }
  const SolidRefusal why = find_refusal(environment_.complex(), all, elements, cells).refusal;
  stuck_ = why != SolidRefusal::none && why != SolidRefusal::cell_not_positive;
}

SolidAudit Catheter::Impl::audit() const {
  SolidAudit audit;
  if (!options_.edges || stuck_) return audit;
  const WallAudit walls(environment_.complex());
  const std::vector<Vec3> all = points();
  for (std::uint32_t i = 0; i + 1 < all.size(); ++i) {
    ++audit.checked;
    if (!walls.meets_wall(all, chain_segment(i)) || audit.failed++ != 0) continue;
    audit.first = fmt::format("catheter: the segment from point {} to point {} meets a wall", i, i + 1);
  }
  return audit;
}

MovePartner& CatheterMoves::prepare(Catheter& catheter) {
  catheter.impl_->check_current("move_with");
  return *catheter.impl_;
}

void CatheterMoves::check(const Catheter& catheter, const CatheterInput& input) { catheter.impl_->check(input); }

}  // namespace dartcast
