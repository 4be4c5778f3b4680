// Distances of words against the best of all alignments, and which words are near enough to be meant.
#include "base/closest_word.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace dartcast::test::closest_word_test {

// From the front: whatever the first change may be, and the best of the rest.
std::size_t best_of_all(std::string_view a, std::string_view b) {
  if (a.empty() || b.empty()) return a.size() + b.size();
  std::size_t best = std::min(best_of_all(a.substr(1), b), best_of_all(a, b.substr(1))) + 1;
  best = std::min(best, best_of_all(a.substr(1), b.substr(1)) + (a[0] == b[0] ? 0 : 1));
  if (a.size() > 1 && b.size() > 1 && a[0] == b[1] && a[1] == b[0])
    best = std::min(best, best_of_all(a.substr(2), b.substr(2)) + 1);
  return best;
}

// All words of up to four letters out of two.
TEST(EditDistance, IsThatOfTheBestAlignment) {
  std::vector<std::string> words = {""};
  for (std::size_t i = 0; i < words.size() && words[i].size() < 4; ++i) {
    words.push_back(words[i] + "a");
    words.push_back(words[i] + "b");
  }
  for (const std::string& a : words) {
    for (const std::string& b : words) EXPECT_EQ(edit_distance(a, b), best_of_all(a, b)) << a << ' ' << b;
  }
  EXPECT_EQ(edit_distance("restituton", "restitution"), 1U);
  EXPECT_EQ(edit_distance("chekc", "check"), 1U);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);
}

TEST(DidYouMean, NamesTheNearestWordIfItIsClose) {
  const std::vector<std::string> verbs = {"run", "report", "view", "check", "info", "convert"};
  EXPECT_EQ(did_you_mean("chekc", verbs), " (did you mean 'check'?)");
  EXPECT_EQ(did_you_mean("reprot", verbs), " (did you mean 'report'?)");
  EXPECT_EQ(did_you_mean("rn", verbs), " (did you mean 'run'?)");
  for (const char* far : {"", "r", "fly", "simulate", "particles"}) EXPECT_EQ(did_you_mean(far, verbs), "") << far;
  EXPECT_EQ(did_you_mean("run", {}), "");
}

}  // namespace dartcast::test::closest_word_test
