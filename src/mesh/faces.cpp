// Matches equal faces of cells by sorted corners, in buckets.
#include "mesh/faces.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include "mesh/baffles.hpp"
#include "mesh/cell_types.hpp"
#include "mesh/polyhedron.hpp"

namespace dartcast {
namespace {

constexpr std::uint32_t no_corner = 0xffffffffU;

/// A face by its four smallest corners, for sorting.
struct FaceKey {
  std::array<std::uint32_t, 4> corners;  // ascending; `no_corner` if the face has fewer
  std::uint32_t cell;
  std::uint32_t place;         // from the cell's start in connectivity for a polyhedron; else the face's number
  std::uint32_t size : 16;     // at most polyhedron_limit
  std::uint32_t forward : 1;   // the corner after the smallest is smaller than the one before it; edges: the first is
  std::uint32_t opposite : 2;  // of a quadrangle: which of corners[1..3] lies opposite the smallest
};

static_assert(polyhedron_limit <= 0xffffU);

FaceKey make_key(std::span<const std::uint32_t> face, std::size_t cell, std::size_t place) {
  FaceKey key{};
  const std::size_t n = face.size();
  key.corners.fill(no_corner);
  std::partial_sort_copy(face.begin(), face.end(), key.corners.begin(), key.corners.end());
  const auto at = static_cast<std::size_t>(std::find(face.begin(), face.end(), key.corners[0]) - face.begin());
  key.cell = static_cast<std::uint32_t>(cell);
  key.place = static_cast<std::uint32_t>(place);
  key.size = static_cast<std::uint16_t>(n);
  key.forward = (n == 2 ? at == 0 : face[(at + 1) % n] < face[(at + n - 1) % n]) ? 1 : 0;
  for (std::uint32_t k = 1; n == 4 && k < 4; ++k) {
    if (face[(at + 2) % n] == key.corners[k]) key.opposite = k & 3U;
  }
  return key;
}

/// Calls visit(corners, cell, place) for every face of the mesh.
template <class Visit>
void for_each_placed_face(const MeshData& mesh, Visit&& visit) {
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    const bool polyhedron = mesh.types[c] == CellType::polyhedron;
    std::size_t place = polyhedron ? 1 : 0;
    for_each_face(mesh, c, [&](std::span<const std::uint32_t> face) {
      visit(face, c, place);
      place += polyhedron ? face.size() + 1 : 1;
    });
  }
}

/// The corners of a face in the cell's own order.
std::vector<std::uint32_t> corners_of(const MeshData& mesh, const FaceKey& key) {
  const auto cell = mesh.cell(key.cell);
  std::vector<std::uint32_t> out;
  if (mesh.types[key.cell] == CellType::polyhedron) {
    const auto face = cell.subspan(key.place + 1, cell[key.place]);
    out.assign(face.begin(), face.end());
  } else if (mesh.types[key.cell] == CellType::polygon) {
    out = {cell[key.place], cell[(key.place + 1) % cell.size()]};
  } else {
    for (const std::uint8_t k : standard_faces(mesh.types[key.cell])[key.place]) out.push_back(cell[k]);
  }
  return out;
}

std::vector<std::uint32_t> sorted_corners(const MeshData& mesh, const FaceKey& key) {
  auto corners = corners_of(mesh, key);
  std::sort(corners.begin(), corners.end());
  return corners;
}

/// Three-way order by the set of corners.
int compare(const MeshData& mesh, const FaceKey& a, const FaceKey& b) {
  if (a.corners != b.corners) return a.corners < b.corners ? -1 : 1;
  if (a.size != b.size) return a.size < b.size ? -1 : 1;
  if (a.size <= 4) return 0;
  const auto x = sorted_corners(mesh, a);
  const auto y = sorted_corners(mesh, b);
  return x == y ? 0 : (x < y ? -1 : 1);
}

enum class FaceUse { opposite, same_side, twisted };

/// How two faces with the same set of corners lie to each other.
FaceUse meeting(const MeshData& mesh, const FaceKey& a, const FaceKey& b) {
  if (a.size <= 4) {
    if (a.opposite != b.opposite) return FaceUse::twisted;
    return a.forward != b.forward ? FaceUse::opposite : FaceUse::same_side;
  }
  const auto x = corners_of(mesh, a);
  auto y = corners_of(mesh, b);
  const auto matches = [&] {
    std::rotate(y.begin(), std::find(y.begin(), y.end(), x[0]), y.end());
    return x == y;
  };
  if (matches()) return FaceUse::same_side;
  std::reverse(y.begin(), y.end());
  return matches() ? FaceUse::opposite : FaceUse::twisted;
}

/// Faces grouped by their smallest corner, by counting: bucket v holds keys [start[v], start[v + 1]).
struct Buckets {
  std::vector<std::size_t> start;
  std::vector<FaceKey> keys;
};

Buckets fill_buckets(const MeshData& mesh) {
  Buckets b;
  b.start.assign(mesh.points.size() + 1, 0);
  for_each_placed_face(mesh, [&](std::span<const std::uint32_t> face, std::size_t, std::size_t) {
    ++b.start[*std::min_element(face.begin(), face.end()) + 1];
  });
  std::partial_sum(b.start.begin(), b.start.end(), b.start.begin());
  b.keys.resize(b.start.back());
  auto next = b.start;
  for_each_placed_face(mesh, [&](std::span<const std::uint32_t> face, std::size_t cell, std::size_t place) {
    const FaceKey key = make_key(face, cell, place);
    b.keys[next[key.corners[0]]++] = key;
  });
  return b;
}

std::uint32_t find_root(std::vector<std::uint32_t>& parent, std::uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

}  // namespace

FaceMatch match_faces(const MeshData& mesh, bool with_baffles) {
  FaceMatch out;
  const Baffles baffles(mesh);
  Buckets buckets = fill_buckets(mesh);
  std::vector<std::uint32_t> parent(mesh.cell_count());
  std::iota(parent.begin(), parent.end(), 0U);
  out.parts = parent.size();

  const auto unite = [&](std::uint32_t x, std::uint32_t y) {
    const auto a = find_root(parent, x);
    const auto b = find_root(parent, y);
    if (a == b) return;
    parent[b] = a;
    --out.parts;
  };
  const auto add_boundary = [&](const FaceKey& key) {
    const auto corners = corners_of(mesh, key);
    out.boundary.corners.insert(out.boundary.corners.end(), corners.begin(), corners.end());
    out.boundary.offsets.push_back(out.boundary.corners.size());
    out.boundary.cells.push_back(key.cell);
  };
  const auto take_group = [&](std::span<const FaceKey> group) {
    if (group.size() == 1) {
      add_boundary(group[0]);
    } else if (group.size() > 2) {
      out.crowded.push_back(group[0].cell);
    } else {
      const FaceUse how = meeting(mesh, group[0], group[1]);
      if (how == FaceUse::same_side) {
        out.same_side.push_back({group[0].cell, group[1].cell});
        return;
      }
      if (how == FaceUse::twisted) out.twisted.push_back(group[0].cell);
      if (baffles.contains(corners_of(mesh, group[0]))) {
        for (std::size_t side = 0; with_baffles && side < 2; ++side) add_boundary(group[side]);
        return;
      }
    }
    for (const FaceKey& key : group) unite(group[0].cell, key.cell);
  };

  for (std::size_t v = 0; v + 1 < buckets.start.size(); ++v) {
    const std::span<FaceKey> bucket(buckets.keys.data() + buckets.start[v], buckets.start[v + 1] - buckets.start[v]);
    std::sort(bucket.begin(), bucket.end(), [&](const FaceKey& a, const FaceKey& b) {
      const int order = compare(mesh, a, b);
      return order != 0 ? order < 0 : a.cell < b.cell;
    });
    for (std::size_t i = 0, j = 0; i < bucket.size(); i = j) {
      for (j = i + 1; j < bucket.size() && compare(mesh, bucket[i], bucket[j]) == 0;) ++j;
      take_group(bucket.subspan(i, j - i));
    }
  }
  for (std::uint32_t c = 0; c < parent.size(); ++c) parent[c] = find_root(parent, c);
  out.part = std::move(parent);
  return out;
}

}  // namespace dartcast
