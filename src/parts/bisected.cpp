// Recursive bisection without sorting.
//
// All groups of cells that still hold several parts are split at the same time. Phases of such a level: Find each
// group's longest side. Find the cell at its wanted weight, digit by digit of its place on that side. Send the others
// left or right of it. Ranks add up numbers for each group, never cells.
#include "parts/bisected.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <string>

#include "base/are_several.hpp"
#include "base/reduced.hpp"
#include "dartcast/error.hpp"
#include "mesh/cell_types.hpp"

namespace dartcast {

namespace {

constexpr unsigned digits = 12;  // of 8 bits: 8 of the coordinate, 4 of the number
constexpr std::size_t digit_values = 256;

// A cell's place along an axis. No two cells have the same.
struct Key {
  std::uint64_t place = 0;
  std::uint32_t number = 0;

  auto operator<=>(const Key&) const = default;
  [[nodiscard]] std::size_t digit(unsigned d) const {
    return d < 8 ? place >> (56 - 8 * d) & 0xffU : number >> (24 - 8 * (d - 8)) & 0xffU;
  }
};

// In the order of the coordinates.
std::uint64_t ordered_bits(double x) {
  const auto bits = std::bit_cast<std::uint64_t>(x);
  return (bits >> 63U) != 0 ? ~bits : bits | std::uint64_t{1} << 63U;
}

struct MiddlesBox {
  Vec3 low = {std::numeric_limits<double>::max(), std::numeric_limits<double>::max(),
              std::numeric_limits<double>::max()};
  Vec3 high = {std::numeric_limits<double>::lowest(), std::numeric_limits<double>::lowest(),
               std::numeric_limits<double>::lowest()};

  void add(const MiddlesBox& b) {
    low = {std::min(low.x, b.low.x), std::min(low.y, b.low.y), std::min(low.z, b.low.z)};
    high = {std::max(high.x, b.high.x), std::max(high.y, b.high.y), std::max(high.z, b.high.z)};
  }
  [[nodiscard]] double Vec3::*longest() const {
    const Vec3 d = high - low;
    if (d.x >= d.y && d.x >= d.z) return &Vec3::x;
    return d.y >= d.z ? &Vec3::y : &Vec3::z;
  }
};

// Cells that will be the parts [first, first + count).
struct Group {
  Group(std::uint32_t first_part, std::uint32_t part_count) : first(first_part), count(part_count) {}

  std::uint32_t first;
  std::uint32_t count;
  double Vec3::*axis = nullptr;
  std::uint64_t weight = 0;
  std::uint64_t cells = 0;
  // The search: `wanted` is the weight on the left times `share`; by counts, each cell weighs 1.
  bool by_count = false;
  std::uint64_t wanted = 0;
  std::uint64_t share = 1;
  std::uint64_t weight_before = 0;
  std::uint64_t cells_before = 0;
  std::uint64_t weight_here = 0;
  std::size_t digit = 0;
  Key split;

  [[nodiscard]] std::uint32_t low() const { return count / 2; }
  [[nodiscard]] bool takes_split() const { return (2 * weight_before + weight_here) * share < 2 * wanted; }
  [[nodiscard]] std::uint64_t cells_on_left() const { return cells_before + (takes_split() ? 1 : 0); }
};

class Bisection {
 public:
  Bisection(std::span<const Vec3> middles, std::span<const std::uint32_t> numbers,
            std::span<const std::uint64_t> weights, Ranks* ranks)
      : middles_(middles), numbers_(numbers), weights_(weights), ranks_(ranks), group_(middles.size()) {}

  std::vector<std::uint32_t> divide(std::uint32_t parts) {
    groups_ = {Group{0, parts}};
    while (std::any_of(groups_.begin(), groups_.end(), [](const Group& g) { return g.count > 1; })) split_all();
    std::vector<std::uint32_t> result(group_.size());
    for (std::size_t c = 0; c < result.size(); ++c) result[c] = groups_[group_[c]].first;
    return result;
  }

 private:
  void split_all() {
    find_axes();
    weigh();
    search();
    bool again = false;  // each part needs a cell
    for (Group& g : groups_) {
      const std::uint64_t here = g.cells_on_left();
      const std::uint64_t allowed = std::clamp<std::uint64_t>(here, g.low(), g.cells - (g.count - g.low()));
      if (g.count == 1 || allowed == here) continue;
      again = g.by_count = true;
      g.wanted = allowed;
      g.share = 1;
    }
    if (again) search();
    send();
  }

  void find_axes() {
    std::vector<MiddlesBox> boxes(groups_.size());
    for (std::size_t c = 0; c < group_.size(); ++c) boxes[group_[c]].add({middles_[c], middles_[c]});
    const auto add = [](std::vector<MiddlesBox>& all, const std::vector<MiddlesBox>& other) {
      for (std::size_t g = 0; g < all.size(); ++g) all[g].add(other[g]);
    };
    const auto pack = [](const std::vector<MiddlesBox>& all) {
      ByteWriter out;
      out.put(all);
      return out.bytes();
    };
    const auto unpack = [](const std::string& bytes) { return ByteReader(bytes).take_list<MiddlesBox>(); };
    boxes = reduced(ranks_, boxes, add, pack, unpack);
    for (std::size_t g = 0; g < groups_.size(); ++g) groups_[g].axis = boxes[g].longest();
  }

  void weigh() {
    std::vector<std::uint64_t> sums(2 * groups_.size());
    for (std::size_t c = 0; c < group_.size(); ++c) {
      sums[2 * group_[c]] += weights_[c];
      ++sums[2 * group_[c] + 1];
    }
    if (are_several(ranks_)) ranks_->sum(sums);
    for (std::size_t i = 0; i < groups_.size(); ++i) {
      Group& g = groups_[i];
      g.weight = sums[2 * i];
      g.cells = sums[2 * i + 1];
      g.by_count = false;
      g.wanted = g.weight * g.low();
      g.share = g.count;
    }
  }

  [[nodiscard]] Key key(std::size_t c) const {
    return {ordered_bits(middles_[c].*groups_[group_[c]].axis),
            numbers_.empty() ? static_cast<std::uint32_t>(c) : numbers_[c]};
  }

  // Finds in each group the cell that holds the wanted weight.
  void search() {
    std::vector<std::uint32_t> candidates;
    for (std::uint32_t c = 0; c < group_.size(); ++c) {
      if (groups_[group_[c]].count > 1) candidates.push_back(c);
    }
    for (Group& g : groups_) {
      g.weight_before = g.cells_before = 0;
      g.split = {};
    }
    std::vector<std::uint64_t> sums;  // by group and digit: weights, then numbers
    for (unsigned d = 0; d < digits; ++d) {
      sums.assign(2 * digit_values * groups_.size(), 0);
      for (const std::uint32_t c : candidates) {
        const std::size_t at = 2 * (digit_values * group_[c] + key(c).digit(d));
        sums[at] += groups_[group_[c]].by_count ? 1 : weights_[c];
        ++sums[at + 1];
      }
      if (are_several(ranks_)) ranks_->sum(sums);
      for (std::size_t g = 0; g < groups_.size(); ++g) {
        if (groups_[g].count > 1)
          choose(groups_[g], std::span(sums).subspan(2 * digit_values * g, 2 * digit_values), d);
      }
      std::erase_if(candidates, [&](std::uint32_t c) { return key(c).digit(d) != groups_[group_[c]].digit; });
    }
  }

  static void choose(Group& g, std::span<const std::uint64_t> sums, unsigned d) {
    g.digit = 0;
    while ((g.weight_before + sums[2 * g.digit]) * g.share < g.wanted) {
      g.weight_before += sums[2 * g.digit];
      g.cells_before += sums[2 * g.digit + 1];
      ++g.digit;
    }
    g.weight_here = sums[2 * g.digit];
    if (d < 8)
      g.split.place |= std::uint64_t{g.digit} << (56 - 8 * d);
    else
      g.split.number |= static_cast<std::uint32_t>(g.digit) << (24 - 8 * (d - 8));
  }

  void send() {
    std::vector<Group> halves;
    std::vector<std::uint32_t> left(groups_.size());
    for (std::size_t i = 0; i < groups_.size(); ++i) {
      const Group& g = groups_[i];
      left[i] = static_cast<std::uint32_t>(halves.size());
      halves.emplace_back(g.first, g.count > 1 ? g.low() : 1);
      if (g.count > 1) halves.emplace_back(g.first + g.low(), g.count - g.low());
    }
    for (std::size_t c = 0; c < group_.size(); ++c) {
      const Group& g = groups_[group_[c]];
      bool right = false;
      if (g.count > 1) {
        const Key k = key(c);
        right = g.takes_split() ? k > g.split : k >= g.split;
      }
      group_[c] = left[group_[c]] + (right ? 1 : 0);
    }
    groups_ = std::move(halves);
  }

  std::span<const Vec3> middles_;
  std::span<const std::uint32_t> numbers_;
  std::span<const std::uint64_t> weights_;
  Ranks* ranks_;
  std::vector<std::uint32_t> group_;  // of each cell
  std::vector<Group> groups_;
};

}  // namespace

std::vector<Vec3> middles_of(const MeshData& mesh) {
  std::vector<Vec3> middles(mesh.cell_count());
  for (std::size_t c = 0; c < middles.size(); ++c) {
    Vec3 sum;
    double count = 0.0;
    for_each_face(mesh, c, [&](std::span<const std::uint32_t> face) {
      for (const std::uint32_t p : face) {
        sum += mesh.points[p];
        count += 1.0;
      }
    });
    middles[c] = sum * (1.0 / count);
  }
  return middles;
}

std::vector<std::uint32_t> bisected(std::span<const Vec3> middles, std::span<const std::uint32_t> numbers,
                                    std::span<const std::uint64_t> weights, std::uint32_t parts, Ranks* ranks) {
  std::uint64_t cells = middles.size();
  if (are_several(ranks)) ranks->sum({&cells, 1});
  if (parts == 0 || cells < parts)
    throw InvalidArgument(fmt::format("partition: {} parts of {} cells: each part needs a cell", parts, cells));
  return Bisection(middles, numbers, weights, ranks).divide(parts);
}

}  // namespace dartcast
