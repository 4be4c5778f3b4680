// Vertices that are weighted means of others.
#include <utility>

#include "dartcast/cell_complex.hpp"

namespace dartcast {

std::size_t SteinerWeights::bytes() const {
  return vertex_.size() * sizeof(Vertex) + offsets_.size() * sizeof(std::size_t) +
         corner_.size() * (sizeof(std::uint32_t) + sizeof(double));
}

void SteinerWeights::add(Vertex v, std::span<const std::uint32_t> corners, std::span<const double> weights) {
  if (!place_.empty()) place_[v.value] = vertex_.size();
  vertex_.push_back(v);
  corner_.insert(corner_.end(), corners.begin(), corners.end());
  weight_.insert(weight_.end(), weights.begin(), weights.end());
  offsets_.push_back(corner_.size());
}

void SteinerWeights::add(const SteinerWeights& other) {
  for (std::size_t i = 0; i < other.vertex_.size(); ++i) {
    const std::size_t first = other.offsets_[i];
    const std::size_t size = other.offsets_[i + 1] - first;
    if (!other.vertex_[i].valid()) continue;
    add(other.vertex_[i], std::span(other.corner_).subspan(first, size), std::span(other.weight_).subspan(first, size));
  }
}

void SteinerWeights::list_places() {
  if (!place_.empty()) return;
  for (std::size_t i = 0; i < vertex_.size(); ++i) {
    if (vertex_[i].valid()) place_[vertex_[i].value] = i;
  }
}

std::pair<std::span<const std::uint32_t>, std::span<const double>> SteinerWeights::of(Vertex v) {
  list_places();
  const auto found = place_.find(v.value);
  if (found == place_.end()) return {};
  const std::size_t first = offsets_[found->second];
  const std::size_t size = offsets_[found->second + 1] - first;
  return {std::span(corner_).subspan(first, size), std::span(weight_).subspan(first, size)};
}

void SteinerWeights::remove(Vertex v) {
  list_places();
  const auto found = place_.find(v.value);
  if (found == place_.end()) return;
  vertex_[found->second] = {};
  place_.erase(found);
  ++removed_;
  if (2 * removed_ > vertex_.size()) close_gaps();
}

void SteinerWeights::close_gaps() {
  SteinerWeights dense;
  dense.add(*this);
  *this = std::move(dense);
}

void SteinerWeights::compute(std::span<Vec3> positions) const {
  for (std::size_t i = 0; i < vertex_.size(); ++i) {
    if (!vertex_[i].valid()) continue;
    Vec3 sum;
    for (std::size_t k = offsets_[i]; k < offsets_[i + 1]; ++k) sum += positions[corner_[k]] * weight_[k];
    positions[vertex_[i].value] = sum;
  }
}

}  // namespace dartcast
