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
}  // namespace detail

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
class CellTally {
 public:
  /// No sums yet. Cost: linear in the cells, 52 bytes each.
  explicit CellTally(const CellComplex& complex);

  // The sums of a cell. Precondition: it is one of the complex.
  [[nodiscard]] double track_length(Cell c) const { return of(c).length.value() * unit_; }  ///< m
  /// Time that particles have spent there, in steps: the duration of a step makes seconds of it.
  [[nodiscard]] double residence(Cell c) const { return of(c).time.value(); }
  /// How often particles have come from another cell.
  [[nodiscard]] std::uint64_t visits(Cell c) const { return of(c).visits; }

  /// The particles that deposit() has counted.
  [[nodiscard]] std::uint64_t deposited(Cell c) const { return of(c).deposited; }

  // The sums of all particles, which are kept apart.
  [[nodiscard]] double path_length() const { return length_.value() * unit_; }  ///< m
  [[nodiscard]] double age() const { return time_.value(); }                    ///< in steps
  /// Whether the cells' sums of lengths and times are those of all particles, to the last bit. Cost: linear in the cells.
  [[nodiscard]] bool adds_up() const;

  /// Takes time back, in steps: a particle that ends its step in this cell had left before.
  void take_back(Cell c, double time);
  /// Counts particles that were deposited at a wall of the cell.
  void deposit(Cell c, std::uint64_t number = 1) { of(c).deposited += number; }
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
    std::vector<Sums> sums;             // by place
    std::vector<std::uint32_t> source;  // of the cell there
  };

  [[nodiscard]] const Sums& of(Cell c) const { return pools_[c.pool()].sums[c.index()]; }
  Sums& of(Cell c) { return pools_[c.pool()].sums[c.index()]; }
  void fit(const CellComplex& complex);
  void share_out(const CellComplex& complex, const Sums& sums, std::span<const Cell> cells);

  double unit_ = 1.0;  // m: a power of two, at least 16 times the size of the complex
  std::array<Pool, 5> pools_;
  detail::TallySum length_;
  detail::TallySum time_;
};

}  // namespace dartcast
