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
#include "tracking/tally_amount.hpp"
#include "tracking/tally_writer.hpp"

namespace dartcast {

double detail::TallyAmount::value() const {
  const bool negative = part[3] >> 63U != 0;
  const TallyAmount size = negative ? -*this : *this;
  double sum = 0.0;
  for (std::size_t i = size.part.size(); i-- > 0;) sum = sum * 0x1p+64 + static_cast<double>(size.part[i]);
  sum = std::ldexp(sum, -tally_amount_digits);
  return negative ? -sum : sum;
}

namespace {

__extension__ using Wide = unsigned __int128;
using detail::TallyAmount;
using detail::TallySum;

constexpr std::size_t digits_of_sum = 4;  // of 32 bits, each in a word: carries of many sums have room
constexpr std::size_t words_of_sums = 2 * digits_of_sum + 2;
constexpr std::size_t digits_of_amount = 8;
constexpr std::uint32_t most_classes = 256;  // and as many amounts

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

void put(const TallyAmount& amount, std::vector<std::uint64_t>& words) {
  for (const std::uint64_t part : amount.part) {
    words.push_back(part & 0xffffffffU);
    words.push_back(part >> 32U);
  }
}

TallySum taken(std::span<const std::uint64_t>& words) {
  Wide sum = 0;
  for (unsigned i = 0; i < digits_of_sum; ++i) sum += Wide{words[i]} << (32U * i);
  words = words.subspan(digits_of_sum);
  return sum_of(sum);
}

TallyAmount taken_amount(std::span<const std::uint64_t>& words) {
  TallyAmount amount;
  Wide carry = 0;
  for (std::size_t i = 0; i < digits_of_amount; ++i) {
    carry += words[i];
    amount.part[i / 2] |= (static_cast<std::uint64_t>(carry) & 0xffffffffU) << 32U * (i % 2);
    carry >>= 32U;
  }
  words = words.subspan(digits_of_amount);
  return amount;
}

// The part that the first cells of a list get.
TallyAmount part_of(const TallyAmount& whole, double share) {
  return share < 1.0 ? detail::tally_amount(whole.value() * share) : whole;
}

}  // namespace

CellTally::CellTally(const CellComplex& complex, std::uint32_t classes, std::uint32_t amounts)
    : unit_(unit_for(complex.positions())), classes_(classes), amounts_(std::min(amounts, most_classes)) {
  if (classes == 0 || classes > most_classes || amounts > most_classes)
    throw InvalidArgument(
        fmt::format("CellTally: {} classes and {} amounts: give 1 to {} classes, and at most {} amounts", classes,
                    amounts, most_classes, most_classes));
  reset(complex);
}

void CellTally::reset(const CellComplex& complex) {
  pools_ = {};
  length_ = time_ = {};
  std::fill(amounts_.begin(), amounts_.end(), TallyAmount());
  fit(complex);
  for (const Cell c : complex.map().cells()) pools_[c.pool()].source[c.index()] = complex.map().source(c);
}

void CellTally::fit(const CellComplex& complex) {
  for (std::uint32_t pool = 0; pool < pools_.size(); ++pool) {
    const std::size_t places = complex.map().slot_count(pool);
    pools_[pool].sums.resize(places * classes_);
    pools_[pool].amounts.resize(places * classes_ * amounts_.size());
    pools_[pool].source.resize(places);
  }
}

bool CellTally::fits(const CellComplex& complex) const {
  for (std::uint32_t pool = 0; pool < pools_.size(); ++pool) {
    if (pools_[pool].source.size() != complex.map().slot_count(pool)) return false;
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

CellTally::Record& CellTally::Record::operator+=(const Record& other) {
  sums.resize(other.sums.size());
  amounts.resize(other.amounts.size());
  for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += other.sums[k];
  for (std::size_t k = 0; k < amounts.size(); ++k) add_to(amounts[k], other.amounts[k]);
  return *this;
}

CellTally::Sums CellTally::sum_of(Cell c, std::uint32_t of_class) const {
  const Sums* const first = pools_[c.pool()].sums.data() + c.index() * classes_;
  if (of_class != all_classes) return first[of_class];
  Sums all;
  for (std::size_t k = 0; k < classes_; ++k) all += first[k];
  return all;
}

double CellTally::track_length(Cell c, std::uint32_t of_class) const {
  return sum_of(c, of_class).length.value() * unit_;
}
double CellTally::residence(Cell c, std::uint32_t of_class) const { return sum_of(c, of_class).time.value(); }
std::uint64_t CellTally::visits(Cell c, std::uint32_t of_class) const { return sum_of(c, of_class).visits; }
std::uint64_t CellTally::deposited(Cell c, std::uint32_t of_class) const { return sum_of(c, of_class).deposited; }
double CellTally::amount(Cell c, std::uint32_t which, std::uint32_t of_class) const {
  const bool all = of_class == all_classes;
  TallyAmount sum;
  for (std::size_t k = all ? 0 : of_class; k < (all ? classes_ : of_class + std::size_t{1}); ++k)
    add_to(sum, pools_[c.pool()].amounts[(c.index() * classes_ + k) * amounts_.size() + which]);
  return sum.value();
}

bool CellTally::adds_up() const {
  Sums all;
  std::vector<TallyAmount> amounts(amounts_.size());
  for (const Pool& pool : pools_) {
    for (const Sums& s : pool.sums) all += s;
    for (std::size_t i = 0; i < pool.amounts.size(); ++i) add_to(amounts[i % amounts.size()], pool.amounts[i]);
  }
  return all.length == length_ && all.time == time_ && amounts == amounts_;
}

void CellTally::take_back(Cell c, double time, std::uint32_t of_class) {
  if (!(time > 0.0)) return;
  Sums& sums = of(c, of_class);
  time = std::min(time, 0x1p+62);
  const double whole = std::floor(time);
  const Wide asked = wide({detail::tally_units(time - whole) << 2U, static_cast<std::uint64_t>(whole)});
  const Wide rest = std::min(asked, wide(sums.time));
  sums.time = dartcast::sum_of(wide(sums.time) - rest);
  time_ = dartcast::sum_of(wide(time_) - rest);
}

void CellTally::take_back_amounts(Cell c, std::span<const double> amounts, std::uint32_t of_class) {
  for (std::size_t k = 0; k < amounts.size(); ++k) {
    const TallyAmount back = -detail::tally_amount(amounts[k]);
    add_to(amounts_of(c, of_class)[k], back);
    add_to(amounts_[k], back);
  }
}

void CellTally::share_out(const CellComplex& complex, const Record& record, std::span<const Cell> cells) {
  double whole = 0.0;
  for (const Cell c : cells) whole += volume6(complex, c);
  double so_far = 0.0;
  Record given{std::vector<Sums>(record.sums.size()), std::vector<TallyAmount>(record.amounts.size())};
  for (std::size_t i = 0; i < cells.size(); ++i) {
    so_far += volume6(complex, cells[i]);
    const bool is_last = i + 1 == cells.size();
    const double share = is_last || !(whole > 0.0) ? 1.0 : std::min(so_far / whole, 1.0);
    for (std::size_t k = 0; k < record.sums.size(); ++k) {
      const Sums& sums = record.sums[k];
      const Sums& before = given.sums[k];
      const Sums upto{dartcast::sum_of(part_of(wide(sums.length), share)),
                      dartcast::sum_of(part_of(wide(sums.time), share)),
                      static_cast<std::uint64_t>(part_of(sums.visits, share)),
                      static_cast<std::uint64_t>(part_of(sums.deposited, share))};
      of(cells[i], static_cast<std::uint32_t>(k)) +=
          Sums{dartcast::sum_of(wide(upto.length) - wide(before.length)),
               dartcast::sum_of(wide(upto.time) - wide(before.time)), upto.visits - before.visits,
               upto.deposited - before.deposited};
      given.sums[k] = upto;
    }
    for (std::size_t k = 0; k < record.amounts.size(); ++k) {
      const TallyAmount upto = part_of(record.amounts[k], share);
      add_to(amounts_of(cells[i], 0)[k], upto - given.amounts[k]);
      given.amounts[k] = upto;
    }
  }
}

// All of a cell, which then has nothing.
CellTally::Record CellTally::take(Cell c) {
  Record taken{std::vector<Sums>(classes_), std::vector<TallyAmount>(classes_ * amounts_.size())};
  std::swap_ranges(taken.sums.begin(), taken.sums.end(), &of(c, 0));
  std::swap_ranges(taken.amounts.begin(), taken.amounts.end(), amounts_of(c, 0));
  return taken;
}

void CellTally::give_up(const Record& record) {
  for (const Sums& s : record.sums) {
    length_ = dartcast::sum_of(wide(length_) - wide(s.length));
    time_ = dartcast::sum_of(wide(time_) - wide(s.time));
  }
  for (std::size_t i = 0; i < record.amounts.size(); ++i) add_to(amounts_[i % amounts_.size()], -record.amounts[i]);
}

// Places of removed cells may be those of added ones.
void CellTally::update_after_edit(const CellComplex& complex, const ComplexEditReport& edit) {
  if (edit.replaced)
    throw InvalidArgument("cell tally: the mesh was replaced, and its cells are others: make a new tally");
  std::unordered_map<std::uint32_t, Record> removed;  // by source
  for (const CellHandle& h : edit.map.removed) {
    const Pool& pool = pools_[h.cell.pool()];
    if (h.cell.index() >= pool.source.size()) continue;  // added and removed by the same edit
    removed[pool.source[h.cell.index()]] += take(h.cell);
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
  Record others;
  for (const auto& [source, record] : removed) {
    const auto found = by_source.find(source);
    if (found != by_source.end()) {
      share_out(complex, record, found->second);
      continue;
    }
    others += record;
  }
  if (!added.empty()) return share_out(complex, others, added);
  give_up(others);
}

std::vector<std::uint64_t> CellTally::words() const {
  std::vector<std::uint64_t> words;
  put(length_, words);
  put(time_, words);
  for (const TallyAmount& a : amounts_) put(a, words);
  for (const Pool& pool : pools_) {
    for (const Sums& s : pool.sums) {
      put(s.length, words);
      put(s.time, words);
      words.push_back(s.visits);
      words.push_back(s.deposited);
    }
    for (const TallyAmount& a : pool.amounts) put(a, words);
  }
  return words;
}

void CellTally::set_words(std::span<const std::uint64_t> words) {
  std::size_t cells = 0;
  for (const Pool& pool : pools_) cells += pool.source.size();
  const std::size_t of_amounts = digits_of_amount * amounts_.size();
  if (words.size() != 2 * digits_of_sum + of_amounts + cells * classes_ * (words_of_sums + of_amounts))
    throw InvalidArgument(
        fmt::format("CellTally::set_words: {} words for a complex with {} places of cells: give those "
                    "that words() returned for this complex, of a tally with as many classes and amounts",
                    words.size(), cells));
  length_ = taken(words);
  time_ = taken(words);
  for (TallyAmount& a : amounts_) a = taken_amount(words);
  for (Pool& pool : pools_) {
    for (Sums& s : pool.sums) {
      s.length = taken(words);
      s.time = taken(words);
      s.visits = words[0];
      s.deposited = words[1];
      words = words.subspan(2);
    }
    for (TallyAmount& a : pool.amounts) a = taken_amount(words);
  }
}

}  // namespace dartcast
