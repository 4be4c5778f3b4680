// Removal of marked items from arrays: what remains is found once, as runs, and moved by the run in every array.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace dartcast {

/// The runs of unmarked items that do not stay at their places.
class KeptRuns {
 public:
  struct Run {
    std::size_t from;
    std::size_t to;
    std::size_t size;
  };

  /// Removes the items whose marks are not 0. Cost: a pass over the marks.
  explicit KeptRuns(std::span<const std::uint8_t> marks) {
    std::size_t end = next(marks, 0, true);
    kept_ = end;
    while (end < marks.size()) {
      const std::size_t begin = next(marks, end, false);
      end = next(marks, begin, true);
      if (end > begin) runs_.push_back({begin, kept_, end - begin});
      kept_ += end - begin;
    }
  }

  [[nodiscard]] std::size_t kept() const { return kept_; }
  [[nodiscard]] std::span<const Run> runs() const { return runs_; }

  /// Removes the marked items of an array that has `width` values for each item.
  template <class T>
  void keep_in(std::vector<T>& values, std::size_t width = 1) const {
    const auto begin = values.begin();
    const auto at = [&](std::size_t item) { return begin + static_cast<std::ptrdiff_t>(item * width); };
    for (const Run& run : runs_) std::move(at(run.from), at(run.from + run.size), at(run.to));
    values.resize(kept_ * width);
  }

 private:
  // The first item from here on that is marked, or is not. Few are marked: eight marks are looked at together.
  static std::size_t next(std::span<const std::uint8_t> marks, std::size_t from, bool marked) {
    for (std::uint64_t eight = 0; marked && from + sizeof eight <= marks.size(); from += sizeof eight) {
      std::memcpy(&eight, &marks[from], sizeof eight);
      if (eight != 0) break;
    }
    while (from < marks.size() && (marks[from] != 0) != marked) ++from;
    return from;
  }

  std::size_t kept_ = 0;
  std::vector<Run> runs_;
};

}  // namespace dartcast
