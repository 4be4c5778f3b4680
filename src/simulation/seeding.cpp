// Random points, uniform by volume in free cells or by area on a patch.
#include "simulation/seeding.hpp"

#include <algorithm>
#include <array>

#include "complex/simplex.hpp"
#include "dartcast/error.hpp"

namespace dartcast {

namespace {

// In the plane twice the area: see CellComplex::corners().
double volume6(const Corners& v) { return std::max(0.0, dot(v[1] - v[0], cross(v[2] - v[0], v[3] - v[0]))); }

// N non-negative numbers that sum to 1, uniformly: the gaps between N - 1 random cuts of [0, 1].
template <std::size_t N>
std::array<double, N> random_weights(Random& random) {
  std::array<double, N> cut{};
  for (std::size_t i = 0; i + 1 < N; ++i) cut[i] = random.uniform();
  cut[N - 1] = 1.0;
  std::sort(cut.begin(), cut.end());
  for (std::size_t i = N - 1; i > 0; --i) cut[i] -= cut[i - 1];
  return cut;
}

std::size_t choose(const std::vector<double>& up_to, Random& random) {
  const auto found = std::upper_bound(up_to.begin(), up_to.end(), random.uniform() * up_to.back());
  return std::min<std::size_t>(static_cast<std::size_t>(found - up_to.begin()), up_to.size() - 1);
}

}  // namespace

VolumeSampler::VolumeSampler(const CellComplex& complex) {
  double sum = 0.0;
  for (const Cell c : complex.map().cells()) {
    const CellView view = complex.map().view(c);
    if (!view.is_free()) continue;
    for (std::size_t s = 0; s < view.shape().simplices().size(); ++s) {
      sum += volume6(complex.corners({c, static_cast<std::uint16_t>(s)}));
    }
    cells_.push_back(c);
    volume_up_to_.push_back(sum);
  }
  if (cells_.empty() || !(sum > 0.0)) throw InvalidArgument("there is no free cell to put particles into");
}

Sample VolumeSampler::sample(const CellComplex& complex, Random& random) const {
  const Cell cell = cells_[choose(volume_up_to_, random)];
  std::vector<double> up_to;
  double sum = 0.0;
  for (std::size_t s = 0; s < complex.map().shape(cell).simplices().size(); ++s) {
    up_to.push_back(sum += volume6(complex.corners({cell, static_cast<std::uint16_t>(s)})));
  }
  const SimplexId simplex{cell, static_cast<std::uint16_t>(choose(up_to, random))};
  const Corners v = complex.corners(simplex);
  if (complex.map().dimension() == 2) {
    const auto w = random_weights<3>(random);
    return {simplex, (v[0] * w[0] + v[1] * w[1]) + v[2] * w[2]};
  }
  const auto w = random_weights<4>(random);
  return {simplex, (v[0] * w[0] + v[1] * w[1]) + (v[2] * w[2] + v[3] * w[3])};
}

namespace {

// Calls visit(cell, its shape, face) for each wall of the patch at a free cell.
template <class Visit>
void for_each_face(const CombinatorialMap& map, Patch patch, Visit&& visit) {
  for (const Cell c : map.cells()) {
    const CellView view = map.view(c);
    if (!view.is_free()) continue;
    for (std::uint16_t f = 0; f < view.shape().face_count(); ++f) {
      if (view.is_wall(f) && map.patch({c, f}) == patch) visit(c, view.shape(), f);
    }
  }
}

}  // namespace

bool has_free_face(const CombinatorialMap& map, Patch patch) {
  bool found = false;
  for_each_face(map, patch, [&](Cell, const Shape&, std::uint16_t) { found = true; });
  return found;
}

namespace {

// Twice the area of a triangle; in the plane the length of an edge.
double facet_size(unsigned dimension, const Corners& v, unsigned facet) {
  if (dimension == 2) return norm(v[plane_facet_corners[facet][1]] - v[plane_facet_corners[facet][0]]);
  const auto& f = facet_corners[facet];
  return norm(cross(v[f[1]] - v[f[0]], v[f[2]] - v[f[0]]));
}

Vec3 random_on_facet(unsigned dimension, const Corners& v, unsigned facet, Random& random) {
  if (dimension == 2) {
    const auto w = random_weights<2>(random);
    return v[plane_facet_corners[facet][0]] * w[0] + v[plane_facet_corners[facet][1]] * w[1];
  }
  const auto& f = facet_corners[facet];
  const auto w = random_weights<3>(random);
  return v[f[0]] * w[0] + v[f[1]] * w[1] + v[f[2]] * w[2];
}

}  // namespace

PatchSampler::PatchSampler(const CellComplex& complex, Patch patch) {
  for_each_face(complex.map(), patch, [&](Cell c, const Shape& shape, std::uint16_t f) {
    for (std::uint16_t t = 0; t < shape.triangle_count(f); ++t) {
      const Across behind = shape.entry(f, t);
      triangles_.push_back({{c, behind.index}, behind.place});
    }
  });
  if (triangles_.empty()) throw InvalidArgument("the patch has no wall face at a free cell");
  update(complex);
}

void PatchSampler::update(const CellComplex& complex) {
  area_up_to_.clear();
  double sum = 0.0;
  for (const Triangle& t : triangles_) {
    const Corners v = complex.corners(t.simplex);
    area_up_to_.push_back(sum += facet_size(complex.map().dimension(), v, t.facet));
  }
}

Sample PatchSampler::sample(const CellComplex& complex, Random& random) const {
  const Triangle& t = triangles_[choose(area_up_to_, random)];
  const Corners v = complex.corners(t.simplex);
  const Vec3 on_face = random_on_facet(complex.map().dimension(), v, t.facet, random);
  return {t.simplex, on_face + (v[t.facet] - on_face) * 0x1p-6};
}

}  // namespace dartcast
