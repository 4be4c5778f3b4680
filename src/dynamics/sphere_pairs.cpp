// Pairs of spheres whose swept boxes meet: from cell lists if spheres are small, else from the grid.
#include "dynamics/sphere_pairs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "base/parallel.hpp"
#include "dartcast/error.hpp"
#include "tracking/step.hpp"

namespace dartcast {

namespace {

constexpr std::size_t pair_grain = 256;

// Lists are quicker than the grid if edges of cells are longer than this many reaches, because few spheres then
// meet other cells. Measured between 16 and 32, for 0.1 to 3 particles a cell.
constexpr double short_reach = 16.0;

// Room of a wide box beyond its own: a share of the radius, and the motion of some steps, up to half a radius.
constexpr double wide_share = 0x1p-3;
constexpr double steps_ahead = 4.0;
constexpr unsigned narrow_searches = 16;

constexpr double max_coordinate = 0x1p+1000;  // of a box: differences and levels of the grid stay in range

// False if one is NaN.
bool in_range(const Vec3& v) {
  return std::abs(v.x) <= max_coordinate && std::abs(v.y) <= max_coordinate && std::abs(v.z) <= max_coordinate;
}

[[noreturn]] void refuse_motion(std::size_t i, const SphereMotion& s) {
  throw InvalidArgument(fmt::format(
      "pairs: sphere {} at ({}, {}, {}) with a motion of ({}, {}, {}) and a radius of {} reaches beyond 2^1000, or is "
      "not "
      "finite: its radius or velocity is out of range",
      i, s.centre.x, s.centre.y, s.centre.z, s.displacement.x, s.displacement.y, s.displacement.z, s.radius));
}

// The set of cells that a search has visited.
class VisitedCells {
 public:
  // Whether it is new.
  bool add(Cell c) {
    if (2 * cells_.size() >= table_.size()) grow();
    Cell& place = table_[slot(c)];
    if (place == c) return false;
    place = c;
    cells_.push_back(c);
    return true;
  }
  void clear() {
    if (cells_.size() * 8 < table_.size()) {
      for (const Cell c : cells_) table_[slot_of_kept(c)] = Cell();
    } else {
      std::fill(table_.begin(), table_.end(), Cell());
    }
    cells_.clear();
  }
  [[nodiscard]] bool contains(Cell c) const { return table_[slot(c)] == c; }
  [[nodiscard]] std::size_t size() const { return cells_.size(); }
  [[nodiscard]] Cell operator[](std::size_t i) const { return cells_[i]; }

 private:
  [[nodiscard]] std::size_t home(Cell c) const {
    return static_cast<std::size_t>((c.value * 0x9e3779b97f4a7c15U) >> 32U) & (table_.size() - 1);
  }
  [[nodiscard]] std::size_t slot(Cell c) const {
    std::size_t at = home(c);
    while (table_[at].valid() && table_[at] != c) at = (at + 1) & (table_.size() - 1);
    return at;
  }
  // During removal: an earlier slot of the chain may be empty already.
  [[nodiscard]] std::size_t slot_of_kept(Cell c) const {
    std::size_t at = home(c);
    while (table_[at] != c) at = (at + 1) & (table_.size() - 1);
    return at;
  }
  void grow() {
    table_.assign(2 * table_.size(), Cell());
    for (const Cell c : cells_) table_[slot(c)] = c;
  }

  std::vector<Cell> cells_;
  std::vector<Cell> table_ = std::vector<Cell>(256);
};

detail::SweptBox bounds_of(const CellComplex& complex, const CellView& cell) {
  const auto positions = complex.positions();
  detail::SweptBox box = {positions[cell.vertex(0).value], positions[cell.vertex(0).value]};
  for (const std::uint32_t v : cell.vertices()) box = box.joined({positions[v], positions[v]});
  return box;
}

// Cells whose bounds meet the box, and that free cells connect to the first one.
void visit_cells(const CellComplex& complex, Cell start, const detail::SweptBox& box, VisitedCells& cells) {
  const CombinatorialMap& map = complex.map();
  cells.clear();
  cells.add(start);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const CellView cell = map.view(cells[i]);
    for (std::uint16_t f = 0; f < cell.shape().face_count(); ++f) {
      if (cell.is_wall(f)) continue;
      const Cell other = cell.neighbour(f);
      if (cells.contains(other)) continue;
      if (bounds_of(complex, map.view(other)).meets(box)) cells.add(other);
    }
  }
}

}  // namespace

void PairFinder::make_boxes(std::span<const SphereMotion> spheres, Threads threads) {
  boxes_.resize(spheres.size());
  reaches_.resize(spheres.size());
  parallel_for(spheres.size(), 4 * pair_grain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const SphereMotion& s = spheres[i];
      const Vec3 to = s.centre + s.displacement;
      const double r = s.radius > 0.0 ? s.radius : -std::numeric_limits<double>::infinity();
      boxes_[i].low = {std::min(s.centre.x, to.x) - r, std::min(s.centre.y, to.y) - r, std::min(s.centre.z, to.z) - r};
      boxes_[i].high = {std::max(s.centre.x, to.x) + r, std::max(s.centre.y, to.y) + r, std::max(s.centre.z, to.z) + r};
      reaches_[i] = r + std::max({std::abs(s.displacement.x), std::abs(s.displacement.y), std::abs(s.displacement.z)});
      if (r > 0.0 && !(in_range(boxes_[i].low) && in_range(boxes_[i].high) && in_range(to))) refuse_motion(i, s);
    }
  });
}

// The sphere with the farthest reach decides for all: only the cost depends on it.
bool PairFinder::lists_do(const CellComplex& complex, const CellLists& lists,
                          std::span<const ParticleState> states) const {
  if (lists.crowded() > 0 || states.empty()) return lists.crowded() == 0;
  const auto farthest = std::max_element(reaches_.begin(), reaches_.end());
  const detail::SweptBox cell =
      bounds_of(complex, complex.map().view(states[static_cast<std::size_t>(farthest - reaches_.begin())].cell));
  const Vec3 edge = cell.high - cell.low;
  return short_reach * *farthest <= std::max({edge.x, edge.y, edge.z});
}

// The box that holds the centre of every sphere with at most this reach that meets this one's box.
detail::SweptBox PairFinder::room_of(std::uint32_t sphere) const {
  const detail::SweptBox& b = boxes_[sphere];
  const double far = std::max({std::abs(b.low.x), std::abs(b.high.x), std::abs(b.low.y), std::abs(b.high.y),
                               std::abs(b.low.z), std::abs(b.high.z)});
  // Rounding of boxes, of reaches and of this sum: a few units in the last place of the coordinates.
  const double reach = reaches_[sphere] + 0x1p-48 * (reaches_[sphere] + far);
  const Vec3 room = {reach, reach, reach};
  return {b.low - room, b.high + room};
}

// The sphere with the further reach finds a pair: the other's centre is in its room. All spheres of a cell search
// together.
void PairFinder::search_lists(const CellComplex& complex, const CellLists& lists, std::span<const ParticleState> states,
                              Threads threads) {
  parts_.resize(chunk_count(states.size(), pair_grain));
  parallel_for(states.size(), pair_grain, threads, [&](std::size_t begin, std::size_t end) {
    VisitedCells cells;
    std::vector<std::uint32_t> own;
    std::vector<SpherePair>& found = parts_[begin / pair_grain];
    found.clear();
    for (std::size_t i = begin; i < end; ++i) {
      if (!lists.leads(static_cast<std::uint32_t>(i))) continue;
      own.clear();
      detail::SweptBox room = {{1.0, 1.0, 1.0}, {0.0, 0.0, 0.0}};
      lists.for_each(states[i].cell, [&](std::uint32_t j) {
        if (boxes_[j].empty()) return;
        own.push_back(j);
        room = room.empty() ? room_of(j) : room.joined(room_of(j));
      });
      if (own.empty()) continue;
      visit_cells(complex, states[i].cell, room, cells);
      for (std::size_t k = 0; k < cells.size(); ++k) {
        lists.for_each(cells[k], [&](std::uint32_t j) {
          for (const std::uint32_t o : own) {
            const bool further = reaches_[j] < reaches_[o] || (reaches_[j] == reaches_[o] && j < o);
            if (further && boxes_[j].meets(boxes_[o])) found.push_back({std::min(j, o), std::max(j, o)});
          }
        });
      }
    }
  });
}

// Searches the wide boxes.
void PairFinder::search_grid(Threads threads) {
  grid_.build(wide_boxes_);
  parts_.resize(chunk_count(grid_.size(), pair_grain));
  parallel_for(grid_.size(), pair_grain, threads, [&](std::size_t begin, std::size_t end) {
    std::vector<SpherePair>& found = parts_[begin / pair_grain];
    found.clear();
    for (std::size_t e = begin; e < end; ++e) grid_.find(e, found);
  });
}

bool PairFinder::wide_boxes_hold(Threads threads) {
  if (wide_boxes_.size() != boxes_.size()) return false;
  hold_.resize(chunk_count(boxes_.size(), 4 * pair_grain));
  parallel_for(boxes_.size(), 4 * pair_grain, threads, [&](std::size_t begin, std::size_t end) {
    bool all = true;
    for (std::size_t i = begin; i < end; ++i) all = all && (boxes_[i].empty() || wide_boxes_[i].holds(boxes_[i]));
    hold_[begin / (4 * pair_grain)] = all ? 1 : 0;
  });
  return std::find(hold_.begin(), hold_.end(), 0) == hold_.end();
}

// A wide box has room for the sphere's motion of some steps. If that lasts for no step, the next searches do
// without, because they find more pairs than they need.
void PairFinder::widen(std::span<const SphereMotion> spheres) {
  if (narrow_left_ > 0)
    --narrow_left_;
  else if (wide_uses_ == 0 && !wide_boxes_.empty())
    narrow_left_ = narrow_searches;
  wide_uses_ = 0;
  wide_boxes_ = boxes_;
  if (narrow_left_ > 0) return;
  for (std::size_t i = 0; i < wide_boxes_.size(); ++i) {
    detail::SweptBox& box = wide_boxes_[i];
    if (box.empty()) continue;
    const double r = spheres[i].radius;
    const double room = wide_share * r;
    const auto ahead = [&](double motion) { return std::clamp(steps_ahead * motion, -0.5 * r, 0.5 * r); };
    const Vec3 d = spheres[i].displacement;
    const Vec3 way = {ahead(d.x), ahead(d.y), ahead(d.z)};
    box.low += Vec3{std::min(0.0, way.x) - room, std::min(0.0, way.y) - room, std::min(0.0, way.z) - room};
    box.high += Vec3{std::max(0.0, way.x) + room, std::max(0.0, way.y) + room, std::max(0.0, way.z) + room};
  }
}

// Picks the pairs whose own boxes meet from those whose wide ones do.
void PairFinder::pick(Threads threads) {
  const std::size_t grain = 8 * pair_grain;
  const std::size_t chunks = chunk_count(wide_pairs_.size(), grain);
  if (picked_.size() < chunks) picked_.resize(chunks);
  parallel_for(wide_pairs_.size(), grain, threads, [&](std::size_t begin, std::size_t end) {
    std::vector<SpherePair>& found = picked_[begin / grain];
    found.clear();
    for (std::size_t k = begin; k < end; ++k) {
      if (boxes_[wide_pairs_[k].a].meets(boxes_[wide_pairs_[k].b])) found.push_back(wide_pairs_[k]);
    }
  });
  pairs_.clear();
  for (std::size_t c = 0; c < chunks; ++c) pairs_.insert(pairs_.end(), picked_[c].begin(), picked_[c].end());
}

void PairFinder::find_by_grid(std::span<const SphereMotion> spheres, Threads threads) {
  if (wide_boxes_hold(threads)) {
    ++wide_uses_;
  } else {
    widen(spheres);
    search_grid(threads);
    merge(wide_pairs_);
  }
  pick(threads);
}

// Sorts by counting the pairs of each sphere.
void PairFinder::merge(std::vector<SpherePair>& pairs) {
  starts_.assign(boxes_.size() + 1, 0);
  for (const auto& part : parts_) {
    for (const SpherePair& p : part) ++starts_[p.a + 1];
  }
  for (std::size_t i = 0; i + 1 < starts_.size(); ++i) starts_[i + 1] += starts_[i];
  pairs.resize(starts_.back());
  for (const auto& part : parts_) {
    for (const SpherePair& p : part) pairs[starts_[p.a]++] = p;
  }
  std::size_t begin = 0;  // starts_[i] is now where the pairs of sphere i end
  for (std::size_t i = 0; i + 1 < starts_.size(); ++i) {
    std::sort(pairs.begin() + static_cast<std::ptrdiff_t>(begin), pairs.begin() + starts_[i]);
    begin = starts_[i];
  }
}

std::span<const SpherePair> PairFinder::find(const CellComplex& complex, const CellLists& lists,
                                             std::span<const ParticleState> states,
                                             std::span<const SphereMotion> spheres, Threads threads,
                                             PairSearch search) {
  if (states.size() != spheres.size() || lists.size() != states.size())
    throw InvalidArgument("pairs: one state and one sphere per listed particle are needed");
  make_boxes(spheres, threads);
  by_lists_ = search == PairSearch::automatic ? lists_do(complex, lists, states) : search == PairSearch::lists;
  if (by_lists_) {
    search_lists(complex, lists, states, threads);
    merge(pairs_);
  } else {
    find_by_grid(spheres, threads);
  }
  return pairs_;
}

std::span<const SpherePair> PairFinder::find(std::span<const SphereMotion> spheres, Threads threads) {
  make_boxes(spheres, threads);
  by_lists_ = false;
  find_by_grid(spheres, threads);
  return pairs_;
}

bool separated(const CellComplex& complex, const ParticleState& a, const ParticleState& b) {
  if (a.cell == b.cell || a.held || b.held) return false;
  const StepOptions options;
  const ContactCallback stop;
  ParticleState state = a;
  Weights weights{};
  ContactList contacts;
  Counters counters;
  Stepper(complex, false, options, stop).step(0, state, weights, b.position, contacts, counters);
  return !contacts.contacts.empty() && contacts.contacts.front().time_of_impact < 1.0;
}

}  // namespace dartcast
