// Sets of solids: what is added, and the checks of it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.hpp"
#include "dartcast/error.hpp"
#include "dartcast/predicates.hpp"
#include "solids/audit_solids.hpp"
#include "solids/solid_set_impl.hpp"
#include "surface/inside.hpp"

namespace dartcast {

namespace {

using Corners3 = std::array<Vec3, 3>;

Corners3 corners_of(const SolidElement& e, std::span<const Vec3> points) {
  return {points[e.vertex[0]], points[e.vertex[1]], points[e.vertex[2]]};
}

// Whether all corners of `a` are on one side of the plane of `b`.
bool on_one_side(const Corners3& a, const Corners3& b) {
  const Sign first = orient3d(b[0], b[1], b[2], a[0]);
  return first != Sign::zero && orient3d(b[0], b[1], b[2], a[1]) == first && orient3d(b[0], b[1], b[2], a[2]) == first;
}

double longest_side(std::span<const SolidElement> elements, std::span<const Vec3> points) {
  double longest = 0.0;
  for (const SolidElement& e : elements) {
    for (unsigned i = 0; i < side_count(e); ++i)
      longest = std::max(longest, norm(points[e.vertex[(i + 1) % e.count]] - points[e.vertex[i]]));
  }
  return longest;
}

MovingElement at_rest(const SolidElement& e, std::span<const Vec3> points) {
  MovingElement m;
  m.from = corners_of(e, points);
  m.to = m.from;
  m.count = e.count;
  return m;
}

// Whether each edge of the triangles has an even number of them.
bool is_closed(const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  std::vector<std::array<std::uint32_t, 2>> edges;
  for (const auto& t : triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [a, b] = std::minmax(t[i], t[(i + 1) % 3]);
      edges.push_back({a, b});
    }
  }
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
    while (end < edges.size() && edges[end] == edges[i]) ++end;
    if ((end - i) % 2 != 0) return false;
  }
  return !triangles.empty();
}

AddSolidResult refused(SolidRefusal why, const SolidElement& e) { return {why, 0xffffffffU, e.vertex, e.count}; }

VertexMotion walls_at_rest(const CellComplex& complex) { return {complex.positions(), complex.positions()}; }

// Whether an element meets a wall or reaches a flat cell.
SolidRefusal refusal_of(const CellComplex& complex, NearWalls& near, Cell cell, const SolidElement& e,
                        std::span<const Vec3> points) {
  const Corners3 corners = corners_of(e, points);
  for (const NearWall& w : near.search(complex, cell, at_rest(e, points), walls_at_rest(complex))) {
    const Corners3 wall = {flushed(w.corners.to[0]), flushed(w.corners.to[1]), flushed(w.corners.to[2])};
    if (!on_one_side(corners, wall) && audit_meet(corners, wall)) return SolidRefusal::meets_wall;
  }
  const bool flat = first_flat_time(complex, near.cells_reached(), walls_at_rest(complex)).has_value();
  return flat ? SolidRefusal::cell_not_positive : SolidRefusal::none;
}

}  // namespace

void SolidSet::Impl::check_current(const char* caller) const {
  environment.check_advance(particles, StepOptions{}, caller);
  if (particles.size() > 0 && environment.awaits_advance(particles))
    throw InvalidArgument(fmt::format(
        "{}: the environment was moved without its solids: move it by SolidSet::move_with(), or make a new set",
        caller));
}

// Walls inside a closed solid touch nothing, so a search of its whole box looks for them.
bool SolidSet::Impl::encloses_wall(const SolidMesh& mesh, std::span<const Location> places) const {
  if (!is_closed(mesh.triangles)) return false;
  const InsideTest test(mesh.points, mesh.triangles);
  MovingElement box;
  const std::uint32_t first = mesh.triangles[0][0];
  box.from[0] = mesh.points[first];
  box.to[0] = box.from[0];
  double reach = 0.0;
  for (const Vec3& p : mesh.points) reach = std::max(reach, norm(p - box.from[0]));
  NearWalls near;
  const CellComplex& complex = environment.complex();
  for (const NearWall& w :
       near.search(complex, places[first].simplex.cell, box, walls_at_rest(complex), reach * (1.0 + 0x1p-20))) {
    const auto inside = [&](const Vec3& corner) { return test.side(corner) == PointSide::inside; };
    if (std::any_of(w.corners.to.begin(), w.corners.to.end(), inside)) return true;
  }
  return false;
}

AddSolidResult SolidSet::Impl::refusal(const SolidMesh& mesh, std::span<const SolidElement> elements_of_mesh,
                                       std::span<const Location> places) const {
  for (std::uint32_t i = 0; i < places.size(); ++i) {
    if (places[i].place != Place::free) return refused(SolidRefusal::vertex_not_free, {{i}, 1});
  }
  NearWalls near;
  for (const SolidElement& e : elements_of_mesh) {
    const SolidRefusal why = refusal_of(environment.complex(), near, places[e.vertex[0]].simplex.cell, e, mesh.points);
    if (why != SolidRefusal::none) return refused(why, e);
  }
  if (encloses_wall(mesh, places)) return refused(SolidRefusal::encloses_wall, elements_of_mesh.front());
  return {};
}

AddSolidResult SolidSet::Impl::add(const SolidMesh& given) {
  check(given);
  check_current("add");
  SolidMesh mesh = given;
  std::transform(mesh.points.begin(), mesh.points.end(), mesh.points.begin(), flushed);
  const std::vector<Location> places = environment.locate(mesh.points);
  const std::vector<SolidElement> added = elements_of(mesh);
  AddSolidResult result = refusal(mesh, added, places);
  if (result.refusal != SolidRefusal::none) return result;
  try {
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (!environment.add(particles, places[i].simplex, mesh.points[i]))
        throw InternalError(
            fmt::format("solids: point {} of the solid is not in the simplex that was found for it", i));
    }
    result.solid = append(mesh, added);
  } catch (...) {
    keep_first(static_cast<std::uint32_t>(longest.size()));
    throw;
  }
  return result;
}

// `longest` grows last: its size says how many solids are complete.
std::uint32_t SolidSet::Impl::append(const SolidMesh& mesh, std::span<const SolidElement> added) {
  const std::uint32_t first = first_vertex.back();
  for (SolidElement e : added) {
    for (std::uint32_t& v : e.vertex) v += first;
    elements.push_back(e);
  }
  solid_of_element.resize(elements.size(), count());
  positions.insert(positions.end(), mesh.points.begin(), mesh.points.end());
  inverse_masses.resize(positions.size(), 1.0);
  first_vertex.push_back(static_cast<std::uint32_t>(positions.size()));
  first_element.push_back(static_cast<std::uint32_t>(elements.size()));
  longest.push_back(longest_side(added, mesh.points));
  return count() - 1;
}

void SolidSet::Impl::keep_first(std::uint32_t solids) {
  first_vertex.resize(solids + 1);
  first_element.resize(solids + 1);
  elements.resize(first_element.back());
  solid_of_element.resize(first_element.back());
  positions.resize(first_vertex.back());
  inverse_masses.resize(first_vertex.back());
  particles.truncate(first_vertex.back());
}

SolidAudit SolidSet::Impl::audit() const {
  constexpr std::size_t grain = 64;
  const WallAudit walls(environment.complex());
  std::vector<std::uint8_t> meets(elements.size());
  parallel_for(elements.size(), grain, environment.threads(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) meets[i] = walls.meets_wall(positions, elements[i]) ? 1 : 0;
  });
  SolidAudit audit;
  audit.checked = elements.size();
  for (std::size_t i = 0; i < elements.size(); ++i) {
    if (meets[i] == 0 || audit.failed++ != 0) continue;
    const std::uint32_t solid = solid_of_element[i];
    std::vector<std::uint32_t> numbers;
    for (unsigned k = 0; k < elements[i].count; ++k) numbers.push_back(elements[i].vertex[k] - first_vertex[solid]);
    audit.first = fmt::format("solid {}: the part with the vertices {} meets a wall", solid, fmt::join(numbers, ", "));
  }
  return audit;
}

SolidSet::SolidSet(Environment& environment) : impl_(std::make_unique<Impl>(environment)) {
  if (environment.map().dimension() != 3)
    throw InvalidArgument("solids: the environment is of the plane; solids need one of space");
}

SolidSet::~SolidSet() = default;

AddSolidResult SolidSet::add(const SolidMesh& mesh) { return impl_->add(mesh); }
std::size_t SolidSet::size() const { return impl_->longest.size(); }
std::span<const Vec3> SolidSet::positions() const { return impl_->positions; }
std::span<const std::uint32_t> SolidSet::first_vertices() const { return impl_->first_vertex; }
const Particles& SolidSet::particles() const { return impl_->particles; }
SolidAudit SolidSet::audit() const { return impl_->audit(); }

void SolidSet::set_inverse_masses(std::span<const double> inverse_masses) {
  if (inverse_masses.size() != impl_->positions.size())
    throw InvalidArgument(fmt::format("solids: {} inverse masses for {} vertices: give one for each",
                                      inverse_masses.size(), impl_->positions.size()));
  const auto bad = std::find_if(inverse_masses.begin(), inverse_masses.end(),
                                [](double m) { return !(m >= 0.0) || !std::isfinite(m); });
  if (bad != inverse_masses.end())
    throw InvalidArgument(fmt::format("solids: the inverse mass of vertex {} is {}: give a finite number of at least 0",
                                      bad - inverse_masses.begin(), *bad));
  impl_->inverse_masses.assign(inverse_masses.begin(), inverse_masses.end());
}

const SolidStep& SolidSet::advance(std::span<const Vec3> targets, const SolidStepOptions& options) {
  impl_->advance(targets, options);
  return impl_->last;
}

const SolidStep& SolidSet::move_with(std::span<const Vec3> targets, std::span<const Vec3> positions,
                                     const SolidStepOptions& options) {
  impl_->move_with(targets, positions, options);
  return impl_->last;
}

}  // namespace dartcast
