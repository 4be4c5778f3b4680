// Numbers on the command line, each within the limits of its scene key.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>

namespace dartcast::app {

/// A transform for an option whose value is a whole number, in decimal digits, from `low` to `high`. Any other value is
/// wrong usage: the message has the option, the value and the range.
CLI::Validator whole_number(std::uint64_t low, std::uint64_t high);

}  // namespace dartcast::app
