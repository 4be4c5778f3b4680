// Inverse-distance weights, with a linear correction: w (1 + c . r) for an item at r from the point. The vector c makes
// the sum of all w (1 + c . r) r vanish, so that linear fields come out exactly. It solves a symmetric system of three.
#include "mesh/point_weights.hpp"

#include <algorithm>
#include <cmath>

#include "mesh/cell_types.hpp"

namespace dartcast {

namespace {

Vec3 mean_of_corners(const MeshData& mesh, std::span<const std::uint32_t> face) {
  Vec3 sum;
  for (const std::uint32_t p : face) sum += mesh.points[p];
  return sum * (1.0 / static_cast<double>(face.size()));
}

// Adds up pieces of a cell: their sizes, and their centres times their sizes.
struct CentreSum {
  double size = 0.0;
  Vec3 moment;

  void add(double piece, const Vec3& centre) {
    size += piece;
    moment += centre * piece;
  }
};

// Tetrahedra from m over the triangles of a face around its mean; in the plane a triangle over an edge.
void add_pieces(const MeshData& mesh, std::span<const std::uint32_t> face, const Vec3& m, CentreSum& sum) {
  if (face.size() == 2) {
    const Vec3 a = mesh.points[face[0]] - m;
    const Vec3 b = mesh.points[face[1]] - m;
    return sum.add(a.x * b.y - a.y * b.x, (a + b) * (1.0 / 3.0));
  }
  const Vec3 middle = mean_of_corners(mesh, face) - m;
  for (std::size_t i = 0; i < face.size(); ++i) {
    const Vec3 a = mesh.points[face[i]] - m;
    const Vec3 b = mesh.points[face[(i + 1) % face.size()]] - m;
    sum.add(dot(middle, cross(a, b)), (middle + a + b) * 0.25);
  }
}

// Each item's point numbers, without repeats.
template <class PointsOf>
PointWeights items_around(std::size_t points, std::size_t items, PointsOf&& points_of) {
  PointWeights out;
  out.offsets.assign(points + 1, 0);
  std::vector<std::uint32_t> own;
  const auto for_each = [&](auto&& visit) {
    for (std::uint32_t i = 0; i < items; ++i) {
      own.clear();
      points_of(i, own);
      std::sort(own.begin(), own.end());
      own.erase(std::unique(own.begin(), own.end()), own.end());
      for (const std::uint32_t p : own) visit(p, i);
    }
  };
  for_each([&](std::uint32_t p, std::uint32_t) { ++out.offsets[p + 1]; });
  for (std::size_t p = 0; p < points; ++p) out.offsets[p + 1] += out.offsets[p];
  out.items.resize(out.offsets.back());
  std::vector<std::size_t> at(out.offsets.begin(), out.offsets.end() - 1);
  for_each([&](std::uint32_t p, std::uint32_t i) { out.items[at[p]++] = i; });
  out.weights.resize(out.items.size());
  return out;
}

// The solution of A c = b; a, b, c: the columns of A. Not finite if A is singular.
Vec3 solution(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& right) {
  const Vec3 bc = cross(b, c);
  return Vec3{dot(right, bc), dot(a, cross(right, c)), dot(a, cross(b, right))} * (1.0 / dot(a, bc));
}

// If all centres lie in a plane that misses the point, nothing but rounding would be left of the weights.
constexpr double smallest_share = 0x1p-10;

// Corrects the weights of items at these places relative to the point, in units of the nearest, if none turns negative.
void correct(std::span<const Vec3> places, std::span<double> weights, bool plane) {
  Vec3 first;
  Vec3 x;
  Vec3 y;
  Vec3 z = {0.0, 0.0, plane ? 1.0 : 0.0};
  for (std::size_t k = 0; k < places.size(); ++k) {
    const Vec3& r = places[k];
    first += r * weights[k];
    x += r * (weights[k] * r.x);
    y += r * (weights[k] * r.y);
    z += r * (weights[k] * r.z);
  }
  const Vec3 c = solution(x, y, z, first * -1.0);
  std::vector<double> corrected;
  double before = 0.0;
  double after = 0.0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const double factor = 1.0 + dot(c, places[k]);
    if (!(factor >= 0.0)) return;
    before += weights[k];
    after += corrected.emplace_back(weights[k] * factor);
  }
  if (after >= smallest_share * before && std::isfinite(after))
    std::copy(corrected.begin(), corrected.end(), weights.begin());
}

// An item at the point itself has all the weight.
void weigh(std::vector<Vec3>& places, std::span<double> weights, bool corrects, bool plane) {
  double nearest = norm(places.front());
  for (const Vec3& r : places) nearest = std::min(nearest, norm(r));
  for (std::size_t k = 0; k < places.size(); ++k) {
    if (nearest > 0.0) places[k] *= 1.0 / nearest;
    weights[k] = nearest > 0.0 ? 1.0 / norm(places[k]) : (norm(places[k]) > 0.0 ? 0.0 : 1.0);
  }
  if (corrects && nearest > 0.0) correct(places, weights, plane);
  double sum = 0.0;
  for (const double w : weights) sum += w;
  for (double& w : weights) w /= sum;
}

void weigh_all(const MeshData& mesh, std::span<const Vec3> centres, bool corrects, PointWeights& out) {
  const bool plane = mesh.dimension() == 2;
  std::vector<Vec3> places;
  for (std::size_t p = 0; p < out.points(); ++p) {
    const std::size_t begin = out.offsets[p];
    const std::size_t size = out.offsets[p + 1] - begin;
    if (size == 0) continue;
    places.clear();
    for (std::size_t k = begin; k < begin + size; ++k) places.push_back(centres[out.items[k]] - mesh.points[p]);
    weigh(places, std::span(out.weights).subspan(begin, size), corrects, plane);
  }
}

}  // namespace

std::vector<Vec3> cell_centres(const MeshData& mesh) {
  std::vector<Vec3> centres(mesh.cell_count());
  for (std::size_t c = 0; c < centres.size(); ++c) {
    Vec3 m;
    double count = 0.0;
    for_each_face(mesh, c, [&](std::span<const std::uint32_t> face) {
      for (const std::uint32_t p : face) m += mesh.points[p];
      count += static_cast<double>(face.size());
    });
    m *= 1.0 / count;
    CentreSum sum;
    for_each_face(mesh, c, [&](std::span<const std::uint32_t> face) { add_pieces(mesh, face, m, sum); });
    centres[c] = sum.size > 0.0 ? m + sum.moment * (1.0 / sum.size) : m;
  }
  return centres;
}

PointWeights weights_of_cells(const MeshData& mesh) {
  PointWeights out =
      items_around(mesh.points.size(), mesh.cell_count(), [&](std::size_t c, std::vector<std::uint32_t>& own) {
        for_each_face(mesh, c,
                      [&](std::span<const std::uint32_t> face) { own.insert(own.end(), face.begin(), face.end()); });
      });
  weigh_all(mesh, cell_centres(mesh), true, out);
  return out;
}

PointWeights weights_of_patch_faces(const MeshData& mesh) {
  std::vector<Vec3> middles;
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) middles.push_back(mean_of_corners(mesh, mesh.patch_face(f)));
  PointWeights out =
      items_around(mesh.points.size(), middles.size(), [&](std::size_t f, std::vector<std::uint32_t>& own) {
        const auto face = mesh.patch_face(f);
        own.assign(face.begin(), face.end());
      });
  weigh_all(mesh, middles, false, out);
  return out;
}

std::vector<double> values_at_points(const PointWeights& weights, std::span<const double> values,
                                     std::size_t components) {
  std::vector<double> out(weights.points() * components);
  for (std::size_t p = 0; p < weights.points(); ++p) {
    const std::size_t begin = weights.offsets[p];
    const std::size_t end = weights.offsets[p + 1];
    if (begin == end) continue;
    for (std::size_t j = 0; j < components; ++j) {
      const double first = values[weights.items[begin] * components + j];
      double sum = 0.0;
      for (std::size_t k = begin + 1; k < end; ++k)
        sum += (values[weights.items[k] * components + j] - first) * weights.weights[k];
      out[p * components + j] = first + sum;
    }
  }
  return out;
}

}  // namespace dartcast
