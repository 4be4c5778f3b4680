// Damage to files: other bytes, other numbers and signs, and ends that are missing.
#pragma once

#include <algorithm>
#include <random>
#include <string>
#include <vector>

namespace dartcast::test {

/// Damages one file after the other, the same for the same seed.
class Mutants {
 public:
  explicit Mutants(unsigned seed) : random_(seed) {}

  std::size_t below(std::size_t n) { return random_() % n; }

  /// The content with one to three changes.
  std::string damaged(std::string content) {
    for (std::size_t k = 1 + below(3); k > 0 && !content.empty(); --k) change(content);
    return content;
  }

 private:
  void change(std::string& content) {
    static const std::vector<std::string> words = {
        "-1", "0", "3", "1e400", "nan", "4294967295", "-2147483648", "9223372036854775807", "99999999999999999999",
        "x",  "",  "(", ")",     "}",   ";",          "{0}"};
    const std::size_t at = below(content.size());
    const std::size_t way = below(16);
    if (way == 0) {
      content.resize(at);
    } else if (way < 8) {
      content[at] = static_cast<char>(random_());
    } else {
      const std::size_t digit = std::min(content.find_first_of("0123456789", at), content.size());
      const std::size_t end = std::min(content.find_first_not_of("0123456789", digit), content.size());
      content = content.substr(0, digit) + words[below(words.size())] + content.substr(end);
    }
  }

  std::mt19937 random_;
};

}  // namespace dartcast::test
