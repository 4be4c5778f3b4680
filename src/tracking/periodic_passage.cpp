// Where walks end at faces of periodic pairs, and where particles enter. In a file of its own: in those of the steps it would
// change what g++ 12 inlines there.
#include "tracking/periodic_passage.hpp"

#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "tracking/representable_point.hpp"

namespace dartcast::detail {

namespace {

/// The pair's face that a facet is part of leads there; null if it is in no pair.
const PeriodicPartner* partner_of(const PeriodicFaces& pairs, SimplexId id, const CellView& cell, unsigned facet) {
  const Across across = cell.shape().simplices()[id.simplex].across[facet];
  return across.outer() ? pairs.partner(CellFace{id.cell, across.face()}) : nullptr;
}

/// The image of a point is that of the motion, moved by the differences between the partner's corners and the images of
/// the face's own. These are 0 if the corners are exact.
template <class Positions, std::size_t N>
Vec3 shift_at(const Space<Positions, N>& space, const PeriodicFaces& pairs, const PeriodicPartner& to, const Walk& w,
              const Vec3& x) {
  const CellView cell = space.map->view(w.wall_simplex.cell);
  const ImplicitSimplex& s = cell.shape().simplices()[w.wall_simplex.simplex];
  const std::array<Vec3, N> v = space.corners(cell, s);
  std::array<Vec3, N - 1> off{};
  bool exact = true;
  for (unsigned i = 0; i < N - 1; ++i) {
    const unsigned corner = facet_corner<N>(w.wall_facet, i);
    const Vertex partner = pairs.partner(to, cell.vertex(s.vertex[corner]));
    if (!partner.valid()) continue;
    off[i] = space.positions[partner] - pairs.motion(to).point(v[corner]);
    if constexpr (N == 3) off[i].z = 0.0;
    exact &= off[i] == Vec3{};
  }
  if (exact) return {};
  const std::array<double, N - 1> weight = weights_in(v, facet_plane(v, w.wall_facet), x);
  double sum = 0.0;
  for (const double each : weight) sum += each;
  const bool known = sum > 0.0 && std::isfinite(sum);
  Vec3 shift;
  for (unsigned i = 0; i < N - 1; ++i) shift += off[i] * (known ? weight[i] / sum : 1.0 / (N - 1.0));
  return shift;
}

template <class Positions, std::size_t N>
double fraction_of(const Space<Positions, N>& space, const Walk& w, const Vec3& p, const Vec3& q) {
  const std::array<Vec3, N> v = space.corners(w.wall_simplex);
  return contact_geometry(*space.map, v, facet_plane(v, w.wall_facet), w, p, q).fraction;
}

}  // namespace

template <class Positions, std::size_t N>
PeriodicEntry<N> periodic_entry(const Space<Positions, N>& space, const PeriodicFaces& pairs, const PeriodicPartner& to,
                                const Walk& w, const Vec3& p, const Vec3& q, const WallImpact* impact) {
  const double fraction = w.at_start ? 0.0 : impact != nullptr ? impact->fraction : fraction_of(space, w, p, q);
  const Vec3 x = w.at_start ? p : flushed(p + (q - p) * fraction);
  const Vec3 shift = shift_at(space, pairs, to, w, x);
  const PeriodicMotion& motion = pairs.motion(to);
  PeriodicEntry<N> entry{};
  entry.point = flushed(motion.point(x) + shift);
  entry.target = flushed(motion.point(q) + shift);
  const CellView cell = space.map->view(to.face.cell);
  const std::uint16_t triangles = cell.shape().triangle_count(to.face.face);
  double nearest = std::numeric_limits<double>::infinity();
  for (std::uint16_t t = 0; t < triangles; ++t) {
    const Across behind = cell.shape().entry(to.face.face, t);
    const SimplexId simplex = {to.face.cell, behind.index};
    const std::array<Vec3, N> v = space.corners(cell, cell.shape().simplices()[behind.index]);
    const PeriodicEntry<N> here = {simplex,  behind.place, v,           facet_plane(v, behind.place),
                                   fraction, entry.point,  entry.target};
    if (triangles == 1 || here.is_over()) return here;
    const double off = norm(here.on_plane() - here.point);
    if (t > 0 && !(off < nearest)) continue;
    nearest = off;
    entry = here;
  }
  return entry;
}

namespace {

/// The way round a wall through periodic faces: the first facet that a segment passes which starts at p, on walls. p has an
/// image at each periodic face that holds it, and these have images, too. The segment can start if it can at one of
/// them. Without such an image the facet is one that q is strictly beyond and whose image of p is rounded; nothing if
/// there is none. `at`: a free simplex that holds p. Cost: that of the stars of the images.
template <class Positions, std::size_t N>
std::optional<SimplexFacet> way_round(const Space<Positions, N>& space, const PeriodicFaces& pairs, SimplexId at,
                                      const Vec3& p, const Vec3& q) {
  constexpr std::size_t most_images = 64;
  struct Image {
    SimplexId simplex;
    Vec3 p, q;
    SimplexFacet first;
  };
  std::vector<Image> images{{at, p, q, {}}};
  std::optional<SimplexFacet> beyond;
  TestCounts uncounted;
  for (std::size_t next = 0; next < images.size() && images.size() < most_images; ++next) {
    const Image here = images[next];
    if (next > 0 && simplex_towards(space, here.simplex, here.p, here.q, uncounted).valid()) return here.first;
    const CellView of_here = space.map->view(here.simplex.cell);
    const ImplicitSimplex& simplex = of_here.shape().simplices()[here.simplex.simplex];
    const Feature around = feature_of<N>(of_here, simplex, zeros_of(space.corners(of_here, simplex), here.p));
    if (around.count >= N - 1) continue;
    const auto pass_wall = [&](SimplexId id, const CellView& cell, const ImplicitSimplex& s, std::uint16_t facet) {
      const PeriodicPartner* const to = partner_of(pairs, id, cell, facet);
      if (to == nullptr) return true;
      Walk through;
      through.at_start = true;
      through.wall_simplex = id;
      through.wall_facet = static_cast<std::uint8_t>(facet);
      const PeriodicEntry<N> entry = periodic_entry(space, pairs, *to, through, here.p, here.q);
      const auto is_known = [&](const Image& i) { return i.simplex.cell == entry.simplex.cell && i.p == entry.point; };
      const bool on_face = in_closed_simplex(entry.corners, entry.point) &&
                           orient_facet(entry.corners, entry.facet, entry.point) == Sign::zero;
      if (!on_face) {
        const bool leaves = next == 0 && orient_facet(space.corners(cell, s), facet, q) == Sign::negative;
        if (leaves && !beyond) beyond = SimplexFacet{id, facet};
      } else if (std::none_of(images.begin(), images.end(), is_known)) {
        images.push_back({entry.simplex, entry.point, entry.target, next == 0 ? SimplexFacet{id, facet} : here.first});
      }
      return true;
    };
    search_walls<N>(*space.map, here.simplex, around, pass_wall);
  }
  return beyond;
}

}  // namespace

template <class Positions, std::size_t N>
const PeriodicPartner* periodic_end(const Space<Positions, N>& space, const PeriodicFaces& pairs, Walk& w,
                                    const Vec3& p, const Vec3& q) {
  const CellView cell = space.map->view(w.wall_simplex.cell);
  const PeriodicPartner* partner = partner_of(pairs, w.wall_simplex, cell, w.wall_facet);
  if (w.at_end && partner != nullptr) {
    w.end = WalkEnd::arrived;
    const CellView last = space.map->view(w.simplex.cell);
    const Feature around = feature_of<N>(last, last.shape().simplices()[w.simplex.simplex], w.zeros);
    if (around.count == N - 1) return nullptr;
    search_walls<N>(*space.map, w.simplex, around,
                    [&](SimplexId id, const CellView& at, const ImplicitSimplex&, std::uint16_t facet) {
                      if (partner_of(pairs, id, at, facet) != nullptr) return true;
                      w.end = WalkEnd::wall;
                      w.wall_simplex = id;
                      w.wall_facet = static_cast<std::uint8_t>(facet);
                      return false;
                    });
    return nullptr;
  }
  if (!w.at_start) return partner;
  const std::optional<SimplexFacet> way = way_round(space, pairs, w.wall_simplex, p, q);
  if (!way) return partner;
  w.wall_simplex = way->simplex;
  w.wall_facet = static_cast<std::uint8_t>(way->facet);
  return partner_of(pairs, w.wall_simplex, space.map->view(w.wall_simplex.cell), w.wall_facet);
}

template PeriodicEntry<3> periodic_entry(const Space<Stored, 3>&, const PeriodicFaces&, const PeriodicPartner&,
                                         const Walk&, const Vec3&, const Vec3&, const WallImpact*);
template const PeriodicPartner* periodic_end(const Space<Stored, 3>&, const PeriodicFaces&, Walk&, const Vec3&,
                                             const Vec3&);
template PeriodicEntry<4> periodic_entry(const Space<Stored, 4>&, const PeriodicFaces&, const PeriodicPartner&,
                                         const Walk&, const Vec3&, const Vec3&, const WallImpact*);
template const PeriodicPartner* periodic_end(const Space<Stored, 4>&, const PeriodicFaces&, Walk&, const Vec3&,
                                             const Vec3&);
template PeriodicEntry<3> periodic_entry(const Space<Between, 3>&, const PeriodicFaces&, const PeriodicPartner&,
                                         const Walk&, const Vec3&, const Vec3&, const WallImpact*);
template const PeriodicPartner* periodic_end(const Space<Between, 3>&, const PeriodicFaces&, Walk&, const Vec3&,
                                             const Vec3&);
template PeriodicEntry<4> periodic_entry(const Space<Between, 4>&, const PeriodicFaces&, const PeriodicPartner&,
                                         const Walk&, const Vec3&, const Vec3&, const WallImpact*);
template const PeriodicPartner* periodic_end(const Space<Between, 4>&, const PeriodicFaces&, Walk&, const Vec3&,
                                             const Vec3&);

}  // namespace dartcast::detail
