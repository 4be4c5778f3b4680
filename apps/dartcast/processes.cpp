// MPI is started only where a launcher has started this process: a command of its own does not pay for it.
#include "processes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <string>
#include <thread>

#include "commands.hpp"
#include "dartcast/error.hpp"
#ifdef DARTCAST_MPI
#include "dartcast/mpi_ranks.hpp"
#endif

namespace dartcast::app {

namespace {

// The number of processes that a launcher says it has started; 0: it says none.
unsigned started_together() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"}) {
    const char* value = std::getenv(name);
    if (value != nullptr) return static_cast<unsigned>(std::strtoul(value, nullptr, 10));
  }
  return 0;
}

#ifdef DARTCAST_MPI
int run_shared(Ranks& ranks, const std::function<int(Ranks*)>& run) {
  try {
    std::uint64_t status = static_cast<std::uint64_t>(run(&ranks));
    if (ranks.rank() != 0) status = 0;
    ranks.sum({&status, 1});
    return static_cast<int>(status);
  } catch (const RankFailed&) {
    return failed;  // which the rank itself has said
  } catch (const std::exception& e) {
    if (ranks.fail(e.what())) fmt::print(stderr, "dartcast: rank {}: {}\n", ranks.rank(), e.what());
    return failed;
  }
}
#endif

}  // namespace

int on_ranks(const std::function<int(Ranks*)>& run) {
  const unsigned count = started_together();
  if (count == 0) return run(nullptr);
#ifdef DARTCAST_MPI
  const MpiSession session;
  const std::unique_ptr<Ranks> ranks = mpi_ranks();
  return run_shared(*ranks, run);
#else
  if (count == 1) return run(nullptr);
  throw Error(
      "a launcher has started several processes, but this command is built without MPI: build it with "
      "-DDARTCAST_MPI=ON, "
      "or start one process");
#endif
}

Threads threads_of_rank(const Ranks* ranks) {
  if (ranks == nullptr || ranks->size() == 1) return {};
  unsigned here = ranks->size();
  for (const char* name : {"OMPI_COMM_WORLD_LOCAL_SIZE", "MPI_LOCALNRANKS"}) {
    if (const char* value = std::getenv(name)) here = static_cast<unsigned>(std::strtoul(value, nullptr, 10));
  }
  return {std::max(1U, std::thread::hardware_concurrency() / std::max(1U, here))};
}

}  // namespace dartcast::app
