#include "support/random_edits.hpp"

namespace dartcast::test {

EditKind in_dimension(EditKind kind, unsigned dimension) {
  return dimension == 2 && kind == EditKind::split_cell ? EditKind::split_face : kind;
}

EditKind draw_kind(const CellBag& bag, std::size_t usual, Random& random, unsigned dimension) {
  using enum EditKind;
  constexpr std::array<EditKind, 20> kinds = {split_edge,  split_edge,  split_face,  split_face,  split_cell,
                                              split_cell,  merge_cells, merge_cells, merge_faces, merge_faces,
                                              merge_faces, merge_edges, merge_edges, merge_edges, sew,
                                              sew,         sew,         unsew,       mark,        remove};
  const EditKind kind = kinds[random.below(kinds.size())];
  const EditKind split = in_dimension(split_cell, dimension);
  if ((kind == split_cell || kind == split) && bag.size() > usual * 3 / 2) return merge_cells;
  if (kind == remove && (bag.size() < usual * 2 / 3 || random.below(4) != 0)) return split;
  return in_dimension(kind, dimension);
}

Edit draw_edit(const CombinatorialMap& map, EditKind kind, Cell c, const CellBag& bag, Random& random) {
  const Shape& s = map.shape(c);
  const auto any_dart = [&](Cell x) {
    return Dart{x, static_cast<std::uint16_t>(random.below(map.shape(x).dart_count()))};
  };
  const Dart d = any_dart(c);
  switch (kind) {
    case EditKind::split_face: {
      if (s.dimension() == 2) return {kind, {d, any_dart(c)}};
      const std::uint16_t f = s.face_of(d.number);
      return {kind, {d, {c, static_cast<std::uint16_t>(s.first_dart(f) + random.below(s.degree(f)))}}};
    }
    case EditKind::split_cell: {
      // Around some faces grown from one.
      std::vector<bool> inside(s.face_count());
      std::vector<std::uint16_t> grown = {s.face_of(d.number)};
      inside[grown[0]] = true;
      for (std::uint32_t n = 1 + random.below(s.face_count()); n > 0; --n) {
        const std::uint16_t f = grown[random.below(static_cast<std::uint32_t>(grown.size()))];
        const auto e = static_cast<std::uint16_t>(s.first_dart(f) + random.below(s.degree(f)));
        const std::uint16_t g = s.face_of(s.phi2(e));
        if (!inside[g]) grown.push_back(g);
        inside[g] = true;
      }
      Edit edit{kind, {}};
      const auto on_rim = [&](std::uint16_t e) { return inside[s.face_of(e)] && !inside[s.face_of(s.phi2(e))]; };
      std::uint16_t first = 0;
      while (first < s.dart_count() && !on_rim(first)) ++first;
      if (first == s.dart_count()) return edit;
      for (std::uint16_t e = first; edit.darts.empty() || e != first;) {
        edit.darts.push_back({c, e});
        for (e = s.phi1(e); !on_rim(e);) e = s.phi1(s.phi2(e));
      }
      return edit;
    }
    case EditKind::sew: {
      // Onto a face with the same vertices, as after unsew(), or onto any.
      for (int i = 0; i < 30; ++i) {
        const Dart e = any_dart(bag.draw(map, random));
        if (map.opposite(map.face(e)).valid() || e.cell == c) continue;
        if (random.below(8) == 0) return {kind, {d, e}};
        for (std::uint16_t x = 0; x < s.dart_count(); ++x) {
          if (map.origin({c, x}) == map.origin(map.phi1(e)) && map.origin(map.phi1({c, x})) == map.origin(e))
            return {kind, {{c, x}, e}};
        }
      }
      return {kind, {d, d}};
    }
    default: return {kind, {d}};
  }
}

std::vector<Cell> apply(Transaction& t, const Edit& e) {
  const CombinatorialMap& map = t.map();
  switch (e.kind) {
    case EditKind::split_edge: return split_edge(t, e.darts[0]).cells;
    case EditKind::split_face: return split_face(t, e.darts[0], e.darts[1]);
    case EditKind::split_cell: {
      const auto parts = split_cell(t, e.darts);
      return {parts.begin(), parts.end()};
    }
    case EditKind::merge_cells: return {merge_cells(t, map.face(e.darts[0]))};
    case EditKind::merge_faces: return merge_faces(t, e.darts[0]);
    case EditKind::merge_edges: return merge_edges(t, e.darts[0]);
    case EditKind::sew: return sew(t, e.darts[0], e.darts[1]);
    case EditKind::unsew: return unsew(t, map.face(e.darts[0]));
    case EditKind::mark: t.set_free(e.darts[0].cell, !map.is_free(e.darts[0].cell)); break;
    case EditKind::remove: remove(t, e.darts[0].cell); break;
  }
  return {};
}

}  // namespace dartcast::test
