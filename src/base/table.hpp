// Rows of plain values: what happens to a row happens to it in all columns. Not installed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "base/bytes.hpp"

namespace dartcast {

/// Names a column of a table, and of its copies.
template <class T>
struct Column {
  std::size_t number = 0;
};

/// A table owns its columns. Each operation goes through all of them, so that a new column is one call of add_column().
class Table {
 public:
  /// Values are 0 at first. `width`: values in each row.
  template <class T>
  requires std::is_trivially_copyable_v<T> Column<T> add_column(std::size_t width = 1) {
    columns_.push_back({});
    set_width(Column<T>{columns_.size() - 1}, width);
    return {columns_.size() - 1};
  }
  /// All values of the column become 0.
  template <class T>
  void set_width(Column<T> column, std::size_t width) {
    columns_[column.number] = {std::vector<std::byte>(rows_ * width * sizeof(T)), width * sizeof(T)};
  }

  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] std::size_t bytes() const;
  /// The values of all rows, row by row. Adding and removing rows ends the validity of the span.
  template <class T>
  [[nodiscard]] std::span<T> operator[](Column<T> column) {
    std::vector<std::byte>& bytes = columns_[column.number].bytes;
    return {reinterpret_cast<T*>(bytes.data()), bytes.size() / sizeof(T)};
  }
  template <class T>
  [[nodiscard]] std::span<const T> operator[](Column<T> column) const {
    const std::vector<std::byte>& bytes = columns_[column.number].bytes;
    return {reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)};
  }
  /// The values of one row.
  template <class T>
  [[nodiscard]] std::span<T> row(Column<T> column, std::size_t row) {
    const std::size_t width = columns_[column.number].width / sizeof(T);
    return (*this)[column].subspan(row * width, width);
  }
  template <class T>
  [[nodiscard]] std::span<const T> row(Column<T> column, std::size_t row) const {
    const std::size_t width = columns_[column.number].width / sizeof(T);
    return (*this)[column].subspan(row * width, width);
  }

  /// Adds rows of zeros.
  void append_zeros(std::size_t count);
  /// Adds a row of another table. Precondition: that one has these columns; it may have others behind them.
  void append(const Table& other, std::size_t row);
  /// Adds a row that pack() has written.
  void append(ByteReader& in);
  void pack(std::size_t row, ByteWriter& out) const;
  /// Keeps the first `count` rows alone, also if an exception has ended an addition. It needs no memory.
  void truncate(std::size_t count);
  /// Removes rows that are marked with 1; the others keep their order. `marks`: one per row.
  void remove(std::span<const std::uint8_t> marks);
  /// Row i is then the former row order[i]. `order`: a permutation.
  void reorder(std::span<const std::uint32_t> order);
  /// Puts the rows in the order of these numbers. Returns that for reorder(); empty: they have it already.
  std::vector<std::uint32_t> sort_by(Column<std::uint64_t> numbers);

 private:
  struct Values {
    std::vector<std::byte> bytes;
    std::size_t width = 0;  // bytes of a row
  };

  std::vector<Values> columns_;
  std::size_t rows_ = 0;
};

}  // namespace dartcast
