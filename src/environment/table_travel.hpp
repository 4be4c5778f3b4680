// The rows of a table go along with particles that go to other ranks. Not installed.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "base/table.hpp"
#include "environment/part_environment.hpp"

namespace dartcast {

class TableTravel : public TravelData {
 public:
  /// Row i is that of particle i.
  explicit TableTravel(Table& table) : table_(table) {}

  [[nodiscard]] std::string leave(std::uint32_t particle, std::uint32_t /*contacts*/) const override {
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
};

}  // namespace dartcast
