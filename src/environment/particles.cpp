// Sets of particles: some of them taken out, put back, removed, or all put in another order.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "dartcast/environment.hpp"
#include "dartcast/error.hpp"

namespace dartcast {

namespace {

void check_indices(std::span<const std::uint32_t> which, std::size_t size, const char* call) {
  const auto bad = std::find_if(which.begin(), which.end(), [size](std::uint32_t i) { return i >= size; });
  if (bad == which.end()) return;
  throw InvalidArgument(fmt::format("{}: index {} (number {} of {}) names none of the {} particles", call, *bad,
                                    bad - which.begin(), which.size(), size));
}

}  // namespace

void Particles::remove(std::span<const std::uint8_t> marks) {
  if (marks.size() != size())
    throw InvalidArgument(
        fmt::format("remove: {} marks for {} particles: one mark per particle is needed", marks.size(), size()));
  std::size_t kept = 0;
  for (std::size_t i = 0; i < size(); ++i) {
    if (marks[i] != 0) continue;
    states_[kept] = states_[i];
    weights_[kept] = weights_[i];
    if (!caches_.empty()) caches_.put(kept, caches_[i], caches_.mark(i));
    vertices_[kept++] = vertices_[i];
  }
  states_.resize(kept);
  weights_.resize(kept);
  vertices_.resize(kept);
  if (!caches_.empty()) caches_.resize(kept);
  index_.reset();
}

void Particles::reorder(std::span<const std::uint32_t> order) {
  if (order.size() != size())
    throw InvalidArgument(fmt::format("reorder: {} indices for {} particles", order.size(), size()));
  check_indices(order, size(), "reorder");
  std::vector<std::uint8_t> seen(size(), 0);
  const auto again = std::find_if(order.begin(), order.end(), [&](std::uint32_t i) { return seen[i]++ != 0; });
  if (again != order.end())
    throw InvalidArgument(fmt::format("reorder: the order is no permutation, it names particle {} twice", *again));
  std::vector<ParticleState> states(size());
  std::vector<Weights> weights(size());
  std::vector<detail::VertexNumbers> vertices(size());
  detail::SimplexCache caches;
  caches.resize(caches_.size());
  for (std::size_t i = 0; i < size(); ++i) {
    states[i] = states_[order[i]];
    weights[i] = weights_[order[i]];
    vertices[i] = vertices_[order[i]];
    if (!caches_.empty()) caches.put(i, caches_[order[i]], caches_.mark(order[i]));
  }
  states_ = std::move(states);
  weights_ = std::move(weights);
  vertices_ = std::move(vertices);
  caches_ = std::move(caches);
  index_.reset();
}

Particles Particles::selected(std::span<const std::uint32_t> which) const {
  check_indices(which, size(), "selected");
  Particles some;
  for (const std::uint32_t i : which) {
    some.states_.push_back(states_[i]);
    some.weights_.push_back(weights_[i]);
    some.vertices_.push_back(vertices_[i]);
    if (!caches_.empty()) some.caches_.push_back(caches_[i], caches_.mark(i));
  }
  some.cache_kind_ = cache_kind_;
  some.walls_changed_ = walls_changed_;
  some.environment_ = environment_;
  some.moves_ = moves_;
  some.edits_ = edits_;
  return some;
}

void Particles::replace(std::span<const std::uint32_t> which, const Particles& by) {
  if (which.size() != by.size())
    throw InvalidArgument(
        fmt::format("replace: {} indices for {} particles: one index per particle is needed", which.size(), by.size()));
  check_indices(which, size(), "replace");
  if (which.empty()) return;
  if (by.environment_ != environment_) throw InvalidArgument("replace: the particles are of another environment");
  if (by.moves_ != moves_ || by.edits_ != edits_)
    throw InvalidArgument(
        "replace: one set has gone along with a move or an edit that the other has not: advance both after each move, "
        "and follow() each edit with both");
  for (std::size_t k = 0; k < which.size(); ++k) {
    const std::uint32_t i = which[k];
    states_[i] = by.states_[k];
    weights_[i] = by.weights_[k];
    vertices_[i] = by.vertices_[k];
    if (caches_.empty()) continue;
    if (cache_kind_ == by.cache_kind_)
      caches_.put(i, by.caches_[k], by.caches_.mark(k));
    else
      caches_.forget(i);
  }
  walls_changed_ = walls_changed_ || by.walls_changed_;
  index_.reset();
}

}  // namespace dartcast
