// The cache follows its set of particles: entries are added, removed, reordered, replaced.
#include "tracking/batch/particle_cache.hpp"

#include <utility>

#include "complex/simplex.hpp"

namespace dartcast::detail {

SimplexCacheEntry cache_entry_of(CacheKind kind, std::span<const Vec3> positions, const VertexNumbers& vertices,
                                 const Vec3& p) {
  SimplexCacheEntry entry = unknown_entry();
  if (kind != CacheKind::previous_geometry) return entry;
  const Corners v = {positions[vertices[0]], positions[vertices[1]], positions[vertices[2]], positions[vertices[3]]};
  const Determinants d(v, p);
  for (unsigned i = 0; i < 4; ++i) {
    const Vec3 relative = v[i] - p;
    entry.x[i] = static_cast<float>(relative.x);
    entry.y[i] = static_cast<float>(relative.y);
    entry.z[i] = static_cast<float>(relative.z);
  }
  if (d.proves_coordinates()) entry.w = d.value;
  return entry;
}

void ParticleCache::add(const CellComplex& complex, SimplexId simplex, const Vec3& position) {
  const VertexNumbers& vertices = vertices_.emplace_back(vertex_numbers(complex, simplex));
  if (kind_ != CacheKind::none) simplices_.push_back(cache_entry_of(kind_, complex.positions(), vertices, position));
}

void ParticleCache::place(std::size_t i, const CellComplex& complex, const ParticleState& state) {
  vertices_[i] = vertex_numbers(complex, state.at());
  if (kind_ == CacheKind::previous_geometry)
    simplices_.put(i, cache_entry_of(kind_, complex.positions(), vertices_[i], state.position));
  else if (kind_ == CacheKind::barycentric)
    simplices_.forget(i);
}

void ParticleCache::forget() {
  kind_ = CacheKind::none;
  simplices_.resize(0);
}

void ParticleCache::keep(const KeptRuns& runs) {
  runs.keep_in(vertices_);
  if (simplices_.empty()) return;
  for (const KeptRuns::Run& run : runs.runs()) {
    for (std::size_t k = 0; k < run.size; ++k)
      simplices_.put(run.to + k, simplices_[run.from + k], simplices_.flags(run.from + k));
  }
  simplices_.resize(runs.kept());
}

void ParticleCache::truncate(std::size_t count) {
  if (vertices_.size() > count) vertices_.resize(count);
  if (simplices_.size() > count) simplices_.resize(count);
}

void ParticleCache::reorder(std::span<const std::uint32_t> order) {
  std::vector<VertexNumbers> vertices(order.size());
  SimplexCache simplices;
  simplices.resize(simplices_.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    vertices[i] = vertices_[order[i]];
    if (!simplices_.empty()) simplices.put(i, simplices_[order[i]], simplices_.flags(order[i]));
  }
  vertices_ = std::move(vertices);
  simplices_ = std::move(simplices);
}

ParticleCache ParticleCache::selected(std::span<const std::uint32_t> which) const {
  ParticleCache some;
  for (const std::uint32_t i : which) {
    some.vertices_.push_back(vertices_[i]);
    if (!simplices_.empty()) some.simplices_.push_back(simplices_[i], simplices_.flags(i));
  }
  some.kind_ = kind_;
  some.walls_changed_ = walls_changed_;
  return some;
}

void ParticleCache::replace(std::span<const std::uint32_t> which, const ParticleCache& by) {
  for (std::size_t k = 0; k < which.size(); ++k) {
    const std::uint32_t i = which[k];
    vertices_[i] = by.vertices_[k];
    if (simplices_.empty()) continue;
    if (kind_ == by.kind_)
      simplices_.put(i, by.simplices_[k], by.simplices_.flags(k));
    else
      simplices_.forget(i);
  }
  walls_changed_ = walls_changed_ || by.walls_changed_;
}

}  // namespace dartcast::detail
