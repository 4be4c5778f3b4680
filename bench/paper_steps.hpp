// Steps of the particles of a scheme; for the .cpp files that define a walk.
#pragma once

#include <cmath>
#include <span>

#include "bench/paper_scheme.hpp"

namespace dartcast::bench {

// The way of one particle from p to q, and its orientation tests: what a walk in space and one in the plane share.
// Functions that return bool say whether the step goes on.
template <class StateOf>
class PaperPath {
 public:
  PaperPath(const CombinatorialMap& map, std::span<const Vec3> positions, double tolerance, StateOf& state,
            const Vec3& q)
      : map_(map), x_(positions), tolerance_(tolerance), s_(state), q_(q) {}

 protected:
  [[nodiscard]] Vec3 d1(Dart i) const { return x_[map_.origin(i).value]; }
  [[nodiscard]] Vec3 d2(Dart i) const { return x_[map_.origin(map_.phi1(i)).value]; }
  // An orientation test: counted; zero within the tolerance.
  int test(double determinant) {
    ++result_.tests;
    return determinant > tolerance_ ? 1 : determinant < -tolerance_ ? -1 : 0;
  }
  [[nodiscard]] bool too_long() const { return result_.tests > paper_max_tests; }
  bool end(PaperEnd how) {
    result_.end = how;
    return false;
  }
  bool arrive() {
    s_.p = q_;
    return end(PaperEnd::arrived);
  }
  bool collide(CellFace wall) {
    result_.wall = wall;
    result_.time = 1.0 - left_;
    return end(PaperEnd::collision);
  }
  // Moves p by a share of the rest of the step.
  void go(double share) {
    s_.p += (q_ - s_.p) * share;
    left_ *= 1.0 - share;
  }
  // The share at which the segment meets a plane or a line, from the signed distances of p and q to its outer side.
  static double share_to(double p, double q) { return q <= 0.0 ? 1.0 : p >= 0.0 ? 0.0 : p / (p - q); }

  const CombinatorialMap& map_;
  std::span<const Vec3> x_;
  double tolerance_;
  StateOf& s_;
  Vec3 q_;
  double left_ = 1.0;  // share of the step
  PaperResult result_;
};

template <class StateOf, class WalkOf>
PaperSchemeOf<StateOf, WalkOf>::PaperSchemeOf(const CellComplex& complex)
    : complex_(complex), tolerance_(1e-12 * std::pow(mean_edge(complex), complex.map().dimension())) {}

template <class StateOf, class WalkOf>
void PaperSchemeOf<StateOf, WalkOf>::start(std::span<const ParticleState> states) {
  states_.assign(states.size(), {});
  for (std::size_t i = 0; i < states.size(); ++i) place(i, states[i].position, states[i].cell);
}

template <class StateOf, class WalkOf>
void PaperSchemeOf<StateOf, WalkOf>::place(std::size_t particle, const Vec3& p, Cell cell) {
  StateOf& s = states_[particle];
  s.p = p;
  WalkOf(complex_.map(), complex_.positions(), tolerance_, s, p).aim_in_cell(cell);
}

template <class StateOf, class WalkOf>
void PaperSchemeOf<StateOf, WalkOf>::advance(std::span<const Vec3> targets, std::span<PaperResult> results) {
  for (std::size_t i = 0; i < states_.size(); ++i) {
    WalkOf walk(complex_.map(), complex_.positions(), tolerance_, states_[i], targets[i]);
    results[i] = moved_ ? walk.step_after_move() : walk.step();
  }
  moved_ = false;
}

}  // namespace dartcast::bench
