// Builds the stars of a shape: groups of simplices around each corner and edge.
#include <algorithm>
#include <bit>
#include <utility>

#include "dartcast/cell_shape.hpp"

namespace dartcast {

namespace {

constexpr std::uint16_t none = 0xffffU;

// The points of the one or two corners in a mask, in ascending order. A single one comes twice.
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

Stars::Stars(std::span<const ImplicitSimplex> simplices, const Fans& fans)
    : star_(simplices.size() * features, none), first_triangle_(fans.first) {
  constexpr std::array<std::uint8_t, features> one_or_two = {1, 2, 3, 4, 5, 6, 8, 9, 10, 12};  // masks
  facets_.reserve(6 * fans.triangles.size());
  std::vector<std::uint16_t> open;
  std::vector<std::pair<std::uint16_t, std::uint16_t>> known;  // points, star by star
  for (std::uint16_t s = 0; s < simplices.size(); ++s) {
    for (const std::uint8_t corners : one_or_two) {
      if (star(s, corners) != none) continue;
      add_star(simplices, fans, s, corners, open);
      known.push_back(points_of(simplices[s].vertex, corners));
    }
  }
  std::sort(known.begin(), known.end());
  one_each_ = std::adjacent_find(known.begin(), known.end()) == known.end();
  add_triangles(simplices, fans);
}

void Stars::add_star(std::span<const ImplicitSimplex> simplices, const Fans& fans, std::uint16_t simplex,
                     unsigned corners, std::vector<std::uint16_t>& open) {
  const auto number = static_cast<std::uint16_t>(first_.size() - 1);
  const auto points = points_of(simplices[simplex].vertex, corners);
  open.assign(1, simplex);
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
        const std::uint32_t first = fans.first[across.face()];
        const auto mirrored = static_cast<std::uint16_t>(fans.first[across.face() + 1U] - first - 1U - across.place);
        const unsigned of_triangle = corners_at(fans.triangles[first + across.place], points);
        facets_.push_back({at, facet, across.face(), 0, mirrored, from_other_side(of_triangle)});
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

void Stars::add_triangles(std::span<const ImplicitSimplex> simplices, const Fans& fans) {
  behind_.assign(fans.triangles.size() * masks, none);
  for (std::uint16_t s = 0; s < simplices.size(); ++s) {
    for (const Across& across : simplices[s].across) {
      if (!across.outer()) continue;
      const std::size_t triangle = fans.first[across.face()] + across.place;
      for (unsigned held = 1; held < 7; ++held) {
        behind_[triangle * masks + held] =
            star(s, corners_at(simplices[s].vertex, points_of(fans.triangles[triangle], held)));
      }
    }
  }
}

}  // namespace dartcast
