// Turns the faces of a polyhedron the same way, and checks that they close.
#include "mesh/polyhedron.hpp"

#include <algorithm>
#include <tuple>
#include <utility>
#include <vector>

namespace dartcast {
namespace {

/// An edge of a face, from its smaller corner.
struct PolyhedronEdge {
  std::uint32_t low;
  std::uint32_t high;
  std::uint32_t face;
  bool forward;  // the face runs from low to high
};

struct PolyhedronFaces {
  std::vector<std::uint32_t*> start;  // of each face's corners
  std::vector<std::size_t> size;
};

PolyhedronFaces faces_of(MeshData& mesh, std::size_t c) {
  std::uint32_t* cell = mesh.connectivity.data() + mesh.offsets[c];
  PolyhedronFaces faces;
  std::size_t at = 1;
  for (std::uint32_t f = 0; f < cell[0]; ++f) {
    faces.start.push_back(cell + at + 1);
    faces.size.push_back(cell[at]);
    at += cell[at] + 1;
  }
  return faces;
}

std::vector<PolyhedronEdge> sorted_edges(const PolyhedronFaces& faces) {
  std::vector<PolyhedronEdge> edges;
  for (std::uint32_t f = 0; f < faces.start.size(); ++f) {
    for (std::size_t k = 0; k < faces.size[f]; ++k) {
      const std::uint32_t a = faces.start[f][k];
      const std::uint32_t b = faces.start[f][(k + 1) % faces.size[f]];
      edges.push_back({std::min(a, b), std::max(a, b), f, a < b});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const PolyhedronEdge& a, const PolyhedronEdge& b) {
    return std::tie(a.low, a.high, a.face) < std::tie(b.low, b.high, b.face);
  });
  return edges;
}

/// A face's neighbour across an edge, and whether the two run through it the same way.
struct Neighbour {
  std::uint32_t face;
  bool disagrees;
};

}  // namespace

Closure close_polyhedron(MeshData& mesh, std::size_t c) {
  const PolyhedronFaces faces = faces_of(mesh, c);
  const std::vector<PolyhedronEdge> edges = sorted_edges(faces);
  if (edges.size() % 2 != 0) return Closure::open;
  std::vector<std::vector<Neighbour>> neighbours(faces.start.size());
  for (std::size_t i = 0; i < edges.size(); i += 2) {
    const PolyhedronEdge& a = edges[i];
    const PolyhedronEdge& b = edges[i + 1];
    const bool pair = a.low == b.low && a.high == b.high;
    const bool third = i + 2 < edges.size() && edges[i + 2].low == a.low && edges[i + 2].high == a.high;
    if (!pair || third) return Closure::open;
    neighbours[a.face].push_back({b.face, a.forward == b.forward});
    neighbours[b.face].push_back({a.face, a.forward == b.forward});
  }

  enum : std::uint8_t { unseen, keep, turn };
  std::vector<std::uint8_t> mark(faces.start.size(), unseen);
  std::vector<std::uint32_t> front = {0};
  mark[0] = keep;
  while (!front.empty()) {
    const std::uint32_t f = front.back();
    front.pop_back();
    for (const auto& [g, disagrees] : neighbours[f]) {
      const std::uint8_t wanted = (mark[f] == turn) != disagrees ? turn : keep;
      if (mark[g] == unseen) {
        mark[g] = wanted;
        front.push_back(g);
      } else if (mark[g] != wanted) {
        return Closure::open;
      }
    }
  }
  if (std::find(mark.begin(), mark.end(), unseen) != mark.end()) return Closure::open;
  Closure result = Closure::closed;
  for (std::size_t f = 0; f < mark.size(); ++f) {
    if (mark[f] != turn) continue;
    std::reverse(faces.start[f], faces.start[f] + faces.size[f]);
    result = Closure::repaired;
  }
  return result;
}

}  // namespace dartcast
