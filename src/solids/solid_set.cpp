// Sets of solids: what is added, and the checks of it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.hpp"
#include "complex/periodic_faces.hpp"
#include "dartcast/error.hpp"
#include "dartcast/predicates.hpp"
#include "solids/audit_solids.hpp"
#include "solids/solid_refusal.hpp"
#include "solids/solid_set_impl.hpp"

namespace dartcast {

namespace {

double longest_side(std::span<const SolidElement> elements, std::span<const Vec3> points) {
  double longest = 0.0;
  for (const SolidElement& e : elements) {
    for (unsigned i = 0; i < side_count(e); ++i)
      longest = std::max(longest, norm(points[e.vertex[(i + 1) % e.count]] - points[e.vertex[i]]));
  }
  return longest;
}

}  // namespace

void SolidSet::Impl::check_current(const char* caller) const {
  environment.check_advance(particles, StepOptions{}, caller);
  if (particles.size() > 0 && environment.awaits_advance(particles))
    throw InvalidArgument(fmt::format(
        "{}: the environment was moved without its solids: move it by SolidSet::move_with(), or make a new set",
        caller));
}

SolidPlacement SolidSet::Impl::add(const SolidMesh& given, std::span<const std::uint32_t> others) {
  check(given);
  check_current("add");
  const auto unknown = std::find_if(others.begin(), others.end(), [&](std::uint32_t o) { return o >= count(); });
  if (unknown != others.end())
    throw InvalidArgument(fmt::format("add: there is no solid {} to meet: the set has {}", *unknown, count()));
  SolidMesh mesh = given;
  std::transform(mesh.points.begin(), mesh.points.end(), mesh.points.begin(), flushed);
  const std::vector<Location> located = environment.locate(mesh.points);
  std::vector<Cell> cells(located.size());
  for (std::size_t i = 0; i < located.size(); ++i) {
    if (located[i].place == Place::free) cells[i] = located[i].simplex.cell;
  }
  const std::vector<SolidElement> added = elements_of(mesh);
  SolidPlacement result = find_refusal(environment.complex(), mesh.points, added, cells);
  for (std::size_t i = 0; i < others.size() && result.refusal == SolidRefusal::none; ++i)
    result = overlap_with(others[i], mesh.points, added);
  if (result.refusal != SolidRefusal::none) return result;
  try {
    for (std::size_t i = 0; i < located.size(); ++i) {
      if (!environment.add(particles, located[i].simplex, mesh.points[i]))
        throw InternalError(
            fmt::format("solids: point {} of the solid is not in the simplex that was found for it", i));
    }
    std::vector<std::uint32_t>& met = meets.emplace_back(others.begin(), others.end());
    std::sort(met.begin(), met.end());
    met.erase(std::unique(met.begin(), met.end()), met.end());
    result.solid = append(mesh, added);
  } catch (...) {
    keep_first(static_cast<std::uint32_t>(longest.size()));
    throw;
  }
  return result;
}

SolidPlacement SolidSet::Impl::overlap_with(std::uint32_t other, std::span<const Vec3> points,
                                            std::span<const SolidElement> added) const {
  std::vector<SolidElement> own(elements.begin() + first_element[other], elements.begin() + first_element[other + 1]);
  for (SolidElement& e : own) {
    for (std::uint32_t& v : e.vertex) v -= first_vertex[other];
  }
  const auto places =
      std::span<const Vec3>(positions).subspan(first_vertex[other], first_vertex[other + 1] - first_vertex[other]);
  SolidPlacement result = find_overlap({points, added}, {places, own});
  if (result.refusal != SolidRefusal::none) result.other = other;
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
  meets.resize(solids);
  first_vertex.resize(solids + 1);
  first_element.resize(solids + 1);
  elements.resize(first_element.back());
  solid_of_element.resize(first_element.back());
  positions.resize(first_vertex.back());
  inverse_masses.resize(first_vertex.back());
  particles.truncate(first_vertex.back());
}

// The solid that an element meets; none if it is count().
std::uint32_t SolidSet::Impl::audit_other(std::size_t element, const BoxTree& all) const {
  const std::uint32_t mine = solid_of_element[element];
  const auto corners = [&](std::size_t e) {
    const auto& v = elements[e].vertex;
    return std::array{positions[v[0]], positions[v[1]], positions[v[2]]};
  };
  std::uint32_t met = count();
  all.query(audit_box(corners(element)), [&](std::size_t e) {
    const std::uint32_t other = solid_of_element[e];
    if (is_stuck(other) || !std::binary_search(meets[mine].begin(), meets[mine].end(), other)) return true;
    if (audit_meet(corners(element), corners(e))) met = other;
    return met == count();
  });
  return met;
}

SolidAudit SolidSet::Impl::audit() const {
  constexpr std::size_t grain = 64;
  const WallAudit walls(environment.complex());
  std::vector<Box> boxes;
  for (std::size_t e = 0; have_pairs() && e < elements.size(); ++e) {
    const auto& v = elements[e].vertex;
    boxes.push_back(audit_box({positions[v[0]], positions[v[1]], positions[v[2]]}));
  }
  const BoxTree all(std::move(boxes));
  std::vector<std::uint8_t> meets_wall(elements.size());
  std::vector<std::uint32_t> other(elements.size(), count());
  parallel_for(elements.size(), grain, environment.threads(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (is_stuck(solid_of_element[i])) continue;
      meets_wall[i] = walls.meets_wall(positions, elements[i]) ? 1 : 0;
      other[i] = audit_other(i, all);
    }
  });
  SolidAudit audit;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    audit.checked += is_stuck(solid_of_element[i]) ? 0 : 1;
    if ((meets_wall[i] == 0 && other[i] == count()) || audit.failed++ != 0) continue;
    const std::uint32_t solid = solid_of_element[i];
    std::vector<std::uint32_t> numbers;
    for (unsigned k = 0; k < elements[i].count; ++k) numbers.push_back(elements[i].vertex[k] - first_vertex[solid]);
    audit.first = fmt::format("solid {}: the part with the vertices {} meets {}", solid, fmt::join(numbers, ", "),
                              meets_wall[i] != 0 ? "a wall" : fmt::format("solid {}", other[i]));
  }
  return audit;
}

SolidSet::SolidSet(Environment& environment) : impl_(std::make_unique<Impl>(environment)) {
  if (environment.map().dimension() != 3)
    throw InvalidArgument("solids: the environment is of the plane; solids need one of space");
}

SolidSet::~SolidSet() = default;

SolidPlacement SolidSet::add(const SolidMesh& mesh, std::span<const std::uint32_t> meets) {
  detail::refuse_periodic(impl_->environment.complex(), "solids");
  return impl_->add(mesh, meets);
}
std::size_t SolidSet::size() const { return impl_->longest.size(); }
std::span<const Vec3> SolidSet::positions() const { return impl_->positions; }
std::span<const std::uint32_t> SolidSet::first_vertices() const { return impl_->first_vertex; }
const Particles& SolidSet::particles() const { return impl_->particles; }
void SolidSet::remove(std::uint32_t solid) { impl_->remove(solid); }
UpdateReport SolidSet::update_after_edit() { return impl_->update_after_edit(); }
std::span<const SolidPlacement> SolidSet::stuck() const { return impl_->stuck; }
SolidCheckpoint SolidSet::checkpoint() const { return impl_->checkpoint(); }
void SolidSet::restore(const SolidCheckpoint& saved) { impl_->restore(saved); }
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
  impl_->advance({{targets.begin(), targets.end()}}, options);
  return impl_->last;
}

const SolidStep& SolidSet::move_with(std::span<const Vec3> targets, std::span<const Vec3> positions,
                                     const SolidStepOptions& options) {
  impl_->prepare({{targets.begin(), targets.end()}}, options);
  MovePartner* const self = impl_.get();
  move_together(impl_->environment, {&self, 1}, positions);
  return impl_->last;
}

MovePartner& JointMoves::prepare(SolidSet& solids, SolidWay way, const SolidStepOptions& options) {
  solids.impl_->prepare(std::move(way), options);
  return *solids.impl_;
}

const SolidStep& JointMoves::advance(SolidSet& solids, SolidWay way, const SolidStepOptions& options) {
  solids.impl_->advance(std::move(way), options);
  return solids.impl_->last;
}

double JointMoves::separation(const SolidSet& solids, std::size_t solid) {
  return default_separation * solids.impl_->longest[solid];
}

std::unique_ptr<SolidSet> JointMoves::copy(const SolidSet& solids) {
  auto made = std::make_unique<SolidSet>(solids.impl_->environment);
  made->impl_ = std::make_unique<SolidSet::Impl>(*solids.impl_);
  return made;
}

const SolidStep& JointMoves::last_step(const SolidSet& solids) { return solids.impl_->last; }

}  // namespace dartcast
