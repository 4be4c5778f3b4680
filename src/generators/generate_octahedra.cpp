// A lattice of truncated octahedra, as polyhedra.
#include <fmt/format.h>

#include <cstdlib>
#include <utility>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/ids.hpp"
#include "generators/block_size.hpp"
#include "generators/generate_blocked.hpp"

namespace dartcast {
namespace {

// A lattice point, in quarters of a cube. Middles of octahedra have coordinates that are all 2 or all 0 modulo 4.
// Around a middle at 0 the 24 corners are the permutations of (0, +-1, +-2).
using LatticePlace = std::array<int, 3>;

constexpr LatticePlace operator+(const LatticePlace& a, const LatticePlace& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
constexpr int dot(const LatticePlace& a, const LatticePlace& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
constexpr int det(const LatticePlace& a, const LatticePlace& b, const LatticePlace& c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

struct Face {
  LatticePlace to_neighbour;          // from the octahedron's middle to that of the octahedron across the face
  std::vector<LatticePlace> corners;  // counterclockwise seen from the outside
};

// The face across which the neighbour lies: the corners halfway to it, each joined to the next counterclockwise by an
// edge of length sqrt 2.
Face make_face(const LatticePlace& to_neighbour) {
  std::vector<LatticePlace> on_face;
  for (int x = -2; x <= 2; ++x) {
    for (int y = -2; y <= 2; ++y) {
      for (int z = -2; z <= 2; ++z) {
        const bool is_corner = std::abs(x) + std::abs(y) + std::abs(z) == 3 && x * x + y * y + z * z == 5;
        if (is_corner && 2 * dot({x, y, z}, to_neighbour) == dot(to_neighbour, to_neighbour))
          on_face.push_back({x, y, z});
      }
    }
  }
  Face face{to_neighbour, {on_face[0]}};
  while (face.corners.size() < on_face.size()) {
    const LatticePlace& last = face.corners.back();
    for (const LatticePlace& next : on_face) {
      const LatticePlace edge = {next[0] - last[0], next[1] - last[1], next[2] - last[2]};
      if (dot(edge, edge) == 2 && det(to_neighbour, last, next) > 0) {
        face.corners.push_back(next);
        break;
      }
    }
  }
  return face;
}

std::vector<Face> make_faces() {
  std::vector<Face> faces;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const int sign : {-4, 4}) {
      LatticePlace square{};
      square[axis] = sign;
      faces.push_back(make_face(square));
    }
  }
  for (const int x : {-2, 2}) {
    for (const int y : {-2, 2}) {
      for (const int z : {-2, 2}) faces.push_back(make_face({x, y, z}));
    }
  }
  return faces;
}

void check(const OctahedraOptions& o) {
  std::uint64_t room = Cell::index_mask / 2;
  for (const std::uint32_t n : o.cells) {
    if (n == 0) throw InvalidArgument("octahedra: no cells along an axis; give at least 1 along each");
    room /= n;
  }
  if (room == 0) {
    throw InvalidArgument(
        fmt::format("octahedra: {} x {} x {} cubes of 2 cells are more than the {} cells a mesh may have", o.cells[0],
                    o.cells[1], o.cells[2], Cell::index_mask));
  }
  const Vec3 size = block_size(o);
  if (!is_finite(o.origin) || !is_finite(size) || !is_finite(o.origin + size * 2.0)) {
    throw InvalidArgument("octahedra: origin and size must be finite numbers");
  }
  if (!(size.x > 0 && size.y > 0 && size.z > 0)) {
    throw InvalidArgument("octahedra: size must be positive along each axis");
  }
  if (!(o.blocked_share >= 0 && o.blocked_share <= 1)) {
    throw InvalidArgument("octahedra: blocked_share must be in [0, 1]");
  }
}

class OctahedraBuilder {
 public:
  explicit OctahedraBuilder(const OctahedraOptions& options)
      : o_(options), size_(block_size(options)), faces_(make_faces()) {
    for (std::size_t a = 0; a < 3; ++a) n_[a] = static_cast<int>(o_.cells[a]);
    numbers_.assign(std::size_t{4 * o_.cells[0] + 3} * (4 * o_.cells[1] + 3) * (4 * o_.cells[2] + 3), none);
  }

  MeshData build() {
    for (int k = 0; k < n_[2]; ++k) {
      for (int j = 0; j < n_[1]; ++j) {
        for (int i = 0; i < n_[0]; ++i) {
          add_octahedron({4 * i + 2, 4 * j + 2, 4 * k + 2});
          add_octahedron({4 * i + 4, 4 * j + 4, 4 * k + 4});
        }
      }
    }
    mesh_.patch_names[1] = "boundary";
    if (o_.blocked_layer || o_.blocked_share > 0) {
      block_share(blocked_, o_.blocked_share, o_.seed);
      for (const std::uint8_t b : blocked_) mesh_.free.push_back(b == 0 ? 1 : 0);
    }
    return std::move(mesh_);
  }

 private:
  static constexpr std::uint32_t none = 0xffffffffU;

  // Whether there is an octahedron around a place that is a middle of the packing.
  [[nodiscard]] bool in_block(const LatticePlace& middle) const {
    const int low = (middle[0] & 3) == 2 ? 2 : 4;
    for (std::size_t a = 0; a < 3; ++a) {
      if (middle[a] < low || middle[a] > 4 * n_[a] - 4 + low) return false;
    }
    return true;
  }

  std::uint32_t point(const LatticePlace& p) {
    const auto index = [&](std::size_t a) { return static_cast<std::size_t>(p[a]); };
    const auto extent = [&](std::size_t a) { return 4 * static_cast<std::size_t>(n_[a]) + 3; };
    std::uint32_t& number = numbers_[index(0) + extent(0) * (index(1) + extent(1) * index(2))];
    if (number == none) {
      number = static_cast<std::uint32_t>(mesh_.points.size());
      mesh_.points.push_back({o_.origin.x + size_.x * p[0] / (4.0 * n_[0]),
                              o_.origin.y + size_.y * p[1] / (4.0 * n_[1]),
                              o_.origin.z + size_.z * p[2] / (4.0 * n_[2])});
    }
    return number;
  }

  void add_octahedron(const LatticePlace& middle) {
    stream_.assign(1, static_cast<std::uint32_t>(faces_.size()));
    bool outermost = false;
    for (const Face& face : faces_) {
      stream_.push_back(static_cast<std::uint32_t>(face.corners.size()));
      for (const LatticePlace& corner : face.corners) stream_.push_back(point(middle + corner));
      if (in_block(middle + face.to_neighbour)) continue;
      mesh_.add_patch_face({stream_.data() + stream_.size() - face.corners.size(), face.corners.size()}, 1);
      outermost = true;
    }
    mesh_.add_cell(CellType::polyhedron, stream_);
    blocked_.push_back(outermost && o_.blocked_layer ? 1 : 0);
  }

  const OctahedraOptions& o_;
  const Vec3 size_;
  const std::vector<Face> faces_;
  std::array<int, 3> n_{};
  std::vector<std::uint32_t> numbers_;  // point at each lattice place, or none
  std::vector<std::uint32_t> stream_;
  std::vector<std::uint8_t> blocked_;
  MeshData mesh_;
};

}  // namespace

MeshData generate_octahedra(const OctahedraOptions& options) {
  check(options);
  return OctahedraBuilder(options).build();
}

}  // namespace dartcast
