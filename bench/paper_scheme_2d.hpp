// The paper's own scheme in the plane, as its authors would have written it: doubles and a tolerance, no exact signs,
// no mending.
//
// T. Jund, D. Cazier, J.-F. Dufourd, "Particle-based forecast mechanism for continuous collision detection in
// deformable environments", SPM 2009: map and cells of sections 3.1 and 3.2, states and forecasts of section 4.2 (face,
// edge, vertex), deformation of section 6.1. Every point/edge orientation is counted as one test: a forecast that is
// still valid takes three.
//
// Where the paper is silent:
//  - A determinant counts as zero below 1e-12 times the square of the mean edge length at the start.
//  - An edge met in passing is crossed at once: the test of the edge state would repeat the one just made. In the face
//    behind it the edge after the one crossed is aimed at first, since the crossed one holds p.
//  - Around a vertex, blocked faces are turned through as well; the particle stops where the last one reached is
//    blocked.
//  - Section 6.1 as its last paragraph says, as in space (bench/paper_scheme.hpp): after a deformation the step starts
//    at the mean of the cell's corners.
//  - A particle that takes more than max_tests tests in a step turns in an endless loop and is given up.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bench/paper_scheme.hpp"

namespace dartcast::bench {

/// The paper's state S = (p, k, i).
struct PaperState2D {
  Vec3 p;
  Dart i;  ///< the edge aimed at, or that p is on, or one that starts at the vertex p; its cell is free
  Kind k = Kind::face;
};

/// As PaperScheme.
class PaperScheme2D {
 public:
  static constexpr std::uint32_t max_tests = PaperScheme::max_tests;

  /// `complex` is of the plane and outlives the scheme; its vertices may move between steps.
  explicit PaperScheme2D(const Complex& complex);

  /// Takes particles as they are, each in its free cell, and makes their first forecasts.
  void start(std::span<const State> states);
  /// Puts a particle elsewhere. Its forecast is kept where the cell is the same and p not on the edge aimed at.
  void place(std::size_t particle, const Vec3& p, Cell cell);
  /// The complex has moved: the next step takes section 6.1 into account.
  void moved() { moved_ = true; }
  /// Moves every particle towards its target until it arrives or collides. A particle that collides stays at the point
  /// of contact, one in error where it got to. `targets`, `results`: as many as particles. Allocates nothing.
  void advance(std::span<const Vec3> targets, std::span<PaperResult> results);

  [[nodiscard]] Cell cell(std::size_t particle) const { return states_[particle].i.cell; }
  [[nodiscard]] Vec3 position(std::size_t particle) const { return states_[particle].p; }
  [[nodiscard]] Kind kind(std::size_t particle) const { return states_[particle].k; }

 private:
  const Complex& complex_;
  double tolerance_;
  std::vector<PaperState2D> states_;
  bool moved_ = false;
};

}  // namespace dartcast::bench
