// Edits of a complex: those of the map (map/edit.hpp), with positions and interior points. All or nothing.
//
// "Sewing, simplifying or cutting cells": T. Jund, D. Cazier, J.-F. Dufourd, "Particle-based forecast mechanism for
// continuous collision detection in deformable environments", SPM 2009, section 6.2.
#pragma once

#include <cstddef>
#include <vector>

#include "dartcast/geometry/complex.hpp"
#include "dartcast/map/transaction.hpp"

namespace dartcast {

/// A vertex that an edit made, and how data given at the vertices follow: it lies at (1 - share) from + share other +
/// offset. A vertex parted from another: share 0.
struct PlacedVertex {
  Vertex vertex;
  Vertex from, other;
  double share = 0.0;
  Vec3 offset;  ///< in the positions when it was made
};

/// What an edit did.
struct ComplexEditReport {
  EditReport map;
  /// Vertices made, interior points apart, in order: `from` and `other` are older. Among them may be some that were
  /// given up again.
  std::vector<PlacedVertex> placed;
  /// Cells that stay as they are, next to cells that were touched.
  std::vector<Cell> around;
  /// No point of a wall or of the boundary where an edit split, merged or fanned faces anew lies farther than this from
  /// where it lay (m): rounding where the faces are planar, their warp else. Faces that became walls are no part of it.
  double boundary_shift = 0.0;
};

/// Values at the vertices after an edit: those of new vertices are interpolated. `values`: one per vertex before the
/// edit; takes as many as `size` afterwards. Cost: the vertices made.
template <class T>
void follow(const ComplexEditReport& report, std::size_t size, std::vector<T>& values) {
  values.resize(size);
  for (const PlacedVertex& p : report.placed) {
    if (p.vertex.value >= size) continue;
    values[p.vertex.value] = values[p.from.value] * (1.0 - p.share) + values[p.other.value] * p.share;
  }
}

/// A sequence of edits. What is not committed when it ends is taken back. While it is open, nobody else edits, copies
/// or moves the complex; whoever reads it sees cells without their interior points.
class ComplexEdit {
 public:
  explicit ComplexEdit(Complex& complex);
  ComplexEdit(const ComplexEdit&) = delete;
  ComplexEdit& operator=(const ComplexEdit&) = delete;
  ComplexEdit(ComplexEdit&&) = delete;
  ComplexEdit& operator=(ComplexEdit&&) = delete;
  ~ComplexEdit();

  /// For the functions of map/edit.hpp. Drafts given to its replace() name no points of cells: commit() finds these.
  [[nodiscard]] Transaction& topology() { return transaction_; }
  [[nodiscard]] const Map& map() const { return transaction_.map(); }

  /// Where a vertex is. One that this edit put on an edge lies in its middle until it is placed; one that was parted
  /// lies where the other does.
  [[nodiscard]] Vec3 position(Vertex v);
  /// Places a vertex that this edit made. Throws InvalidArgument where it made no such vertex, or x is not finite or
  /// outside the exact range.
  void place(Vertex v, const Vec3& x);

  [[nodiscard]] Transaction::Mark mark() const { return transaction_.mark(); }
  /// Takes back everything after the mark. (Not by topology().roll_back(): places would stay.)
  void roll_back(const Transaction::Mark& to);

  /// Gives touched cells the interior points that they need, and makes everything final. Throws EditRefused, everything
  /// taken back, where a new cell has a simplex that is not positive and no interior point mends it: names the cell.
  /// Cost: that of the cells touched and their neighbours.
  ComplexEditReport commit();

 private:
  void take_born();
  void check_added() const;
  [[nodiscard]] std::vector<PlacedVertex> placed(std::size_t born) const;
  [[nodiscard]] std::vector<Cell> around() const;
  ComplexEditReport make_final(const InteriorWeights& points, std::size_t born);

  Complex& complex_;
  std::size_t positions_before_;
  Transaction transaction_;
  std::size_t born_ = 0;  // so many of the transaction's new vertices have positions
};

}  // namespace dartcast
