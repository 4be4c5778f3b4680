// Reads the option --max-memory: an amount with a unit.
#include "max_memory.hpp"

#include <fmt/format.h>

#include <cctype>
#include <charconv>
#include <system_error>

namespace dartcast::app {

std::uint64_t parse_memory(const std::string& text) {
  double number = 0.0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number, std::chars_format::fixed);
  std::string unit(rest, end);
  for (char& c : unit) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  if (unit.ends_with("B")) unit.pop_back();
  if (unit.ends_with("I") && unit.size() == 2) unit.pop_back();
  const std::size_t power = unit.empty() ? 0 : std::string("KMGT").find(unit) + 1;
  for (std::size_t k = 0; k < power && k < 5; ++k) number *= 1024.0;
  const bool known = unit.empty() || (unit.size() == 1 && power >= 1 && power <= 4);
  if (error != std::errc() || !known || !(number >= 1.0 && number < 0x1p63))
    throw CLI::ValidationError("--max-memory",
                               fmt::format("'{}' is no amount of memory: give a number and K, M, G or T, as 2G", text));
  return static_cast<std::uint64_t>(number);
}

void add_max_memory(CLI::App& verb, std::uint64_t& bytes) {
  verb.add_option_function<std::string>(
          "--max-memory", [&bytes](const std::string& text) { bytes = parse_memory(text); },
          "memory that reading may take, as 512M or 2G (half of the machine's); a file that may need more is refused")
      ->type_name("SIZE");
}

}  // namespace dartcast::app
