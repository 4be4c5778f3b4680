// The kernel of the batch, compiled for each instruction set.
#pragma once

#include <cstddef>

#include "tracking/batch/batch.hpp"

namespace dartcast::detail {

// step(): as step_batch(). all_between(): whether every number is 0 (not -0), or has a magnitude between the two.
namespace portable {
void step(const BatchScene& scene, const BatchSteps& steps, Counters& counters);
bool all_between(const double* x, std::size_t count, double low, double high);
}  // namespace portable

namespace avx2 {
void step(const BatchScene& scene, const BatchSteps& steps, Counters& counters);
bool all_between(const double* x, std::size_t count, double low, double high);
}  // namespace avx2

}  // namespace dartcast::detail
