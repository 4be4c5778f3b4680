// The faces of periodic pairs, and their partners. Not installed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "dartcast/cell_complex.hpp"
#include "dartcast/combinatorial_map.hpp"
#include "dartcast/mesh_data.hpp"

namespace dartcast::detail {

/// A rotation about a point and a translation: x goes to R (x - from) + to. It is exact where all numbers are.
class PeriodicMotion {
 public:
  /// From a to b. Throws InvalidMesh if a number of the pair is not finite, or an angle has no axis.
  explicit PeriodicMotion(const PeriodicPair& pair);
  [[nodiscard]] PeriodicMotion inverse() const;
  /// The motion made so many times: a whole number, from 0 to 2^53. Cost: logarithmic.
  [[nodiscard]] PeriodicMotion power(double times) const;

  [[nodiscard]] Vec3 vector(const Vec3& v) const { return {dot(rows_[0], v), dot(rows_[1], v), dot(rows_[2], v)}; }
  [[nodiscard]] Vec3 point(const Vec3& x) const { return vector(x - from_) + to_; }
  [[nodiscard]] const std::array<Vec3, 3>& rows() const { return rows_; }

 private:
  [[nodiscard]] PeriodicMotion then(const PeriodicMotion& next) const;

  std::array<Vec3, 3> rows_ = {Vec3{1.0, 0.0, 0.0}, Vec3{0.0, 1.0, 0.0}, Vec3{0.0, 0.0, 1.0}};
  Vec3 from_, to_;
};

/// The face that a particle enters by, and the way there.
struct PeriodicPartner {
  CellFace face;
  std::uint16_t pair = 0;
  bool back = false;  ///< from b to a
};

/// It does not change after it is made: vertices may move if partners stay partners.
class PeriodicFaces {
 public:
  /// Pairs the wall faces of patches by their corners. A face is passed if the cells at both are free. `positions`: of all
  /// vertices. Throws InvalidMesh if a pair is not well formed, and for a face without a partner, with its place. Cost:
  /// linear in the faces of the map.
  PeriodicFaces(std::vector<PeriodicPair> pairs, const CombinatorialMap& map, std::span<const Vec3> positions);

  [[nodiscard]] std::span<const PeriodicPair> pairs() const { return pairs_; }
  /// Pairs of faces that particles can pass.
  [[nodiscard]] std::size_t face_count(std::size_t pair) const { return ways_[pair].faces; }

  /// Null if the face leads nowhere.
  [[nodiscard]] const PeriodicPartner* partner(CellFace face) const {
    const auto found = partners_.find(code(face));
    return found == partners_.end() ? nullptr : &found->second;
  }
  /// The partner of a vertex of the face that leads there; invalid for a Steiner point without one.
  [[nodiscard]] Vertex partner(const PeriodicPartner& to, Vertex v) const;
  [[nodiscard]] const PeriodicMotion& motion(const PeriodicPartner& to) const {
    const Ways& ways = ways_[to.pair];
    return to.back ? ways.back : ways.there;
  }

  /// Throws InvalidArgument if vertices that are partners are too far apart in new positions of the mesh's points.
  void check_move(std::span<const Vec3> positions) const;

 private:
  struct Ways {
    PeriodicMotion there, back;
    double tolerance = 0.0;  // a length
    std::size_t faces = 0;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> corners{};              // of a and b
    std::array<std::unordered_map<std::uint32_t, std::uint32_t>, 2> vertices{};  // from a to b, and back
  };
  struct Side {
    CellFace face;
    std::vector<std::uint32_t> corners;
  };

  static std::uint64_t code(CellFace f) { return (std::uint64_t{f.cell.value} << 16U) | f.face; }
  static std::vector<Side> sides(const CombinatorialMap& map, Patch patch);
  void add_pair(std::uint16_t number, const CombinatorialMap& map, std::span<const Vec3> positions);
  void pair_corners(std::uint16_t number, std::span<const Side> a, std::span<const Side> b,
                    std::span<const Vec3> positions);
  void pair_faces(std::uint16_t number, std::span<const Side> a, std::span<const Side> b, const CombinatorialMap& map,
                  std::span<const Vec3> positions);
  void join(std::uint16_t number, CellFace a, CellFace b, const CombinatorialMap& map);

  std::vector<PeriodicPair> pairs_;
  std::vector<Ways> ways_;
  std::unordered_map<std::uint64_t, PeriodicPartner> partners_;  // by the code of a face
};

/// Throws InvalidArgument if the complex has periodic pairs: these (a plural) do not know of them.
void refuse_periodic(const CellComplex& complex, const char* what);

}  // namespace dartcast::detail
