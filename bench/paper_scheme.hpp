// The paper's own scheme, as its authors would have written it: doubles and a tolerance, no exact signs, no mending.
//
// T. Jund, D. Cazier, J.-F. Dufourd, "Particle-based forecast mechanism for continuous collision detection in
// deformable environments", SPM 2009: states and forecasts of sections 5.1 (volume), 5.2 (face), 5.3 (edge), 5.4
// (vertex), deformation of section 6.1, over the map of section 3.1. Orientation tests are counted as in section 7.2: a
// forecast that is still valid takes four.
//
// Where the paper is silent:
//  - A determinant counts as zero below 1e-12 times the cube of the mean edge length at the start.
//  - The first diagonal of a face starts at the face's lowest-numbered vertex, so that both cells at a face agree.
//  - When the first test turns a forecast backwards, the half-plane it leaves is not tested again.
//  - A face met in passing is crossed at once: the state of 5.2 is entered by particles that stop on it or meet a wall.
//  - Section 6.1 as its last paragraph says: after a deformation the step itself starts at the mean of the cell's
//    corners (bringing the particle back first would take 17 tests a step in the bar, not the paper's 6.85). It touches
//    where its own way meets the wall's plane; where the wall has swept over it, where the way from the mean does.
//  - A particle that takes more than paper_max_tests tests in a step is given up.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/cell_complex.hpp"
#include "dartcast/particle_state.hpp"

namespace dartcast::bench {

enum class PaperEnd : std::uint8_t { arrived, collision, error };  ///< error: a loop, or no way on

/// The result of one particle's step.
struct PaperResult {
  PaperEnd end = PaperEnd::arrived;
  CellFace wall;            ///< on a collision: seen from the free cell
  double time = 1.0;        ///< on a collision: the fraction of the step
  std::uint32_t tests = 0;  ///< orientation tests
};

/// The mean length of all cells' edges, each counted as often as it has darts. Cost: linear in the cells.
double mean_edge(const CellComplex& complex);

/// The paper's state S = (p, k, i), and the point of the face aimed at.
struct PaperState {
  Vec3 p;
  Vec3 sp;  ///< a point on the face of i
  Dart i;   ///< of the face aimed at, or of the face, edge or vertex that p is on; its cell is free
  Kind k = Kind::volume;
};

/// A particle that takes more in a step is given up.
inline constexpr std::uint32_t paper_max_tests = 10000;

/// The particles of a scheme. `StateOf`: the paper's state; `WalkOf`: one particle's step, known where the class is
/// instantiated (bench/paper_steps.hpp).
template <class StateOf, class WalkOf>
class PaperSchemeOf {
 public:
  /// `complex` outlives the scheme; its vertices may move between steps.
  explicit PaperSchemeOf(const CellComplex& complex);

  /// Takes particles as they are, each in its free cell, and makes their first forecasts.
  void start(std::span<const ParticleState> states);
  /// Puts a particle elsewhere. Its forecast is kept where the cell is the same and the forecast not flat.
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
  const CellComplex& complex_;
  double tolerance_;
  std::vector<StateOf> states_;
  bool moved_ = false;
};

class PaperWalk;
using PaperScheme = PaperSchemeOf<PaperState, PaperWalk>;

}  // namespace dartcast::bench
