// Solids that meet each other: what touches on their ways, and who stops.
//
//  touching_pairs()     boxes around ways find the pairs of solids that may touch, then groups of elements. The elements of
//                       the one solid are walls to those of the other: the same pairs of parts, with the same proofs
//  stop_at_solids()     after the walls have cut the ways: a solid that goes towards another stops before it
#include "solids/solid_pairs.hpp"

#include <algorithm>
#include <iterator>

#include "base/parallel.hpp"
#include "solids/solid_set_impl.hpp"

namespace dartcast {

namespace {

// An element as a wall: an edge or a point repeats its last corner.
NearWall wall_of(const SolidElement& e, const SolidMotion& motion) {
  NearWall wall;
  for (unsigned i = 0; i < 3; ++i) {
    wall.vertex[i] = Vertex{e.vertex[i]};
    wall.corners.from[i] = motion.from[e.vertex[i]];
    wall.corners.to[i] = motion.to[e.vertex[i]];
  }
  return wall;
}

}  // namespace

std::vector<ElementTouch> SolidPairFinder::find(std::span<const SolidElement> solid,
                                                std::span<const SolidElement> other, const SolidMotion& motion) {
  constexpr std::size_t elements_in_one_query = 16;
  std::vector<Box> boxes(other.size());
  std::transform(other.begin(), other.end(), boxes.begin(), [&](const auto& e) { return way_of(e, motion); });
  const BoxTree tree(std::move(boxes));
  std::vector<ElementTouch> touches;
  for (std::size_t begin = 0; begin < solid.size(); begin += elements_in_one_query) {
    const auto group = solid.subspan(begin, std::min(elements_in_one_query, solid.size() - begin));
    Box box = way_of(group[0], motion);
    for (const SolidElement& e : group) box = join(box, way_of(e, motion));
    std::vector<std::size_t> near;
    if (motion.margin > 0.0) box = widened(box, motion.margin);
    tree.query(box, [&](std::size_t i) {
      near.push_back(i);
      return true;
    });
    std::sort(near.begin(), near.end());
    std::vector<NearWall> walls;
    for (const std::size_t i : near) walls.push_back(wall_of(other[i], motion));
    parts_.set(walls);
    for (const SolidElement& e : group) finder_.find_among(parts_, e, motion, touches);
  }
  for (ElementTouch& t : touches) t.beside.reset();  // walls have a free side, solids may be open
  return touches;
}

std::span<const SolidElement> SolidSet::Impl::elements_of_solid(std::uint32_t solid) const {
  return std::span<const SolidElement>(elements).subspan(first_element[solid],
                                                         first_element[solid + 1] - first_element[solid]);
}

bool SolidSet::Impl::moves(std::uint32_t solid, std::span<const Vec3> to) const {
  return !std::equal(from.begin() + first_vertex[solid], from.begin() + first_vertex[solid + 1],
                     to.begin() + first_vertex[solid]);
}

bool SolidSet::Impl::have_pairs() const {
  return std::any_of(meets.begin(), meets.end(), [](const auto& others) { return !others.empty(); });
}

// All that meet and may be as near as these margins on the way.
std::vector<SolidSet::Impl::Pair> SolidSet::Impl::near_pairs(std::span<const Vec3> to,
                                                             std::span<const double> kept) const {
  std::vector<Box> ways(count());
  for (std::uint32_t s = 0; s < count(); ++s) {
    ways[s] = way_of(from[first_vertex[s]], to[first_vertex[s]]);
    for (std::uint32_t v = first_vertex[s] + 1; v < first_vertex[s + 1]; ++v)
      ways[s] = join(ways[s], way_of(from[v], to[v]));
  }
  std::vector<Pair> near;
  for (std::uint32_t s = 0; s < count(); ++s) {
    for (const std::uint32_t other : meets[s]) {
      const double margin = kept[s] + kept[other];
      if (overlap(widened(ways[s], margin), ways[other])) near.push_back({s, other, margin, {}});
    }
  }
  return near;
}

// The touches of each pair. The earliest is the first.
void SolidSet::Impl::look_at_pairs(std::vector<Pair>& pairs, std::span<const Vec3> to) const {
  parallel_for(pairs.size(), 1, environment.threads(), [&](std::size_t begin, std::size_t end) {
    SolidPairFinder finder;
    for (std::size_t i = begin; i < end; ++i) {
      Pair& p = pairs[i];
      p.touches = finder.find(elements_of_solid(p.solid), elements_of_solid(p.other), {from, to, p.margin});
      const auto earlier = [](const ElementTouch& a, const ElementTouch& b) { return a.time < b.time; };
      const auto first = std::min_element(p.touches.begin(), p.touches.end(), earlier);
      if (first != p.touches.end()) std::iter_swap(p.touches.begin(), first);
    }
  });
}

std::vector<SolidSet::Impl::Pair> SolidSet::Impl::touching_pairs(std::span<const Vec3> to) const {
  std::vector<Pair> pairs = near_pairs(to, margins);
  std::erase_if(pairs, [&](const Pair& p) { return !moves(p.solid, to) && !moves(p.other, to); });
  look_at_pairs(pairs, to);
  std::erase_if(pairs, [](const Pair& p) { return p.touches.empty(); });
  return pairs;
}

// Solids on arcs leave each other both their separations, or what they have of them at the start.
void SolidSet::Impl::leave_margins_to_solids() {
  std::vector<double> asked(count());
  std::transform(way.arcs.begin(), way.arcs.end(), asked.begin(), [](const SolidArc& a) { return a.separation; });
  std::vector<Pair> pairs = near_pairs(from, asked);
  std::erase_if(pairs, [](const Pair& p) { return p.margin == 0.0; });
  look_at_pairs(pairs, from);
  for (const Pair& p : pairs) {
    double share = 1.0;
    for (const ElementTouch& t : p.touches) share = std::min(share, kept_share * t.distance / p.margin);
    for (const std::uint32_t s : {p.solid, p.other}) margins[s] = std::min(margins[s], share * asked[s]);
  }
}

// Those of a pair that go towards the other; if none does, both that move.
SolidSet::Impl::Solids SolidSet::Impl::to_blame(const Pair& pair, const SolidConstraint& meeting) const {
  const ElementTouch& t = meeting.touch;
  Vec3 way_of_solid;
  Vec3 way_of_other;
  for (unsigned i = 0; i < t.count; ++i)
    way_of_solid += (reached[t.vertices[i]] - from[t.vertices[i]]) * meeting.weights[i];
  for (unsigned i = 0; i < t.wall_count; ++i) {
    const std::uint32_t v = t.wall.vertex[t.corners[i]].value;
    way_of_other += (reached[v] - from[v]) * meeting.wall_weights[i];
  }
  Solids all;
  if (dot(way_of_solid, meeting.normal) < 0.0) all.push_back(pair.solid);
  if (dot(way_of_other, meeting.normal) > 0.0) all.push_back(pair.other);
  if (!all.empty()) return all;
  for (const std::uint32_t s : {pair.solid, pair.other}) {
    if (moves(s, reached)) all.push_back(s);
  }
  return all;
}

// Each round makes the way of a solid shorter, and ends it after some 30 times. At the start no two solids touch, so the
// rounds end. At the end `squeezed` has those that walls run into even if they stay, too.
void SolidSet::Impl::stop_at_solids(Solids& squeezed, const VertexMotion& walls) {
  double share = cut_share;
  for (std::vector<Pair> pairs = touching_pairs(reached); !pairs.empty(); pairs = touching_pairs(reached)) {
    std::vector<double> shorter = shares;
    Solids open;
    for (const Pair& p : pairs) {
      const ElementTouch& touch = p.touches.front();
      meetings.push_back(constraint_of(touch, {from, reached, p.margin}, step_options.separation, longest[p.solid]));
      meetings.back().slice = slice;
      for (const std::uint32_t s : to_blame(p, meetings.back())) {
        const double until = share == cut_share ? touch.time : 1.0;
        shorter[s] = std::min(shorter[s], shares[s] * share * until);
        open.push_back(s);
      }
    }
    std::sort(open.begin(), open.end());
    open.erase(std::unique(open.begin(), open.end()), open.end());
    shares = std::move(shorter);
    cut_each(open, walls);
    squeezed.insert(squeezed.end(), open.begin(), open.end());
    share = 0.5;
  }
}

// By solid, then by the other; each pair once, as it was found first. Cells may have carried solids that are stuck.
void SolidSet::Impl::report_meetings() {
  for (const SolidConstraint& c : meetings) {
    const ElementTouch& t = c.touch;
    SolidMeeting m;
    m.solid = solid_of(t.vertices[0]);
    m.other = solid_of(t.wall.vertex[0].value);
    m.kind = t.kind;
    m.count = t.count;
    m.weights = c.weights;
    m.other_weights = c.wall_weights;
    for (unsigned i = 0; i < t.count; ++i) {
      m.vertices[i] = t.vertices[i] - first_vertex[m.solid];
      m.point += positions[t.vertices[i]] * c.weights[i];
    }
    for (unsigned i = 0; i < t.wall_count; ++i) {
      const std::uint32_t v = t.wall.vertex[t.corners[i]].value;
      m.other_vertices[i] = v - first_vertex[m.other];
      m.other_point += positions[v] * c.wall_weights[i];
    }
    m.time_of_impact = (c.slice + t.time) / way.slices;
    m.normal = c.normal;
    m.gap = dot(m.normal, m.point - m.other_point);
    last.meetings.push_back(m);
  }
  const auto by_pair = [](const SolidMeeting& m) { return std::pair(m.solid, m.other); };
  std::stable_sort(last.meetings.begin(), last.meetings.end(),
                   [&](const auto& a, const auto& b) { return by_pair(a) < by_pair(b); });
  const auto same = [&](const auto& a, const auto& b) { return by_pair(a) == by_pair(b); };
  last.meetings.erase(std::unique(last.meetings.begin(), last.meetings.end(), same), last.meetings.end());
}

}  // namespace dartcast
