#include "dartcast/map/stars.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "dartcast/map/shape.hpp"

namespace dartcast {

namespace {

constexpr std::uint16_t none = 0xffffU;

// The points of a simplex's corners in a mask, in ascending order; a single one twice.
std::pair<std::uint16_t, std::uint16_t> points_of(const ImplicitSimplex& s, unsigned corners) {
  const std::uint16_t a = s.vertex[static_cast<std::size_t>(std::countr_zero(corners))];
  const std::uint16_t b = s.vertex[static_cast<std::size_t>(std::bit_width(corners)) - 1U];
  return std::minmax(a, b);
}

unsigned corners_at(const ImplicitSimplex& s, std::pair<std::uint16_t, std::uint16_t> points) {
  unsigned corners = 0;
  for (unsigned i = 0; i < 4; ++i) {
    corners |= s.vertex[i] == points.first || s.vertex[i] == points.second ? 1U << i : 0U;
  }
  return corners;
}

}  // namespace

Stars::Stars(std::span<const ImplicitSimplex> simplices) : star_(simplices.size() * features, none), first_{0} {
  std::vector<std::pair<std::uint16_t, std::uint16_t>> known;  // points, star by star
  for (std::uint16_t s = 0; s < simplices.size(); ++s) {
    for (unsigned corners = 1; corners < 16; ++corners) {
      if (std::popcount(corners) > 2 || star(s, corners) != none) continue;
      add_star(simplices, s, corners);
      known.push_back(points_of(simplices[s], corners));
    }
  }
  std::sort(known.begin(), known.end());
  one_each_ = std::adjacent_find(known.begin(), known.end()) == known.end();
}

void Stars::add_star(std::span<const ImplicitSimplex> simplices, std::uint16_t simplex, unsigned corners) {
  const auto number = static_cast<std::uint16_t>(first_.size() - 1);
  const auto points = points_of(simplices[simplex], corners);
  std::vector<std::uint16_t> open = {simplex};
  star_[simplex * features + feature_of_mask[corners]] = number;
  const auto begin = static_cast<std::ptrdiff_t>(facets_.size());
  while (!open.empty()) {
    const std::uint16_t at = open.back();
    open.pop_back();
    const ImplicitSimplex& s = simplices[at];
    const unsigned held = corners_at(s, points);
    for (std::uint16_t facet = 0; facet < 4; ++facet) {
      if (((held >> facet) & 1U) != 0) continue;
      const Across across = s.across[facet];
      if (across.outer()) {
        facets_.push_back({at, facet, across.face(), across.place});
        continue;
      }
      std::uint16_t& next =
          star_[across.index * features + feature_of_mask[corners_at(simplices[across.index], points)]];
      if (next == none) open.push_back(across.index);
      next = number;
    }
  }
  std::sort(facets_.begin() + begin, facets_.end(), [](const Facet& a, const Facet& b) {
    return std::pair{a.face, a.simplex} < std::pair{b.face, b.simplex};
  });
  first_.push_back(static_cast<std::uint32_t>(facets_.size()));
}

std::size_t Stars::bytes() const {
  return star_.size() * sizeof(std::uint16_t) + first_.size() * sizeof(std::uint32_t) + facets_.size() * sizeof(Facet);
}

}  // namespace dartcast
