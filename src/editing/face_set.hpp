// The open faces that form the end of a vessel, and how two such ends match. Private to editing.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "dartcast/complex_edit.hpp"

namespace dartcast::detail {

/// A set of open faces, by their darts.
class FaceSet {
 public:
  /// Throws InvalidArgument if a face does not exist or is named twice, or there is none. Throws EditRefused if a
  /// face is not open, or two share an edge in the same direction.
  FaceSet(const CombinatorialMap& map, std::span<const CellFace> faces);

  [[nodiscard]] const CombinatorialMap& map() const { return map_; }
  [[nodiscard]] std::span<const CellFace> faces() const { return faces_; }
  [[nodiscard]] std::span<const Dart> darts() const { return darts_; }
  [[nodiscard]] Vertex from(Dart d) const { return map_.origin(d); }
  [[nodiscard]] Vertex to(Dart d) const { return map_.origin(map_.phi1(d)); }
  /// The dart of another face of the set along the same edge; invalid at the rim.
  [[nodiscard]] Dart across(Dart d) const { return find(to(d), from(d)); }
  /// The darts at the rim, one after another. Throws EditRefused if they are not a simple loop.
  [[nodiscard]] std::vector<Dart> rim() const;

 private:
  [[nodiscard]] Dart find(Vertex from, Vertex to) const;
  [[noreturn]] void refuse_rim() const;

  const CombinatorialMap& map_;
  std::vector<CellFace> faces_;
  std::vector<Dart> darts_;
  std::unordered_map<std::uint64_t, Dart> by_ends_;
};

/// The pairs of darts of two sets that lie against each other: their origins and ends are exchanged.
using Matching = std::map<Dart, Dart>;

/// The best matching of two sets of faces. Nothing if they do not match.
std::optional<Matching> match(ComplexEdit& edit, const FaceSet& a, const FaceSet& b);

}  // namespace dartcast::detail
