// The word that somebody may have meant. Not installed.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace dartcast {

/// The fewest changes that make one word of the other. A change inserts, removes or replaces a letter, or swaps two
/// neighbours; no letter is changed twice. Cost: the product of the lengths.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// " (did you mean 'x'?)", where x is the nearest of the words, the first of several. Empty if none is close: more than
/// a third of the letters of `word` differ, and more than one, or all.
std::string did_you_mean(std::string_view word, std::span<const std::string> words);

}  // namespace dartcast
