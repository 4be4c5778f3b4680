// Which cells are subdivided and merged, and the edits that do it.
#include "simulation/adaptive_subdivision.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "dartcast/error.hpp"

namespace dartcast {

namespace {

bool has_vertex(const CombinatorialMap& map, Cell c, Vertex v) {
  const auto vertices = map.view(c).vertices();
  return std::find(vertices.begin(), vertices.end(), v.value) != vertices.end();
}

// The cells around the vertex, from one of them on, through faces.
std::vector<Cell> cells_around(const CombinatorialMap& map, Cell start, Vertex v) {
  std::vector<Cell> cells = {start};
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const CellView cell = map.view(cells[i]);
    for (std::uint16_t f = 0; f < cell.shape().face_count(); ++f) {
      const Cell other = cell.neighbour(f);
      if (!other.valid() || !has_vertex(map, other, v)) continue;
      if (std::find(cells.begin(), cells.end(), other) == cells.end()) cells.push_back(other);
    }
  }
  return cells;
}

// The shortest extent along an axis. Edges are no measure, because neighbours that were subdivided have halved some.
double extent_of(const CellComplex& complex, Cell c) {
  const CellView cell = complex.map().view(c);
  Vec3 low = complex.positions()[cell.vertex(0).value];
  Vec3 high = low;
  for (const std::uint32_t v : cell.vertices()) {
    const Vec3& p = complex.positions()[v];
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const Vec3 extent = high - low;
  return std::min({extent.x, extent.y, extent.z});
}

}  // namespace

AdaptiveSubdivision::AdaptiveSubdivision(const AdaptiveSubdivisionOptions& options) : options_(options) {
  if (options.min_particles >= options.max_particles)
    throw InvalidArgument("adaptive subdivision: min_particles must be less than max_particles");
  if (!(options.smallest >= 0.0) || !std::isfinite(options.smallest))
    throw InvalidArgument("adaptive subdivision: smallest must be finite and not negative");
}

void AdaptiveSubdivision::update_after_edit(const CombinatorialMap& map, std::span<const Cell> added) {
  for (Subdivision& s : subdivisions_) dartcast::update_after_edit(map, added, s);
}

// The cell with the most particles; the lowest number if several have as many.
AdaptiveSubdivision::Fullest AdaptiveSubdivision::fullest(const CombinatorialMap& map) const {
  Fullest result;
  for (const Cell c : map.cells()) {
    const std::uint32_t count = counts_.of(c);
    if (count <= options_.max_particles) continue;
    if (std::find(passed_over_.begin(), passed_over_.end(), c) != passed_over_.end()) continue;
    ++result.others;
    if (count < result.particles || (count == result.particles && !(c < result.cell))) continue;
    result.cell = c;
    result.particles = count;
  }
  if (result.others > 0) --result.others;
  return result;
}

// Throws EditRefused, nothing changed.
void AdaptiveSubdivision::make(const CellComplex& complex, const SubdivisionChange& change, const Edit& edit) {
  std::optional<Subdivision> made;
  const ComplexEditReport done = edit([&](ComplexEdit& e) {
    if (change.merged)
      coarsen(e, subdivisions_[change.what]);
    else
      made = subdivide(e, Cell(change.what)).subdivision;
  });
  if (made)
    subdivisions_.push_back(*std::move(made));
  else
    subdivisions_.erase(subdivisions_.begin() + static_cast<std::ptrdiff_t>(change.what));
  update_after_edit(complex.map(), done.map.added);
}

void AdaptiveSubdivision::repeat(const CellComplex& complex, const SubdivisionChange& change, const Edit& edit) {
  if (change.merged ? change.what >= subdivisions_.size() : !complex.map().contains(Cell(change.what)))
    throw InvalidArgument(
        fmt::format("adaptive subdivision: there is no {} {} to edit again: the log does not fit this simulation",
                    change.merged ? "subdivision" : "cell", change.what));
  make(complex, change, edit);
}

// Whether the change was made. A refusal is added to the report.
bool AdaptiveSubdivision::try_edit(const CellComplex& complex, const SubdivisionChange& change, const Edit& edit,
                                   SubdivisionRefusal refusal, AdaptiveSubdivisionReport& report) {
  try {
    make(complex, change, edit);
    report.changes.push_back(change);
    return true;
  } catch (const EditRefused& e) {
    refusal.reason = e.what();
    report.refused.push_back(std::move(refusal));
    return false;
  }
}

void AdaptiveSubdivision::subdivide_fullest(const CellComplex& complex, const Particles& particles, const Edit& edit,
                                            AdaptiveSubdivisionReport& report) {
  passed_over_.clear();
  while (true) {
    counts_.update(complex.map(), particles.states(), ranks_);
    const Fullest full = fullest(complex.map());
    if (!full.cell.valid()) return;
    const SubdivisionRefusal refusal = {full.cell, full.particles, {}};
    if (report.subdivided == options_.edits) {
      report.waiting = full.others + 1;
      return;
    }
    const double extent = extent_of(complex, full.cell);
    if (0.5 * extent < options_.smallest) {
      report.refused.push_back(refusal);
      report.refused.back().reason = fmt::format(
          "it is {} m across: its parts would be smaller than the smallest allowed, {} m", extent, options_.smallest);
      passed_over_.push_back(full.cell);
      continue;
    }
    if (!try_edit(complex, {false, full.cell.value}, edit, refusal, report)) {
      passed_over_.push_back(full.cell);
      continue;
    }
    ++report.subdivided;
  }
}

// Whether no part is subdivided itself. A subdivision of a part has the middle among its corners.
bool AdaptiveSubdivision::is_whole(const CombinatorialMap& map, std::size_t subdivision) const {
  const Subdivision& s = subdivisions_[subdivision];
  return map.contains(s.part) && cells_around(map, s.part.cell, s.middle).size() == s.corners.size() &&
         std::none_of(subdivisions_.begin() + static_cast<std::ptrdiff_t>(subdivision) + 1, subdivisions_.end(),
                      [&](const Subdivision& later) {
                        return std::find(later.corners.begin(), later.corners.end(), s.middle) != later.corners.end();
                      });
}

void AdaptiveSubdivision::merge_emptiest(const CellComplex& complex, const Particles& particles, const Edit& edit,
                                         AdaptiveSubdivisionReport& report) {
  const CombinatorialMap& map = complex.map();
  for (std::size_t i = subdivisions_.size(); i-- > 0 && report.merged < options_.edits;) {
    if (!is_whole(map, i)) continue;
    const Subdivision& s = subdivisions_[i];
    counts_.update(map, particles.states(), ranks_);
    std::uint64_t held = 0;
    for (const Cell c : cells_around(map, s.part.cell, s.middle)) held += counts_.of(c);
    if (held >= options_.min_particles) continue;
    const SubdivisionRefusal refusal = {s.part.cell, static_cast<std::uint32_t>(held), {}};
    if (try_edit(complex, {true, static_cast<std::uint32_t>(i)}, edit, refusal, report)) ++report.merged;
  }
}

AdaptiveSubdivisionReport AdaptiveSubdivision::adapt(const CellComplex& complex, const Particles& particles,
                                                     const Edit& edit, Ranks* ranks) {
  ranks_ = ranks;
  AdaptiveSubdivisionReport report;
  subdivide_fullest(complex, particles, edit, report);
  merge_emptiest(complex, particles, edit, report);
  return report;
}

}  // namespace dartcast
