// Cutting and carving: splits cells by the planes of tools, and frees or removes the parts inside.
#include <algorithm>
#include <cmath>

#include "dartcast/cutting.hpp"
#include "dartcast/error.hpp"
#include "dartcast/map_edits.hpp"
#include "editing/cutter.hpp"
#include "editing/near.hpp"

namespace dartcast {

namespace {

using CellNumbers = std::vector<std::uint32_t>;

class Carver {
 public:
  Carver(ComplexEdit& edit, std::span<const Cell> cells, Carving what, const CarveOptions& options)
      : edit_(edit), cutter_(edit, cells), what_(what), options_(options), done_(cells.size()) {
    for (std::size_t n = 0; n < cells.size(); ++n) done_[n] = what == Carving::open && edit.map().is_free(cells[n]);
  }

  void take(const ConvexTool& tool) {
    const CellNumbers inside = options_.whole_cells ? middles_in(tool) : split_by(tool);
    done_.resize(cutter_.size());
    for (const std::uint32_t n : inside) done_[n] = true;
    taken_.insert(taken_.end(), inside.begin(), inside.end());
  }

  detail::CutAttempt<Carved> finish() {
    detail::CutAttempt<Carved> attempt;
    Carved& carved = attempt.effects;
    attempt.whole = cutter_.cells(whole_);
    attempt.succession = cutter_.put();
    const std::vector<Cell> taken = cutter_.cells(taken_);
    carved.whole = cutter_.cells(whole_);
    if (what_ == Carving::open) {
      for (const Cell c : taken) edit_.topology().set_free(c, true);
      carved.opened = taken;
    } else {
      for (const Cell c : taken) remove(edit_.topology(), c);
      carved.removed = taken.size();
      std::erase_if(carved.whole, [&](Cell c) { return !edit_.map().contains(c); });
    }
    return attempt;
  }

 private:
  // Cells that are neither taken nor excluded yet.
  template <class Condition>
  [[nodiscard]] CellNumbers left(Condition&& condition) {
    CellNumbers numbers;
    for (std::uint32_t n = 0; n < cutter_.size(); ++n) {
      if (!done_[n] && condition(n)) numbers.push_back(n);
    }
    return numbers;
  }

  [[nodiscard]] CellNumbers middles_in(const ConvexTool& tool) {
    return left([&](std::uint32_t n) {
      const Vec3 x = cutter_.middle(n);
      return std::all_of(tool.planes.begin(), tool.planes.end(), [&](const Plane& p) { return p.height(x) < 0.0; });
    });
  }

  // Parts beyond one of the later planes are not split by the earlier ones.
  CellNumbers split_by(const ConvexTool& tool) {
    CellNumbers inside = left([&](std::uint32_t n) {
      return detail::near(cutter_.corners(n), tool.planes, [&](Vertex v) { return edit_.position(v); });
    });
    cutter_.take(tool.planes, cutter_.snap_distance(inside, {options_.snap, tool.finest}));
    for (std::size_t i = 0; i < tool.planes.size(); ++i) {
      std::erase_if(inside, [&](std::uint32_t n) { return !cutter_.reaches_below(n, i); });
      const auto parts = cutter_.split(inside, i);
      whole_.insert(whole_.end(), parts.whole.begin(), parts.whole.end());
      inside = parts.below;
    }
    return inside;
  }

  ComplexEdit& edit_;
  detail::Cutter cutter_;
  Carving what_;
  CarveOptions options_;
  std::vector<bool> done_;  // by number
  CellNumbers taken_, whole_;
};

}  // namespace

Carved carve(ComplexEdit& edit, std::span<const Cell> cells, std::span<const ConvexTool> tools, Carving what,
             const CarveOptions& options) {
  detail::check_snap(options.snap);
  return detail::cut_with_division(edit, cells, options.snap, {}, [&](const std::vector<Cell>& given, double snap) {
    Carver carver(edit, given, what, {options.whole_cells, snap});
    for (const ConvexTool& tool : tools) carver.take(tool);
    return carver.finish();
  });
}

std::vector<CellFace> open_faces(ComplexEdit& edit, std::span<const Cell> cells, const Plane& plane, double within) {
  std::vector<CellFace> faces;
  for (const Cell c : cells) {
    if (!edit.map().contains(c)) throw InvalidArgument("there is no such cell: an earlier edit replaced it");
    const CellView v = edit.map().view(c);
    for (std::uint16_t f = 0; f < v.shape().face_count(); ++f) {
      const auto corners = v.shape().corners(f);
      const bool on_plane = std::all_of(corners.begin(), corners.end(), [&](std::uint16_t k) {
        return std::abs(plane.height(edit.position(v.vertex(k)))) <= within;
      });
      if (on_plane && !v.neighbour(f).valid()) faces.push_back({c, f});
    }
  }
  return faces;
}

}  // namespace dartcast
