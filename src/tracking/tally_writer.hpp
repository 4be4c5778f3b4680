// Adds the steps of particles to a tally, from their walks.
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "dartcast/cell_tally.hpp"
#include "tracking/passed_facets.hpp"
#include "tracking/step_run.hpp"
#include "tracking/tallied.hpp"
#include "tracking/tally_amount.hpp"

namespace dartcast::detail {

// A TallySum grows by whole units of 2^-62.
inline constexpr std::uint64_t tally_one = std::uint64_t{1} << 62U;

/// A length of 2 units and more, which only a mesh that has grown far can have, counts as the longest one.
inline std::uint64_t tally_units(double x) {
  constexpr double most = 0x1.fffffffffffffp+62;
  return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::min(x * 0x1p+62, most)));
}

/// So many times these units.
inline TallySum tally_sum(std::uint64_t units, std::uint64_t number) {
  __extension__ using Wide = unsigned __int128;
  const Wide sum = (Wide{units} << 2U) * number;
  return {static_cast<std::uint64_t>(sum), static_cast<std::uint64_t>(sum >> 64U)};
}

inline void add_to(TallySum& sum, const TallySum& more) {
  sum.low += more.low;
  sum.high += more.high + (sum.low < more.low ? 1 : 0);
}

/// Steps of consecutive particles, in one thread. Others may write into the same tally at the same time. It is a driver of
/// steps (tracking/step_run.hpp), too: for each, begin() comes first and finish() last.
class TallyWriter {
 public:
  static constexpr bool waits = false;
  static constexpr bool travels = false;

  explicit TallyWriter(CellTally& tally)
      : tally_(tally), per_unit_(1.0 / tally.unit_), shared_(tally.amounts_.size()), whole_(tally.amounts_.size()) {}
  TallyWriter(const TallyWriter&) = delete;
  TallyWriter& operator=(const TallyWriter&) = delete;
  ~TallyWriter() {
    add_shared(tally_.length_, length_);
    add_shared(tally_.time_, time_);
    for (std::size_t k = 0; k < whole_.size(); ++k) add_shared(tally_.amounts_[k], whole_[k]);
  }

  /// The next steps are of this particle.
  void set_particle(const TalliedParticles& particles, std::size_t i) {
    if (!particles.numbers.empty()) number_ = particles.numbers[i];
    if (!particles.classes.empty()) class_ = particles.classes[i];
    if (!particles.amounts.empty()) amounts_ = particles.amounts.subspan(i * whole_.size(), whole_.size());
  }

  /// A whole step within one simplex.
  void stay(Cell cell, double length) {
    const TallySum sum = tally_sum(tally_units(length * per_unit_), number_);
    CellTally::Sums& sums = tally_.of(cell, class_);
    add_shared(sums.length, sum);
    std::atomic_ref(sums.time.high).fetch_add(number_, std::memory_order_relaxed);
    add_to(length_, sum);
    time_.high += number_;
    if (amounts_.empty()) return;
    cell_ = cell;
    begin_amounts();
    share_amounts(tally_one);
  }

  /// A step of this particle begins. `state` is read as it changes.
  void begin(const ParticleState& state) {
    state_ = &state;
    cell_ = state.cell;
    spent_ = 0;
    begin_amounts();
  }
  void finish() {
    come_to(state_->cell);
    spend(tally_one);
    time_.high += number_;
  }
  /// One whole walk, at rest, that arrives.
  template <std::size_t N>
  void walk(const Space<Stored, N>& space, const ParticleState& before, const ParticleState& after) {
    begin(before);
    const double length = norm(after.position - before.position) * per_unit_;
    add_walk(space, before.at(), before.position, after.position, length, 0.0, 1.0);
    state_ = &after;
    finish();
  }
  /// A step without a walk, from where the mesh has carried the particle to. `begin` has been called with its state before
  /// that.
  template <std::size_t N>
  void go_straight(const Space<Stored, N>& space, const SimplexPlacement& from, const ParticleState& after,
                   double end) {
    const Vec3& p = from.position;
    const double length = norm(after.position - p) * per_unit_;
    come_to(from.simplex.cell);
    const std::uint64_t walked =
        p == after.position ? 0 : add_walk(space, from.simplex, p, after.position, length, 0.0, end);
    come_to(after.cell);
    add_length(tally_units(length) - walked);
    state_ = &after;
    finish();
  }

  // As a driver.
  static NoVisitor visitor() { return {}; }
  template <class Positions, std::size_t N>
  void walked(const Space<Positions, N>& space, const Walk& /*w*/, const Vec3& p, const Vec3& q, double begin,
              double end) {
    add_walk(space, state_->at(), p, q, norm(q - p) * per_unit_, begin, end);
  }
  void put(const ParticleState& /*state*/, double time) { spend(tally_units(time)); }

 private:
  static void add_shared(TallySum& sum, const TallySum& more) {
    const std::uint64_t low = std::atomic_ref(sum.low).fetch_add(more.low, std::memory_order_relaxed);
    const std::uint64_t high = more.high + (low + more.low < more.low ? 1 : 0);
    if (high != 0) std::atomic_ref(sum.high).fetch_add(high, std::memory_order_relaxed);
  }
  // As add_to().
  static void add_shared(TallyAmount& sum, const TallyAmount& more) {
    std::uint64_t carry = 0;
    for (std::size_t i = 0; i < sum.part.size(); ++i) {
      const std::uint64_t with_carry = more.part[i] + carry;
      carry = with_carry < carry ? 1 : 0;
      if (with_carry == 0) continue;
      const std::uint64_t before = std::atomic_ref(sum.part[i]).fetch_add(with_carry, std::memory_order_relaxed);
      if (before + with_carry < with_carry) ++carry;
    }
  }

  // Its start has these. Returns the length that has been walked.
  template <class Positions, std::size_t N>
  std::uint64_t add_walk(const Space<Positions, N>& space, SimplexId start, const Vec3& p, const Vec3& q, double length,
                         double begin, double end) {
    std::uint64_t walked = 0;
    walk_cells(space, start, p, q, passed_, [&](Cell cell, double fraction) {
      come_to(cell);
      const std::uint64_t so_far = tally_units(length * fraction);
      add_length(so_far - walked);
      walked = so_far;
      spend(tally_units(begin + (end - begin) * fraction));
    });
    return walked;
  }
  void come_to(Cell cell) {
    if (cell == cell_) return;
    cell_ = cell;
    std::atomic_ref(tally_.of(cell, class_).visits).fetch_add(number_, std::memory_order_relaxed);
  }
  void add_length(std::uint64_t units) {
    const TallySum sum = tally_sum(units, number_);
    add_shared(tally_.of(cell_, class_).length, sum);
    add_to(length_, sum);
  }
  // In the cell, up to this time. Rounded times of walks may fall.
  void spend(std::uint64_t until) {
    if (until <= spent_) return;
    add_shared(tally_.of(cell_, class_).time, tally_sum(until - spent_, number_));
    spent_ = until;
    share_amounts(until);
  }
  void begin_amounts() {
    for (std::size_t k = 0; k < amounts_.size(); ++k) {
      shared_[k] = {};
      add_to(whole_[k], tally_amount(amounts_[k]));
    }
  }
  // Likewise.
  void share_amounts(std::uint64_t until) {
    const double share = until == tally_one ? 1.0 : static_cast<double>(until) * 0x1p-62;
    for (std::size_t k = 0; k < amounts_.size(); ++k) {
      const TallyAmount so_far = tally_amount(amounts_[k] * share);
      add_shared(tally_.amounts_of(cell_, class_)[k], so_far - shared_[k]);
      shared_[k] = so_far;
    }
  }

  CellTally& tally_;
  double per_unit_;
  const ParticleState* state_ = nullptr;
  Cell cell_;
  std::uint64_t spent_ = 0;  // of the step
  std::uint64_t number_ = 1;
  std::uint32_t class_ = 0;
  std::span<const double> amounts_;  // of the step; empty: none
  std::vector<TallyAmount> shared_;  // of these, so far
  TallySum length_;                  // of all steps here, as the next two
  TallySum time_;
  std::vector<TallyAmount> whole_;
  std::vector<PassedFacet> passed_;  // by a walk
};

}  // namespace dartcast::detail
