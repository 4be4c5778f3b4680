// The rows of a table go along with particles that go to other ranks. Not installed.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "base/table.hpp"
#include "environment/part_environment.hpp"

namespace dartcast {

class TableTravel final : public TravelData {
 public:
  /// Row i is that of particle i. `counts`: the column with the number of its contacts.
  explicit TableTravel(Table& table, std::optional<Column<std::uint32_t>> counts = {})
      : table_(table), counts_(counts) {}

  [[nodiscard]] std::string leave(std::uint32_t particle, std::uint32_t contacts) const override {
    if (counts_) {  // the row that stays is removed after the step
      std::uint32_t& count = table_[*counts_][particle];
      count += std::min(contacts, UINT32_MAX - count);
    }
    ByteWriter out;
    table_.pack(particle, out);
    return out.bytes();
  }
  void come(std::string_view data) override {
    ByteReader in(data);
    table_.append(in);
  }

 private:
  Table& table_;
  std::optional<Column<std::uint32_t>> counts_;
};

}  // namespace dartcast
