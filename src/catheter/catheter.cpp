// A catheter's step: pieces of the push, each tried, and undone if it leaves a segment too long or too short.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "catheter/catheter_impl.hpp"
#include "catheter/transport.hpp"
#include "complex/periodic_faces.hpp"
#include "dartcast/error.hpp"
#include "dartcast/predicates.hpp"
#include "tracking/carry.hpp"
#include "tracking/representable_point.hpp"

namespace dartcast {

namespace {

constexpr double max_push = 0.25;    // of the spacing, in a substep
constexpr double max_turn = 0.2;     // rad, in a substep
constexpr int max_halvings = 4;      // of a push that is not possible
constexpr double max_bending = 1e8;  // see src/catheter/chain_solver.cpp
constexpr double max_points = 1e6;

void check_option(const char* name, double value, double low, double high) {
  if (value >= low && value <= high) return;
  throw InvalidArgument(fmt::format("catheter: {} is {}; give a number from {} to {}", name, value, low, high));
}

void check_options(const CatheterOptions& o) {
  check_option("spacing", o.spacing, 1e-9, 1e9);
  check_option("length", o.length, o.spacing, max_points * o.spacing);
  const double h2 = o.spacing * o.spacing;
  check_option("stiffness", o.stiffness, 0.0, max_bending * h2 * h2);
  check_option("tip_length", o.tip_length, 0.0, o.length);
  check_option("tip_curvature", o.tip_curvature, 0.0, 1.0 / o.spacing);
  check_option("friction", o.friction, 0.0, 10.0);
  check_option("rounds", o.rounds, 1, 10000);
  check_option("tolerance", o.tolerance, 1e-6, 0.0099);
  if (!is_finite(o.entry) || !is_finite(o.direction) || !(norm(o.direction) > 0.0))
    throw InvalidArgument("catheter: the entry and its direction must be finite, and the direction not zero");
}

}  // namespace

Catheter::Impl::Impl(Environment& environment, const CatheterOptions& options)
    : environment_(environment), options_(options) {
  check_options(options);
  if (environment.map().dimension() != 3) throw InvalidArgument("catheter: the environment must be of space");
  count_ = static_cast<std::size_t>(std::lround(options.length / options.spacing)) + 1;
  direction_ = unit_or(options.direction, {0.0, 0.0, 1.0});
  reference_ = any_normal(direction_);
  Particles first;
  if (environment.add(first, {&options_.entry, 1}).front().location.place != Place::free)
    throw InvalidArgument(fmt::format("catheter: the entry ({}, {}, {}) is in no free cell: put it inside of one",
                                      options.entry.x, options.entry.y, options.entry.z));
  const SimplexId at = first[0].at();
  for (std::size_t i = 0; i <= count_; ++i) {
    if (!environment.add(particles_, at, options.entry)) throw InternalError("catheter: the entry was lost");
  }
  const Vec3 end = options.entry + direction_ * options.spacing;
  if (environment.advance(first, {&end, 1}).counters.contacts != std::array<std::uint64_t, 3>{})
    throw InvalidArgument("catheter: the way from the entry, by the spacing in its direction, is not free");
  targets_.resize(count_ + 1);
  ends_.resize(count_ + 1);
  wanted_.resize(count_);
  start_.resize(count_ + 1);
  bends_.resize(count_);
  before_.resize(count_ + 1);
  hold();
}

double Catheter::Impl::total_length() const { return static_cast<double>(count_ - 1) * options_.spacing; }

// Those that are farther than 0 from the entry.
std::size_t Catheter::Impl::inserted_points() const {
  const auto m = static_cast<std::size_t>(std::ceil(inserted_ / options_.spacing));
  const bool rounded_up = m > 0 && !(static_cast<double>(m - 1) * options_.spacing < inserted_);
  return std::min(rounded_up ? m - 1 : m, count_ - 1);
}

// The proximal end holds the last one inserted.
std::size_t Catheter::Impl::free_points() const { return std::max<std::size_t>(inserted_points(), 1) - 1; }

// The place of the last point inserted, and of the points behind it, on a straight line through the entry.
Vec3 Catheter::Impl::base(std::size_t i) const {
  return entry() + direction_ * (inserted_ - static_cast<double>(i) * options_.spacing);
}

void Catheter::Impl::check(const CatheterInput& input) const {
  if (!std::isfinite(input.push) || !is_finite(input.load))
    throw InvalidArgument("catheter: the push and the load must be finite");
  if (!(std::abs(input.turn) <= 2.0 * std::numbers::pi))
    throw InvalidArgument("catheter: the turn must be between -2 pi and 2 pi");
  if (!(norm(input.load) <= total_length()))
    throw InvalidArgument("catheter: the load must not displace a point by more than the catheter's length in a step");
}

void Catheter::Impl::check_current(const char* caller) const {
  if (edits_ != environment_.edit_count())
    throw InvalidArgument("catheter: the environment was edited: call update_after_edit() after each edit");
  environment_.check_advance(particles_, StepOptions{}, caller);
  if (options_.edges && environment_.awaits_advance(particles_))
    throw InvalidArgument(
        "catheter: the environment was moved without its edges: move it by Catheter::move_with(), or set edges to "
        "false");
}

CatheterStep Catheter::Impl::step(const CatheterInput& input) {
  check(input);
  check_current("catheter");
  CatheterStep result;
  result.stuck = is_stuck();
  if (result.stuck) return result;
  surroundings_.clear();
  if (!options_.edges) move_with_vessel(result);
  const double push = std::clamp(input.push, -inserted_, total_length() - inserted_);
  const double asked = std::max(std::abs(push) / (max_push * options_.spacing), std::abs(input.turn) / max_turn);
  const auto pieces = static_cast<std::uint32_t>(std::max(1.0, std::ceil(asked)));
  const double share = 1.0 / pieces;
  bool pushing = true;
  for (std::uint32_t i = 0; i < pieces; ++i) {
    const CatheterInput piece = {pushing ? push * share : 0.0, input.turn * share, input.load * share};
    if (make(piece, share, result)) continue;
    if (pushing) make_less(piece, share, result);
    if (!pushing || input.turn == 0.0) break;
    pushing = false;
  }
  if (result.substeps == 0) relax(input.load, result);
  result.worst_segment = worst_segment();
  result.at_walls = points_at_walls();
  hold();
  return result;
}

// Tries a substep, and undoes it if it leaves a segment off by more than `limit`.
bool Catheter::Impl::attempt(const CatheterInput& piece, double share, Bending bending, double limit,
                             CatheterStep& result) {
  save();
  const Outcome outcome = substep(piece, share, bending);
  result.rounds += outcome.rounds;
  result.contacts += outcome.contacts;
  result.held = outcome.held;
  if (!(outcome.worst <= limit)) {
    take_back();
    return false;
  }
  ++result.substeps;
  result.pushed += piece.push;
  result.turned += piece.turn;
  return true;
}

// A pull may leave segments as long as the vessel has drawn them out.
bool Catheter::Impl::make(const CatheterInput& piece, double share, CatheterStep& result) {
  const double limit = piece.push < 0.0 ? std::max(options_.tolerance, worst_segment()) : options_.tolerance;
  return attempt(piece, share, Bending::stiff, limit, result);
}

// Tries half of the substep, then half of that, and so on. The rest is refused.
void Catheter::Impl::make_less(const CatheterInput& piece, double share, CatheterStep& result) {
  double part = 1.0;
  for (int i = 0; i < max_halvings; ++i) {
    part *= 0.5;
    if (make({piece.push * part, piece.turn * part, piece.load * part}, share * part, result)) return;
  }
}

// No part of the push was possible. Lengths come before bends then. If they cannot be corrected either, the points
// stay where the vessel carried them.
void Catheter::Impl::relax(const Vec3& load, CatheterStep& result) {
  const CatheterInput nothing = {0.0, 0.0, load};
  if (attempt(nothing, 1.0, Bending::stiff, options_.tolerance, result)) return;
  attempt({}, 1.0, Bending::limp, std::max(options_.tolerance, worst_segment()), result);
}

// Carries the points with the vessel: they keep their weights in their simplices, which may have moved.
void Catheter::Impl::move_with_vessel(CatheterStep& result) {
  for (std::size_t i = 0; i <= count_; ++i) targets_[i] = flushed(carried(i));
  const Corners corners = environment_.complex().corners(particles_[count_].at());
  std::vector<ChainWall> moved = walls_;  // walls move as the points on them do
  for (ChainWall& w : moved) w.point += targets_[w.index] - particles_[w.index].position;
  const StepReport report = environment_.advance(particles_, targets_, slide_at_walls);
  walls_ = std::move(moved);
  turn_with_vessel(holds_.back().corners, corners);
  result.contacts += report.contacts.contacts.size();
  keep_walls(report.contacts);
}

Vec3 Catheter::Impl::carried(std::size_t i) const {
  const bool waits = i + 1 >= holds_.size();
  const Hold& h = waits ? holds_.back() : holds_[i];
  const ParticleState& s = particles_[waits ? count_ : i];
  const Corners now = environment_.complex().corners(s.at());
  Vec3 x = s.position;
  for (std::size_t k = 0; k < 4; ++k) x += (now[k] - h.corners[k]) * h.weights[k];
  return in_exact_range(x) ? x : s.position;  // else a corner has gone out of range, and the point is held
}

// Turns the entry's direction like a line drawn in its simplex.
void Catheter::Impl::turn_with_vessel(const Corners& before, const Corners& now) {
  std::array<Vec3, 3> edges;
  for (std::size_t k = 0; k < 3; ++k) edges[k] = before[k + 1] - before[0];
  const std::array<Vec3, 3> dual = detail::duals(edges);
  const double volume = dot(edges[0], dual[0]);
  Vec3 change;
  for (std::size_t k = 0; k < 3; ++k)
    change += ((now[k + 1] - now[0]) - edges[k]) * (dot(dual[k], direction_) / volume);
  if (change == Vec3{} || !is_finite(change)) return;
  const Vec3 old = std::exchange(direction_, unit_or(direction_ + change, direction_));
  reference_ = transported(reference_, old, direction_);
}

// Stores the points' weights in their simplices, so that the vessel can carry them. Points that await a move are
// still in the previous positions.
void Catheter::Impl::hold() {
  const bool before_move = environment_.awaits_advance(particles_);
  const CellComplex& complex = environment_.complex();
  const std::size_t inserted = inserted_points();
  holds_.resize(inserted + 1);
  for (std::size_t i = 0; i <= inserted; ++i) {
    const ParticleState& s = particles_[i < inserted ? i : count_];
    const Corners corners = before_move ? complex.previous_corners(s.at()) : complex.corners(s.at());
    holds_[i] = {corners, detail::barycentric(corners, s.position)};
  }
  edits_ = environment_.edit_count();
}

void Catheter::Impl::save() {
  saved_.particles = particles_;
  saved_.inserted = inserted_;
  saved_.turned = turned_;
  saved_.walls = walls_;
}

void Catheter::Impl::take_back() {
  particles_ = saved_.particles;
  inserted_ = saved_.inserted;
  turned_ = saved_.turned;
  walls_ = saved_.walls;
}

// The public functions.

Catheter::Catheter(Environment& environment, const CatheterOptions& options)
    : impl_((detail::refuse_periodic(environment.complex(), "catheters"),
             std::make_unique<Impl>(environment, options))) {}
Catheter::~Catheter() = default;

double Catheter::move_with(std::span<const Vec3> positions) { return impl_->move_with(positions); }
CatheterStep Catheter::step(const CatheterInput& input) { return impl_->step(input); }
UpdateReport Catheter::update_after_edit() { return impl_->update_after_edit(); }
std::vector<Vec3> Catheter::points() const { return impl_->points(); }
std::vector<CatheterFrame> Catheter::frames() const { return impl_->frames(); }
std::vector<SolidContact> Catheter::contacts() const { return impl_->contacts(); }
double Catheter::inserted() const { return impl_->inserted_; }
double Catheter::measured_length() const { return impl_->measured_length(); }
double Catheter::total_length() const { return impl_->total_length(); }
double Catheter::turned() const { return impl_->turned_; }
Vec3 Catheter::entry() const { return impl_->entry(); }
Vec3 Catheter::direction() const { return impl_->direction_; }
SolidAudit Catheter::audit() const { return impl_->audit(); }
const Particles& Catheter::particles() const { return impl_->particles_; }
const CatheterOptions& Catheter::options() const { return impl_->options_; }
StateHash Catheter::state_hash() const { return impl_->state_hash(); }
CatheterCheckpoint Catheter::checkpoint() const { return impl_->checkpoint(); }
void Catheter::restore(const CatheterCheckpoint& saved) { impl_->restore(saved); }

}  // namespace dartcast
