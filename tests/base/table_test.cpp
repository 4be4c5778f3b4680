// A table against a list of rows that each keep their own values.
#include "base/table.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "base/random.hpp"
#include "dartcast/error.hpp"

namespace dartcast::table_test {

struct Row {
  std::uint64_t id = 0;
  std::uint8_t mark = 0;
  std::array<double, 3> numbers{};
  bool operator==(const Row&) const = default;
};

struct Rows : Table {
  Column<std::uint64_t> id = add_column<std::uint64_t>();
  Column<double> numbers = add_column<double>(3);
  Column<std::uint8_t> mark = add_column<std::uint8_t>();

  void put(std::size_t i, const Row& row) {
    (*this)[id][i] = row.id;
    (*this)[mark][i] = row.mark;
    std::copy(row.numbers.begin(), row.numbers.end(), (*this)[numbers].subspan(3 * i).begin());
  }
  [[nodiscard]] std::vector<Row> all() const {
    std::vector<Row> list;
    for (std::size_t i = 0; i < rows(); ++i) {
      list.push_back({(*this)[id][i], (*this)[mark][i], {}});
      std::copy_n((*this)[numbers].subspan(3 * i).begin(), 3, list.back().numbers.begin());
    }
    return list;
  }
};

class Pair {
 public:
  explicit Pair(std::uint64_t seed) : random_(seed) {}

  void step() {
    switch (random_.below(6)) {
      case 0: return append_zeros();
      case 1: return append();
      case 2: return travel();
      case 3: return truncate();
      case 4: return remove();
      case 5: return reorder();
    }
  }
  void expect_same() const {
    ASSERT_EQ(table_.rows(), rows_.size());
    EXPECT_EQ(table_.bytes(), rows_.size() * 33);
    EXPECT_TRUE(table_.all() == rows_);
  }

 private:
  std::size_t below(std::size_t n) { return random_.below(static_cast<std::uint32_t>(n)); }
  Row row() {
    const double x = random_.uniform();
    return {++last_, static_cast<std::uint8_t>(random_.below(256)), {x, -x, 2.0 * x}};
  }
  void append_zeros() {
    const std::size_t count = below(9);
    table_.append_zeros(count);
    rows_.resize(rows_.size() + count);
    for (std::size_t i = rows_.size() - count + (count > 0 ? 1 : 0); i < rows_.size(); ++i) {
      rows_[i] = row();
      table_.put(i, rows_[i]);
    }
  }
  void append() {
    const Rows copy = table_;
    if (copy.rows() == 0) return;
    const std::size_t i = below(copy.rows());
    table_.append(copy, i);
    rows_.push_back(rows_[i]);
  }
  void travel() {
    const std::size_t count = rows_.size();
    if (count == 0) return;
    ByteWriter out;
    for (int k = 0; k < 3; ++k) {
      const std::size_t i = below(count);
      table_.pack(i, out);
      rows_.push_back(rows_[i]);
    }
    for (ByteReader in(out.bytes()); !in.at_end();) table_.append(in);
  }
  void truncate() {
    const std::size_t count = rows_.size() - std::min(below(4), rows_.size());
    table_.truncate(count + rows_.size());
    table_.truncate(count);
    rows_.resize(count);
  }
  void remove() {
    std::vector<std::uint8_t> marks(rows_.size());
    for (std::uint8_t& m : marks) m = random_.below(3) == 0 ? 1 : 0;
    table_.remove(marks);
    std::size_t i = 0;
    std::erase_if(rows_, [&](const Row& /*row*/) { return marks[i++] != 0; });
  }
  void reorder() {
    std::vector<std::uint32_t> order(rows_.size());
    std::iota(order.begin(), order.end(), 0U);
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[below(i)]);
    table_.reorder(order);
    const std::vector<Row> before = rows_;
    for (std::size_t i = 0; i < order.size(); ++i) rows_[i] = before[order[i]];
  }

  Random random_;
  Rows table_;
  std::vector<Row> rows_;
  std::uint64_t last_ = 0;
};

TEST(Table, DoesTheSameToAllColumns) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Pair pair(seed);
    for (int k = 0; k < 200; ++k) {
      pair.step();
      ASSERT_NO_FATAL_FAILURE(pair.expect_same()) << "seed " << seed << ", step " << k;
    }
  }
}

TEST(Table, GetsColumnsWhenItHasRows) {
  Table table;
  table.append_zeros(2);
  const auto more = table.add_column<float>(2);
  EXPECT_EQ(table[more].size(), 4U);
  table[more][3] = 1.5F;
  EXPECT_EQ(std::as_const(table)[more][3], 1.5F);
  table.set_width(more, 1);
  EXPECT_EQ(table[more].size(), 2U);
  EXPECT_EQ(table[more][1], 0.0F);
}

TEST(Table, IsSortedByNumbers) {
  Rows table;
  table.append_zeros(3);
  for (const std::size_t i : {0U, 1U, 2U}) table.put(i, {7 * (i + 1) % 10, static_cast<std::uint8_t>(i), {}});
  EXPECT_EQ(table.sort_by(table.id), (std::vector<std::uint32_t>{2, 1, 0}));
  EXPECT_EQ(table[table.id][0], 1U);
  EXPECT_EQ(table[table.mark][0], 2U);
  EXPECT_TRUE(table.sort_by(table.id).empty());
}

TEST(Table, RefusesARowThatEndsTooEarly) {
  Rows table;
  ByteReader in("short");
  EXPECT_THROW(table.append(in), Error);
  table.truncate(0);
  EXPECT_EQ(table.bytes(), 0U);
}

}  // namespace dartcast::table_test
