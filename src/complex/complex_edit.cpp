#include "dartcast/complex_edit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "complex/boundary_shift.hpp"
#include "complex/place_steiner_points.hpp"
#include "dartcast/error.hpp"
#include "dartcast/validity.hpp"

namespace dartcast {

namespace {

std::uint64_t simplices_of(const Map& map, std::span<const Cell> cells) {
  std::uint64_t sum = 0;
  for (const Cell c : cells) sum += map.view(c).shape().simplices().size();
  return sum;
}

}  // namespace

ComplexEdit::ComplexEdit(Complex& complex)
    : complex_(complex), transaction_(complex.map_), born_(transaction_, complex.front_) {}

ComplexEdit::~ComplexEdit() { born_.give_up(); }

Vec3 ComplexEdit::position(Vertex v) { return born_.at(v); }

// Returns its number among the new ones.
std::size_t ComplexEdit::place_born(Vertex v, const Vec3& x) {
  if (map().dimension() == 2 && x.z != 0.0)
    throw InvalidArgument(
        fmt::format("place: vertex {} would be at ({}, {}, {}): in the plane z must be 0", v.value, x.x, x.y, x.z));
  return born_.place(v, x);
}

void ComplexEdit::place(Vertex v, const Vec3& x) { means_.erase(place_born(v, x)); }

void ComplexEdit::place(Vertex v, std::span<const Vertex> of, std::span<const double> weights) {
  if (of.empty() || of.size() != weights.size())
    throw InvalidArgument("place: give one weight per vertex, one at least");
  // From the first one: the mean of equal coordinates is that coordinate, so that planes across an axis stay plane.
  const Vec3 first = position(of[0]);
  Vec3 x = first;
  for (std::size_t i = 1; i < of.size(); ++i) x += (position(of[i]) - first) * weights[i];
  means_[place_born(v, x)] = {{of.begin(), of.end()}, {weights.begin(), weights.end()}};
}

void ComplexEdit::roll_back(const Transaction::Mark& to) {
  transaction_.roll_back(to);
  means_.erase(means_.lower_bound(transaction_.born_count()), means_.end());
  born_.take();
}

ComplexEditReport ComplexEdit::commit() {
  try {
    born_.take();
    const std::size_t born = born_.count();
    GivenPoints given = give_interior_points(transaction_, complex_.front_);
    born_.take();
    given.weights.compute(complex_.front_);
    check_added();
    ComplexEditReport report = make_final(given.weights, born);
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
          fmt::format("{}; no interior point mends it: place new vertices elsewhere, or split it into convex parts",
                      invalid->message));
    }
  }
}

PlacedVertex ComplexEdit::placed(std::size_t born) const {
  const BornVertex& v = transaction_.born(born);
  const auto position = [&](Vertex w) { return complex_.front_[w.value]; };
  const auto mean = means_.find(born);
  if (mean != means_.end()) return {v.vertex, mean->second.of, mean->second.weights, {}};
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

// Nothing here is refused.
ComplexEditReport ComplexEdit::make_final(const InteriorWeights& points, std::size_t born) {
  ComplexEditReport report;
  report.boundary_shift = boundary_shift(transaction_, complex_.front_);
  for (std::size_t i = 0; i < born; ++i) report.placed.push_back(placed(i));
  report.around = around();
  const std::uint64_t gone = simplices_of(map(), transaction_.removed());
  std::vector<Vertex> news;
  for (std::size_t i = 0; i < transaction_.born_count(); ++i) news.push_back(transaction_.born(i).vertex);

  report.map = transaction_.commit();
  complex_.simplex_count_ = complex_.simplex_count_ - gone + simplices_of(map(), report.map.added);
  for (const Vertex v : report.map.died) complex_.interior_.remove(v);
  complex_.interior_.add(points);
  for (const PlacedVertex& p : report.placed)
    complex_.point_count_ = std::max<std::size_t>(complex_.point_count_, p.vertex.value + 1U);
  if (!complex_.back_.empty()) {
    complex_.back_.resize(complex_.front_.size());
    for (const Vertex v : news) complex_.back_[v.value] = complex_.front_[v.value];
  }
  std::erase_if(complex_.invalid_, [&](const InvalidCell& c) { return !map().contains(c.cell); });
  born_.keep();
  means_.clear();
  return report;
}

}  // namespace dartcast
