// A mesh with periodic pairs many times over, side by side or turned, without pairs.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "soak/periodic.hpp"

namespace dartcast::soak {

class PeriodicTruth::Repeated {
 public:
  /// Null if it would be too large.
  static std::unique_ptr<Repeated> make(const Case& c, const SceneMesh& scene, const Environment& environment);

  /// The fault of a step beside the same one in this mesh. Ways that a hair decides are left out.
  std::string check(const Environment& environment, const Crowd& crowd, const PeriodicStep& step);

 private:
  Repeated(const Case& c, const SceneMesh& scene, const Environment& environment, std::vector<Placing> images);

  // The end of a particle's step, and what it met.
  struct Way {
    Vec3 end, velocity;
    double first = 1.0;  // the time of the first contact
    bool graze = false;  // of an edge, a vertex, or the outside
  };
  struct Start {
    std::size_t particle;
    Vec3 from, to;
  };

  [[nodiscard]] std::vector<Vec3> places(std::span<const Vec3> of_one) const;
  // Takes steps with the vertices as before the step, then after it.
  std::vector<Way> take(const Environment& environment, const Crowd& crowd, const PeriodicStep& step,
                        std::vector<Start>& starts, bool any_cell);
  bool put(Particles& particles, Cell cell, const Vec3& at);
  [[nodiscard]] bool is_stable(const Environment& environment, const Crowd& crowd, const PeriodicStep& step,
                               const Start& start, const Way& way);

  const Case& case_;
  std::vector<Placing> images_;                                // the first one stays
  std::vector<std::pair<std::size_t, std::uint32_t>> points_;  // image and point of the one mesh
  std::unique_ptr<Environment> all_;
  std::vector<Cell> cells_;  // of the first image, by the cell's number in the mesh
  Patch outside_;
  bool simplices_ = false;  // whether all cells of the plane are triangles
};

}  // namespace dartcast::soak
