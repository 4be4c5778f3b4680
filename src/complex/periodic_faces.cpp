// Pairs the faces of periodic patches.
//
// The phases, for each pair:
// 1. Find the wall faces of both patches.
// 2. Find for each corner of a the corner of b that the motion takes it to, in a grid.
// 3. Find for each face of a the face of b with these corners.
#include "complex/periodic_faces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>

#include "base/elementary.hpp"
#include "dartcast/error.hpp"

namespace dartcast::detail {

namespace {

constexpr double largest_tolerance = 0.1;

std::string name_of(const PeriodicPair& pair) { return fmt::format("periodic pair \"{}\", \"{}\"", pair.a, pair.b); }

[[noreturn]] void refuse(const PeriodicPair& pair, const std::string& why) {
  throw InvalidMesh(fmt::format("{}: {}", name_of(pair), why));
}

std::string text(const Vec3& x) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", x.x, x.y, x.z); }

double distance(const Vec3& a, const Vec3& b) { return hypotenuse(a.x - b.x, a.y - b.y, a.z - b.z); }

void check(const PeriodicPair& pair, unsigned dimension) {
  if (pair.a == pair.b) refuse(pair, "a patch cannot be its own partner: name two patches");
  if (!(pair.tolerance > 0.0 && pair.tolerance <= largest_tolerance))
    refuse(pair,
           fmt::format("the tolerance is {}: it must be above 0, and at most {}", pair.tolerance, largest_tolerance));
  const bool planar = pair.translate.z == 0.0 && pair.axis.x == 0.0 && pair.axis.y == 0.0 && pair.centre.z == 0.0;
  if (dimension == 2 && !planar)
    refuse(pair, "in the plane the z of translate and centre must be 0, and the axis must be (0, 0, 1)");
}

// Vertices by place, to find those near a point.
class CornerBins {
 public:
  CornerBins(std::span<const std::uint32_t> vertices, std::span<const Vec3> positions, double reach)
      : positions_(positions), reach_(reach), width_(2.0 * reach), origin_(positions[vertices.front()]) {
    for (const std::uint32_t v : vertices) bins_[bin(positions[v])].push_back(v);
  }

  // The nearest one within reach; none: 0xffffffff.
  [[nodiscard]] std::uint32_t nearest(const Vec3& x) const {
    const Bin low = bin(x - Vec3{reach_, reach_, reach_});
    std::uint32_t best = none;
    double least = reach_;
    for (unsigned next = 0; next < 8; ++next) {  // bins are twice as wide as the reach
      const auto found = bins_.find({low[0] + (next & 1U), low[1] + ((next >> 1U) & 1U), low[2] + (next >> 2U)});
      if (found == bins_.end()) continue;
      for (const std::uint32_t v : found->second) {
        const double d = distance(positions_[v], x);
        if (d > least) continue;
        least = d;
        best = v;
      }
    }
    return best;
  }

  static constexpr std::uint32_t none = 0xffffffffU;

 private:
  using Bin = std::array<double, 3>;  // whole numbers: the tolerance keeps them far below 2^53
  [[nodiscard]] Bin bin(const Vec3& x) const {
    const auto at = [&](double along) { return std::floor(along / width_); };
    return {at(x.x - origin_.x), at(x.y - origin_.y), at(x.z - origin_.z)};
  }

  std::span<const Vec3> positions_;
  double reach_, width_;
  Vec3 origin_;
  std::map<Bin, std::vector<std::uint32_t>> bins_;
};

double diagonal(std::span<const std::uint32_t> vertices, std::span<const Vec3> positions) {
  Vec3 low = positions[vertices.front()];
  Vec3 high = low;
  for (const std::uint32_t v : vertices) {
    const Vec3& x = positions[v];
    low = {std::min(low.x, x.x), std::min(low.y, x.y), std::min(low.z, x.z)};
    high = {std::max(high.x, x.x), std::max(high.y, x.y), std::max(high.z, x.z)};
  }
  return distance(low, high);
}

template <class Sides>
std::vector<std::uint32_t> corners_of(const Sides& sides) {
  std::set<std::uint32_t> all;
  for (const auto& side : sides) all.insert(side.corners.begin(), side.corners.end());
  return {all.begin(), all.end()};
}

Vec3 middle(std::span<const std::uint32_t> corners, std::span<const Vec3> positions) {
  Vec3 sum;
  for (const std::uint32_t v : corners) sum += positions[v];
  return sum * (1.0 / static_cast<double>(corners.size()));
}

std::vector<std::uint32_t> sorted(std::vector<std::uint32_t> corners) {
  std::sort(corners.begin(), corners.end());
  return corners;
}

}  // namespace

PeriodicMotion::PeriodicMotion(const PeriodicPair& pair) {
  const bool finite = is_finite(pair.translate) && is_finite(pair.axis) && is_finite(pair.centre);
  if (!finite || !std::isfinite(pair.angle)) refuse(pair, "a number is not finite");
  to_ = pair.translate;
  if (pair.angle == 0.0) return;
  const double length = hypotenuse(pair.axis.x, pair.axis.y, pair.axis.z);
  if (!(length > 0.0)) refuse(pair, "an angle needs an axis that is not zero");
  from_ = pair.centre;
  to_ = pair.centre + pair.translate;
  const Vec3 n = {pair.axis.x / length, pair.axis.y / length, pair.axis.z / length};
  const auto [s, c] = sine_cosine_of_turns(pair.angle / 360.0);
  const double d = 1.0 - c;
  rows_ = {Vec3{c + n.x * n.x * d, n.x * n.y * d - n.z * s, n.x * n.z * d + n.y * s},
           Vec3{n.y * n.x * d + n.z * s, c + n.y * n.y * d, n.y * n.z * d - n.x * s},
           Vec3{n.z * n.x * d - n.y * s, n.z * n.y * d + n.x * s, c + n.z * n.z * d}};
}

PeriodicMotion PeriodicMotion::inverse() const {
  PeriodicMotion back = *this;
  back.rows_ = {Vec3{rows_[0].x, rows_[1].x, rows_[2].x}, Vec3{rows_[0].y, rows_[1].y, rows_[2].y},
                Vec3{rows_[0].z, rows_[1].z, rows_[2].z}};
  std::swap(back.from_, back.to_);
  return back;
}

PeriodicMotion PeriodicMotion::then(const PeriodicMotion& next) const {
  PeriodicMotion both = *this;
  const PeriodicMotion rows_of_this = inverse();  // its rows are the columns of this
  for (unsigned i = 0; i < 3; ++i) both.rows_[i] = rows_of_this.vector(next.rows_[i]);
  both.to_ = next.point(to_);
  return both;
}

PeriodicMotion PeriodicMotion::power(double times) const {
  PeriodicMotion result = *this;
  result.rows_ = {Vec3{1.0, 0.0, 0.0}, Vec3{0.0, 1.0, 0.0}, Vec3{0.0, 0.0, 1.0}};
  result.to_ = from_;
  PeriodicMotion square = *this;
  for (auto left = static_cast<std::uint64_t>(times); left != 0; left /= 2) {
    if (left % 2 != 0) result = result.then(square);
    square = square.then(square);
  }
  return result;
}

PeriodicFaces::PeriodicFaces(std::vector<PeriodicPair> pairs, const CombinatorialMap& map,
                             std::span<const Vec3> positions)
    : pairs_(std::move(pairs)) {
  if (pairs_.size() > 0xffffU) throw InvalidMesh("periodic pairs: there are more than 65,535");
  for (std::size_t i = 0; i < pairs_.size(); ++i) add_pair(static_cast<std::uint16_t>(i), map, positions);
}

Vertex PeriodicFaces::partner(const PeriodicPartner& to, Vertex v) const {
  const auto& vertices = ways_[to.pair].vertices[to.back ? 1 : 0];
  const auto found = vertices.find(v.value);
  return found == vertices.end() ? Vertex{} : Vertex{found->second};
}

void PeriodicFaces::check_move(std::span<const Vec3> positions) const {
  for (std::size_t i = 0; i < ways_.size(); ++i) {
    const Ways& ways = ways_[i];
    for (const auto& [a, b] : ways.corners) {
      const double off = distance(ways.there.point(positions[a]), positions[b]);
      if (off <= ways.tolerance) continue;
      throw InvalidArgument(fmt::format(
          "move: {}: vertex {} at {} comes {:.3g} off its partner, vertex {} at {}; the tolerance is {:.3g}: move both "
          "sides in the same way",
          name_of(pairs_[i]), a, text(positions[a]), off, b, text(positions[b]), ways.tolerance));
    }
  }
}

std::vector<PeriodicFaces::Side> PeriodicFaces::sides(const CombinatorialMap& map, Patch patch) {
  std::vector<Side> sides;
  for (const Cell c : map.cells()) {
    const CellView cell = map.view(c);
    for (std::uint16_t f = 0; f < cell.shape().face_count(); ++f) {
      if (!cell.is_wall(f) || map.patch(CellFace{c, f}) != patch) continue;
      Side& side = sides.emplace_back(Side{{c, f}, {}});
      for (const std::uint16_t corner : cell.shape().corners(f)) side.corners.push_back(cell.vertex(corner).value);
    }
  }
  return sides;
}

void PeriodicFaces::add_pair(std::uint16_t number, const CombinatorialMap& map, std::span<const Vec3> positions) {
  const PeriodicPair& pair = pairs_[number];
  check(pair, map.dimension());
  const PeriodicMotion there(pair);
  ways_.push_back({there, there.inverse()});
  const std::vector<Side> a = sides(map, map.patch(pair.a));
  const std::vector<Side> b = sides(map, map.patch(pair.b));
  for (const auto* patch : {&a, &b})
    if (patch->empty()) refuse(pair, fmt::format("\"{}\" has no wall face", patch == &a ? pair.a : pair.b));
  pair_corners(number, a, b, positions);
  pair_faces(number, a, b, map, positions);
}

void PeriodicFaces::pair_corners(std::uint16_t number, std::span<const Side> a, std::span<const Side> b,
                                 std::span<const Vec3> positions) {
  const PeriodicPair& pair = pairs_[number];
  Ways& ways = ways_[number];
  const std::vector<std::uint32_t> from = corners_of(a);
  const std::vector<std::uint32_t> to = corners_of(b);
  ways.tolerance = pair.tolerance * diagonal(from, positions);
  const CornerBins corners(to, positions, ways.tolerance);
  for (const std::uint32_t v : from) {
    const Vec3 image = ways.there.point(positions[v]);
    const std::uint32_t partner = corners.nearest(image);
    if (partner == CornerBins::none || !ways.vertices[1].emplace(partner, v).second) {
      const auto nearer = [&](std::uint32_t x, std::uint32_t y) {
        return distance(positions[x], image) < distance(positions[y], image);
      };
      const Vec3& nearest = positions[*std::min_element(to.begin(), to.end(), nearer)];
      refuse(pair,
             fmt::format("the corner at {} of \"{}\" comes to {}: no corner of \"{}\" is its partner within {:.3g}; "
                         "the nearest one is at {}",
                         text(positions[v]), pair.a, text(image), pair.b, ways.tolerance, text(nearest)));
    }
    ways.vertices[0].emplace(v, partner);
    ways.corners.emplace_back(v, partner);
  }
}

void PeriodicFaces::pair_faces(std::uint16_t number, std::span<const Side> a, std::span<const Side> b,
                               const CombinatorialMap& map, std::span<const Vec3> positions) {
  const PeriodicPair& pair = pairs_[number];
  std::map<std::vector<std::uint32_t>, CellFace> partners;
  for (const Side& side : b) {
    if (!partners.emplace(sorted(side.corners), side.face).second)
      refuse(pair, fmt::format("two faces of \"{}\" have the same corners, at {}", pair.b,
                               text(middle(side.corners, positions))));
  }
  const auto lacks = [&](const std::string& patch, const Vec3& place, const std::string& other) {
    refuse(pair, fmt::format("the face of \"{}\" at {} has no partner in \"{}\"", patch, text(place), other));
  };
  for (const Side& side : a) {
    std::vector<std::uint32_t> images;
    for (const std::uint32_t v : side.corners) images.push_back(ways_[number].vertices[0].at(v));
    const auto found = partners.find(sorted(images));
    if (found == partners.end()) lacks(pair.a, middle(side.corners, positions), pair.b);
    join(number, side.face, found->second, map);
    partners.erase(found);
  }
  if (!partners.empty()) lacks(pair.b, middle(partners.begin()->first, positions), pair.a);
}

// Steiner points of the faces are partners, too.
void PeriodicFaces::join(std::uint16_t number, CellFace a, CellFace b, const CombinatorialMap& map) {
  Ways& ways = ways_[number];
  const Vertex point_a = map.point(a);
  const Vertex point_b = map.point(b);
  if (point_a.valid() && point_b.valid()) {
    ways.vertices[0].emplace(point_a.value, point_b.value);
    ways.vertices[1].emplace(point_b.value, point_a.value);
  }
  if (!map.is_free(a.cell) || !map.is_free(b.cell)) return;
  const bool added = partners_.emplace(code(a), PeriodicPartner{b, number, false}).second &&
                     partners_.emplace(code(b), PeriodicPartner{a, number, true}).second;
  if (!added) refuse(pairs_[number], "a patch is in another pair, too");
  ++ways.faces;
}

void refuse_periodic(const CellComplex& complex, const char* what) {
  if (complex.periodic() != nullptr)
    throw InvalidArgument(
        fmt::format("{}: they cannot be in a scene with periodic pairs: leave either out. Pairs that the mesh's file "
                    "names are walls if `walls` of the scene names a patch of them",
                    what));
}

}  // namespace dartcast::detail
