// Records the crossings of a step (dartcast/step.hpp) from the facets that its walks leave.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/cell_complex.hpp"
#include "dartcast/contact.hpp"
#include "dartcast/particle_state.hpp"
#include "dartcast/step.hpp"
#include "tracking/step_run.hpp"
#include "tracking/walk.hpp"

namespace dartcast::detail {

/// The barycentric coordinates, up to a factor, of the point where the line pq passes a facet; 0 exactly if it meets
/// the side opposite to that corner. Precondition: it passes the closed facet, and is not in its plane.
inline std::array<double, 3> passing_weights(const Corners& v, unsigned facet, const Vec3& p, const Vec3& q) {
  const auto& f = facet_corners[facet];
  const auto side = [&](unsigned i, unsigned j) { return std::abs(orient3d_value(v[f[i]], v[f[j]], p, q)); };
  return {side(1, 2), side(2, 0), side(0, 1)};
}
inline std::array<double, 2> passing_weights(const PlaneCorners& v, unsigned facet, const Vec3& p, const Vec3& q) {
  const auto& f = plane_facet_corners[facet];
  return {std::abs(orient2d_value(p, q, v[f[1]])), std::abs(orient2d_value(p, q, v[f[0]]))};
}

/// Follows one particle through its step.
class CrossingRecorder {
 public:
  static constexpr bool waits = false;
  static constexpr bool travels = false;

  /// `start`: its cell. `moved`: as for Stepper. `contacts`: those of the step.
  CrossingRecorder(const CellComplex& complex, bool moved, Cell start, const ContactList& contacts,
                   std::vector<Crossing>& crossings)
      : complex_(complex), moved_(moved), cell_(start), contacts_(contacts), crossings_(crossings) {}

  /// For the walk that starts now.
  CrossingRecorder& visitor() {
    left_.clear();
    return *this;
  }
  void operator()(SimplexId simplex, unsigned facet) { left_.push_back({simplex, facet}); }

  /// The walk from p to q has ended, in no invalid cell. It took the part of the step from `begin` to `end`.
  template <class Positions, std::size_t N>
  void walked(const Space<Positions, N>& space, const Walk& w, const Vec3& p, const Vec3& q, double begin, double end) {
    const bool to_wall = w.end == WalkEnd::wall && !w.at_end;
    const std::span<const Left> passed = std::span<const Left>(left_).first(left_.size() - (to_wall ? 1 : 0));
    std::size_t first = 0;
    for (std::size_t i = 0; i < passed.size(); ++i) first = is_wall(passed[i]) ? i + 1 : first;
    // A walk passes a wall only if p lies on it: there it started again, in another simplex around p.
    if (first > 0) turn<N>(space, first < left_.size() ? left_[first].simplex : w.simplex, p, begin);
    for (const Left& left : passed.subspan(first)) pass<N>(space, left, p, q, begin, end);
  }

  /// The particle has this state at this time: rounding may have put it into another cell.
  void put(const ParticleState& state, double time) {
    last_is_here_ = false;
    const Kind inside = static_cast<Kind>(complex_.map().dimension());
    add({after(time), state.position, cell_, state.cell, inside, {}, 0});
  }

 private:
  struct Left {
    SimplexId simplex;
    unsigned facet;
  };

  [[nodiscard]] bool is_wall(const Left& left) const {
    const CellView cell = complex_.map().view(left.simplex.cell);
    const Across across = cell.shape().simplices()[left.simplex.simplex].across[left.facet];
    return across.outer() && cell.is_wall(across.face());
  }

  // Around p, without leaving it.
  template <std::size_t N, class Positions>
  void turn(const Space<Positions, N>& space, SimplexId to, const Vec3& p, double begin) {
    const SimplexId from = left_.front().simplex;
    const std::array<Vec3, N> v = space.corners(from);
    const Shape::Feature feature = come_to<N>(from, zeros_of(v, p));
    const double time = after(begin);
    std::array<double, N> weights{};
    for (unsigned i = 0; i < N; ++i) weights[i] = orient_facet_value(v, i, p);
    const Vec3 point = moved_ ? point_at(time, complex_.vertices(from), weights) : p;
    add({time, point, cell_, to.cell, feature.kind, {from.cell, feature.dart}, 0});
  }

  // Through a facet that q is strictly beyond; one within a cell is no crossing.
  template <std::size_t N, class Positions>
  void pass(const Space<Positions, N>& space, const Left& left, const Vec3& p, const Vec3& q, double begin,
            double end) {
    const CellView cell = complex_.map().view(left.simplex.cell);
    const ImplicitSimplex& s = cell.shape().simplices()[left.simplex.simplex];
    const Across across = s.across[left.facet];
    if (!across.outer()) return;
    const std::array<Vec3, N> v = space.corners(cell, s);
    const std::array<double, N - 1> weights = passing_weights(v, left.facet, p, q);
    unsigned zeros = 1U << left.facet;
    for (unsigned i = 0; i < N - 1; ++i) zeros |= weights[i] == 0.0 ? 1U << facet_corner<N>(left.facet, i) : 0U;
    Shape::Feature feature = come_to<N>(left.simplex, zeros);
    // Two faces may hold the same three corners, if the one in the middle is on their common edge.
    if (feature.kind == Kind::face) feature.dart = cell.shape().first_dart(across.face());
    const double height = orient_facet_value(v, left.facet, p);
    const double fraction = std::clamp(height / (height - orient_facet_value(v, left.facet, q)), 0.0, 1.0);
    const double time = after(begin + fraction * (end - begin));
    std::array<Vertex, 4> corners;
    for (unsigned i = 0; i < N - 1; ++i) corners[i] = cell.vertex(s.vertex[facet_corner<N>(left.facet, i)]);
    const Vec3 point = point_at(time, corners, weights);
    add({time, point, cell_, cell.neighbour(across.face()), feature.kind, {left.simplex.cell, feature.dart}, 0});
  }

  // The face, edge or vertex of a simplex's cell that holds a point with these zero facets.
  template <std::size_t N>
  Shape::Feature come_to(SimplexId simplex, unsigned zeros) {
    const CellView cell = complex_.map().view(simplex.cell);
    const ImplicitSimplex& s = cell.shape().simplices()[simplex.simplex];
    std::array<Vertex, 4> place{};
    std::array<std::uint16_t, N> points{};
    std::size_t count = 0;
    for (unsigned i = 0; i < N; ++i) {
      if (((zeros >> i) & 1U) != 0) continue;
      points[count] = s.vertex[i];
      place[count++] = cell.vertex(s.vertex[i]);
    }
    last_is_here_ = last_is_here_ && std::is_permutation(place.begin(), place.end(), place_.begin());
    place_ = place;
    return cell.shape().feature(std::span<const std::uint16_t>(points.data(), count));
  }

  // Joined with the last one, if that is at the same place.
  void add(Crossing crossing) {
    cell_ = crossing.to;
    if (last_is_here_) {
      crossings_.back().to = crossing.to;
    } else {
      crossing.contacts = static_cast<std::uint32_t>(contacts_.contacts.size());
      crossings_.push_back(crossing);
    }
    last_is_here_ = crossings_.back().from != crossings_.back().to;
    if (last_is_here_) return;
    crossings_.pop_back();
  }

  // Rounded times follow one another, too.
  double after(double time) { return time_ = std::max(time_, time); }

  // The mean of as many vertices as there are weights.
  template <std::size_t M>
  [[nodiscard]] Vec3 point_at(double time, const std::array<Vertex, 4>& vertices,
                              const std::array<double, M>& weights) const {
    const Between positions = space_between(complex_, moved_ ? time : 1.0).positions;
    double sum = 0.0;
    for (const double weight : weights) sum += weight;
    Vec3 point;
    for (unsigned i = 0; i < M; ++i) point += positions[vertices[i]] * (weights[i] / sum);
    return point;
  }

  const CellComplex& complex_;
  bool moved_;
  Cell cell_;
  double time_ = 0.0;
  const ContactList& contacts_;
  std::vector<Crossing>& crossings_;
  std::vector<Left> left_;         // by the walk
  std::array<Vertex, 4> place_{};  // where the walk passed a facet last: the corners that span it
  bool last_is_here_ = false;      // the last crossing is at that place
};

}  // namespace dartcast::detail
