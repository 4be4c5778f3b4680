#include "dartcast/geometry/validity.hpp"

#include <algorithm>
#include <string>

namespace dartcast {

namespace {

std::string describe(const Map& map, Cell c, std::uint16_t simplex, Sign sign) {
  const char* what = sign == Sign::zero       ? " is flat"
                     : sign == Sign::negative ? " is inverted"
                                              : " has a corner that is not finite or outside the exact range";
  return "cell " + std::to_string(map.source(c)) + ": simplex " + std::to_string(simplex) + what;
}

}  // namespace

std::optional<InvalidCell> check_cell(const Map& map, std::span<const Vec3> positions, Cell c) {
  const CellView v = map.view(c);
  const auto& simplices = v.shape().simplices();
  for (std::uint16_t s = 0; s < simplices.size(); ++s) {
    Corners corners;
    for (unsigned i = 0; i < 4; ++i) corners[i] = positions[v.vertex(simplices[s].vertex[i]).value];
    if (const Sign sign = volume_sign(corners); sign != Sign::positive)
      return InvalidCell{c, s, describe(map, c, s, sign)};
  }
  return {};
}

Validity check_validity(const Map& map, std::span<const Vec3> positions, Threads threads, std::size_t most) {
  constexpr std::size_t grain = 4096;
  Validity all;
  for (std::uint32_t pool = 0; pool <= Map::general_pool; ++pool) {
    const std::size_t count = map.slot_count(pool);
    std::vector<Validity> parts(chunk_count(count, grain));
    parallel_for(count, grain, threads, [&](std::size_t begin, std::size_t end) {
      Validity& part = parts[begin / grain];
      for (std::size_t i = begin; i < end; ++i) {
        const Cell c(pool, static_cast<std::uint32_t>(i));
        if (!map.contains(c)) continue;
        auto invalid = check_cell(map, positions, c);
        if (!invalid) continue;
        ++part.invalid_count;
        if (part.first.size() < most) part.first.push_back(std::move(*invalid));
      }
    });
    all.cells_checked += map.cell_count(pool);
    for (Validity& part : parts) {
      all.invalid_count += part.invalid_count;
      const auto keep = static_cast<std::ptrdiff_t>(std::min(most - all.first.size(), part.first.size()));
      all.first.insert(all.first.end(), part.first.begin(), part.first.begin() + keep);
    }
  }
  return all;
}

Validity check_validity(const Complex& complex, Threads threads, std::size_t most) {
  return check_validity(complex.map(), complex.positions(), threads, most);
}

}  // namespace dartcast
