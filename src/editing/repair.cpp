// Local remeshing: Steiner points, moved vertices, regions that are merged and cut again.
#include <algorithm>
#include <optional>
#include <unordered_set>

#include "dartcast/error.hpp"
#include "dartcast/remeshing.hpp"
#include "editing/kernel_point.hpp"
#include "editing/region.hpp"
#include "topology/rework.hpp"

namespace dartcast {

namespace {

using detail::Star;

class Repairer {
 public:
  Repairer(ComplexEdit& edit, const RepairOptions& options) : edit_(edit), map_(edit.map()), options_(options) {}

  void mend(Cell c) {
    if (sound(c)) return;
    if (give_point(c)) return;
    const std::vector<Star> stars = stars_around(c);
    for (const Star& star : stars) {
      if (star.closed && move(star)) return;
    }
    if (cut({c})) return;
    for (const Star& star : stars) {
      if (cut(star.cells)) return;
    }
    std::vector<Cell> region = {c};
    for (const Star& star : stars) {
      region.insert(region.end(), star.cells.begin(), star.cells.end());
      std::sort(region.begin(), region.end());
      region.erase(std::unique(region.begin(), region.end()), region.end());
      if (region.size() > options_.max_cells) break;
      if (&star != stars.data() && cut(region)) return;
    }
    grow(c);
  }

  RepairReport report;

 private:
  [[nodiscard]] bool planar() const { return map_.dimension() == 2; }

  [[nodiscard]] bool sound(Cell c) { return mended_.contains(c.value) || detail::is_positive(edit_, c); }

  [[nodiscard]] detail::Position position() {
    return [this](Vertex v) { return edit_.position(v); };
  }

  // The cells around each corner. Those with the most cells to repair come first.
  std::vector<Star> stars_around(Cell c) {
    struct Ranked {
      std::size_t bad;
      Star star;
    };
    std::vector<Ranked> ranked;
    for (const Vertex v : detail::corners_of(draft_of(map_, c).faces)) {
      Star star = detail::star_of(map_, c, v, options_.max_cells);
      if (star.too_large) continue;
      const auto bad = std::count_if(star.cells.begin(), star.cells.end(), [&](Cell x) { return !sound(x); });
      ranked.push_back({static_cast<std::size_t>(bad), std::move(star)});
    }
    std::stable_sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.bad > b.bad; });
    std::vector<Star> stars;
    for (Ranked& r : ranked) stars.push_back(std::move(r.star));
    return stars;
  }

  // The commit gives a cell the mean of its corners wherever that suffices.
  bool give_point(Cell c) {
    const CellDraft draft = draft_of(map_, c);
    const Vec3 mean = mean_of(detail::corners_of(draft.faces));
    if (!detail::all_positive(mean, detail::fans_of(draft.faces, position()))) return false;
    const std::vector<Cell> cells = {c};
    return put(Mending::point, cells, [&] { return std::vector<CellDraft>{draft}; });
  }

  Vec3 mean_of(std::span<const Vertex> corners) {
    Vec3 sum;
    for (const Vertex v : corners) sum += edit_.position(v);
    return sum * (1.0 / static_cast<double>(corners.size()));
  }

  // Only if the commit gives no Steiner points, because these would depend on the position of the vertex.
  bool move(const Star& star) {
    for (const Cell c : star.cells) {
      const auto& faces = map_.shape(c).key().faces;
      if (map_.has_flat(c) || std::any_of(faces.begin(), faces.end(), [](const auto& f) { return f.has_point; }))
        return false;
    }
    const Transaction::Savepoint before = edit_.savepoint();
    Vertex moved;
    const bool done = put(Mending::moved, star.cells, [&] {
      moved = edit_.topology().add_vertex(star.vertex, star.vertex);
      return with_vertex_replaced(star, moved);
    });
    if (!done) return false;
    const auto& cells = report.mended.back().cells;
    const auto facets = opposite(cells, moved);
    if (const auto x = kernel_point(facets)) {
      place(moved, detail::corners_of(detail::surface_of(map_, sorted(cells))), *x, facets);
      for (const Cell c : cells) mended_.erase(c.value);
      if (std::all_of(cells.begin(), cells.end(), [&](Cell c) { return sound(c); })) {
        for (const Cell c : cells) mended_.insert(c.value);
        return true;
      }
    }
    for (const Cell c : cells) mended_.erase(c.value);
    report.mended.pop_back();
    edit_.roll_back(before);
    return false;
  }

  // In the plane the triangles are upright, and a point sees the same above and below it.
  [[nodiscard]] std::optional<Vec3> kernel_point(std::span<const detail::ConeTriangle> triangles) const {
    std::optional<Vec3> x = detail::kernel_point(triangles);
    if (x && planar()) x->z = 0.0;
    return x;
  }

  std::vector<CellDraft> with_vertex_replaced(const Star& star, Vertex by) {
    std::vector<CellDraft> drafts;
    for (const Cell c : star.cells) {
      drafts.push_back(draft_of(map_, c));
      for (DraftFace& face : drafts.back().faces) {
        for (DraftCorner& corner : face.corners) {
          if (corner.vertex == star.vertex) corner.vertex = by;
        }
      }
    }
    return drafts;
  }

  static std::vector<Cell> sorted(std::vector<Cell> cells) {
    std::sort(cells.begin(), cells.end());
    return cells;
  }

  // The facets that the vertex must be behind, so that the simplices with the vertex are positive.
  std::vector<detail::ConeTriangle> opposite(std::span<const Cell> cells, Vertex v) {
    std::vector<detail::ConeTriangle> facets;
    for (const Cell c : cells) {
      const CellView view = map_.view(c);
      for (const ImplicitSimplex& s : view.shape().simplices()) {
        const auto at = [&](unsigned k) { return edit_.position(view.vertex(s.vertex[k])); };
        for (unsigned i = 0; i < map_.dimension() + 1; ++i) {
          if (view.vertex(s.vertex[i]) != v) continue;
          const auto& f = facet_corners[i];
          facets.push_back(planar() ? detail::upright(at((i + 1) % 3), at((i + 2) % 3))
                                    : detail::ConeTriangle{at(f[0]), at(f[2]), at(f[1])});
        }
      }
    }
    return facets;
  }

  bool cut(const std::vector<Cell>& region) {
    if (region.size() > options_.max_cells) return false;
    const std::vector<DraftFace> surface = detail::surface_of(map_, region);
    if (!detail::bounds_solid(surface)) return false;
    const auto triangles = detail::fans_of(surface, position());
    const auto x = kernel_point(triangles);
    if (!x) return false;
    return put(Mending::cut, region, [&] {
      const std::vector<Vertex> corners = detail::corners_of(surface);
      const Vertex apex = edit_.topology().add_vertex(corners[0], corners[1]);
      place(apex, corners, *x, triangles);
      return detail::pyramids_on(map_, surface, apex);
    });
  }

  // The vertex is a combination of the corners, so that it moves with them. It is at x itself if rounding leads out of
  // the kernel.
  void place(Vertex v, std::span<const Vertex> corners, const Vec3& x,
             std::span<const detail::ConeTriangle> triangles) {
    std::vector<Vec3> points;
    std::vector<std::uint32_t> numbers;
    for (const Vertex c : corners) {
      numbers.push_back(static_cast<std::uint32_t>(points.size()));
      points.push_back(edit_.position(c));
    }
    edit_.place(v, corners, detail::weights_for(x, points, numbers));
    if (!detail::all_positive(edit_.position(v), triangles)) edit_.place(v, x);
  }

  // Layer by layer.
  void grow(Cell c) {
    std::vector<Cell> region = {c};
    for (;;) {
      std::vector<Cell> larger = detail::grown(map_, region);
      if (larger.size() == region.size() || larger.size() > options_.max_cells) break;
      region = std::move(larger);
      if (cut(region)) return;
    }
    report.left.push_back(
        {c, map_.source(c),
         "cell " + std::to_string(map_.source(c)) + " stays as it is: none of the regions around it of " + "at most " +
             std::to_string(options_.max_cells) + " cells of its kind has a surface that can be seen from one point"});
  }

  // Puts drafts in the place of the cells. False, nothing changed, if the result would not be a map.
  template <class Drafts>
  bool put(Mending how, const std::vector<Cell>& cells, Drafts&& drafts) {
    const Transaction::Savepoint before = edit_.savepoint();
    MendedRegion region{how, {}, {}};
    for (const Cell c : cells) region.sources.push_back(map_.source(c));
    std::sort(region.sources.begin(), region.sources.end());
    region.sources.erase(std::unique(region.sources.begin(), region.sources.end()), region.sources.end());
    try {
      region.cells = edit_.topology().replace(cells, drafts());
    } catch (const EditRefused&) {
      edit_.roll_back(before);
      return false;
    }
    for (const Cell c : region.cells) mended_.insert(c.value);
    report.mended.push_back(std::move(region));
    return true;
  }

  ComplexEdit& edit_;
  const CombinatorialMap& map_;
  RepairOptions options_;
  std::unordered_set<std::uint32_t> mended_;  // cells whose simplices will be positive after the commit
};

}  // namespace

RepairReport repair(ComplexEdit& edit, std::span<const Cell> cells, const RepairOptions& options) {
  for (const Cell c : cells) detail::expect_cell(edit.map(), c);
  Repairer repairer(edit, options);
  RepairReport& report = repairer.report;
  std::vector<Cell> pending(cells.begin(), cells.end());
  std::size_t mended = 0;
  do {
    mended = report.mended.size();
    report.left.clear();
    for (const Cell c : pending) {
      if (edit.map().contains(c)) repairer.mend(c);
    }
    pending.clear();
    for (const LeftCell& c : report.left) pending.push_back(c.cell);
  } while (!pending.empty() && report.mended.size() > mended);
  std::erase_if(report.left, [&](const LeftCell& c) { return !edit.map().contains(c.cell); });
  return std::move(report);
}

}  // namespace dartcast
