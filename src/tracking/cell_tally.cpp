// The sums of a tally: read, shared out after edits, saved.
#include "dartcast/cell_tally.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "base/wide_integer.hpp"
#include "complex/simplex.hpp"
#include "dartcast/cell_complex.hpp"
#include "dartcast/complex_edit.hpp"
#include "dartcast/error.hpp"
#include "tracking/tally_writer.hpp"

namespace dartcast {

namespace {

__extension__ using Wide = unsigned __int128;
using detail::TallySum;

constexpr std::size_t digits_of_sum = 4;  // of 32 bits, each in a word: carries of many sums have room
constexpr std::size_t words_of_cell = 2 * digits_of_sum + 2;

Wide wide(const TallySum& s) { return (Wide{s.high} << 64U) | s.low; }
TallySum sum_of(Wide w) { return {static_cast<std::uint64_t>(w), static_cast<std::uint64_t>(w >> 64U)}; }
void add(TallySum& sum, const TallySum& more) { sum = sum_of(wide(sum) + wide(more)); }

// At least 16 times the size of the complex, so that few lengths are beyond one unit.
double unit_for(std::span<const Vec3> points) {
  constexpr double largest = std::numeric_limits<double>::infinity();
  Vec3 low{largest, largest, largest};
  Vec3 high = low * -1.0;
  for (const Vec3& x : points) {
    if (!in_exact_range(x)) continue;
    low = {std::min(low.x, x.x), std::min(low.y, x.y), std::min(low.z, x.z)};
    high = {std::max(high.x, x.x), std::max(high.y, x.y), std::max(high.z, x.z)};
  }
  const double size = std::max({high.x - low.x, high.y - low.y, high.z - low.z, 0.0});
  return size > 0.0 ? std::ldexp(1.0, std::ilogb(size) + 6) : 1.0;
}

// Six times the volume; in the plane twice the area.
double volume6(const CellComplex& complex, Cell c) {
  double sum = 0.0;
  for (std::uint16_t s = 0; s < complex.map().shape(c).simplices().size(); ++s)
    sum += volume_value(complex.corners({c, s}));
  return std::max(sum, 0.0);
}

// The part of a whole that the first cells of a list get. It never falls as the share grows.
Wide part_of(Wide whole, double share) {
  const double part = static_cast<double>(whole) * share;
  return part < static_cast<double>(whole) ? std::min(static_cast<Wide>(part), whole) : whole;
}

void put(const TallySum& sum, std::vector<std::uint64_t>& words) {
  for (const std::uint64_t half : {sum.low, sum.high}) {
    words.push_back(half & 0xffffffffU);
    words.push_back(half >> 32U);
  }
}

TallySum taken(std::span<const std::uint64_t>& words) {
  Wide sum = 0;
  for (unsigned i = 0; i < digits_of_sum; ++i) sum += Wide{words[i]} << (32U * i);
  words = words.subspan(digits_of_sum);
  return sum_of(sum);
}

}  // namespace

CellTally::CellTally(const CellComplex& complex) : unit_(unit_for(complex.positions())) { reset(complex); }

void CellTally::reset(const CellComplex& complex) {
  pools_ = {};
  length_ = time_ = {};
  fit(complex);
  for (const Cell c : complex.map().cells()) pools_[c.pool()].source[c.index()] = complex.map().source(c);
}

void CellTally::fit(const CellComplex& complex) {
  for (std::uint32_t pool = 0; pool < pools_.size(); ++pool) {
    pools_[pool].sums.resize(complex.map().slot_count(pool));
    pools_[pool].source.resize(complex.map().slot_count(pool));
  }
}

bool CellTally::fits(const CellComplex& complex) const {
  for (std::uint32_t pool = 0; pool < pools_.size(); ++pool) {
    if (pools_[pool].sums.size() != complex.map().slot_count(pool)) return false;
  }
  return true;
}

CellTally::Sums& CellTally::Sums::operator+=(const Sums& other) {
  add(length, other.length);
  add(time, other.time);
  visits += other.visits;
  deposited += other.deposited;
  return *this;
}

bool CellTally::adds_up() const {
  TallySum length;
  TallySum time;
  for (const Pool& pool : pools_) {
    for (const Sums& s : pool.sums) {
      add(length, s.length);
      add(time, s.time);
    }
  }
  return length == length_ && time == time_;
}

void CellTally::take_back(Cell c, double time) {
  if (!(time > 0.0)) return;
  Sums& sums = of(c);
  time = std::min(time, 0x1p+62);
  const double whole = std::floor(time);
  const Wide asked = wide({detail::tally_units(time - whole) << 2U, static_cast<std::uint64_t>(whole)});
  const Wide rest = std::min(asked, wide(sums.time));
  sums.time = sum_of(wide(sums.time) - rest);
  time_ = sum_of(wide(time_) - rest);
}

void CellTally::share_out(const CellComplex& complex, const Sums& sums, std::span<const Cell> cells) {
  double whole = 0.0;
  for (const Cell c : cells) whole += volume6(complex, c);
  double so_far = 0.0;
  Sums given;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    so_far += volume6(complex, cells[i]);
    const bool is_last = i + 1 == cells.size();
    const double share = is_last || !(whole > 0.0) ? 1.0 : std::min(so_far / whole, 1.0);
    const Sums upto{sum_of(part_of(wide(sums.length), share)), sum_of(part_of(wide(sums.time), share)),
                    static_cast<std::uint64_t>(part_of(sums.visits, share)),
                    static_cast<std::uint64_t>(part_of(sums.deposited, share))};
    Sums& to = of(cells[i]);
    add(to.length, sum_of(wide(upto.length) - wide(given.length)));
    add(to.time, sum_of(wide(upto.time) - wide(given.time)));
    to.visits += upto.visits - given.visits;
    to.deposited += upto.deposited - given.deposited;
    given = upto;
  }
}

// Places of removed cells may be those of added ones.
void CellTally::update_after_edit(const CellComplex& complex, const ComplexEditReport& edit) {
  if (edit.replaced)
    throw InvalidArgument("cell tally: the mesh was replaced, and its cells are others: make a new tally");
  std::unordered_map<std::uint32_t, Sums> removed;  // by source
  for (const CellHandle& h : edit.map.removed) {
    if (h.cell.index() >= pools_[h.cell.pool()].sums.size()) continue;  // added and removed by the same edit
    Sums& sums = of(h.cell);
    removed[pools_[h.cell.pool()].source[h.cell.index()]] += sums;
    sums = {};
  }
  fit(complex);
  std::vector<Cell> added;
  for (const Cell c : edit.map.added) {
    if (!complex.map().contains(c)) continue;
    added.push_back(c);
    pools_[c.pool()].source[c.index()] = complex.map().source(c);
  }
  std::sort(added.begin(), added.end());
  std::unordered_map<std::uint32_t, std::vector<Cell>> by_source;
  for (const Cell c : added) by_source[complex.map().source(c)].push_back(c);
  Sums others;
  for (const auto& [source, sums] : removed) {
    const auto found = by_source.find(source);
    if (found != by_source.end()) {
      share_out(complex, sums, found->second);
      continue;
    }
    others += sums;
  }
  if (!added.empty()) return share_out(complex, others, added);
  length_ = sum_of(wide(length_) - wide(others.length));
  time_ = sum_of(wide(time_) - wide(others.time));
}

std::vector<std::uint64_t> CellTally::words() const {
  std::vector<std::uint64_t> words;
  put(length_, words);
  put(time_, words);
  for (const Pool& pool : pools_) {
    for (const Sums& s : pool.sums) {
      put(s.length, words);
      put(s.time, words);
      words.push_back(s.visits);
      words.push_back(s.deposited);
    }
  }
  return words;
}

void CellTally::set_words(std::span<const std::uint64_t> words) {
  std::size_t cells = 0;
  for (const Pool& pool : pools_) cells += pool.sums.size();
  if (words.size() != 2 * digits_of_sum + words_of_cell * cells)
    throw InvalidArgument(
        fmt::format("CellTally::set_words: {} words for a complex with {} places of cells: give those "
                    "that words() returned for this complex",
                    words.size(), cells));
  length_ = taken(words);
  time_ = taken(words);
  for (Pool& pool : pools_) {
    for (Sums& s : pool.sums) {
      s.length = taken(words);
      s.time = taken(words);
      s.visits = words[0];
      s.deposited = words[1];
      words = words.subspan(2);
    }
  }
}

}  // namespace dartcast
