// Values on the command line, each within the limits of its scene key. A wrong one is wrong usage: the message has the
// option, the value, and those that are allowed.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <vector>

namespace dartcast::app {

/// A transform for an option whose value is a whole number, in decimal digits, from `low` to `high`.
CLI::Validator whole_number(std::uint64_t low, std::uint64_t high);

/// A check for an option whose value is a number from `low` to `high`.
CLI::Validator number(double low, double high);

/// A check for an option whose value is one of these words, and the name of its type in help: "tetgen|gmsh".
CLI::Validator one_of(std::vector<std::string> words);
std::string alternatives(const std::vector<std::string>& words);

}  // namespace dartcast::app
