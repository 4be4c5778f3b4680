#include "oracle/checked_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "complex/simplex.hpp"
#include "tracking/step.hpp"

namespace dartcast::test {
namespace {

std::string text(const Vec3& p) { return fmt::format("({:a}, {:a}, {:a})", p.x, p.y, p.z); }

std::vector<std::uint32_t> sorted_corners(const CellView& cell, std::uint16_t face) {
  std::vector<std::uint32_t> corners;
  for (const std::uint16_t local : cell.shape().corners(face)) corners.push_back(cell.vertex(local).value);
  std::sort(corners.begin(), corners.end());
  return corners;
}

// The Steiner points that the library chose, as the oracle names them. In a shape, points are numbered: corners, then
// the points of faces, then the cell's.
oracle::InteriorVertices interior_of(const CellComplex& complex, const MeshData& mesh) {
  oracle::InteriorVertices interior;
  const CombinatorialMap& map = complex.map();
  for (const Cell c : map.cells()) {
    const CellView cell = map.view(c);
    const std::uint32_t number = map.source(c);
    std::uint16_t next = cell.shape().corner_count();
    const auto faces = oracle::faces_of(mesh, number);
    for (std::uint16_t f = 0; f < cell.shape().face_count(); ++f) {
      if (!cell.shape().key().faces[f].has_point) continue;
      for (std::uint32_t k = 0; k < faces.size(); ++k) {
        auto corners = faces[k];
        std::sort(corners.begin(), corners.end());
        if (corners == sorted_corners(cell, f)) interior.of_face[{number, k}] = cell.vertex(next).value;
      }
      ++next;
    }
    if (cell.shape().key().has_point) interior.of_cell[number] = cell.vertex(next).value;
  }
  return interior;
}

const oracle::Touch* find(const oracle::Trace& trace, std::uint32_t wall) {
  const auto found =
      std::find_if(trace.touches.begin(), trace.touches.end(), [&](const auto& t) { return t.wall == wall; });
  return found == trace.touches.end() ? nullptr : &*found;
}

struct Box {
  Vec3 low, high;
};

// Whether all of the box lies strictly beyond one facet: so do its corners, exactly.
bool beyond_a_facet(const Corners& v, const Box& box) {
  for (unsigned facet = 0; facet < 4; ++facet) {
    bool beyond = true;
    for (unsigned corner = 0; corner < 8 && beyond; ++corner) {
      const auto pick = [&](unsigned axis, double low, double high) {
        return ((corner >> axis) & 1U) != 0 ? high : low;
      };
      const Vec3 x = {pick(0, box.low.x, box.high.x), pick(1, box.low.y, box.high.y), pick(2, box.low.z, box.high.z)};
      beyond = orient_facet(v, facet, x) == Sign::negative;
    }
    if (beyond) return true;
  }
  return false;
}

// Whether the simplex is proved to hold no point of the box with a double along this axis: between two neighbouring
// doubles the box falls into two parts, each beyond a facet.
bool passes_between_doubles(const Corners& v, const Box& box, double Vec3::*axis) {
  Box lower = box;
  double beyond = box.low.*axis;  // up to here all is, and from `other` on something is not
  double other = box.high.*axis;
  while (std::nextafter(beyond, other) < other) {
    lower.high.*axis = beyond + (other - beyond) * 0.5;
    (beyond_a_facet(v, lower) ? beyond : other) = lower.high.*axis;
  }
  lower.high.*axis = beyond;
  Box upper = box;
  upper.low.*axis = other;
  return beyond_a_facet(v, lower) && beyond_a_facet(v, upper);
}

bool holds_no_double(const Corners& v, const Box& box) {
  return beyond_a_facet(v, box) || passes_between_doubles(v, box, &Vec3::x) ||
         passes_between_doubles(v, box, &Vec3::y) || passes_between_doubles(v, box, &Vec3::z);
}

}  // namespace

CheckedScene::CheckedScene(MeshData mesh) : mesh_(std::move(mesh)), complex_(mesh_, Threads{1}) {
  if (!complex_.invalid_cells().empty()) return;
  const auto positions = complex_.positions();
  oracle_ = std::make_unique<oracle::Oracle>(mesh_, std::vector<Vec3>(positions.begin(), positions.end()),
                                             interior_of(complex_, mesh_));
  const auto& simplices = oracle_->triangulation().simplices();
  library_.resize(simplices.size());
  for (const Cell c : complex_.map().cells()) {
    for (std::uint16_t i = 0; i < complex_.map().shape(c).simplices().size(); ++i) {
      const std::uint32_t number = oracle_simplex({c, i});
      if (number != oracle::none) library_[number] = {c, i};
    }
  }
  for (std::uint32_t s = 0; s < simplices.size(); ++s) {
    if (oracle_->triangulation().is_free(simplices[s].cell)) free_simplices_.push_back(s);
  }
}

std::uint32_t CheckedScene::oracle_simplex(SimplexId s) const {
  if (!complex_.map().contains(s.cell) || s.simplex >= complex_.map().shape(s.cell).simplices().size())
    return oracle::none;
  const auto v = complex_.vertices(s);
  return oracle_->triangulation().find(complex_.map().source(s.cell), {v[0].value, v[1].value, v[2].value, v[3].value});
}

std::uint32_t CheckedScene::oracle_wall(SimplexId s, unsigned facet) const {
  const std::uint32_t number = oracle_simplex(s);
  if (number == oracle::none) return oracle::none;
  const oracle::Simplex& simplex = oracle_->triangulation().simplices()[number];
  const auto at = std::find(simplex.vertex.begin(), simplex.vertex.end(), complex_.vertices(s)[facet].value);
  return simplex.wall[static_cast<std::size_t>(at - simplex.vertex.begin())];
}

std::uint32_t CheckedScene::oracle_wall(const WallHit& hit) const {
  const Across behind = complex_.map().shape(hit.face.cell).entry(hit.face.face, hit.triangle);
  return oracle_wall({hit.face.cell, behind.index}, behind.place);
}

std::string CheckedScene::check_walk(SimplexId start, const Vec3& p, const Vec3& q, const oracle::Trace& trace) const {
  TestCounts counts;
  const Walk w = walk(current_space(complex_), start, p, q, counts);
  switch (w.end) {
    case WalkEnd::arrived: return check_arrival(w, q, trace);
    case WalkEnd::wall: return check_wall(w, start, p, q, trace);
    case WalkEnd::invalid_cell: break;
  }
  return "stopped at a cell that is valid";
}

std::string CheckedScene::check_arrival(const Walk& w, const Vec3& q, const oracle::Trace& trace) const {
  const std::uint32_t last = oracle_simplex(w.simplex);
  if (last == oracle::none) return "arrived in a simplex that does not exist";
  if (!oracle_->triangulation().is_free(oracle_->triangulation().simplices()[last].cell))
    return "arrived in a blocked cell";
  if (!oracle_->contains(last, q)) return "arrived in a simplex that does not contain the target";
  if (trace.leaves) return fmt::format("passed a wall at time {}", trace.exit_time);
  for (const oracle::Touch& t : trace.touches) {
    if (t.ends_on()) return fmt::format("ends on wall {}, which was not met", t.wall);
  }
  if (!oracle_->walls_at(q).empty()) return "ends on a wall, which was not met";
  return {};
}

std::string CheckedScene::check_wall(const Walk& w, SimplexId start, const Vec3& p, const Vec3& q,
                                     const oracle::Trace& trace) const {
  const std::uint32_t wall = oracle_wall(w.wall_simplex, w.wall_facet);
  if (wall == oracle::none) return "met what is no wall of a free cell";
  const oracle::Touch* touch = find(trace, wall);
  if (touch == nullptr) return fmt::format("met wall {}, which the segment does not touch", wall);
  if (w.at_start) {
    if (!touch->starts_outward()) return fmt::format("met wall {} at the start, but does not head beyond it", wall);
    return oracle_->can_start(oracle_simplex(start), p, q) ? "met a wall at the start, but there is a free way on" : "";
  }
  if (w.at_end) {
    const auto at_end = oracle_->walls_at(q);
    if (std::find(at_end.begin(), at_end.end(), wall) == at_end.end())
      return "met a wall at the end, which is not on it";
    if (trace.leaves) return fmt::format("passed a wall at time {} before it met one at its end", trace.exit_time);
    const std::uint32_t last = oracle_simplex(w.simplex);
    if (last == oracle::none || !oracle_->contains(last, q)) return "the last simplex does not contain the end";
    return {};
  }
  if (!touch->passes_out())
    return fmt::format("met wall {} without passing it: from {} to {}", wall, touch->from, touch->to);
  if (trace.leaves && touch->rank > trace.exit_rank) {
    return fmt::format("met wall {} at {}, but left the free cells at {}", wall, touch->time, trace.exit_time);
  }
  return {};
}

std::string CheckedScene::check_state(const ParticleState& state) const {
  const std::uint32_t s = oracle_simplex(state.at());
  if (s == oracle::none) return "the state names a simplex that does not exist";
  if (!oracle_->triangulation().is_free(oracle_->triangulation().simplices()[s].cell))
    return "the state's cell is blocked";
  if (!oracle_->contains(s, state.position)) return "the position is not in the state's simplex";
  if (state.held) return "held in a valid scene";
  const auto kind = static_cast<Kind>(oracle_->dimension_at(s, state.position));
  ParticleState untouched = state;
  untouched.touching_count = 0;
  if (forecast(complex_.map(), untouched, complex_.corners(state.at())).kind != kind) return "the kind is wrong";
  return {};
}

std::string CheckedScene::check_step(ParticleState& state, const Vec3& q, ContactList& contacts) const {
  const ParticleState before = state;
  const oracle::Trace trace = oracle_->trace(state.position, q);
  std::string wrong = q == state.position ? "" : check_walk(state.at(), state.position, q, trace);
  contacts.clear();
  Counters counters;
  Weights weights{};
  const ContactCallback none;
  const StepOptions options;
  const StepResult result = Stepper(complex_, false, options, none).step(0, state, weights, q, contacts, counters);
  if (wrong.empty()) wrong = check_state(state);
  if (wrong.empty() && result.held) wrong = "held in a valid scene";
  if (wrong.empty() && contacts.contacts.size() > 1) wrong = "went on without a response";
  if (wrong.empty() && contacts.contacts.empty() && state.position != q) wrong = "neither arrived nor met a wall";
  if (wrong.empty() && !contacts.contacts.empty()) {
    const Contact& c = contacts.contacts[0];
    wrong = check_contact(c, contacts.walls_of(c), before, state, q, trace);
  }
  if (wrong.empty()) return {};
  return fmt::format("{}; from {} in simplex {} to {}", wrong, text(before.position), oracle_simplex(before.at()),
                     text(q));
}

double CheckedScene::min_distance(const Vec3& x, double from) const {
  const auto none_within = [&](double distance) {
    const Vec3 reach = {distance, distance, distance};
    const Box box = {x - reach, x + reach};
    return std::all_of(free_simplices_.begin(), free_simplices_.end(),
                       [&](std::uint32_t s) { return holds_no_double(complex_.corners(library_[s]), box); });
  };
  double least = 0.0;
  for (double distance = from; none_within(distance); distance *= 1.5) least = distance;
  return least;
}

std::string CheckedScene::check_contact(const Contact& contact, std::span<const WallHit> walls,
                                        const ParticleState& before, const ParticleState& after, const Vec3& q,
                                        const oracle::Trace& trace) const {
  const Vec3& p = before.position;
  if (walls.empty()) return "a contact without a wall";
  const oracle::Touch* first = find(trace, oracle_wall(walls[0]));
  if (first == nullptr) return "a contact with a wall that is not touched";
  const bool at_end = !first->passes_out() && !first->starts_outward();
  const double time = at_end ? 1.0 : first->time;
  if (!(std::abs(contact.time_of_impact - time) <= 1e-12 * time)) {
    return fmt::format("time of impact {} instead of {}", contact.time_of_impact, time);
  }
  const auto around = at_end ? oracle_->walls_at(q) : std::vector<std::uint32_t>{};
  const int dimension = at_end ? oracle_->dimension_at(oracle_simplex(after.at()), q) : first->dimension;
  if (static_cast<int>(contact.kind) != dimension) {
    return fmt::format("kind {} instead of {}", static_cast<int>(contact.kind), dimension);
  }
  double largest = 0.0;
  for (const Vec3& x : oracle_->points()) largest = std::max({largest, std::abs(x.x), std::abs(x.y), std::abs(x.z)});
  const Vec3 point = p + (q - p) * time;
  if (norm(contact.point - point) > 1e-13 * (largest + norm(q - p))) return "the contact point is off";
  const double off = norm(after.position - contact.point);
  if (off > 1e-11 * largest && off > 4.0 * min_distance(contact.point, 1e-11 * largest))
    return "the particle is far from the contact point";
  for (const WallHit& hit : walls) {
    const std::uint32_t wall = oracle_wall(hit);
    if (wall == oracle::none) return "a contact lists what is no wall";
    const oracle::Touch* touch = find(trace, wall);
    const bool met = at_end ? std::find(around.begin(), around.end(), wall) != around.end()
                            : touch != nullptr &&
                                  (touch->rank == first->rank || (touch->rank < first->rank && touch->lies_in_plane()));
    if (!met) return fmt::format("wall {} is listed, but not at the contact", wall);
    if (!(std::abs(norm(hit.normal) - 1.0) < 1e-12)) return "a normal is not of unit length";
  }
  return {};
}

}  // namespace dartcast::test
