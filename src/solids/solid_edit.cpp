// Solids after an edit of the environment, and from a checkpoint. A solid that walls pierce is stuck until another edit
// frees it.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "dartcast/error.hpp"
#include "dartcast/predicates.hpp"
#include "solids/solid_refusal.hpp"
#include "solids/solid_set_impl.hpp"
#include "tracking/carry.hpp"

namespace dartcast {

namespace {

template <class T>
void erase(std::vector<T>& values, std::size_t begin, std::size_t end) {
  values.erase(values.begin() + static_cast<std::ptrdiff_t>(begin), values.begin() + static_cast<std::ptrdiff_t>(end));
}

}  // namespace

void SolidSet::Impl::remove(std::uint32_t solid) {
  if (solid >= count())
    throw InvalidArgument(fmt::format("solids: there is no solid {}: the set has {}", solid, count()));
  const std::uint32_t vertex = first_vertex[solid];
  const std::uint32_t vertices = first_vertex[solid + 1] - vertex;
  const std::uint32_t element = first_element[solid];
  const std::uint32_t parts_of_it = first_element[solid + 1] - element;
  std::vector<std::uint8_t> marks(positions.size(), 0);
  std::fill_n(marks.begin() + vertex, vertices, std::uint8_t{1});
  particles.remove(marks);
  erase(positions, vertex, vertex + vertices);
  erase(inverse_masses, vertex, vertex + vertices);
  erase(elements, element, element + parts_of_it);
  erase(solid_of_element, element, element + parts_of_it);
  erase(longest, solid, solid + 1);
  erase(first_vertex, solid, solid + 1);
  erase(first_element, solid, solid + 1);
  for (std::size_t e = element; e < elements.size(); ++e) {
    for (std::uint32_t& v : elements[e].vertex) v -= vertices;
    --solid_of_element[e];
  }
  for (std::size_t s = solid; s < first_vertex.size(); ++s) {
    first_vertex[s] -= vertices;
    first_element[s] -= parts_of_it;
  }
  erase(meets, solid, solid + 1);
  for (auto& others : meets) {
    std::erase(others, solid);
    for (std::uint32_t& other : others) other -= other > solid ? 1 : 0;
  }
  std::erase_if(stuck, [&](const SolidPlacement& p) { return p.solid == solid; });
  for (SolidPlacement& p : stuck) p.solid -= p.solid > solid ? 1 : 0;
}

UpdateReport SolidSet::Impl::update_after_edit() {
  if (particles.size() > 0 && environment.awaits_advance(particles))
    throw InvalidArgument(
        "solids: the environment was moved without its solids before the edit: move it by SolidSet::move_with()");
  Particles updated = particles;
  UpdateReport report = environment.update_after_edit(updated, OrphanPolicy::hold);
  if (updated.size() != particles.size())
    throw InvalidArgument("solids: the edit left no free cell for a vertex: remove its solid, or keep a free cell");
  particles = std::move(updated);
  for (std::size_t v = 0; v < positions.size(); ++v) positions[v] = particles[v].position;
  find_stuck();
  return report;
}

SolidCheckpoint SolidSet::Impl::checkpoint() const {
  SolidCheckpoint saved;
  for (std::size_t v = 0; v < particles.size(); ++v) {
    saved.states.push_back(particles[v]);
    saved.held_weights.push_back(particles.held_weights(v));
  }
  return saved;
}

void SolidSet::Impl::restore(const SolidCheckpoint& saved) {
  if (saved.states.size() != positions.size())
    throw InvalidArgument(
        fmt::format("solids: the checkpoint has {} vertices, the set has {}: add the same solids first",
                    saved.states.size(), positions.size()));
  particles = environment.restored(saved.states, saved.held_weights);
  for (std::size_t v = 0; v < positions.size(); ++v) positions[v] = particles[v].position;
  find_stuck();
}

void SolidSet::Impl::find_stuck() {
  stuck.clear();
  const CellComplex& complex = environment.complex();
  for (std::uint32_t s = 0; s < count(); ++s) {
    std::vector<Cell> cells;
    for (std::uint32_t v = first_vertex[s]; v < first_vertex[s + 1]; ++v)
      cells.push_back(complex.map().is_free(particles[v].cell) ? particles[v].cell : Cell{});
    std::vector<SolidElement> own(elements.begin() + first_element[s], elements.begin() + first_element[s + 1]);
    for (SolidElement& e : own) {
      for (std::uint32_t& v : e.vertex) v -= first_vertex[s];
    }
    SolidPlacement placement = find_refusal(complex, of(positions, s), own, cells);
    placement.solid = s;
    // Steps look at flat cells around a solid by themselves: vertices that move can make these positive again.
    const auto states = particles.states().subspan(first_vertex[s], cells.size());
    const bool in_flat_cell = std::any_of(states.begin(), states.end(), [](const ParticleState& v) { return v.held; });
    const bool flat = placement.refusal == SolidRefusal::cell_not_positive;
    if (in_flat_cell || (placement.refusal != SolidRefusal::none && !flat)) stuck.push_back(placement);
  }
}

bool SolidSet::Impl::is_stuck(std::uint32_t solid) const {
  return std::binary_search(stuck.begin(), stuck.end(), SolidPlacement{SolidRefusal::none, solid},
                            [](const SolidPlacement& a, const SolidPlacement& b) { return a.solid < b.solid; });
}

// After a move: the cells carry the vertices of stuck solids along, all others go their ways.
void SolidSet::Impl::move_all_but_stuck() {
  const CellComplex& complex = environment.complex();
  std::vector<Vec3> carried(positions);
  std::vector<std::uint32_t> others;
  std::vector<SimplexId> at;
  std::vector<std::uint8_t> held(positions.size(), 0);
  std::vector<Vec3> to;
  for (std::uint32_t s = 0; s < count(); ++s) {
    for (std::uint32_t v = first_vertex[s]; v < first_vertex[s + 1]; ++v) {
      if (!is_stuck(s)) {
        others.push_back(v);
        to.push_back(reached[v]);
        if (!ends().empty()) at.push_back(ends()[v]);
        continue;
      }
      held[v] = 1;
      const ParticleState& state = particles[v];
      const Weights weights = detail::barycentric(complex.previous_corners(state.at()), state.position);
      const Vec3 target = flushed(detail::combine(complex.corners(state.at()), weights));
      if (in_exact_range(target)) carried[v] = target;
    }
  }
  Particles moved = particles;
  moved.remove(held);
  follow_move(environment, moved, to, at);
  environment.advance(particles, carried);
  particles.replace(others, moved);
}

}  // namespace dartcast
