// Operations on rows, column by column.
#include "base/table.hpp"

#include "base/kept_runs.hpp"
#include "base/put_in_order.hpp"

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
  for (Values& c : columns_) put_in_order(c.bytes, order, c.width);
}

}  // namespace dartcast
