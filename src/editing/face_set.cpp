// The end of a vessel as a set of open faces, and the best matching of two ends.
#include "editing/face_set.hpp"

#include <algorithm>
#include <limits>
#include <set>

#include "dartcast/error.hpp"
#include "topology/rework.hpp"

namespace dartcast::detail {

namespace {

std::uint64_t key(Vertex from, Vertex to) { return (std::uint64_t{from.value} << 32U) | to.value; }

}  // namespace

FaceSet::FaceSet(const CombinatorialMap& map, std::span<const CellFace> faces)
    : map_(map), faces_(faces.begin(), faces.end()) {
  if (faces.empty()) throw InvalidArgument("an end to reconnect has no faces");
  std::set<CellFace> seen;
  for (const CellFace& f : faces) {
    expect_face(map, f);
    if (!seen.insert(f).second)
      throw InvalidArgument("a face of cell " + std::to_string(map.source(f.cell)) + " is named twice");
    if (map.opposite(f).valid()) refuse(map, f.cell, "has a neighbour at a face to reconnect: name open faces only");
    const Shape& s = map.shape(f.cell);
    for (std::uint16_t d = s.first_dart(f.face); d < s.first_dart(f.face) + s.degree(f.face); ++d) {
      darts_.push_back({f.cell, d});
      if (!by_ends_.emplace(key(from(darts_.back()), to(darts_.back())), darts_.back()).second)
        refuse(map, f.cell, "has a face to reconnect that meets another from the same side: take them one at a time");
    }
  }
}

Dart FaceSet::find(Vertex from, Vertex to) const {
  const auto found = by_ends_.find(key(from, to));
  return found == by_ends_.end() ? Dart{} : found->second;
}

std::vector<Dart> FaceSet::rim() const {
  std::map<Vertex, Dart> next;
  std::size_t count = 0;
  for (const Dart d : darts_) {
    if (across(d).valid()) continue;
    next[from(d)] = d;
    ++count;
  }
  std::vector<Dart> loop;
  if (count == 0) refuse(map_, darts_[0].cell, "is at an end without a rim: it closes upon itself");
  if (next.size() != count) refuse_rim();
  for (Dart d = next.begin()->second; loop.empty() || d != loop.front(); d = next.at(to(d))) loop.push_back(d);
  if (loop.size() != count) refuse_rim();
  return loop;
}

void FaceSet::refuse_rim() const {
  refuse(map_, darts_[0].cell, "is at an end whose rim is no simple loop: reconnect its parts one at a time");
}

namespace {

// A partial matching. It is extended by one connected part of the ends after another.
class Matcher {
 public:
  Matcher(ComplexEdit& edit, const FaceSet& a, const FaceSet& b) : edit_(edit), a_(a), b_(b) {}

  std::optional<Matching> best() {
    if (a_.faces().size() != b_.faces().size() || a_.darts().size() != b_.darts().size()) return {};
    for (const Dart d : a_.darts()) {
      if (!all_.darts.contains(d) && !match_part(d)) return {};
    }
    return all_.darts;
  }

 private:
  struct Part {
    Matching darts;
    std::map<Vertex, Vertex> there, back;
    double cost = 0.0;
  };

  // The best matching of the part of `start`. The most likely starts come first, so that others are abandoned early.
  bool match_part(Dart start) {
    std::vector<std::pair<double, Dart>> ways;
    for (const Dart d : b_.darts()) ways.emplace_back(distance(start, d), d);
    std::sort(ways.begin(), ways.end());
    Part best;
    best.cost = std::numeric_limits<double>::infinity();
    for (const auto& [near, d] : ways) {
      Part part;
      part.there = all_.there;
      part.back = all_.back;
      if (near < best.cost && grow(part, start, d, best.cost)) best = std::move(part);
    }
    all_.darts.merge(best.darts);
    all_.there = std::move(best.there);
    all_.back = std::move(best.back);
    return best.cost < std::numeric_limits<double>::infinity();
  }

  [[nodiscard]] double distance(Dart x, Dart y) {
    return squared(a_.from(x), b_.to(y)) + squared(a_.to(x), b_.from(y));
  }
  [[nodiscard]] double squared(Vertex u, Vertex v) {
    const Vec3 r = edit_.position(u) - edit_.position(v);
    return dot(r, r);
  }

  bool grow(Part& part, Dart x, Dart y, double limit) {
    std::vector<std::pair<Dart, Dart>> open = {{x, y}};
    for (std::size_t i = 0; i < open.size(); ++i) {
      const auto [p, q] = open[i];
      if (const auto found = part.darts.find(p); found != part.darts.end()) {
        if (found->second != q) return false;
        continue;
      }
      if (!match_faces(part, p, q, open) || !(part.cost < limit)) return false;
    }
    return true;
  }

  // Matches the faces of two darts, and queues the faces across their edges.
  bool match_faces(Part& part, Dart x, Dart y, std::vector<std::pair<Dart, Dart>>& open) {
    const CombinatorialMap& map = edit_.map();
    const CellFace f = map.face(x);
    const CellFace g = map.face(y);
    const std::uint16_t degree = map.shape(f.cell).degree(f.face);
    if (degree != map.shape(g.cell).degree(g.face)) return false;
    for (std::uint16_t k = 0; k < degree; ++k, x = map.phi1(x), y = map.phi_1(y)) {
      if (!match_vertices(part, a_.from(x), b_.to(y))) return false;
      part.darts[x] = y;
      const Dart beyond_x = a_.across(x);
      const Dart beyond_y = b_.across(y);
      if (beyond_x.valid() != beyond_y.valid()) return false;
      if (beyond_x.valid()) open.emplace_back(beyond_x, beyond_y);
    }
    return true;
  }

  bool match_vertices(Part& part, Vertex u, Vertex v) {
    const auto [there, fresh] = part.there.emplace(u, v);
    const auto [back, fresh_back] = part.back.emplace(v, u);
    if (fresh != fresh_back || there->second != v || back->second != u) return false;
    if (fresh) part.cost += squared(u, v);
    return true;
  }

  ComplexEdit& edit_;
  const FaceSet& a_;
  const FaceSet& b_;
  Part all_;
};

}  // namespace

std::optional<Matching> match(ComplexEdit& edit, const FaceSet& a, const FaceSet& b) {
  return Matcher(edit, a, b).best();
}

}  // namespace dartcast::detail
