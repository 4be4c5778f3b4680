// Random points, uniform by volume in free cells or by area on a patch.
#include "simulation/seeding.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>

#include "complex/simplex.hpp"
#include "dartcast/error.hpp"

namespace dartcast {

namespace {

// In the plane twice the area: see CellComplex::corners().
double volume6(const Corners& v) { return std::max(0.0, dot(v[1] - v[0], cross(v[2] - v[0], v[3] - v[0]))); }

// N non-negative numbers that sum to 1, uniformly: the gaps between N - 1 random cuts of [0, 1].
template <std::size_t N>
std::array<double, N> random_weights(KeyedRandom& random) {
  std::array<double, N> cut{};
  for (std::size_t i = 0; i + 1 < N; ++i) cut[i] = random.uniform();
  cut[N - 1] = 1.0;
  std::sort(cut.begin(), cut.end());
  for (std::size_t i = N - 1; i > 0; --i) cut[i] -= cut[i - 1];
  return cut;
}

// The first entry of a table of sums above a place in it. Where all are 0, the last.
std::size_t entry_at(const std::vector<std::uint64_t>& up_to, std::uint64_t place) {
  const auto found = std::upper_bound(up_to.begin(), up_to.end(), place);
  return std::min<std::size_t>(static_cast<std::size_t>(found - up_to.begin()), up_to.size() - 1);
}

std::size_t choose(const std::vector<std::uint64_t>& up_to, KeyedRandom& random) {
  return entry_at(up_to, random.below(up_to.back()));
}

std::size_t simplex_count(const CellComplex& complex, Cell cell) {
  return complex.map().shape(cell).simplices().size();
}

double simplex_volume(const CellComplex& complex, Cell cell, std::size_t simplex) {
  return volume6(complex.corners({cell, static_cast<std::uint16_t>(simplex)}));
}

constexpr std::size_t sampler_grain = 1024;  // cells

}  // namespace

void check_count(std::size_t count) {
  if (count > most_at_once)
    throw InvalidArgument(fmt::format("add_random: {} particles at once; at most {} (2^31)", count, most_at_once));
}

// The sum of n sizes of at most 2^(61 - bits of n) each is below 2^62.
FixedPointScale::FixedPointScale(double largest, std::size_t count) {
  if (!(largest > 0.0)) return;
  factor_ =
      std::ldexp(1.0, std::clamp(60 - static_cast<int>(std::bit_width(count)) - std::ilogb(largest), -1000, 1000));
}

std::uint64_t FixedPointScale::operator()(double size) const {
  return static_cast<std::uint64_t>(std::nearbyint(size * factor_));
}

VolumeSampler::VolumeSampler(const CellComplex& complex, Threads threads) {
  for (const Cell c : complex.map().cells()) {
    if (complex.map().is_free(c)) cells_.push_back(c);
  }
  std::vector<double> largest(chunk_count(cells_.size(), sampler_grain));
  std::vector<std::size_t> count(largest.size());
  parallel_for(cells_.size(), sampler_grain, threads, [&](std::size_t begin, std::size_t end) {
    const std::size_t chunk = begin / sampler_grain;
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t simplices = simplex_count(complex, cells_[i]);
      count[chunk] += simplices;
      for (std::size_t s = 0; s < simplices; ++s)
        largest[chunk] = std::max(largest[chunk], simplex_volume(complex, cells_[i], s));
    }
  });
  if (!cells_.empty())
    scale_ = FixedPointScale(*std::max_element(largest.begin(), largest.end()),
                             std::accumulate(count.begin(), count.end(), std::size_t{0}));
  volume_up_to_.resize(cells_.size());
  parallel_for(cells_.size(), sampler_grain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      for (std::size_t s = 0; s < simplex_count(complex, cells_[i]); ++s)
        volume_up_to_[i] += scale_(simplex_volume(complex, cells_[i], s));
    }
  });
  std::partial_sum(volume_up_to_.begin(), volume_up_to_.end(), volume_up_to_.begin());
  if (cells_.empty() || volume_up_to_.back() == 0) throw InvalidArgument("there is no free cell to put particles into");
}

// One number chooses the cell, and the simplex within it.
Sample VolumeSampler::sample(const CellComplex& complex, KeyedRandom& random) const {
  const std::uint64_t place = random.below(volume_up_to_.back());
  const std::size_t entry = entry_at(volume_up_to_, place);
  const Cell cell = cells_[entry];
  std::vector<std::uint64_t> up_to;
  std::uint64_t sum = entry == 0 ? 0 : volume_up_to_[entry - 1];
  for (std::size_t s = 0; s < simplex_count(complex, cell); ++s)
    up_to.push_back(sum += scale_(simplex_volume(complex, cell, s)));
  const SimplexId simplex{cell, static_cast<std::uint16_t>(entry_at(up_to, place))};
  const Corners v = complex.corners(simplex);
  if (complex.map().dimension() == 2) {
    const auto w = random_weights<3>(random);
    return {simplex, (v[0] * w[0] + v[1] * w[1]) + v[2] * w[2]};
  }
  const auto w = random_weights<4>(random);
  return {simplex, (v[0] * w[0] + v[1] * w[1]) + (v[2] * w[2] + v[3] * w[3])};
}

namespace {

// Twice the area of a triangle; in the plane the length of an edge.
double facet_size(unsigned dimension, const Corners& v, unsigned facet) {
  if (dimension == 2) return norm(v[plane_facet_corners[facet][1]] - v[plane_facet_corners[facet][0]]);
  const auto& f = facet_corners[facet];
  return norm(cross(v[f[1]] - v[f[0]], v[f[2]] - v[f[0]]));
}

Vec3 random_on_facet(unsigned dimension, const Corners& v, unsigned facet, KeyedRandom& random) {
  if (dimension == 2) {
    const auto w = random_weights<2>(random);
    return v[plane_facet_corners[facet][0]] * w[0] + v[plane_facet_corners[facet][1]] * w[1];
  }
  const auto& f = facet_corners[facet];
  const auto w = random_weights<3>(random);
  return v[f[0]] * w[0] + v[f[1]] * w[1] + v[f[2]] * w[2];
}

}  // namespace

PatchSampler::PatchSampler(const CellComplex& complex, Patch patch) : patch_(patch) {
  for (const Cell c : complex.map().cells()) add(complex.map(), c);
  if (triangles_.empty()) throw InvalidArgument("the patch has no wall face at a free cell");
  update(complex);
}

void PatchSampler::add(const CombinatorialMap& map, Cell c) {
  const CellView view = map.view(c);
  const Shape& shape = view.shape();
  for (std::uint16_t f = 0; view.is_free() && f < shape.face_count(); ++f) {
    if (!view.is_wall(f) || map.patch({c, f}) != patch_) continue;
    for (std::uint16_t t = 0; t < shape.triangle_count(f); ++t) {
      const Across behind = shape.entry(f, t);
      triangles_.push_back({{c, behind.index}, behind.place});
    }
  }
}

// The order of the triangles is that of a new sampler.
void PatchSampler::update_after_edit(const CellComplex& complex, const ComplexEditReport& edit) {
  std::vector<Cell> touched = edit.around;
  touched.insert(touched.end(), edit.map.added.begin(), edit.map.added.end());
  touched.insert(touched.end(), edit.map.marked.begin(), edit.map.marked.end());
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  std::vector<Cell> listed = touched;
  for (const CellHandle& h : edit.map.removed) listed.push_back(h.cell);
  std::sort(listed.begin(), listed.end());
  std::erase_if(triangles_,
                [&](const Triangle& t) { return std::binary_search(listed.begin(), listed.end(), t.simplex.cell); });
  for (const Cell c : touched) add(complex.map(), c);
  std::stable_sort(triangles_.begin(), triangles_.end(),
                   [](const Triangle& a, const Triangle& b) { return a.simplex.cell < b.simplex.cell; });
  update(complex);
}

void PatchSampler::update(const CellComplex& complex) {
  areas_.resize(triangles_.size());
  area_up_to_.resize(triangles_.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    const Triangle& t = triangles_[i];
    areas_[i] = facet_size(complex.map().dimension(), complex.corners(t.simplex), t.facet);
    largest = std::max(largest, areas_[i]);
  }
  const FixedPointScale scale(largest, areas_.size());
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < areas_.size(); ++i) area_up_to_[i] = sum += scale(areas_[i]);
}

Sample PatchSampler::sample(const CellComplex& complex, KeyedRandom& random) const {
  const Triangle& t = triangles_[choose(area_up_to_, random)];
  const Corners v = complex.corners(t.simplex);
  const Vec3 on_face = random_on_facet(complex.map().dimension(), v, t.facet, random);
  return {t.simplex, on_face + (v[t.facet] - on_face) * 0x1p-6};
}

}  // namespace dartcast
