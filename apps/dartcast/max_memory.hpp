// The option --max-memory of the verbs that read files.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>

namespace dartcast::app {

/// Bytes from a text as 512M or 2.5G. It is a number above 0 and a unit: K, M, G or T for 1024, its square, ... or
/// none. Throws CLI::ValidationError.
std::uint64_t parse_memory(const std::string& text);

/// Adds the option to a verb. `bytes` is as it was if the option is not given, and must outlive the verb.
void add_max_memory(CLI::App& verb, std::uint64_t& bytes);

}  // namespace dartcast::app
