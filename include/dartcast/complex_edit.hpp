// Edits of a complex: those of the map (dartcast/map_edits.hpp), with positions and interior points. All or nothing.
//
// "Sewing, simplifying or cutting cells": T. Jund, D. Cazier, J.-F. Dufourd, "Particle-based forecast mechanism for
// continuous collision detection in deformable environments", SPM 2009, section 6.2.
#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "dartcast/cell_complex.hpp"
#include "dartcast/map_edits.hpp"

namespace dartcast {

/// A vertex that an edit made, and how data given at the vertices follow: it lies at the sum of `weights` times the
/// positions of `of`, and `offset`. On an edge: of its ends. Parted from another: of that one.
struct PlacedVertex {
  Vertex vertex;
  std::vector<Vertex> of;  ///< older ones
  std::vector<double> weights;
  Vec3 offset;  ///< in the positions when it was made
};

/// What an edit did.
struct ComplexEditReport {
  EditReport map;
  /// Vertices made, interior points apart, in order. Among them may be some that were given up again.
  std::vector<PlacedVertex> placed;
  /// Cells that commit() replaced to give them points: what they were while the edit was open, and are now. Sorted.
  std::vector<std::pair<Cell, Cell>> given_points;
  /// Cells that stay as they are, next to cells that were touched.
  std::vector<Cell> around;
  /// No point of a wall or of the boundary where an edit split, merged or fanned faces anew lies farther than this from
  /// where it lay (m): rounding where the faces are planar, their warp else. Faces that became walls are no part of it.
  double boundary_shift = 0.0;

  /// What a cell is now that an edit returned before commit(). Cost: logarithmic.
  [[nodiscard]] Cell now(Cell c) const {
    const auto at = std::lower_bound(given_points.begin(), given_points.end(), std::pair{c, Cell{}},
                                     [](const auto& a, const auto& b) { return a.first < b.first; });
    return at != given_points.end() && at->first == c ? at->second : c;
  }
};

/// Values at the vertices after an edit: those of new vertices are interpolated. `values`: one per vertex before the
/// edit; takes as many as `size` afterwards. Cost: the vertices made.
template <class T>
void update_after_edit(const ComplexEditReport& report, std::size_t size, std::vector<T>& values) {
  values.resize(size);
  for (const PlacedVertex& p : report.placed) {
    if (p.vertex.value >= size) continue;
    T sum = values[p.of[0].value] * p.weights[0];
    for (std::size_t i = 1; i < p.of.size(); ++i) sum += values[p.of[i].value] * p.weights[i];
    values[p.vertex.value] = sum;
  }
}

/// A sequence of edits. What is not committed when it ends is taken back. While it is open, nobody else edits, copies
/// or moves the complex; whoever reads it sees cells without their interior points.
class ComplexEdit {
 public:
  explicit ComplexEdit(CellComplex& complex);
  ComplexEdit(const ComplexEdit&) = delete;
  ComplexEdit& operator=(const ComplexEdit&) = delete;
  ComplexEdit(ComplexEdit&&) = delete;
  ComplexEdit& operator=(ComplexEdit&&) = delete;
  ~ComplexEdit();

  /// For the functions of dartcast/map_edits.hpp. Drafts given to its replace() name no points of cells: commit() finds
  /// these.
  [[nodiscard]] Transaction& topology() { return transaction_; }
  [[nodiscard]] const CombinatorialMap& map() const { return transaction_.map(); }

  /// Where a vertex is. One that this edit put on an edge lies in its middle until it is placed; one that was parted
  /// lies where the other does.
  [[nodiscard]] Vec3 position(Vertex v);
  /// Places a vertex that this edit made. Throws InvalidArgument where it made no such vertex, or x is not finite,
  /// outside the exact range, or not in the plane where the map is.
  void place(Vertex v, const Vec3& x);
  /// Places it at the weighted mean of older vertices, which is what data given at the vertices follow by: better for
  /// one that is in the middle of a face or a cell. `weights`: one per vertex of `of`; they sum to 1. Throws as above,
  /// and where the numbers do not match.
  void place(Vertex v, std::span<const Vertex> of, std::span<const double> weights);

  [[nodiscard]] Transaction::Savepoint savepoint() const { return transaction_.savepoint(); }
  /// Takes back everything after the savepoint. (Not by topology().roll_back(): places would stay.)
  void roll_back(const Transaction::Savepoint& to);

  /// Gives touched cells the interior points that they need (see ComplexEditReport::now()), and makes everything final.
  /// Throws EditRefused, everything taken back, where a new cell has a simplex that is not positive and no interior
  /// point mends it: names the cell. Cost: that of the cells touched and their neighbours.
  ComplexEditReport commit();

 private:
  struct Created;  // the positions of new vertices
  struct Mean {
    std::vector<Vertex> of;
    std::vector<double> weights;
  };

  std::size_t place_created(Vertex v, const Vec3& x);
  void check_added() const;
  [[nodiscard]] PlacedVertex placed(std::size_t created) const;
  [[nodiscard]] std::vector<Cell> around() const;
  ComplexEditReport make_final(const SteinerWeights& points, std::size_t created);

  CellComplex& complex_;
  Transaction transaction_;
  std::unique_ptr<Created> created_;
  std::map<std::size_t, Mean> means_;  // of those placed so, by number among the new
};

}  // namespace dartcast
