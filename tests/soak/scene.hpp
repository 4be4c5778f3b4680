// The scene of a case: its mesh, the edits and the motions of its vertices.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "base/random.hpp"
#include "dartcast/complex_edit.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/mesh_data.hpp"
#include "dartcast/remeshing.hpp"
#include "soak/case.hpp"

namespace dartcast::soak {

/// The use of a random number: numbers of one use do not depend on those of others.
enum class Use : std::uint64_t { mesh = 2, edit, motion, place, target, answer, mover, throwing, state };
Random random_for(const Case& c, Use use, std::uint64_t step = 0, std::uint64_t id = 0);

/// Quarter turns about the z axis, then a shift. It is exact on a lattice.
struct Placing {
  unsigned quarters = 0;  ///< counterclockwise, below 4
  Vec3 shift;

  [[nodiscard]] Vec3 vector(Vec3 v) const {
    for (unsigned i = 0; i < quarters; ++i) v = {-v.y, v.x, v.z};
    return v;
  }
  [[nodiscard]] Vec3 point(const Vec3& x) const { return vector(x) + shift; }
  [[nodiscard]] Placing inverse() const {
    const Placing back{(4 - quarters) % 4, {}};
    return {back.quarters, -back.vector(shift)};
  }
  /// `b`, then `a`.
  friend Placing operator*(const Placing& a, const Placing& b) {
    return {(a.quarters + b.quarters) % 4, a.point(b.shift)};
  }
};

/// A mesh and its box. `edge`: about that of a cell.
struct SceneMesh {
  MeshData mesh;
  Vec3 low, high;
  double edge = 1.0;
  Vec3 box;                    ///< with periodic pairs: the upper corner before points were shaken; the lower one is 0
  std::vector<Vec3> lattice;   ///< all points, then
  std::vector<Placing> pairs;  ///< the motions of MeshData::periodic, from a to b
};
SceneMesh make_mesh(const Case& c);

/// Whether two walls may have been one face, and an edit may have bent one of them alone: free cells overlap then by that
/// much, and which walls are in the way is no question of space any more.
bool has_bent_sheets(const Case& c);

/// The parts of the free cells that walls separate.
class Chambers {
 public:
  /// `partner`: of a wall face that leads on; invalid: it does not.
  Chambers(const CombinatorialMap& map, const std::function<CellFace(CellFace)>& partner);
  /// The number of a cell's chamber.
  [[nodiscard]] std::uint32_t of(Cell c) const { return number_.at(c.value); }

 private:
  std::unordered_map<std::uint32_t, std::uint32_t> number_;
};

/// Draws edits of the case's kind.
class Editor {
 public:
  Editor(const Case& c, const SceneMesh& scene) : case_(c), scene_(scene) {}

  /// The next edit, to be made at once. It throws EditRefused or InvalidArgument where it cannot be.
  std::function<void(ComplexEdit&)> draw(const Environment& environment, std::uint64_t step, std::uint64_t number);
  /// To be called after each edit that was made.
  void follow(const Environment& environment);

 private:
  const Case& case_;
  const SceneMesh& scene_;
  std::vector<Subdivision> subdivisions_;
  std::vector<Subdivision> made_;
  std::size_t used_ = none;  // the subdivision that the edit takes back
  static constexpr std::size_t none = ~std::size_t{0};
};

/// Where the vertices go.
class Motion {
 public:
  Motion(const Case& c, const SceneMesh& scene) : case_(c), scene_(scene) {}
  [[nodiscard]] bool at_rest() const { return case_[Knob::motion] == 0; }
  /// Whether the last motion is about to be taken back: no edits are made then.
  [[nodiscard]] bool is_out() const { return !home_.empty(); }
  std::vector<Vec3> next(const Environment& environment, std::uint64_t step);

 private:
  [[nodiscard]] Vec3 moved(const Vec3& p, std::uint64_t step, std::size_t vertex) const;

  const Case& case_;
  const SceneMesh& scene_;
  std::vector<Vec3> home_;
};

}  // namespace dartcast::soak
