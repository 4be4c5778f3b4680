// Tools to cut with: planes thickened, discs, blades, boxes and capsules as convex bodies.
#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "base/elementary.hpp"
#include "dartcast/cutting.hpp"
#include "dartcast/error.hpp"
#include "editing/near.hpp"

namespace dartcast {

namespace {

void expect_positive(double length, const char* name) {
  if (!(length > 0.0 && std::isfinite(length)))
    throw InvalidArgument(std::string(name) + " must be a positive number of metres");
}

Vec3 unit(const Vec3& v) { return plane_through({}, v).normal; }

// Two unit vectors that form a frame with a third.
std::array<Vec3, 2> across(const Vec3& axis) {
  const Vec3 far = std::abs(axis.x) < 0.6 ? Vec3{1.0, 0.0, 0.0} : Vec3{0.0, 1.0, 0.0};
  const Vec3 u = unit(cross(far, axis));
  return {u, cross(axis, u)};
}

ConvexTool slab(const Plane& plane, double width) {
  const Plane turned = plane.turned();
  return {{{plane.normal, plane.offset + width / 2}, {turned.normal, turned.offset + width / 2}}, width};
}

}  // namespace

std::vector<ConvexTool> thicken(const Plane& plane, double width) {
  expect_positive(width, "the width of a cut");
  if (!is_finite(plane.normal) || !std::isfinite(plane.offset) || !(norm(plane.normal) > 0.0))
    throw InvalidArgument("a plane to cut along must be finite: make it by plane_through()");
  return {slab(plane, width)};
}

std::vector<ConvexTool> thicken(const Disc& disc, double width) {
  expect_positive(width, "the width of a cut");
  expect_positive(disc.radius, "the radius of a disc");
  if (disc.sides < 3 || disc.sides > 1000) throw InvalidArgument("a disc is taken as a polygon of 3 to 1000 sides");
  const Plane plane = plane_through(disc.centre, disc.normal);
  const auto [u, v] = across(plane.normal);
  ConvexTool tool = slab(plane, width);
  const double inner_radius = disc.radius * sine_cosine_of_turns(0.5 / disc.sides).cosine;
  for (std::uint32_t i = 0; i < disc.sides; ++i) {
    const SineCosine turned = sine_cosine_of_turns(static_cast<double>(i) / disc.sides);
    const Vec3 out = unit(u * turned.cosine + v * turned.sine);
    tool.planes.push_back(plane_through(disc.centre + out * inner_radius, out));
  }
  return {tool};
}

namespace {

// A planar part of the region that a blade sweeps. The blade enters by the edge from corner 0 to 1, and leaves by
// another.
struct Facet {
  std::vector<Vec3> corners;
  std::size_t exit;  // the edge from this corner to the next
  Vec3 normal;

  [[nodiscard]] Vec3 corner(std::size_t k) const { return corners[k % corners.size()]; }
};

void add_facet(std::vector<Facet>& facets, std::vector<Vec3> corners, std::size_t exit) {
  const Vec3 n = cross(corners[1] - corners[0], corners.back() - corners[0]);
  if (norm(n) > 0.0) facets.push_back({std::move(corners), exit, unit(n)});
}

std::vector<Facet> facets_of(const BladePath& path) {
  std::vector<Facet> facets;
  for (std::size_t i = 0; i + 1 < path.places.size(); ++i) {
    const auto& [a, b] = path.places[i];
    const auto& [c, d] = path.places[i + 1];
    const Vec3 n = cross(d - a, c - b);
    // Twice the distance of the diagonals, times |n|. Here it is only rounding.
    const double twist = std::abs(dot(n, (b - a) - (d - c)));
    const bool flat = a != c && b != d && twist <= 0x1p-40 * norm(n) * (norm(d - a) + norm(c - b));
    const bool convex = dot(n, cross(b - a, c - a)) > 0.0 && dot(n, cross(b - a, d - b)) > 0.0 &&
                        dot(n, cross(d - c, a - c)) < 0.0 && dot(n, cross(d - c, b - d)) < 0.0;
    if (flat && convex) {
      facets.push_back({{a, b, d, c}, 2, unit(n)});
    } else {
      add_facet(facets, {a, b, d}, 2);
      add_facet(facets, {a, d, c}, 1);
    }
  }
  return facets;
}

// The plane through an edge of a facet: upright on the facet or, between two facets, half way.
Plane side_of(const Facet& facet, std::size_t edge, const Facet* next) {
  const Vec3 up = next == nullptr ? facet.normal : facet.normal + next->normal;
  if (next != nullptr && dot(facet.normal, next->normal) < -0.9)
    throw InvalidArgument("the path of the blade turns back onto itself: cut in two paths");
  return plane_through(facet.corner(edge), cross(facet.corner(edge + 1) - facet.corner(edge), up));
}

}  // namespace

std::vector<ConvexTool> thicken(const BladePath& path, double width) {
  expect_positive(width, "the width of a cut");
  for (const auto& [a, b] : path.places) {
    if (!is_finite(a) || !is_finite(b) || a == b)
      throw InvalidArgument("a blade needs two finite ends apart from each other");
  }
  const std::vector<Facet> facets = facets_of(path);
  if (facets.empty()) throw InvalidArgument("the path of a blade needs two places between which it sweeps an area");
  std::vector<ConvexTool> tools;
  for (std::size_t i = 0; i < facets.size(); ++i) {
    const Facet& facet = facets[i];
    tools.push_back(slab(plane_through(facet.corners[0], facet.normal), width));
    for (std::size_t k = 0; k < facet.corners.size(); ++k) {
      const Facet* next = nullptr;
      if (k == 0 && i > 0) next = &facets[i - 1];
      if (k == facet.exit && i + 1 < facets.size()) next = &facets[i + 1];
      tools.back().planes.push_back(side_of(facet, k, next));
      // Beyond a slight bend, the sides of one part nearly continue those of the next. The wedges between them are cut
      // as they are, because they are too thin to be bent.
      const double bend = next == nullptr ? 1.0 : norm(cross(facet.normal, next->normal));
      if (next != nullptr && bend > 0x1p-30)
        tools.back().finest = std::min(tools.back().finest, width * bend * 0x1p-10);
    }
  }
  return tools;
}

ConvexTool box_tool(const Vec3& low, const Vec3& high) {
  if (!is_finite(low) || !is_finite(high) || !(low.x < high.x && low.y < high.y && low.z < high.z))
    throw InvalidArgument("a box to cut with must be finite and not empty");
  ConvexTool tool;
  for (const Vec3& axis : {Vec3{1.0, 0.0, 0.0}, Vec3{0.0, 1.0, 0.0}, Vec3{0.0, 0.0, 1.0}}) {
    tool.planes.push_back({axis, dot(axis, high)});
    tool.planes.push_back({-axis, -dot(axis, low)});
    tool.finest = std::min(tool.finest, dot(axis, high - low));
  }
  return tool;
}

ConvexTool capsule_tool(const Vec3& a, const Vec3& b, double radius) {
  expect_positive(radius, "the radius of a tool");
  if (!is_finite(a) || !is_finite(b)) throw InvalidArgument("the ends of a tool must be finite");
  const Vec3 axis = a == b ? Vec3{0.0, 0.0, 1.0} : unit(b - a);
  const auto [u, v] = across(axis);
  ConvexTool tool;
  tool.finest = radius;
  for (int i = -1; i <= 1; ++i) {
    for (int j = -1; j <= 1; ++j) {
      for (int k = -1; k <= 1; ++k) {
        if (i == 0 && j == 0 && k == 0) continue;
        const Vec3 n = unit(u * i + v * j + axis * k);
        tool.planes.push_back({n, std::max(dot(n, a), dot(n, b)) + radius});
      }
    }
  }
  return tool;
}

namespace {

std::span<const std::uint32_t> corners_of(const CellView& v) { return v.vertices().first(v.shape().corner_count()); }

bool near(const CellComplex& complex, Cell c, std::span<const ConvexTool> tools) {
  const auto position = [&](Vertex v) { return complex.positions()[v.value]; };
  return std::any_of(tools.begin(), tools.end(), [&](const ConvexTool& tool) {
    return detail::near(corners_of(complex.map().view(c)), tool.planes, position);
  });
}

// Finds cells near a tool. Most cells lie beyond one of the first planes. So each vertex is compared with these once,
// not once for each of its cells.
class NearTool {
 public:
  NearTool(const CellComplex& complex, const ConvexTool& tool)
      : positions_(complex.positions()),
        first_(std::span(tool.planes).first(std::min<std::size_t>(tool.planes.size(), 2))),
        others_(std::span(tool.planes).subspan(first_.size())),
        below_(positions_.size()) {
    for (std::size_t k = 0; k < first_.size(); ++k) {
      const Plane plane = first_[k];
      for (std::size_t v = 0; v < below_.size(); ++v)
        below_[v] |= static_cast<std::uint8_t>((plane.height(positions_[v]) < 0.0 ? 1U : 0U) << k);
    }
  }

  [[nodiscard]] bool operator()(std::span<const std::uint32_t> corners) const {
    unsigned below = 0;
    for (const std::uint32_t v : corners) below |= below_[v];
    return below + 1U == 1U << first_.size() &&
           detail::near(corners, others_, [&](Vertex v) { return positions_[v.value]; });
  }

 private:
  std::span<const Vec3> positions_;
  std::span<const Plane> first_, others_;
  std::vector<std::uint8_t> below_;  // by vertex: bit k is set below plane k of the first
};

}  // namespace

std::vector<Cell> cells_near(const CellComplex& complex, std::span<const ConvexTool> tools) {
  std::vector<NearTool> near;
  for (const ConvexTool& tool : tools) near.emplace_back(complex, tool);
  std::vector<Cell> cells;
  const CombinatorialMap& map = complex.map();
  for (std::uint32_t pool = 0; pool <= CombinatorialMap::general_pool; ++pool) {
    map.for_each_cell(pool, 0, map.slot_count(pool), [&](Cell c, const CellView& v) {
      if (std::any_of(near.begin(), near.end(), [&](const NearTool& tool) { return tool(corners_of(v)); }))
        cells.push_back(c);
    });
  }
  return cells;
}

std::vector<Cell> cells_near(const CellComplex& complex, std::span<const ConvexTool> tools, Cell start) {
  if (!complex.map().contains(start)) throw InvalidArgument("there is no such cell to look for others from");
  if (!near(complex, start, tools)) return {};
  std::vector<Cell> cells = {start};
  std::unordered_set<std::uint32_t> seen = {start.value};
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const CellView v = complex.map().view(cells[i]);
    for (std::uint16_t f = 0; f < v.shape().face_count(); ++f) {
      const Cell other = v.neighbour(f);
      if (other.valid() && seen.insert(other.value).second && near(complex, other, tools)) cells.push_back(other);
    }
  }
  return cells;
}

}  // namespace dartcast
