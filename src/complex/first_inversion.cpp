// The first inversion of a scene, and how far a motion can be followed.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <vector>

#include "base/parallel.hpp"
#include "complex/steiner_points.hpp"
#include "complex/volume_cubic.hpp"
#include "dartcast/error.hpp"
#include "dartcast/validity.hpp"

namespace dartcast {

namespace {

constexpr std::size_t chunk = 4096;

// Text for the vertices of a part of the corners: "vertex 5", "edge 5 7".
std::string part(const std::array<Vertex, 4>& vertices, unsigned corners) {
  constexpr std::array<const char*, 4> names = {"", "vertex", "edge", "face"};
  std::string text = names[static_cast<std::size_t>(std::popcount(corners))];
  for (unsigned i = 0; i < 4; ++i) {
    if (((corners >> i) & 1U) != 0) text += fmt::format(" {}", vertices[i].value);
  }
  return text;
}

std::string describe(const CombinatorialMap& map, const CellInversion& f) {
  const std::string place = fmt::format("cell {}: simplex {} ", map.source(f.simplex.cell), f.simplex.simplex);
  switch (f.how.kind) {
    case InversionKind::from_the_start: return place + "is flat or inverted before the motion";
    case InversionKind::undecidable:
      return place + "has a corner that is not finite or outside the exact range, before or after the motion";
    case InversionKind::line:
      return place + fmt::format("inverts at {}: its vertices {} {} {} {} come to lie on a line", f.how.safe_time,
                                 f.vertices[0].value, f.vertices[1].value, f.vertices[2].value, f.vertices[3].value);
    case InversionKind::vertex_face:
    case InversionKind::edge_edge:
    case InversionKind::vertex_edge:
    case InversionKind::vertex_vertex: break;
  }
  return place + fmt::format("inverts at {}: {} meets {}", f.how.safe_time, part(f.vertices, f.how.one),
                             part(f.vertices, f.how.other));
}

void check_count(const CombinatorialMap& map, std::size_t count, const char* what) {
  if (count != map.vertex_count())
    throw InvalidArgument(fmt::format(
        "inversion: {} positions {} the motion for {} vertices: give one per vertex, Steiner points included", count,
        what, map.vertex_count()));
}

// Keeps the first inversion of the cells that it is shown, in their order.
class InversionSearch {
 public:
  InversionSearch(const CombinatorialMap& map, std::span<const Vec3> before, std::span<const Vec3> after, double until)
      : map_(map), before_(before), after_(after), until_(until) {}

  // Later cells with the same safe_time are ignored: the first is kept.
  void look_at(Cell c) {
    if (found_ && found_->how.safe_time == 0.0) return;
    const CellView v = map_.view(c);
    const auto vertices = v.vertices();
    ends_.resize(vertices.size());
    for (std::size_t i = 0; i < vertices.size(); ++i)
      ends_[i] = detail::ends_of(before_[vertices[i]], after_[vertices[i]]);
    const auto& simplices = v.shape().simplices();
    for (std::uint16_t s = 0; s < simplices.size(); ++s) {
      if (map_.dimension() == 2) {
        look_at({c, s}, v);
        continue;
      }
      const auto& local = simplices[s].vertex;
      const detail::VolumeCubic cubic(ends_[local[0]], ends_[local[1]], ends_[local[2]], ends_[local[3]]);
      if (!cubic.proves_positive()) look_at({c, s}, v);
    }
  }

  [[nodiscard]] std::optional<CellInversion>& found() { return found_; }

 private:
  void look_at(SimplexId id, const CellView& v) {
    std::array<Vertex, 4> vertices;
    Corners from;
    Corners to;
    for (unsigned i = 0; i < 4; ++i) {
      vertices[i] = v.vertex(v.shape().simplices()[id.simplex].vertex[i]);
      from[i] = before_[vertices[i].value];
      to[i] = after_[vertices[i].value];
    }
    if (map_.dimension() == 2) {
      from = raised(from);
      to = raised(to);
    }
    const auto inversion = find_inversion(from, to, until_);
    if (!inversion || (found_ && found_->how.safe_time <= inversion->safe_time)) return;
    found_ = {id, vertices, *inversion, {}};
    until_ = inversion->safe_time;
  }

  const CombinatorialMap& map_;
  std::span<const Vec3> before_;
  std::span<const Vec3> after_;
  double until_;
  std::vector<detail::EndsVec3> ends_;  // of the vertices of a cell
  std::optional<CellInversion> found_;
};

std::optional<CellInversion> described(const CombinatorialMap& map, std::optional<CellInversion> found) {
  if (found) found->message = describe(map, *found);
  return found;
}

// The position of a vertex at the time t: exact at 0 and 1.
Vec3 on_line(const Vec3& before, const Vec3& after, double t) { return (1.0 - t) * before + t * after; }

}  // namespace

std::optional<CellInversion> first_inversion(const CombinatorialMap& map, std::span<const Vec3> before,
                                             std::span<const Vec3> after, Cell c, double until) {
  InversionSearch search(map, before, after, until);
  search.look_at(c);
  return described(map, std::move(search.found()));
}

std::optional<CellInversion> first_inversion(const CombinatorialMap& map, std::span<const Vec3> before,
                                             std::span<const Vec3> after, Threads threads) {
  check_count(map, before.size(), "before");
  check_count(map, after.size(), "after");
  std::optional<CellInversion> first;
  for (std::uint32_t pool = 0; pool <= CombinatorialMap::general_pool; ++pool) {
    const std::size_t count = map.slot_count(pool);
    const double until = first ? first->how.safe_time : 1.0;
    std::vector<std::optional<CellInversion>> parts(chunk_count(count, chunk));
    parallel_for(count, chunk, threads, [&](std::size_t begin, std::size_t end) {
      InversionSearch search(map, before, after, until);
      for (std::size_t i = begin; i < end; ++i) {
        if (const Cell c(pool, static_cast<std::uint32_t>(i)); map.contains(c)) search.look_at(c);
      }
      parts[begin / chunk] = std::move(search.found());
    });
    for (auto& found : parts) {
      if (found && (!first || found->how.safe_time < first->how.safe_time)) first = std::move(found);
    }
  }
  return described(map, std::move(first));
}

std::optional<CellInversion> first_inversion(const CellComplex& complex, Threads threads) {
  return first_inversion(complex.map(), complex.previous_positions(), complex.positions(), threads);
}

double move_towards(const CombinatorialMap& map, const SteinerWeights& steiner_weights, std::span<const Vec3> before,
                    std::span<const Vec3> after, double time, std::span<Vec3> positions, Threads threads) {
  check_count(map, before.size(), "before");
  check_count(map, after.size(), "after");
  check_count(map, positions.size(), "along");
  for (double back = inversion_resolution; time > 0.0; back *= 4.0) {
    parallel_for(positions.size(), chunk, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) positions[i] = on_line(before[i], after[i], time);
    });
    steiner_weights.compute(positions);
    if (!first_inversion(map, before, positions, threads)) return time;
    time = std::max(0.0, time - back);
  }
  std::copy(before.begin(), before.end(), positions.begin());
  return 0.0;
}

}  // namespace dartcast
