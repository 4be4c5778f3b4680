// Sets of particles: some of them taken out, put back, removed, or all put in another order.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/kept_runs.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/error.hpp"
#include "environment/particle_details.hpp"

namespace dartcast {

namespace {

void check_indices(std::span<const std::uint32_t> which, std::size_t size, const char* call) {
  const auto bad = std::find_if(which.begin(), which.end(), [size](std::uint32_t i) { return i >= size; });
  if (bad == which.end()) return;
  throw InvalidArgument(fmt::format("{}: index {} (number {} of {}) names none of the {} particles", call, *bad,
                                    bad - which.begin(), which.size(), size));
}

}  // namespace

Particles::Particles() noexcept = default;
Particles::Particles(std::span<const ParticleState> states, std::span<const Weights> weights)
    : states_(states.begin(), states.end()), details_(std::make_unique<Details>()) {
  if (weights.size() != states.size())
    throw InvalidArgument(fmt::format("Particles: {} weights for {} states", weights.size(), states.size()));
  details_->weights.assign(weights.begin(), weights.end());
  details_->cache.add_unknown(states.size());
}
Particles::Particles(const Particles& other)
    : states_(other.states_), details_(other.details_ ? std::make_unique<Details>(*other.details_) : nullptr) {}
Particles::Particles(Particles&& other) noexcept = default;
Particles& Particles::operator=(const Particles& other) { return *this = Particles(other); }
Particles& Particles::operator=(Particles&& other) noexcept = default;
Particles::~Particles() = default;

Particles::Details& Particles::details() {
  if (!details_) details_ = std::make_unique<Details>();
  return *details_;
}

const Particles::Details& Particles::details() const {
  static const Details of_empty_set;
  return details_ ? *details_ : of_empty_set;
}

const Weights& Particles::held_weights(std::size_t i) const { return details().weights[i]; }
std::span<const std::array<std::uint32_t, 4>> Particles::vertex_numbers() const {
  return details().cache.all_vertices();
}

void Particles::remove(std::span<const std::uint8_t> marks) {
  if (marks.size() != size())
    throw InvalidArgument(
        fmt::format("remove: {} marks for {} particles: one mark per particle is needed", marks.size(), size()));
  const KeptRuns runs(marks);
  runs.keep_in(states_);
  runs.keep_in(details().weights);
  details().cache.keep(runs);
  details().index.reset();
}

void Particles::truncate(std::size_t count) {
  const auto cut = [count](auto& values) {
    if (values.size() > count) values.resize(count);
  };
  cut(states_);
  if (!details_) return;
  cut(details_->weights);
  details_->cache.truncate(count);
  details_->index.reset();
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
  for (std::size_t i = 0; i < size(); ++i) {
    states[i] = states_[order[i]];
    weights[i] = details().weights[order[i]];
  }
  states_ = std::move(states);
  details().weights = std::move(weights);
  details().cache.reorder(order);
  details().index.reset();
}

Particles Particles::selected(std::span<const std::uint32_t> which) const {
  check_indices(which, size(), "selected");
  const Details& all = details();
  Particles some;
  Details& details = some.details();
  for (const std::uint32_t i : which) {
    some.states_.push_back(states_[i]);
    details.weights.push_back(all.weights[i]);
  }
  details.cache = all.cache.selected(which);
  details.environment = all.environment;
  details.moves = all.moves;
  details.edits = all.edits;
  return some;
}

void Particles::replace(std::span<const std::uint32_t> which, const Particles& by) {
  if (which.size() != by.size())
    throw InvalidArgument(
        fmt::format("replace: {} indices for {} particles: one index per particle is needed", which.size(), by.size()));
  check_indices(which, size(), "replace");
  if (which.empty()) return;
  const Details& theirs = by.details();
  Details& ours = details();
  if (theirs.environment != ours.environment)
    throw InvalidArgument(
        "replace: the particles are of another environment: add() their positions to a new set in this one");
  if (theirs.moves != ours.moves || theirs.edits != ours.edits)
    throw InvalidArgument(
        "replace: one set missed a move or an edit that the other has followed: call advance() with both after each "
        "move, and update_after_edit() with both after each edit");
  for (std::size_t k = 0; k < which.size(); ++k) {
    states_[which[k]] = by.states_[k];
    ours.weights[which[k]] = theirs.weights[k];
  }
  ours.cache.replace(which, theirs.cache);
  ours.index.reset();
}

}  // namespace dartcast
