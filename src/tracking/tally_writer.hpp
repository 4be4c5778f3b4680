// Adds the steps of particles to a tally, from their walks.
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "dartcast/cell_tally.hpp"
#include "tracking/passed_facets.hpp"
#include "tracking/step_run.hpp"

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

  explicit TallyWriter(CellTally& tally) : tally_(tally), per_unit_(1.0 / tally.unit_) {}
  TallyWriter(const TallyWriter&) = delete;
  TallyWriter& operator=(const TallyWriter&) = delete;
  ~TallyWriter() {
    add_shared(tally_.length_, length_);
    add_shared(tally_.time_, time_);
  }

  /// The next steps are added so many times.
  void set_number(std::uint64_t number) { number_ = number; }

  /// A whole step within one simplex.
  void stay(Cell cell, double length) {
    const TallySum sum = tally_sum(tally_units(length * per_unit_), number_);
    CellTally::Sums& sums = tally_.of(cell);
    add_shared(sums.length, sum);
    std::atomic_ref(sums.time.high).fetch_add(number_, std::memory_order_relaxed);
    add_to(length_, sum);
    time_.high += number_;
  }

  /// A step of this particle begins. `state` is read as it changes.
  void begin(const ParticleState& state) {
    state_ = &state;
    cell_ = state.cell;
    spent_ = 0;
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
    std::atomic_ref(tally_.of(cell).visits).fetch_add(number_, std::memory_order_relaxed);
  }
  void add_length(std::uint64_t units) {
    const TallySum sum = tally_sum(units, number_);
    add_shared(tally_.of(cell_).length, sum);
    add_to(length_, sum);
  }
  // In the cell, up to this time. Rounded times of walks may fall.
  void spend(std::uint64_t until) {
    if (until <= spent_) return;
    add_shared(tally_.of(cell_).time, tally_sum(until - spent_, number_));
    spent_ = until;
  }

  CellTally& tally_;
  double per_unit_;
  const ParticleState* state_ = nullptr;
  Cell cell_;
  std::uint64_t spent_ = 0;  // of the step
  std::uint64_t number_ = 1;
  TallySum length_;                  // of all steps here
  TallySum time_;                    // likewise
  std::vector<PassedFacet> passed_;  // by a walk
};

}  // namespace dartcast::detail
