// Replays scripts of inputs natively: replay_inputs < SCRIPTS. A line is a call, and an answer is a line: the state hash
// or the error. js/tests/inputs.mjs writes the scripts and compares.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <iostream>
#include <sstream>
#include <string>

#include "engine.hpp"

namespace {

// Lines of a scene are separated by tabs.
std::string lines_of(std::string text) {
  for (char& c : text) c = c == '\t' ? '\n' : c;
  return text;
}

const char* call(const std::string& name, const std::string& values) {
  if (name == "make") return dartcast_make(lines_of(values).c_str());
  if (name == "add") return dartcast_add(lines_of(values).c_str());
  if (name == "edit") return dartcast_edit(lines_of(values).c_str());
  double v[8] = {};
  std::istringstream in(values);
  for (double& x : v) in >> x;
  if (name == "step") return dartcast_step(static_cast<std::uint32_t>(v[0]));
  if (name == "steer") return dartcast_steer(static_cast<std::uint32_t>(v[0]), v[1], v[2]);
  if (name == "steer_solid")
    return dartcast_steer_solid(static_cast<std::uint32_t>(v[0]), v[1], v[2], v[3], v[4], v[5], v[6]);
  if (name == "pull") return dartcast_pull(v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7]);
  return "no such call";
}

}  // namespace

int main() {
  std::string line;
  while (std::getline(std::cin, line)) {
    const std::size_t space = std::min(line.find(' '), line.size());
    const std::string error = call(line.substr(0, space), line.substr(std::min(space + 1, line.size())));
    std::printf("%s\n", error.empty() ? dartcast_hash() : error.c_str());
  }
}
