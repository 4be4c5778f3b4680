// Periodic pairs of a case: meshes whose sides fit to the bit, motions that keep them so, and the mesh many times over.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "dartcast/environment.hpp"
#include "soak/crowd.hpp"
#include "soak/scene.hpp"

namespace dartcast::soak {

/// A mesh with pairs, which has all its points on the lattice of whole numbers.
SceneMesh make_periodic_mesh(const Case& c, Random& random);

/// Moves the points so that partners stay partners to the bit: by multiples of 2^-15. `size`: about the longest way.
std::vector<Vec3> shaken_alike(const Case& c, const SceneMesh& scene, std::uint64_t step, double size);

/// Whether a point is on a side of the box.
bool is_on_border(const SceneMesh& scene, std::uint32_t point);

/// A place on a face of a pair: a corner, or a mean of corners with weights that are exact.
Vec3 place_on_border(const SceneMesh& scene, Random& random);

/// The partners of faces, by the places of their corners on the lattice.
class Partners {
 public:
  Partners(const SceneMesh& scene, const CombinatorialMap& map);
  /// Invalid: it has none.
  [[nodiscard]] CellFace of(CellFace f) const;
  /// The same, and whether the pair and the way are these.
  [[nodiscard]] bool are(const PeriodicCrossing& crossing) const;

 private:
  struct Partner {
    CellFace face;
    std::uint16_t pair;
    bool back;
  };
  std::map<std::pair<std::uint32_t, std::uint16_t>, Partner> partners_;
};

/// Turns velocities at crossings, and keeps these, by particle.
class Crossed {
 public:
  Crossed(const SceneMesh& scene, std::vector<Vec3>& velocities);
  [[nodiscard]] CrossingCallback callback();
  [[nodiscard]] std::uint32_t count(std::size_t particle) const { return counts_[particle]; }
  /// The way back to where the particle would be without pairs.
  [[nodiscard]] const Placing& home(std::size_t particle) const { return homes_[particle]; }

 private:
  const SceneMesh& scene_;
  std::vector<Vec3>& velocities_;
  std::vector<Placing> homes_;
  std::vector<std::uint32_t> counts_;
};

/// A step of points in a mesh with pairs.
struct PeriodicStep {
  std::uint64_t number;
  bool moved, valid;
  const Particles& before;
  const std::vector<Vec3>& targets;
  const StepReport& report;
  const Answers& answers;
  const Crossed& crossed;
  const StepOptions& options;
};

/// The truth of steps, without the library's faces of pairs.
class PeriodicTruth {
 public:
  PeriodicTruth(const Case& c, const SceneMesh& scene, const Environment& environment);
  ~PeriodicTruth();

  /// The fault of a step; empty: it has none. `crowd`: after it, but for the answers.
  std::string check(const Environment& environment, const Crowd& crowd, const PeriodicStep& step);

 private:
  class Repeated;

  [[nodiscard]] std::string check_crossings(const PeriodicStep& step) const;
  [[nodiscard]] std::string check_straight(const Crowd& crowd, const PeriodicStep& step) const;

  const Case& case_;
  const SceneMesh& scene_;
  Partners partners_;
  std::unique_ptr<Repeated> repeated_;  // null: it is too large
};

}  // namespace dartcast::soak
