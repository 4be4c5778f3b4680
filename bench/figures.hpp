// Relations of rows to each other: growth with the scene, the cost of deformation, of threads, of degenerate places.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench/comparison.hpp"

namespace dartcast::bench {

struct Figure {
  std::string key;   ///< in JSON
  std::string text;  ///< for people
  double value = 0.0;
};

/// The faster of Embree's two ways; nothing where it has not been run.
const Series* best_of_embree(const Row& row);

/// How many times dartcast's time each competitor takes, in one row.
double ratio_to_dartcast(const Row& row, const Series& series);

/// Those that the rows allow.
std::vector<Figure> figures(std::span<const Row> rows);

}  // namespace dartcast::bench
