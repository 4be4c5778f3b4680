// The table of a run whose tests are not counted, from that of one process: runs by cells leave these columns empty.
#pragma once

#include <string>

namespace dartcast::test {

inline std::string uncounted(const std::string& stats) {
  constexpr int first = 8, end = 12;  // orientation_tests to updated_by_deformation
  std::string out;
  int column = 0;
  bool in_header = true;
  for (const char c : stats) {
    if (in_header || c == ',' || c == '\n' || column < first || column >= end) out += c;
    column = c == '\n' ? 0 : column + (c == ',' ? 1 : 0);
    in_header = in_header && c != '\n';
  }
  return out;
}

}  // namespace dartcast::test
