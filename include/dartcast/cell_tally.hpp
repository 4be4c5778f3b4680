// Tallies: how far, how long and how often particles are in each cell.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dartcast/ids.hpp"

namespace dartcast {

class CellComplex;         // dartcast/cell_complex.hpp
struct ComplexEditReport;  // dartcast/complex_edit.hpp

namespace detail {
class TallyWriter;

/// A sum of numbers that are not negative, in units of 2^-62: exact, so that the order of adding does not matter.
struct TallySum {
  std::uint64_t low = 0;   ///< in 2^-64
  std::uint64_t high = 0;  ///< whole ones

  [[nodiscard]] double value() const { return static_cast<double>(high) + static_cast<double>(low) * 0x1p-64; }
  auto operator<=>(const TallySum&) const = default;
};

/// A sum of numbers of any sign, in units of 2^-170: exact below 2^84, so that the order of adding does not matter.
struct TallyAmount {
  std::array<std::uint64_t, 4> part{};  ///< the lowest first, two's complement

  [[nodiscard]] double value() const;
  bool operator==(const TallyAmount&) const = default;
};
}  // namespace detail

/// How the steps of particles count in a tally. Each span is empty, or has its values for each particle.
struct TalliedParticles {
  std::span<const std::uint64_t> numbers = {};  ///< how often a step is added, below 2^32; empty: once
  std::span<const std::uint32_t> classes = {};  ///< below CellTally::classes(); empty: 0
  /// CellTally::amounts() finite numbers for each particle, which its step brings with it, whatever its number; empty: none.
  std::span<const double> amounts = {};
};

/// Sums for each cell, over the steps of an environment that they are set for (Environment::set_tally()).
///
/// A step's way is that of its exact walks, from cell to cell. A piece along a face, an edge or a vertex counts once:
/// for the cells that the shift of docs/method.md makes the walk pass. If the walk passes a cell at an edge or a vertex
/// alone, the cell is visited for a length of 0. Lengths and times of pieces are rounded, to 2^-62 of a unit and of the
/// step; their sums are exact. So they are the same bits for any number of threads, and any order of particles.
///
/// If the mesh moves, lengths are relative to it. A particle that the vertices carry along has spent its time in its
/// cell, and its track there has the length 0. A step without a walk has a straight one by this rule: from where the
/// mesh has carried the particle, to where it ends. It takes the time up to the step's first contact. If it meets a
/// wall, the rest of its way and of the time counts for the cell where the step ends. Such are the steps of spheres,
/// and those of points near walls that move at the same time.
///
/// Particles may be of several classes, whose sums are kept apart. They may have amounts: numbers that each step brings
/// with it, as the momentum that it loses. The cells of a step share them by the time in each. An amount is rounded to
/// 2^-170, and counts as 2^84 at most; its shares are rounded, too, but add up to it. Sums of amounts are exact.
class CellTally {
 public:
  /// No sums yet. Throws InvalidArgument if there is no class, or more than 256 classes or amounts. Cost: linear in the
  /// cells; 4 bytes each, and for each class 48 and 32 for each amount.
  explicit CellTally(const CellComplex& complex, std::uint32_t classes = 1, std::uint32_t amounts = 0);

  [[nodiscard]] std::uint32_t classes() const { return static_cast<std::uint32_t>(classes_); }
  [[nodiscard]] std::uint32_t amounts() const { return static_cast<std::uint32_t>(amounts_.size()); }

  // The sums of a cell, for a class or for all. Preconditions: the cell is one of the complex, the class is below classes().
  static constexpr std::uint32_t all_classes = 0xffffffffU;
  [[nodiscard]] double track_length(Cell c, std::uint32_t of_class = all_classes) const;  ///< m
  /// Time that particles have spent there, in steps: the duration of a step makes seconds of it.
  [[nodiscard]] double residence(Cell c, std::uint32_t of_class = all_classes) const;
  /// How often particles have come from another cell.
  [[nodiscard]] std::uint64_t visits(Cell c, std::uint32_t of_class = all_classes) const;
  /// The particles that deposit() has counted.
  [[nodiscard]] std::uint64_t deposited(Cell c, std::uint32_t of_class = all_classes) const;
  /// Precondition: `which` < amounts().
  [[nodiscard]] double amount(Cell c, std::uint32_t which, std::uint32_t of_class = all_classes) const;

  // The sums of all particles, which are kept apart.
  [[nodiscard]] double path_length() const { return length_.value() * unit_; }  ///< m
  [[nodiscard]] double age() const { return time_.value(); }                    ///< in steps
  [[nodiscard]] double whole_amount(std::uint32_t which) const { return amounts_[which].value(); }
  /// Whether the cells' sums of lengths, times and amounts are those of all particles, to the last bit. Cost: linear in the
  /// cells.
  [[nodiscard]] bool adds_up() const;

  /// Takes time back, in steps: a particle that ends its step in this cell had left before.
  void take_back(Cell c, double time, std::uint32_t of_class = 0);
  /// Takes so much of each amount back.
  void take_back_amounts(Cell c, std::span<const double> amounts, std::uint32_t of_class = 0);
  /// Counts particles that were deposited at a wall of the cell.
  void deposit(Cell c, std::uint64_t number = 1, std::uint32_t of_class = 0) { of(c, of_class).deposited += number; }
  /// Follows an edit: the sums of cells that it removed go to the cells in their place. These share them by volume:
  /// those of the same source (CombinatorialMap::source()); if there are none, all that the edit has added. If it has
  /// added none, the sums are given up, and taken from those of all particles. Call it after each edit. Cost: the cells
  /// touched.
  void update_after_edit(const CellComplex& complex, const ComplexEditReport& edit);

  /// Whether each cell of the complex has a place here. If not, the tally has missed an edit.
  [[nodiscard]] bool fits(const CellComplex& complex) const;
  /// Begins anew with the complex as it is now, without sums. The unit of lengths stays.
  void reset(const CellComplex& complex);
  /// All sums as words. Those of several tallies of one complex, each word added to its like, are words of their sum.
  [[nodiscard]] std::vector<std::uint64_t> words() const;
  /// Goes on from words(). Throws InvalidArgument, nothing changed, if there are more or fewer than of this complex.
  void set_words(std::span<const std::uint64_t> words);

 private:
  friend class detail::TallyWriter;

  struct Sums {
    detail::TallySum length;  // in units
    detail::TallySum time;    // in steps
    std::uint64_t visits = 0;
    std::uint64_t deposited = 0;

    Sums& operator+=(const Sums& other);
  };
  struct Pool {
    std::vector<Sums> sums;                    // by place, then by class
    std::vector<detail::TallyAmount> amounts;  // likewise, then by amount
    std::vector<std::uint32_t> source;         // of the cell at a place
  };
  // All that is kept of a cell, by class.
  struct Record {
    std::vector<Sums> sums;
    std::vector<detail::TallyAmount> amounts;

    Record& operator+=(const Record& other);
  };

  Sums& of(Cell c, std::uint32_t of_class) { return pools_[c.pool()].sums[c.index() * classes_ + of_class]; }
  detail::TallyAmount* amounts_of(Cell c, std::uint32_t of_class) {
    return pools_[c.pool()].amounts.data() + (c.index() * classes_ + of_class) * amounts_.size();
  }
  // The sums of a class, or of all.
  [[nodiscard]] Sums sum_of(Cell c, std::uint32_t of_class) const;
  Record take(Cell c);
  void fit(const CellComplex& complex);
  void share_out(const CellComplex& complex, const Record& record, std::span<const Cell> cells);
  void give_up(const Record& record);

  double unit_ = 1.0;  // m: a power of two, at least 16 times the size of the complex
  std::size_t classes_ = 1;
  std::array<Pool, 5> pools_;
  detail::TallySum length_;
  detail::TallySum time_;
  std::vector<detail::TallyAmount> amounts_;
};

}  // namespace dartcast
