// Which workloads are run, and at which sizes.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "bench/workload.hpp"

namespace dartcast::bench {

struct PlanOptions {
  bool quick = false;                ///< W1 at 10^3, 10^5 and 10^6 cells, W2 at 10^5: under two minutes
  std::vector<std::string> only;     ///< names of workloads; empty: all
  std::optional<std::size_t> steps;  ///< of a workload at most; none: its own number
};

/// In the order of running. Throws InvalidArgument where a name of `only` is none, listing those that there are.
///  - W1: boxes that stand still, 10^3 to 10^7 cells; 1,000 particles, 0.1 cells a step.
///  - W2: the same with every vertex moving; and with 10^5 particles at 10^5 cells.
///  - W3: 10^6 particles in 10^5 cells, at random and sorted by cell, one and two threads.
///  - W4: on lattice lines, where most determinants are zero.
///  - W5: steps of 0.01 to 100 cells; and cells of 6 to 60 faces.
///  - W6: squares of the plane, 10^3 to 10^6, that stand still and that move.
///  - bar, bar_deforming, vessel: the scenes of the paper's figures.
std::vector<WorkloadOptions> plan(const PlanOptions& options);

}  // namespace dartcast::bench
