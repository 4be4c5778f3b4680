// Each cell's list of particles, updated for those that changed cells alone.
#include "dynamics/cell_lists.hpp"

namespace dartcast {

void CellLists::fit(const CombinatorialMap& map) {
  for (std::uint32_t p = 0; p < pools_.size(); ++p) {
    if (pools_[p].size() < map.slot_count(p)) pools_[p].resize(map.slot_count(p));
  }
}

void CellLists::insert(std::uint32_t particle, Cell c) {
  List& l = list(c);
  links_[particle] = {l.first, none};
  if (l.first != none) links_[l.first].previous = particle;
  l.first = particle;
  if (++l.count == short_list + 1) ++crowded_;
  cell_of_[particle] = c;
}

void CellLists::remove(std::uint32_t particle) {
  List& l = list(cell_of_[particle]);
  const Link link = links_[particle];
  if (link.previous != none)
    links_[link.previous].next = link.next;
  else
    l.first = link.next;
  if (link.next != none) links_[link.next].previous = link.previous;
  if (l.count-- == short_list + 1) --crowded_;
}

void CellLists::update(const CombinatorialMap& map, std::span<const ParticleState> states) {
  fit(map);
  crossed_ = 0;
  const std::size_t old = cell_of_.size();
  for (std::size_t i = states.size(); i < old; ++i) remove(static_cast<std::uint32_t>(i));
  cell_of_.resize(states.size());
  links_.resize(states.size());
  for (std::size_t i = 0; i < states.size(); ++i) {
    const bool listed = i < old;
    if (listed && cell_of_[i] == states[i].cell) continue;
    const auto particle = static_cast<std::uint32_t>(i);
    if (listed) remove(particle);
    insert(particle, states[i].cell);
    ++crossed_;
  }
}

}  // namespace dartcast
