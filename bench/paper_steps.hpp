// Steps of all particles of a scheme; for the .cpp files that define a walk.
#pragma once

#include <cmath>

#include "bench/paper_scheme.hpp"

namespace dartcast::bench {

template <class StateOf, class WalkOf>
PaperSchemeOf<StateOf, WalkOf>::PaperSchemeOf(const Complex& complex)
    : complex_(complex), tolerance_(1e-12 * std::pow(mean_edge(complex), complex.map().dimension())) {}

template <class StateOf, class WalkOf>
void PaperSchemeOf<StateOf, WalkOf>::start(std::span<const State> states) {
  states_.assign(states.size(), {});
  for (std::size_t i = 0; i < states.size(); ++i) place(i, states[i].position, states[i].cell);
}

template <class StateOf, class WalkOf>
void PaperSchemeOf<StateOf, WalkOf>::place(std::size_t particle, const Vec3& p, Cell cell) {
  StateOf& s = states_[particle];
  s.p = p;
  WalkOf(complex_.map(), complex_.positions(), tolerance_, s, p).aim_in_cell(cell);
}

template <class StateOf, class WalkOf>
void PaperSchemeOf<StateOf, WalkOf>::advance(std::span<const Vec3> targets, std::span<PaperResult> results) {
  for (std::size_t i = 0; i < states_.size(); ++i) {
    WalkOf walk(complex_.map(), complex_.positions(), tolerance_, states_[i], targets[i]);
    results[i] = moved_ ? walk.step_after_move() : walk.step();
  }
  moved_ = false;
}

}  // namespace dartcast::bench
