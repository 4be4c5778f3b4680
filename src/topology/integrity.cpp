// Checks the constraints of a combinatorial map, dart by dart.
#include <algorithm>

#include "dartcast/map_edits.hpp"

namespace dartcast {

namespace {

class IntegrityChecker {
 public:
  IntegrityChecker(const CombinatorialMap& map, std::size_t max_count) : map_(map), max_count_(max_count) {}

  void check(Cell c) {
    const CellView v = map_.view(c);
    check_vertices(c, v);
    for (std::uint16_t d = 0; d < v.shape().dart_count(); ++d) {
      check_in_cell({c, d});
      check_sewn({c, d});
    }
    for (std::uint16_t f = 0; f < v.shape().face_count(); ++f) check_face({c, f}, v);
  }

  [[nodiscard]] bool full() const { return found_.size() >= max_count_; }
  std::vector<Violation> take() { return std::move(found_); }

 private:
  void expect(bool holds, const char* constraint, Dart d, const std::string& seen = {}) {
    if (holds || full()) return;
    found_.push_back({constraint, d,
                      "cell " + std::to_string(map_.source(d.cell)) + ", dart " + std::to_string(d.number) + ": " +
                          constraint + " is broken" + (seen.empty() ? "" : " (" + seen + ")")});
  }

  void check_vertices(Cell c, const CellView& v) {
    std::vector<std::uint32_t> all(v.vertices().begin(), v.vertices().end());
    std::sort(all.begin(), all.end());
    expect(all.back() < map_.vertex_count(), "vertices are in range", {c, 0}, "vertex " + std::to_string(all.back()));
    expect(std::adjacent_find(all.begin(), all.end()) == all.end(), "the vertices of a cell are distinct", {c, 0});
  }

  void check_in_cell(Dart d) {
    expect(map_.phi_1(map_.phi1(d)) == d && map_.phi1(map_.phi_1(d)) == d, "phi1 is a permutation", d);
    if (map_.dimension() == 2) return;
    const Dart other = map_.phi2(d);
    expect(other != d && map_.phi2(other) == d, "phi2 is an involution without fixed points", d);
    expect(map_.origin(other) == map_.origin(map_.phi1(d)) && map_.origin(map_.phi1(other)) == map_.origin(d),
           "phi2 turns the edge around", d);
  }

  // Whether the record's neighbour exists. If not, phi3 cannot be evaluated.
  [[nodiscard]] bool sewn_well(CellFace f, const CellView& v) const {
    const Cell other = v.neighbour(f.face);
    return map_.contains(other) && v.neighbour_face(f.face) < map_.shape(other).face_count() &&
           map_.shape(other).degree(v.neighbour_face(f.face)) == v.shape().degree(f.face);
  }

  // phi3, or phi2 in the plane.
  [[nodiscard]] Dart across(Dart d) const { return map_.dimension() == 2 ? map_.phi2(d) : map_.phi3(d); }

  void check_sewn(Dart d) {
    const bool plane = map_.dimension() == 2;
    const CellView v = map_.view(d.cell);
    const CellFace f = map_.face(d);
    if (!v.neighbour(f.face).valid()) return;
    if (!sewn_well(f, v)) {
      expect(false, plane ? "phi2 leads to an edge" : "phi3 leads to a face with as many darts", d);
      return;
    }
    const char* involution = plane ? "phi2 is an involution" : "phi3 is an involution";
    const Dart other = across(d);
    const CellView w = map_.view(other.cell);
    const std::uint16_t back = w.shape().face_of(other.number);
    if (w.neighbour(back) != d.cell || w.neighbour_face(back) != f.face) {
      expect(false, involution, d);
      return;
    }
    expect(other != d && across(other) == d, involution, d);
    if (!plane) {
      const Dart twice = map_.phi3(map_.phi1(other));
      expect(twice.valid() && map_.phi1(twice) == d, "phi1 o phi3 is an involution", d);
    }
    expect(map_.origin(other) == map_.origin(map_.phi1(d)) && map_.origin(map_.phi1(other)) == map_.origin(d),
           "sewn darts have the same vertices", d);
  }

  void check_face(CellFace f, const CellView& v) {
    const Dart first{f.cell, v.shape().first_dart(f.face)};
    const auto corners = v.shape().corners(f.face);
    const auto by_vertex = [&](auto a, auto b) { return v.vertex(a) < v.vertex(b); };
    expect(corners.size() == 2 || std::min_element(corners.begin(), corners.end(), by_vertex) == corners.begin(),
           "a face starts at its lowest-numbered vertex", first);
    if (v.neighbour(f.face).valid() && sewn_well(f, v))
      expect(map_.point(f) == map_.point(map_.opposite(f)), "both sides of a face are fanned from the same point",
             first);
    const Cell other = v.neighbour(f.face);
    const bool wall = !map_.contains(other) || map_.is_free(other) != v.is_free();
    expect(v.is_wall(f.face) == wall, "a wall is where exactly one side is free", first);
    if (!wall) return;
    for (std::uint16_t t = 0; t < v.shape().triangle_count(f.face); ++t) {
      for (const std::uint16_t k : v.shape().triangle(f.face, t))
        expect(!map_.is_vertex(v.vertex(k)) || map_.may_touch_wall(v.vertex(k)), "the vertices of a wall are marked",
               first);
    }
  }

  const CombinatorialMap& map_;
  std::size_t max_count_;
  std::vector<Violation> found_;
};

}  // namespace

std::vector<Violation> check_integrity(const CombinatorialMap& map, std::span<const Cell> cells,
                                       std::size_t max_count) {
  IntegrityChecker checker(map, max_count);
  for (const Cell c : cells) {
    if (checker.full()) break;
    checker.check(c);
  }
  return checker.take();
}

std::vector<Violation> check_integrity(const CombinatorialMap& map, std::size_t max_count) {
  return check_integrity(map, map.cells(), max_count);
}

}  // namespace dartcast
