// Edits of a complex: the edits of the map (dartcast/map_edits.hpp), with positions and Steiner points. All or nothing.
//
// After "Sewing, simplifying or cutting cells": T. Jund, D. Cazier, J.-F. Dufourd, "Particle-based forecast mechanism
// for continuous collision detection in deformable environments", SPM 2009, section 6.2.
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

/// A vertex that an edit made, and the rule by which data at the vertices follow. It lies at the sum of `weights` times
/// the positions of `of`, plus `offset`. For a vertex on an edge, `of` are the ends of the edge. For a copy of a
/// vertex, made where faces were opened, `of` is that vertex. For a vertex in the place of a Steiner point, `of` are
/// the corners that the point depended on.
struct PlacedVertex {
  Vertex vertex;
  std::vector<Vertex> of;  ///< older ones
  std::vector<double> weights;
  Vec3 offset;  ///< in the positions when it was made
};

/// The changes that an edit made.
struct ComplexEditReport {
  EditReport map;
  /// Vertices that the edit made, without Steiner points, in order. Some of them may have been removed again.
  std::vector<PlacedVertex> placed;
  /// Cells that commit() replaced to give them Steiner points: the cell while the edit was open, and the cell now.
  /// Sorted.
  std::vector<std::pair<Cell, Cell>> given_points;
  /// Unchanged cells next to touched cells.
  std::vector<Cell> around;
  /// Bound on the motion of walls and of the boundary where an edit split, merged or fanned faces anew (m). No point of
  /// them lies farther than this from its old position. It is rounding if the faces are planar, or
  /// split along their fans; else their warp.
  /// Faces that became walls do not count.
  double boundary_shift = 0.0;
  bool replaced = false;  ///< by Environment::replace(): all cells and vertices are others, and the lists are empty

  /// The current cell in place of a cell that an edit returned before commit(). Cost: logarithmic.
  [[nodiscard]] Cell now(Cell c) const {
    const auto at = std::lower_bound(given_points.begin(), given_points.end(), std::pair{c, Cell{}},
                                     [](const auto& a, const auto& b) { return a.first < b.first; });
    return at != given_points.end() && at->first == c ? at->second : c;
  }
};

/// Updates values at the vertices after an edit: those of new vertices are interpolated. `values`: one per vertex
/// before the edit; afterwards `size` of them. Cost: the new vertices.
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

/// A sequence of edits. If it ends without a commit, everything is undone. While it is open, no other code may edit,
/// copy or move the complex, and readers see cells without their Steiner points.
class ComplexEdit {
 public:
  explicit ComplexEdit(CellComplex& complex);
  ComplexEdit(const ComplexEdit&) = delete;
  ComplexEdit& operator=(const ComplexEdit&) = delete;
  ComplexEdit(ComplexEdit&&) = delete;
  ComplexEdit& operator=(ComplexEdit&&) = delete;
  ~ComplexEdit();

  /// The transaction for the functions of dartcast/map_edits.hpp. Drafts given to its replace() name no Steiner points
  /// of cells: commit() finds these.
  [[nodiscard]] Transaction& topology() { return transaction_; }
  [[nodiscard]] const CombinatorialMap& map() const { return transaction_.map(); }

  /// The position of a vertex. A vertex that this edit put on an edge lies in its middle until it is placed. A copy of
  /// a vertex lies where that vertex lies.
  [[nodiscard]] Vec3 position(Vertex v);
  /// Places a vertex that this edit made. Throws InvalidArgument if this edit made no such vertex. It also throws if
  /// x is not finite, outside the exact range, or not in the plane of a planar map.
  void place(Vertex v, const Vec3& x);
  /// Places it at the weighted mean of older vertices. Data at the vertices follow with the same weights. This is
  /// better for a vertex in the middle of a face or a cell. `weights`: one per vertex of `of`; they sum to 1. Throws as
  /// above, and if the numbers do not match.
  void place(Vertex v, std::span<const Vertex> of, std::span<const double> weights);

  [[nodiscard]] Transaction::Savepoint savepoint() const { return transaction_.savepoint(); }
  /// Undoes everything after the savepoint. Do not use topology().roll_back() for it: positions would stay.
  void roll_back(const Transaction::Savepoint& to);

  /// The cells that commit() would refuse as they are now: of the given ones, and of their neighbours at faces that
  /// would get Steiner points. Sorted. `cells`: some that this edit made. `keep_faces`: also cells with a bent face that
  /// would get a Steiner point, which moves it. Throws InvalidArgument if there is no such cell. Cost: linear in the
  /// cells.
  [[nodiscard]] std::vector<Cell> refused_cells(std::span<const Cell> cells, bool keep_faces = false);

  /// Gives touched cells the Steiner points that they need (see ComplexEditReport::now()), and makes everything final.
  /// Throws EditRefused, which names the cell, if a new cell has a simplex that is not positive and no Steiner point
  /// repairs it. Then everything is undone. Cost: that of the cells touched and their neighbours.
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
