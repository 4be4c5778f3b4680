// A catheter's points and frames, checkpoints, and its update after edits.
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/elementary.hpp"
#include "catheter/catheter_impl.hpp"
#include "catheter/transport.hpp"
#include "dartcast/catheter.hpp"
#include "dartcast/cell_complex.hpp"
#include "dartcast/error.hpp"

namespace dartcast {

Vec3 Catheter::Impl::base_normal() const {
  const SineCosine turned = sine_cosine(turned_);
  return reference_ * turned.cosine + cross(direction_, reference_) * turned.sine;
}

std::vector<Vec3> Catheter::Impl::points() const {
  std::vector<Vec3> all;
  const std::size_t inserted = inserted_points();
  for (std::size_t i = 0; i < inserted; ++i) all.push_back(particles_[i].position);
  if (inserted > 0) all.push_back(entry());
  return all;
}

std::vector<CatheterFrame> Catheter::Impl::frames() const {
  const std::vector<Vec3> all = points();
  std::vector<CatheterFrame> frames(all.size());
  Vec3 tangent = direction_;
  Vec3 normal = base_normal();
  for (std::size_t i = all.size(); i-- > 0;) {
    // At a point the mean of the segments beside it.
    const Vec3 in = i + 1 < all.size() ? unit_or(all[i] - all[i + 1], direction_) : direction_;
    const Vec3 out = i > 0 ? unit_or(all[i - 1] - all[i], in) : in;
    const Vec3 mean = unit_or(in + out, in);
    normal = transported(normal, tangent, mean);
    tangent = mean;
    frames[i] = {tangent, normal, cross(tangent, normal)};
  }
  return frames;
}

// The contact of a place on the chain with the wall nearest to it; nothing if none is near.
std::optional<SolidContact> Catheter::Impl::contact_at(const ChainWall& w, NearWalls& near) const {
  const CellComplex& complex = environment_.complex();
  const Vec3& next = w.index + 1 < inserted_points() ? particles_[w.index + 1].position : entry();
  MovingElement part;
  part.count = w.weight > 0.0 ? 2 : 1;
  part.from = part.to = {particles_[w.index].position, next, next};
  const double margin = look_margin * options_.spacing;
  const auto walls =
      near.search(complex, particles_[w.index].cell, part, {complex.positions(), complex.positions()}, margin);
  SolidContact c;
  c.count = static_cast<std::uint8_t>(part.count);
  c.kind = part.count == 2 ? SolidContactKind::edge_edge : SolidContactKind::vertex_face;
  c.vertices = {w.index, part.count == 2 ? w.index + 1 : 0, 0};
  c.weights = {1.0 - w.weight, w.weight, 0.0};
  c.point = part.from[0] * c.weights[0] + next * c.weights[1];
  c.time_of_impact = 1.0;
  const NearWall* nearest = nullptr;
  double least = margin;
  for (const NearWall& wall : walls) {
    const double distance = nearest_on_triangle(wall.corners.to, c.point).distance;
    if (!(distance < least)) continue;
    least = distance;
    nearest = &wall;
  }
  if (nearest == nullptr) return {};
  const WallFeature place = NearWalls::place_on(complex, nearest->face, nearest->triangle, c.point, false);
  c.face = place.face;
  c.triangle = place.triangle;
  c.wall_kind = place.kind;
  c.dart = place.dart;
  c.patch = place.patch;
  c.wall_point = place.point;
  c.normal = place.normal;
  c.gap = place.distance;
  return c;
}

std::vector<SolidContact> Catheter::Impl::contacts() const {
  NearWalls near;
  std::vector<SolidContact> all;
  for (const ChainWall& w : walls_) {
    if (!(w.pressure > 0.0) || w.index >= inserted_points()) continue;
    const auto contact = contact_at(w, near);
    if (contact) all.push_back(*contact);
  }
  return all;
}

double Catheter::Impl::measured_length() const {
  const std::vector<Vec3> all = points();
  double length = 0.0;
  for (std::size_t i = 0; i + 1 < all.size(); ++i) length += norm(all[i] - all[i + 1]);
  return length;
}

StateHash Catheter::Impl::state_hash() const {
  StateHash hash;
  for (std::size_t i = 0; i <= count_; ++i) hash.add(i, particles_[i], {});
  ParticleState frame;
  frame.position = reference_;
  hash.add(count_ + 1, frame, direction_);
  hash.add(count_ + 2, ParticleState{}, {inserted_, turned_, 0.0});
  return hash;
}

CatheterCheckpoint Catheter::Impl::checkpoint() const {
  CatheterCheckpoint saved;
  saved.states.assign(particles_.states().begin(), particles_.states().end());
  for (std::size_t i = 0; i <= count_; ++i) saved.held_weights.push_back(particles_.held_weights(i));
  saved.walls = walls_;
  saved.inserted = inserted_;
  saved.turned = turned_;
  saved.direction = direction_;
  saved.reference = reference_;
  return saved;
}

void Catheter::Impl::restore(const CatheterCheckpoint& saved) {
  const bool fits = saved.states.size() == count_ + 1 && saved.inserted >= 0.0 && saved.inserted <= total_length() &&
                    std::isfinite(saved.turned) && is_finite(saved.direction) && is_finite(saved.reference);
  const std::size_t count = count_;
  const bool walls_fit = std::all_of(saved.walls.begin(), saved.walls.end(), [count](const ChainWall& w) {
    return w.index < count && w.weight >= 0.0 && w.weight <= 1.0 && is_finite(w.normal) && is_finite(w.point) &&
           std::isfinite(w.pressure);
  });
  if (!fits || !walls_fit)
    throw InvalidArgument(
        "catheter: the checkpoint is damaged, or of a catheter with other options: give the same options");
  particles_ = environment_.restored(saved.states, saved.held_weights);
  walls_ = saved.walls;
  inserted_ = saved.inserted;
  turned_ = saved.turned;
  direction_ = saved.direction;
  reference_ = saved.reference;
  hold();
  find_stuck();
}

UpdateReport Catheter::Impl::update_after_edit() {
  if (options_.edges && environment_.awaits_advance(particles_))
    throw InvalidArgument(
        "catheter: the environment was moved without its edges before the edit: move it by Catheter::move_with()");
  Particles moved;
  UpdateReport report;
  for (const OrphanPolicy orphaned : {OrphanPolicy::relocate, OrphanPolicy::hold}) {
    moved = particles_;
    report = environment_.update_after_edit(moved, orphaned);
    if (moved.size() == particles_.size()) break;
  }
  if (moved.size() != particles_.size())
    throw InvalidArgument(
        "catheter: the edit removed the cell of a point and left no free one: put a new catheter into the environment");
  const ParticleState entry = particles_[count_];
  const bool rode = environment_.awaits_advance(particles_) && !environment_.awaits_advance(moved);
  if (rode && environment_.map().contains(entry.cell))
    turn_with_vessel(holds_.back().corners, environment_.complex().corners(entry.at()));
  particles_ = std::move(moved);
  walls_.clear();
  hold();
  find_stuck();
  return report;
}

}  // namespace dartcast
