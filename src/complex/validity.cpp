// Checks the simplices of all cells, four cells of one shape at a time.
#include "dartcast/validity.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <utility>

#include "base/parallel.hpp"
#include "complex/positive_cells.hpp"
#include "complex/simplex.hpp"

namespace dartcast {

namespace {

std::string describe(const CombinatorialMap& map, Cell c, std::uint16_t simplex, Sign sign) {
  const char* what = sign == Sign::zero       ? " is flat"
                     : sign == Sign::negative ? " is inverted"
                                              : " has a corner that is not finite or outside the exact range";
  return "cell " + std::to_string(map.source(c)) + ": simplex " + std::to_string(simplex) + what;
}

// Checks cells four of one shape at a time, and collects those that the filter leaves open.
class Sieve {
 public:
  explicit Sieve(std::span<const Vec3> positions) : positions_(positions) {}

  void add(Cell c, const CellView& v) {
    const Shape* shape = &v.shape();
    if (shape->dimension() == 2) {
      open_.push_back(c);
      return;
    }
    // Shapes that share a group cause each other's cells to be checked early. This costs time and changes no result.
    Group& group = groups_[reinterpret_cast<std::uintptr_t>(shape) / 64U % groups_.size()];
    if (group.shape != shape) {
      check(group);
      group.shape = shape;
    }
    group.cells[group.size] = c;
    group.vertices[group.size] = v.vertices().data();
    if (++group.size == group.cells.size()) check(group);
  }

  /// The cells left open, in order. Called at the end.
  std::vector<Cell> open() {
    for (Group& group : groups_) check(group);
    std::sort(open_.begin(), open_.end());
    return std::move(open_);
  }

 private:
  struct Group {
    const Shape* shape = nullptr;
    std::array<Cell, 4> cells;
    std::array<const std::uint32_t*, 4> vertices;
    std::size_t size = 0;
  };

  void check(Group& group) {
    if (group.size == 0) return;
    for (std::size_t i = group.size; i < group.vertices.size(); ++i) group.vertices[i] = group.vertices[0];
    const unsigned open = detail::not_proved_positive(*group.shape, group.vertices, positions_.data());
    for (std::size_t i = 0; i < group.size; ++i) {
      if (((open >> i) & 1U) != 0) open_.push_back(group.cells[i]);
    }
    group.size = 0;
  }

  std::span<const Vec3> positions_;
  std::array<Group, 64> groups_;
  std::vector<Cell> open_;
};

}  // namespace

std::optional<InvalidCell> check_cell(const CombinatorialMap& map, std::span<const Vec3> positions, Cell c) {
  const CellView v = map.view(c);
  const auto& simplices = v.shape().simplices();
  for (std::uint16_t s = 0; s < simplices.size(); ++s) {
    Corners corners;
    for (unsigned i = 0; i < 4; ++i) corners[i] = positions[v.vertex(simplices[s].vertex[i]).value];
    if (map.dimension() == 2) corners = raised(corners);
    if (const Sign sign = volume_sign(corners); sign != Sign::positive)
      return InvalidCell{c, s, describe(map, c, s, sign)};
  }
  return {};
}

Validity check_validity(const CombinatorialMap& map, std::span<const Vec3> positions, Threads threads,
                        std::size_t max_count) {
  constexpr std::size_t grain = 4096;
  Validity all;
  for (std::uint32_t pool = 0; pool <= CombinatorialMap::general_pool; ++pool) {
    const std::size_t count = map.slot_count(pool);
    std::vector<Validity> parts(chunk_count(count, grain));
    parallel_for(count, grain, threads, [&](std::size_t begin, std::size_t end) {
      Sieve sieve(positions);
      map.for_each_cell(pool, begin, end, [&](Cell c, const CellView& v) { sieve.add(c, v); });
      Validity& part = parts[begin / grain];
      for (const Cell c : sieve.open()) {
        auto invalid = check_cell(map, positions, c);
        if (!invalid) continue;
        ++part.invalid_count;
        if (part.first.size() < max_count) part.first.push_back(std::move(*invalid));
      }
    });
    all.cells_checked += map.cell_count(pool);
    for (Validity& part : parts) {
      all.invalid_count += part.invalid_count;
      const auto keep = static_cast<std::ptrdiff_t>(std::min(max_count - all.first.size(), part.first.size()));
      all.first.insert(all.first.end(), part.first.begin(), part.first.begin() + keep);
    }
  }
  return all;
}

Validity check_validity(const CellComplex& complex, Threads threads, std::size_t max_count) {
  return check_validity(complex.map(), complex.positions(), threads, max_count);
}

}  // namespace dartcast
