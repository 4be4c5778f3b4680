// One plane that splits drafts of cells. Private to editing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "editing/sides.hpp"
#include "topology/workpiece.hpp"

namespace dartcast::detail {

class PlaneCut {
 public:
  /// All outlive it. `plane`: a number in `sides`.
  PlaneCut(ComplexEdit& edit, Workpiece& work, Sides& sides, std::size_t plane)
      : edit_(edit), work_(work), sides_(sides), plane_(plane) {}

  /// Splits cells that have corners on both sides. Returns the draft of each one's part above, or DraftLink::no_draft
  /// if the cell stays whole. The part below keeps the draft. Cells around take the new vertices and edges.
  std::vector<std::uint32_t> split(std::span<const std::uint32_t> drafts);

 private:
  struct RimDart;

  [[nodiscard]] Side side(Vertex v) const { return sides_.of(v)[plane_]; }
  void put_vertices(std::span<const std::uint32_t> drafts);
  bool put_vertices_on(DraftFace& face, bool make);
  Vertex vertex_between(Vertex u, Vertex w, bool make);
  void split_faces(std::uint32_t number);
  [[nodiscard]] std::optional<std::pair<Vertex, Vertex>> chord_of(const DraftFace& face) const;
  std::uint32_t split_cell(std::uint32_t number);
  bool choose_faces_above(const CellDraft& draft);
  [[nodiscard]] bool looks_down(const DraftFace& face) const;
  [[nodiscard]] std::vector<RimDart> rim_of(const CellDraft& draft) const;
  [[nodiscard]] DraftFace face_along(const CellDraft& draft, std::span<const RimDart> rim) const;

  ComplexEdit& edit_;
  Workpiece& work_;
  Sides& sides_;
  std::size_t plane_;
  KeyTable middle_;                     // vertices put on edges, by their ends: parts that touch only in an edge agree
  std::vector<std::uint8_t> is_above_;  // by face of the cell that is split
};

}  // namespace dartcast::detail
