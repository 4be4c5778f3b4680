// Data that the batch keeps of particles from one step to the next, beside their states. It never changes a result.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/kept_runs.hpp"
#include "dartcast/cell_complex.hpp"
#include "dartcast/particle_state.hpp"
#include "tracking/batch/simplex_cache.hpp"

namespace dartcast::detail {

/// The numbers of the vertices of the simplex that a particle is in. A step that ends in the same simplex need not look
/// them up.
using VertexNumbers = std::array<std::uint32_t, 4>;

inline VertexNumbers vertex_numbers(const CellComplex& complex, SimplexId s) {
  const auto v = complex.vertices(s);
  return {v[0].value, v[1].value, v[2].value, v[3].value};
}

/// The cache entry of a particle at p: of previous geometry; barycentric coordinates are unknown until a step makes
/// them. `positions`: of all vertices.
SimplexCacheEntry cache_entry_of(CacheKind kind, std::span<const Vec3> positions, const VertexNumbers& vertices,
                                 const Vec3& p);

/// One entry for each particle of a set, in the order of the states. Code that changes a state outside of a step
/// calls place() or forget().
class ParticleCache {
 public:
  [[nodiscard]] std::size_t size() const { return vertices_.size(); }
  [[nodiscard]] const VertexNumbers& vertices(std::size_t i) const { return vertices_[i]; }
  [[nodiscard]] std::span<const VertexNumbers> all_vertices() const { return vertices_; }

  /// Adds a particle that is in this simplex.
  void add(const CellComplex& complex, SimplexId simplex, const Vec3& position);
  /// Adds particles that are in no complex: of another one, or of none.
  void add_unknown(std::size_t count) { vertices_.resize(vertices_.size() + count, {none, none, none, none}); }
  /// Particle i has this state now.
  void place(std::size_t i, const CellComplex& complex, const ParticleState& state);
  /// All particles may have other places in their simplices now.
  void forget();
  /// The next step must not rely on what is known of walls: some may be new.
  void note_changed_walls() { walls_changed_ = true; }

  // As the functions of Particles, whose preconditions are checked there.

  void keep(const KeptRuns& runs);
  void truncate(std::size_t count);
  void reorder(std::span<const std::uint32_t> order);
  [[nodiscard]] ParticleCache selected(std::span<const std::uint32_t> which) const;
  void replace(std::span<const std::uint32_t> which, const ParticleCache& by);

 private:
  friend class BatchStepper;
  friend class PartSteps;

  static constexpr std::uint32_t none = 0xffffffffU;

  std::vector<VertexNumbers> vertices_;
  CacheKind kind_ = CacheKind::none;
  SimplexCache simplices_;      // of this kind; empty if there is none
  bool walls_changed_ = false;  // since the last step
};

}  // namespace dartcast::detail
