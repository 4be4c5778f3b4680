// Random points, uniform by volume in free cells or by area on a patch.
#include "simulation/seeding.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "base/bytes.hpp"
#include "base/reduced.hpp"
#include "complex/simplex.hpp"
#include "dartcast/error.hpp"
#include "dartcast/predicates.hpp"

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

// The first entry of a table of sums above a place in it. If all are 0, the last.
std::size_t entry_above(const std::vector<std::uint64_t>& up_to, std::uint64_t place) {
  const auto found = std::upper_bound(up_to.begin(), up_to.end(), place);
  return std::min<std::size_t>(static_cast<std::size_t>(found - up_to.begin()), up_to.size() - 1);
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

namespace {

// The largest size and the number of sizes, over all ranks.
struct SizeRange {
  double largest = 0.0;
  std::uint64_t count = 0;
};

// Where a rank's sizes of one cell are on the line.
struct Stretch {
  Cell cell;  // in the whole environment
  std::uint64_t size = 0;
  std::uint64_t begin = 0;
};

// The line of all ranks: cells in their order. The first rank puts it together.
std::vector<std::vector<Stretch>> placed(std::vector<std::vector<Stretch>> ranks, std::uint64_t& length) {
  std::vector<Stretch*> line;
  for (std::vector<Stretch>& stretches : ranks) {
    for (Stretch& s : stretches) line.push_back(&s);
  }
  std::sort(line.begin(), line.end(), [](const Stretch* a, const Stretch* b) { return a->cell < b->cell; });
  for (Stretch* s : line) {
    s->begin = length;
    length += s->size;
  }
  return ranks;
}

// Sets where each begins; returns the line's length. Collective.
std::uint64_t place_on_line(std::vector<Stretch>& own, Ranks& ranks) {
  ByteWriter bytes;
  bytes.put(own);
  std::vector<std::vector<Stretch>> all;
  for (const std::string& b : ranks.gather(bytes.bytes())) all.push_back(ByteReader(b).take_list<Stretch>());
  std::uint64_t length = 0;
  all = placed(std::move(all), length);
  all.resize(ranks.size());
  std::vector<std::string> back;
  for (const std::vector<Stretch>& stretches : all) {
    ByteWriter out;
    out.put(stretches);
    back.push_back(out.bytes());
  }
  own = ByteReader(ranks.exchange(std::move(back)).front()).take_list<Stretch>();
  ranks.sum({&length, 1});
  return length;
}

}  // namespace

FixedPointScale scale_of(double largest, std::size_t count, const std::optional<SampledPart>& part) {
  const SizeRange range =
      reduced(part ? &part->ranks : nullptr, SizeRange{largest, count}, [](SizeRange& sum, const SizeRange& other) {
        sum.largest = std::max(sum.largest, other.largest);
        sum.count += other.count;
      });
  return {range.largest, static_cast<std::size_t>(range.count)};
}

SizeTable::SizeTable(std::vector<std::uint64_t> sizes, std::span<const Cell> cells,
                     const std::optional<SampledPart>& part)
    : size_(std::move(sizes)) {
  for (const std::uint64_t size : size_) {
    begin_.push_back(length_);
    length_ += size;
  }
  if (!part) return;
  const auto is_first = [&](std::size_t i) { return i == 0 || cells[i] != cells[i - 1]; };
  std::vector<Stretch> own;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (is_first(i)) own.push_back({part->cells.whole(cells[i]), 0, 0});
    own.back().size += size_[i];
  }
  length_ = place_on_line(own, part->ranks);
  std::size_t stretch = 0;
  std::uint64_t at = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (is_first(i)) at = own[stretch++].begin;
    begin_[i] = at;
    at += size_[i];
  }
}

// The last of those that begin at the same place is the one that is not empty.
std::optional<std::size_t> SizeTable::entry_at(std::uint64_t place) const {
  const auto after = std::upper_bound(begin_.begin(), begin_.end(), place);
  if (after == begin_.begin()) return {};
  const auto entry = static_cast<std::size_t>(after - begin_.begin()) - 1;
  if (place - begin_[entry] >= size_[entry]) return {};
  return entry;
}

VolumeSampler::VolumeSampler(const CellComplex& complex, Threads threads, const std::optional<SampledPart>& part) {
  for (const Cell c : complex.map().cells()) {
    if (complex.map().is_free(c) && (!part || part->cells.is_own(c))) cells_.push_back(c);
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
  scale_ = scale_of(largest.empty() ? 0.0 : *std::max_element(largest.begin(), largest.end()),
                    std::accumulate(count.begin(), count.end(), std::size_t{0}), part);
  std::vector<std::uint64_t> volumes(cells_.size());
  parallel_for(cells_.size(), sampler_grain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      for (std::size_t s = 0; s < simplex_count(complex, cells_[i]); ++s)
        volumes[i] += scale_(simplex_volume(complex, cells_[i], s));
    }
  });
  volumes_ = SizeTable(std::move(volumes), cells_, part);
  if (volumes_.length() == 0) throw InvalidArgument("there is no free cell to put particles into");
}

// One number chooses the cell, and the simplex within it. Every rank takes as many numbers, so that all draw again alike.
std::optional<Sample> VolumeSampler::sample(const CellComplex& complex, KeyedRandom& random) const {
  const std::uint64_t place = random.below(volumes_.length());
  const bool plane = complex.map().dimension() == 2;
  std::array<double, 4> w{};
  if (plane) {
    const auto three = random_weights<3>(random);
    std::copy(three.begin(), three.end(), w.begin());
  } else {
    w = random_weights<4>(random);
  }
  const std::optional<std::size_t> entry = volumes_.entry_at(place);
  if (!entry) return {};
  const Cell cell = cells_[*entry];
  std::vector<std::uint64_t> up_to;
  std::uint64_t sum = volumes_.begin(*entry);
  for (std::size_t s = 0; s < simplex_count(complex, cell); ++s)
    up_to.push_back(sum += scale_(simplex_volume(complex, cell, s)));
  const SimplexId simplex{cell, static_cast<std::uint16_t>(entry_above(up_to, place))};
  const Corners v = complex.corners(simplex);
  if (plane) return Sample{simplex, (v[0] * w[0] + v[1] * w[1]) + v[2] * w[2], w};
  return Sample{simplex, (v[0] * w[0] + v[1] * w[1]) + (v[2] * w[2] + v[3] * w[3]), w};
}

namespace {

// Twice the area of a triangle; in the plane the length of an edge.
double facet_size(unsigned dimension, const Corners& v, unsigned facet) {
  if (dimension == 2) return norm(v[plane_facet_corners[facet][1]] - v[plane_facet_corners[facet][0]]);
  const auto& f = facet_corners[facet];
  return norm(cross(v[f[1]] - v[f[0]], v[f[2]] - v[f[0]]));
}

// `w`: of the facet's corners.
Vec3 on_facet(unsigned dimension, const Corners& v, unsigned facet, const std::array<double, 3>& w) {
  if (dimension == 2) return v[plane_facet_corners[facet][0]] * w[0] + v[plane_facet_corners[facet][1]] * w[1];
  const auto& f = facet_corners[facet];
  return v[f[0]] * w[0] + v[f[1]] * w[1] + v[f[2]] * w[2];
}

// The number in its simplex of the facet's k-th corner.
unsigned corner_of(unsigned dimension, unsigned facet, unsigned k) {
  return dimension == 2 ? plane_facet_corners[facet][k] : facet_corners[facet][k];
}

// As long as facet_size().
Vec3 inward_normal(unsigned dimension, const Corners& v, unsigned facet) {
  const Vec3 a = v[corner_of(dimension, facet, 0)];
  const Vec3 b = v[corner_of(dimension, facet, 1)] - a;
  const Vec3 normal = dimension == 2 ? Vec3{-b.y, b.x, 0.0} : cross(b, v[corner_of(dimension, facet, 2)] - a);
  return dot(normal, v[facet] - a) < 0.0 ? -normal : normal;
}

// The corner that a number in [0, 1) chooses, by their shares.
std::size_t corner_at(const std::array<double, 3>& shares, unsigned corners, double choice) {
  double left = choice * (shares[0] + shares[1] + shares[2]);
  std::size_t k = 0;
  while (k + 1 < corners && left >= shares[k]) left -= shares[k++];
  return k;
}

template <std::size_t N>
void put_random_weights(KeyedRandom& random, std::array<double, 4>& to) {
  const auto weights = random_weights<N>(random);
  std::copy(weights.begin(), weights.end(), to.begin());
}

}  // namespace

PatchSampler::PatchSampler(const CellComplex& complex, Patch patch, const std::optional<SampledPart>& part)
    : patch_(patch), part_(part) {
  for (const Cell c : complex.map().cells()) {
    if (!part || part->cells.is_own(c)) add(complex.map(), c);
  }
  std::uint64_t count = triangles_.size();
  if (part) part->ranks.sum({&count, 1});
  if (count == 0) throw InvalidArgument("the patch has no wall face at a free cell");
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
  std::vector<double> areas;
  for (const Triangle& t : triangles_)
    areas.push_back(facet_size(complex.map().dimension(), complex.corners(t.simplex), t.facet));
  by_flux_ = false;
  set_sizes(areas);
}

bool PatchSampler::update(const CellComplex& complex, const FlowAtCorner& flow) {
  const unsigned dimension = complex.map().dimension();
  std::vector<double> fluxes;
  inflow_.clear();
  for (const Triangle& t : triangles_) {
    const Vec3 normal = inward_normal(dimension, complex.corners(t.simplex), t.facet);
    std::array<double, 3>& inflow = inflow_.emplace_back();
    for (unsigned k = 0; k < dimension; ++k)
      inflow[k] = std::max(0.0, dot(normal, flow(t.simplex, corner_of(dimension, t.facet, k))));
    fluxes.push_back(inflow[0] + inflow[1] + inflow[2]);
  }
  by_flux_ = true;
  set_sizes(fluxes);
  return sizes_.length() > 0;
}

void PatchSampler::set_sizes(const std::vector<double>& sizes) {
  std::vector<Cell> cells;
  for (const Triangle& t : triangles_) cells.push_back(t.simplex.cell);
  const FixedPointScale scale =
      scale_of(sizes.empty() ? 0.0 : *std::max_element(sizes.begin(), sizes.end()), sizes.size(), part_);
  std::vector<std::uint64_t> scaled;
  for (const double size : sizes) scaled.push_back(scale(size));
  sizes_ = SizeTable(std::move(scaled), cells, part_);
}

// By area: if all areas are 0, the last triangle. Every rank takes as many numbers, so that all draw again alike.
std::optional<Sample> PatchSampler::sample(const CellComplex& complex, KeyedRandom& random) const {
  const std::uint64_t place = random.below(sizes_.length());
  const unsigned dimension = complex.map().dimension();
  std::array<double, 4> gaps{};
  const std::size_t count = dimension + (by_flux_ ? 1 : 0);
  if (count == 2) put_random_weights<2>(random, gaps);
  if (count == 3) put_random_weights<3>(random, gaps);
  if (count == 4) put_random_weights<4>(random, gaps);
  const double corner = by_flux_ ? random.uniform() : 0.0;
  std::optional<std::size_t> entry = sizes_.entry_at(place);
  if (!entry && sizes_.length() == 0 && !triangles_.empty()) entry = triangles_.size() - 1;
  if (!entry) return {};
  // A density that is linear in the triangle is a mixture of those that are 1 at one corner and 0 at the others. One of
  // these is that of the corner's share of the gaps between random cuts, if it has two of them and the others one.
  std::array<double, 3> w = {gaps[0], gaps[1], gaps[2]};
  if (by_flux_) {
    if (dimension == 2) w[2] = 0.0;
    w[corner_at(inflow_[*entry], dimension, corner)] += gaps[count - 1];
  }
  const Triangle& t = triangles_[*entry];
  const Corners v = complex.corners(t.simplex);
  const Vec3 on_face = on_facet(dimension, v, t.facet, w);
  constexpr double inwards = 0x1p-6;
  Weights weights{};
  weights[t.facet] = inwards;
  for (unsigned k = 0; k < dimension; ++k) weights[corner_of(dimension, t.facet, k)] = w[k] * (1.0 - inwards);
  return Sample{t.simplex, on_face + (v[t.facet] - on_face) * inwards, weights};
}

// Nothing is drawn again: the position is exact.
PointSampler::PointSampler(Environment& environment, const Vec3& at, const std::optional<SampledPart>& part) {
  const Location found = environment.locate(flushed(at));
  const bool own = found.place == Place::free && (!part || part->cells.is_own(found.simplex.cell));
  if (own) sample_ = Sample{found.simplex, flushed(at), {}};
  std::uint64_t count = own ? 1 : 0;
  if (part) part->ranks.sum({&count, 1});
  empty_ = count == 0;
}

namespace {

struct Waiting {
  std::uint64_t id;
  KeyedRandom random;
};

std::vector<std::uint64_t> of_all_ranks(const std::vector<std::uint64_t>& ids, Ranks& ranks) {
  ByteWriter out;
  out.put(ids);
  std::vector<std::uint64_t> all;
  for (const std::string& b : ranks.exchange(std::vector<std::string>(ranks.size(), out.bytes()))) {
    const auto list = ByteReader(b).take_list<std::uint64_t>();
    all.insert(all.end(), list.begin(), list.end());
  }
  std::sort(all.begin(), all.end());
  return all;
}

}  // namespace

// Sampled points are rounded. One that fell out of its simplex is drawn again, with the next numbers of the same id. If
// ranks have an environment's parts, all draw for each particle, and the one whose cell it is adds it. Where the last of
// all tries fails, the cells are inverted or too thin: particles wait there as they wait in any such cell.
template <class Sampler>
std::vector<std::uint64_t> place(const Placing& placing, Particles& particles, const Sampler& sampler,
                                 std::uint64_t first, std::uint64_t count) {
  constexpr int max_tries = 1000;
  Environment& environment = placing.environment;
  std::vector<Waiting> waiting;
  for (std::uint64_t id = first; id < first + count; ++id) {
    if (placing.part || placing.share.holds(id))
      waiting.push_back({id, KeyedRandom(placing.seed, RandomPurpose::place, id)});
  }
  std::vector<std::uint64_t> placed;
  for (int tries = 1; !waiting.empty(); ++tries) {
    std::vector<std::uint64_t> failed;
    for (Waiting& w : waiting) {
      const std::optional<Sample> s = sampler.sample(environment.complex(), w.random);
      if (!s) continue;
      const bool added = environment.add(particles, s->simplex, flushed(s->position)) ||
                         (tries == max_tries && environment.add_at(particles, s->simplex, s->weights));
      (added ? placed : failed).push_back(w.id);
    }
    if (placing.part) failed = of_all_ranks(failed, placing.part->ranks);
    std::erase_if(waiting, [&](const Waiting& w) { return !std::binary_search(failed.begin(), failed.end(), w.id); });
  }
  return placed;
}

template std::vector<std::uint64_t> place(const Placing&, Particles&, const VolumeSampler&, std::uint64_t,
                                          std::uint64_t);
template std::vector<std::uint64_t> place(const Placing&, Particles&, const PatchSampler&, std::uint64_t,
                                          std::uint64_t);
template std::vector<std::uint64_t> place(const Placing&, Particles&, const PointSampler&, std::uint64_t,
                                          std::uint64_t);

}  // namespace dartcast
