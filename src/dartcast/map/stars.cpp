#include "dartcast/map/stars.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "dartcast/map/shape.hpp"

namespace dartcast {

namespace {

constexpr std::uint16_t none = 0xffffU;

// The points of one or two corners in a mask, in ascending order; a single one twice.
template <std::size_t N>
std::pair<std::uint16_t, std::uint16_t> points_of(const std::array<std::uint16_t, N>& vertex, unsigned corners) {
  const std::uint16_t a = vertex[static_cast<std::size_t>(std::countr_zero(corners))];
  const std::uint16_t b = vertex[static_cast<std::size_t>(std::bit_width(corners)) - 1U];
  return std::minmax(a, b);
}

template <std::size_t N>
unsigned corners_at(const std::array<std::uint16_t, N>& vertex, std::pair<std::uint16_t, std::uint16_t> points) {
  unsigned corners = 0;
  for (unsigned i = 0; i < N; ++i) {
    corners |= vertex[i] == points.first || vertex[i] == points.second ? 1U << i : 0U;
  }
  return corners;
}

// Both sides fan a face from the same point, in opposite directions.
std::uint16_t from_other_side(unsigned corners) {
  return static_cast<std::uint16_t>((corners & 1U) | ((corners & 2U) << 1U) | ((corners & 4U) >> 1U));
}

}  // namespace

Stars::Stars(std::span<const ImplicitSimplex> simplices, std::span<const Fan> fans)
    : star_(simplices.size() * features, none) {
  std::vector<std::pair<std::uint16_t, std::uint16_t>> known;  // points, star by star
  for (std::uint16_t s = 0; s < simplices.size(); ++s) {
    for (unsigned corners = 1; corners < 16; ++corners) {
      if (std::popcount(corners) > 2 || star(s, corners) != none) continue;
      add_star(simplices, fans, s, corners);
      known.push_back(points_of(simplices[s].vertex, corners));
    }
  }
  std::sort(known.begin(), known.end());
  one_each_ = std::adjacent_find(known.begin(), known.end()) == known.end();
  add_triangles(simplices, fans);
}

void Stars::add_star(std::span<const ImplicitSimplex> simplices, std::span<const Fan> fans, std::uint16_t simplex,
                     unsigned corners) {
  const auto number = static_cast<std::uint16_t>(first_.size() - 1);
  const auto points = points_of(simplices[simplex].vertex, corners);
  std::vector<std::uint16_t> open = {simplex};
  star_[simplex * features + feature_of_mask[corners]] = number;
  const auto begin = static_cast<std::ptrdiff_t>(facets_.size());
  while (!open.empty()) {
    const std::uint16_t at = open.back();
    open.pop_back();
    const ImplicitSimplex& s = simplices[at];
    const unsigned held = corners_at(s.vertex, points);
    for (std::uint16_t facet = 0; facet < 4; ++facet) {
      if (((held >> facet) & 1U) != 0) continue;
      const Across across = s.across[facet];
      if (across.outer()) {
        const Fan& fan = fans[across.face()];
        facets_.push_back({at, facet, across.face(), 0, static_cast<std::uint16_t>(fan.size() - 1 - across.place),
                           from_other_side(corners_at(fan[across.place], points))});
        continue;
      }
      std::uint16_t& next =
          star_[across.index * features + feature_of_mask[corners_at(simplices[across.index].vertex, points)]];
      if (next == none) open.push_back(across.index);
      next = number;
    }
  }
  std::sort(facets_.begin() + begin, facets_.end(), [](const Facet& a, const Facet& b) {
    return std::pair{a.face, a.simplex} < std::pair{b.face, b.simplex};
  });
  for (std::size_t f = facets_.size(); f > first_.back() + 1U; --f) {
    if (facets_[f - 2].face == facets_[f - 1].face)
      facets_[f - 2].rest = static_cast<std::uint16_t>(facets_[f - 1].rest + 1U);
  }
  first_.push_back(static_cast<std::uint32_t>(facets_.size()));
}

void Stars::add_triangles(std::span<const ImplicitSimplex> simplices, std::span<const Fan> fans) {
  std::uint32_t triangles = 0;
  for (const Fan& fan : fans) {
    first_triangle_.push_back(triangles);
    triangles += static_cast<std::uint32_t>(fan.size());
  }
  behind_.assign(triangles * masks, none);
  for (std::uint16_t s = 0; s < simplices.size(); ++s) {
    for (const Across& across : simplices[s].across) {
      if (!across.outer()) continue;
      const auto& corner = fans[across.face()][across.place];
      for (unsigned held = 1; held < 7; ++held) {
        behind_[(first_triangle_[across.face()] + across.place) * masks + held] =
            star(s, corners_at(simplices[s].vertex, points_of(corner, held)));
      }
    }
  }
}

std::size_t Stars::bytes() const {
  return (star_.size() + behind_.size()) * sizeof(std::uint16_t) +
         (first_triangle_.size() + first_.size()) * sizeof(std::uint32_t) + facets_.size() * sizeof(Facet);
}

}  // namespace dartcast
