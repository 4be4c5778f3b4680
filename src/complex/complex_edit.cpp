// Edits of a complex: positions of new vertices, Steiner points, validity at the commit.
#include "dartcast/complex_edit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "complex/boundary_shift.hpp"
#include "complex/created_positions.hpp"
#include "complex/place_steiner_points.hpp"
#include "dartcast/error.hpp"
#include "dartcast/validity.hpp"
#include "topology/rework.hpp"

namespace dartcast {

namespace {

std::uint64_t simplices_of(const CombinatorialMap& map, std::span<const Cell> cells) {
  std::uint64_t sum = 0;
  for (const Cell c : cells) sum += map.view(c).shape().simplices().size();
  return sum;
}

}  // namespace

struct ComplexEdit::Created : detail::CreatedPositions<AlignedVector<Vec3>> {
  using CreatedPositions::CreatedPositions;
};

ComplexEdit::ComplexEdit(CellComplex& complex)
    : complex_(complex), transaction_(complex.map_), created_(std::make_unique<Created>(transaction_, complex.front_)) {
  if (complex.periodic() != nullptr)
    throw EditRefused("edit: a scene with periodic pairs cannot be edited: leave the edit or the pairs out");
}

ComplexEdit::~ComplexEdit() { created_->give_up(); }

Vec3 ComplexEdit::position(Vertex v) { return created_->at(v); }

// Returns the number of the vertex among the new ones.
std::size_t ComplexEdit::place_created(Vertex v, const Vec3& x) {
  if (map().dimension() == 2 && x.z != 0.0)
    throw InvalidArgument(
        fmt::format("place: vertex {} would be at ({}, {}, {}): in the plane z must be 0", v.value, x.x, x.y, x.z));
  return created_->place(v, x);
}

void ComplexEdit::place(Vertex v, const Vec3& x) { means_.erase(place_created(v, x)); }

void ComplexEdit::place(Vertex v, std::span<const Vertex> of, std::span<const double> weights) {
  if (of.empty() || of.size() != weights.size())
    throw InvalidArgument("place: give one weight per vertex, one at least");
  // The mean is taken relative to the first one. So the mean of equal coordinates is that coordinate, and planes
  // perpendicular to an axis stay plane.
  const Vec3 first = position(of[0]);
  Vec3 x = first;
  for (std::size_t i = 1; i < of.size(); ++i) x += (position(of[i]) - first) * weights[i];
  means_[place_created(v, x)] = {{of.begin(), of.end()}, {weights.begin(), weights.end()}};
}

void ComplexEdit::roll_back(const Transaction::Savepoint& to) {
  transaction_.roll_back(to);
  means_.erase(means_.lower_bound(transaction_.created_count()), means_.end());
  created_->take();
}

std::vector<Cell> ComplexEdit::refused_cells(std::span<const Cell> cells, bool keep_faces) {
  for (const Cell c : cells) detail::expect_cell(map(), c);
  created_->take();
  const Transaction::Savepoint before = savepoint();
  std::vector<Cell> refused = cells_without_cone(transaction_, complex_.front_, cells, keep_faces);
  roll_back(before);
  return refused;
}

ComplexEditReport ComplexEdit::commit() {
  try {
    created_->take();
    const std::size_t created = created_->count();
    PlacedSteinerPoints given = place_steiner_points(transaction_, complex_.front_);
    created_->take();
    given.weights.compute(complex_.front_);
    check_added();
    ComplexEditReport report = make_final(given.weights, created);
    report.given_points = std::move(given.replaced);
    return report;
  } catch (...) {
    roll_back({});
    throw;
  }
}

void ComplexEdit::check_added() const {
  for (const Cell c : transaction_.added()) {
    if (const auto invalid = check_cell(map(), complex_.front_, c)) {
      throw EditRefused(
          fmt::format("{}; no Steiner point mends it: place new vertices elsewhere, or split it into convex parts",
                      invalid->message));
    }
  }
}

PlacedVertex ComplexEdit::placed(std::size_t created) const {
  const CreatedVertex& v = transaction_.created(created);
  const auto position = [&](Vertex w) { return complex_.front_[w.value]; };
  const auto mean = means_.find(created);
  if (mean != means_.end()) return {v.vertex, mean->second.of, mean->second.weights, {}};
  if (v.from == v.other) {
    const auto [of, weights] = complex_.steiner_.of(v.from);
    PlacedVertex copy{v.vertex, {}, {weights.begin(), weights.end()}, {}};
    for (const std::uint32_t w : of) copy.of.emplace_back(w);
    if (!of.empty()) return copy;
  }
  if (v.from == v.other) return {v.vertex, {v.from}, {1.0}, position(v.vertex) - position(v.from)};
  const Vec3 edge = position(v.other) - position(v.from);
  const Vec3 way = position(v.vertex) - position(v.from);
  const double length2 = dot(edge, edge);
  const double share = length2 > 0.0 ? std::clamp(dot(way, edge) / length2, 0.0, 1.0) : 0.0;
  return {v.vertex, {v.from, v.other}, {1.0 - share, share}, way - edge * share};
}

std::vector<Cell> ComplexEdit::around() const {
  std::vector<Cell> added = transaction_.added();
  std::sort(added.begin(), added.end());
  std::vector<Cell> around;
  const auto add_neighbours = [&](const std::vector<Cell>& cells) {
    for (const Cell c : cells) {
      const CellView v = map().view(c);
      for (std::uint16_t f = 0; f < v.shape().face_count(); ++f) {
        const Cell other = v.neighbour(f);
        if (map().contains(other) && !std::binary_search(added.begin(), added.end(), other)) around.push_back(other);
      }
    }
  };
  add_neighbours(added);
  add_neighbours(transaction_.removed());
  add_neighbours(transaction_.marked());
  std::sort(around.begin(), around.end());
  around.erase(std::unique(around.begin(), around.end()), around.end());
  return around;
}

// From here on nothing can be refused.
ComplexEditReport ComplexEdit::make_final(const SteinerWeights& points, std::size_t created) {
  ComplexEditReport report;
  report.boundary_shift = boundary_shift(transaction_, complex_.front_);
  for (std::size_t i = 0; i < created; ++i) report.placed.push_back(placed(i));
  report.around = around();
  const std::uint64_t gone = simplices_of(map(), transaction_.removed());
  std::vector<Vertex> news;
  for (std::size_t i = 0; i < transaction_.created_count(); ++i) news.push_back(transaction_.created(i).vertex);

  report.map = transaction_.commit();
  complex_.simplex_count_ = complex_.simplex_count_ - gone + simplices_of(map(), report.map.added);
  for (const Vertex v : report.map.deleted) complex_.steiner_.remove(v);
  complex_.steiner_.add(points);
  for (const PlacedVertex& p : report.placed)
    complex_.point_count_ = std::max<std::size_t>(complex_.point_count_, p.vertex.value + 1U);
  if (!complex_.back_.empty()) {
    complex_.back_.resize(complex_.front_.size());
    for (const Vertex v : news) complex_.back_[v.value] = complex_.front_[v.value];
    points.compute(complex_.back_);  // where a move back to there would put them
  }
  std::erase_if(complex_.invalid_, [&](const InvalidCell& c) { return !map().contains(c.cell); });
  created_->keep();
  means_.clear();
  return report;
}

}  // namespace dartcast
