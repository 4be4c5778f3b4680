// Splits cells by a plane: vertices on edges, then edges in faces, then faces in cells.
#include "editing/cutter.hpp"

#include <algorithm>
#include <array>
#include <unordered_set>

#include "dartcast/error.hpp"
#include "dartcast/map_edits.hpp"
#include "topology/rework.hpp"

namespace dartcast::detail {

Cutter::Cutter(ComplexEdit& edit, std::span<const Cell> cells) : edit_(edit), cells_(cells.begin(), cells.end()) {
  expect_space(edit.map(), "cuts");
  for (std::uint32_t n = 0; n < cells_.size(); ++n) {
    if (!edit.map().contains(cells_[n]))
      throw InvalidArgument("there is no such cell: an earlier edit replaced it; look for cells anew");
    if (!number_.emplace(cells_[n].value, n).second)
      throw InvalidArgument("cell " + std::to_string(edit.map().source(cells_[n])) + " is named twice");
  }
}

std::vector<Cell> Cutter::cells(std::span<const std::uint32_t> numbers) const {
  std::vector<Cell> cells;
  for (const std::uint32_t n : numbers) cells.push_back(cells_[n]);
  return cells;
}

void Cutter::replace(Cell old, Cell now) {
  const auto found = number_.find(old.value);
  if (found == number_.end()) return;
  const std::uint32_t number = found->second;
  number_.erase(found);
  number_[now.value] = number;
  cells_[number] = now;
}

std::vector<std::uint32_t> Cutter::reaching_below(std::span<const std::uint32_t> numbers, const Plane& plane,
                                                  double within, Reaching& known) {
  Sides sides(edit_, plane, within);
  std::vector<std::uint32_t> reaching;
  known.of.resize(cells_.size());
  for (const std::uint32_t n : numbers) {
    Reaching::Answer& answer = known.of[n];
    if (answer.cell != cells_[n]) answer = {cells_[n], sides.reaches_below(cells_[n])};
    if (answer.below) reaching.push_back(n);
  }
  return reaching;
}

double Cutter::snap_distance(std::span<const std::uint32_t> numbers, const SectionOptions& options) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const std::uint32_t n : numbers) {
    const CellView v = edit_.map().view(cells_[n]);
    const Shape& s = v.shape();
    count += s.dart_count();
    for (std::uint16_t d = 0; d < s.dart_count(); ++d)
      sum += norm(edit_.position(v.vertex(s.origin(s.phi1(d)))) - edit_.position(v.vertex(s.origin(d))));
  }
  return options.snap * std::min(sum / static_cast<double>(std::max<std::size_t>(count, 1)), options.finest);
}

Cutter::Parts Cutter::split(std::span<const std::uint32_t> numbers, const Plane& plane, double within) {
  Sides sides(edit_, plane, within);
  std::vector<std::uint32_t> crossed;
  Parts parts;
  const auto put = [&](std::uint32_t n) { (sides.is_above(cells_[n]) ? parts.above : parts.below).push_back(n); };
  for (const std::uint32_t n : numbers) {
    if (sides.reach(cells_[n]).crossed())
      crossed.push_back(n);
    else
      put(n);
  }
  split_edges(crossed, sides);
  for (const std::uint32_t n : crossed) split_faces(n, sides);
  for (const std::uint32_t n : crossed) {
    const std::vector<Dart> path = path_around(cells_[n], sides);
    if (path.empty()) {
      parts.whole.push_back(n);
      put(n);
      continue;
    }
    const auto [above, below] = split_cell(edit_.topology(), path);
    replace(cells_[n], below);
    parts.below.push_back(n);
    parts.above.push_back(static_cast<std::uint32_t>(cells_.size()));
    number_[above.value] = parts.above.back();
    cells_.push_back(above);
  }
  return parts;
}

namespace {

// Adds a vertex between two adjacent corners of a face. The face may be straight there.
void put_between(DraftFace& face, Vertex first, Vertex middle) {
  const auto at = std::find_if(face.corners.begin(), face.corners.end(),
                               [&](const DraftCorner& corner) { return corner.vertex == first; });
  face.corners.insert(at + 1, {middle, true, at->coplanar});
  face.point = {};
}

std::uint64_t key(std::uint32_t high, std::uint32_t low) { return (std::uint64_t{high} << 32U) | low; }

}  // namespace

// Splits all edges at once, as split_edge() splits one. So each cell is replaced only once, and the replacement is
// known.
void Cutter::split_edges(std::span<const std::uint32_t> numbers, Sides& sides) {
  Rework rework(edit_.topology());
  const CombinatorialMap& map = edit_.map();
  std::unordered_map<std::uint64_t, Vertex> middle;  // by the edge's ends: parts that touch only in an edge agree
  std::unordered_set<std::uint64_t> done;            // darts from below to above
  std::vector<Cell> old;
  for (const std::uint32_t n : numbers) {
    const Cell c = cells_[n];
    for (std::uint16_t number = 0; number < map.shape(c).dart_count(); ++number) {
      const Dart d{c, number};
      const Vertex from = map.origin(d);
      const Vertex to = map.origin(map.phi1(d));
      if (sides[from] >= 0 || sides[to] <= 0 || done.contains(key(c.value, number))) continue;
      Vertex& v = middle[key(from.value, to.value)];
      if (!v.valid()) {
        v = edit_.topology().add_vertex(from, to);
        edit_.place(v, sides.crossing(from, to));
        sides.put_on(v);
      }
      for (const Dart x : around_edge(map, d)) {
        done.insert(key(x.cell.value, x.number));
        const std::uint32_t draft = rework.take(x.cell);
        if (draft == old.size()) old.push_back(x.cell);
        put_between(rework.draft(draft).faces[map.face(x).face], from, v);
        put_between(rework.draft(draft).faces[map.face(map.phi2(x)).face], to, v);
      }
    }
  }
  const std::vector<Cell> now = rework.put();
  for (std::size_t i = 0; i < old.size(); ++i) replace(old[i], now[i]);
}

void Cutter::split_faces(std::uint32_t number, Sides& sides) {
  // After a split the other faces may have another order.
  for (std::uint16_t f = 0; f < edit_.map().shape(cells_[number]).face_count();) {
    if (split_face_of(cells_[number], f, sides))
      f = 0;
    else
      ++f;
  }
}

bool Cutter::split_face_of(Cell c, std::uint16_t face, Sides& sides) {
  const auto chord = chord_of(c, face, sides);
  if (!chord) return false;
  const Cell beyond = edit_.map().view(c).neighbour(face);
  try {
    const std::vector<Cell> now = split_face(edit_.topology(), (*chord)[0], (*chord)[1]);
    replace(c, now[0]);
    if (beyond.valid()) replace(beyond, now[1]);
  } catch (const EditRefused&) {
    return false;  // an edge of the cell joins the two corners already: the face stays whole
  }
  return true;
}

// The corners at which to split a face whose rim changes sides twice: from the first corner on the plane after those
// above to the last one before them. Nothing for other faces.
std::optional<std::array<Dart, 2>> Cutter::chord_of(Cell c, std::uint16_t face, Sides& sides) const {
  const CombinatorialMap& map = edit_.map();
  const Shape& s = map.shape(c);
  const std::uint16_t degree = s.degree(face);
  const auto dart = [&](std::size_t k) { return Dart{c, static_cast<std::uint16_t>(s.first_dart(face) + k % degree)}; };
  const auto side = [&](std::size_t k) { return sides[map.origin(dart(k))]; };
  std::size_t changes = 0;
  std::array<Dart, 2> ends;
  for (std::size_t k = 0; k < degree; ++k) {
    if (side(k) == 0) continue;
    std::size_t next = k + 1;
    while (side(next) == 0) ++next;
    if (side(next) == side(k)) continue;
    if (changes < 2) ends[changes] = side(k) > 0 ? dart(k + 1) : dart(next - 1);
    ++changes;
  }
  if (changes != 2) return {};
  return ends;
}

// The faces of a cell that belong to the part above: those with a corner above. A face in the plane belongs to it if it
// looks down, because then the cell is above it. Empty if a face has corners on both sides.
std::vector<bool> Cutter::faces_above(Cell c, Sides& sides) {
  const CellView v = edit_.map().view(c);
  std::vector<bool> all(v.shape().face_count());
  for (std::uint16_t f = 0; f < v.shape().face_count(); ++f) {
    bool above = false;
    bool below = false;
    for (const std::uint16_t k : v.shape().corners(f)) {
      above |= sides[v.vertex(k)] > 0;
      below |= sides[v.vertex(k)] < 0;
    }
    if (above && below) return {};
    all[f] = above || (!below && sides.looks_down({c, f}));
  }
  return all;
}

// The rim of the faces above, as darts of these faces. Empty if there is none, or if it is not a simple loop.
std::vector<Dart> Cutter::path_around(Cell c, Sides& sides) {
  const Shape& s = edit_.map().shape(c);
  const std::vector<bool> above = faces_above(c, sides);
  if (above.empty()) return {};
  const auto on_rim = [&](std::uint16_t d) { return above[s.face_of(d)] && !above[s.face_of(s.phi2(d))]; };
  std::vector<std::uint16_t> rim;
  for (std::uint16_t d = 0; d < s.dart_count(); ++d) {
    if (on_rim(d)) rim.push_back(d);
  }
  std::unordered_set<std::uint16_t> corners;
  std::vector<Dart> path;
  for (std::uint16_t d = rim.front(); corners.insert(s.origin(d)).second;) {
    path.push_back({c, d});
    d = s.phi1(d);
    while (!on_rim(d)) d = s.phi1(s.phi2(d));
  }
  return path.size() == rim.size() ? path : std::vector<Dart>{};
}

}  // namespace dartcast::detail
