// Operations on rows, column by column.
#include "base/table.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/kept_runs.hpp"

namespace dartcast {

std::size_t Table::bytes() const {
  std::size_t sum = 0;
  for (const Values& c : columns_) sum += c.bytes.size();
  return sum;
}

void Table::append_zeros(std::size_t count) {
  for (Values& c : columns_) c.bytes.resize((rows_ + count) * c.width);
  rows_ += count;
}

void Table::append(const Table& other, std::size_t row) {
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    const std::byte* const first = other.columns_[k].bytes.data() + row * columns_[k].width;
    columns_[k].bytes.insert(columns_[k].bytes.end(), first, first + columns_[k].width);
  }
  ++rows_;
}

void Table::append(ByteReader& in) {
  for (Values& c : columns_) {
    const std::span<const std::byte> value = in.take_bytes(c.width);
    c.bytes.insert(c.bytes.end(), value.begin(), value.end());
  }
  ++rows_;
}

void Table::pack(std::size_t row, ByteWriter& out) const {
  for (const Values& c : columns_) out.put_bytes(std::span(c.bytes).subspan(row * c.width, c.width));
}

void Table::truncate(std::size_t count) {
  for (Values& c : columns_) {
    if (c.bytes.size() > count * c.width) c.bytes.resize(count * c.width);
  }
  if (rows_ > count) rows_ = count;
}

void Table::remove(std::span<const std::uint8_t> marks) {
  const KeptRuns runs(marks);
  for (Values& c : columns_) runs.keep_in(c.bytes, c.width);
  rows_ = runs.kept();
}

void Table::reorder(std::span<const std::uint32_t> order) {
  for (Values& c : columns_) {
    std::vector<std::byte> sorted;
    sorted.reserve(c.bytes.size());
    for (const std::uint32_t row : order) {
      const std::byte* const first = c.bytes.data() + row * c.width;
      sorted.insert(sorted.end(), first, first + c.width);
    }
    c.bytes = std::move(sorted);
  }
}

std::vector<std::uint32_t> Table::sort_by(Column<std::uint64_t> numbers) {
  const std::span<const std::uint64_t> n = (*this)[numbers];
  if (std::is_sorted(n.begin(), n.end())) return {};
  std::vector<std::uint32_t> order(rows_);
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return n[a] < n[b]; });
  reorder(order);
  return order;
}

}  // namespace dartcast
