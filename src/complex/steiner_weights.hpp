// Interior points: vertices that are combinations of others.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "dartcast/ids.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast {

class SteinerWeights {
 public:
  [[nodiscard]] std::size_t count() const { return vertex_.size() - removed_; }
  [[nodiscard]] std::size_t bytes() const;

  /// A further vertex. `weights`: one per corner; they sum to 1. Corners are no interior points.
  void add(Vertex v, std::span<const std::uint32_t> corners, std::span<const double> weights);
  /// Adds all of another's.
  void add(const SteinerWeights& other);
  /// Forgets a vertex; nothing happens where it is no interior point. The first call lists the vertices, once; after
  /// that the cost is constant on average.
  void remove(Vertex v);
  /// Writes where the vertices are, in a fixed order of operations. `positions`: of all vertices.
  void compute(std::span<Vec3> positions) const;

 private:
  void close_gaps();

  std::vector<Vertex> vertex_;              // invalid: removed
  std::vector<std::size_t> offsets_ = {0};  // one more than vertices
  std::vector<std::uint32_t> corner_;
  std::vector<double> weight_;
  std::size_t removed_ = 0;
  std::unordered_map<std::uint32_t, std::size_t> place_;  // of a vertex; empty until one is removed
};

}  // namespace dartcast
