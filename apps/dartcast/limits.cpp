// Checks options that are whole numbers in a range.
#include "limits.hpp"

#include <fmt/format.h>

#include <charconv>
#include <string>

namespace dartcast::app {

CLI::Validator whole_number(std::uint64_t low, std::uint64_t high) {
  const auto check = [low, high](std::string& text) -> std::string {
    std::uint64_t value = 0;
    const char* const end = text.data() + text.size();
    const auto [at, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc() || at != end || value < low || value > high)
      return fmt::format("'{}' is no whole number from {} to {}", text, low, high);
    text = fmt::format("{}", value);  // without leading zeros, which CLI11 takes for another base
    return {};
  };
  return {check, fmt::format("{} to {}", low, high), "whole_number"};
}

}  // namespace dartcast::app
