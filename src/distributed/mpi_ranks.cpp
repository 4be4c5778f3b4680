// Ranks under MPI: bytes of any number between processes, and failures that all of them learn of.
//
// Every collective call begins with an exchange of one number: the lowest rank that has failed, if any. A rank that fails
// takes part in one such exchange, which is that of the others' next call. So none waits for a message that does not come,
// and one of those that failed knows that it is the first.
#include "dartcast/mpi_ranks.hpp"

#include <mpi.h>

#include <algorithm>
#include <numeric>
#include <utility>

namespace dartcast {

namespace {

// Messages are counted in int: longer ones go in blocks.
constexpr std::size_t block = std::size_t{1} << 30U;
constexpr int tag = 1;

void send(const std::string& bytes, int to, MPI_Comm comm) {
  for (std::size_t at = 0; at < bytes.size(); at += block) {
    const auto size = static_cast<int>(std::min(block, bytes.size() - at));
    MPI_Send(bytes.data() + at, size, MPI_BYTE, to, tag, comm);
  }
}

std::string received(std::uint64_t size, int from, MPI_Comm comm) {
  std::string bytes(size, '\0');
  for (std::size_t at = 0; at < size; at += block) {
    const auto part = static_cast<int>(std::min<std::size_t>(block, size - at));
    MPI_Recv(bytes.data() + at, part, MPI_BYTE, from, tag, comm, MPI_STATUS_IGNORE);
  }
  return bytes;
}

class MpiRanks final : public Ranks {
 public:
  explicit MpiRanks(MPI_Comm comm) {
    MPI_Comm_dup(comm, &comm_);
    MPI_Comm_rank(comm_, &rank_);
    MPI_Comm_size(comm_, &size_);
  }
  ~MpiRanks() override { MPI_Comm_free(&comm_); }

  [[nodiscard]] unsigned rank() const override { return static_cast<unsigned>(rank_); }
  [[nodiscard]] unsigned size() const override { return static_cast<unsigned>(size_); }

  std::vector<std::string> gather(std::string bytes) override {
    check_failures();
    const std::uint64_t own = bytes.size();
    std::vector<std::uint64_t> sizes(rank_ == 0 ? size() : 0);
    MPI_Gather(&own, 1, MPI_UINT64_T, sizes.data(), 1, MPI_UINT64_T, 0, comm_);
    std::uint64_t small = std::accumulate(sizes.begin(), sizes.end(), std::uint64_t{0}) <= block ? 1 : 0;
    MPI_Bcast(&small, 1, MPI_UINT64_T, 0, comm_);
    if (small != 0) return gather_at_once(bytes, sizes);
    if (rank_ != 0) {
      send(bytes, 0, comm_);
      return {};
    }
    std::vector<std::string> all = {std::move(bytes)};
    for (int from = 1; from < size_; ++from)
      all.push_back(received(sizes[static_cast<std::size_t>(from)], from, comm_));
    return all;
  }

  std::string broadcast(std::string bytes) override {
    check_failures();
    return broadcast_from(0, std::move(bytes));
  }

  std::vector<std::string> exchange(std::vector<std::string> bytes) override {
    check_failures();
    std::vector<std::uint64_t> to(size());
    std::vector<std::uint64_t> from(size());
    for (std::size_t r = 0; r < to.size(); ++r) to[r] = bytes[r].size();
    MPI_Alltoall(to.data(), 1, MPI_UINT64_T, from.data(), 1, MPI_UINT64_T, comm_);
    std::vector<std::string> all(size());
    std::vector<MPI_Request> requests;
    for (int r = 0; r < size_; ++r) {
      const auto i = static_cast<std::size_t>(r);
      if (r == rank_) {
        all[i] = std::move(bytes[i]);
        continue;
      }
      all[i].resize(from[i]);
      start(all[i].data(), from[i], r, MPI_Irecv, requests);
    }
    for (int r = 0; r < size_; ++r) {
      if (r != rank_)
        start(bytes[static_cast<std::size_t>(r)].data(), to[static_cast<std::size_t>(r)], r, MPI_Isend, requests);
    }
    MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
    return all;
  }

  void sum(std::span<std::uint64_t> values) override {
    check_failures();
    for (std::size_t at = 0; at < values.size(); at += block / sizeof(std::uint64_t)) {
      const std::size_t count = std::min(block / sizeof(std::uint64_t), values.size() - at);
      MPI_Allreduce(MPI_IN_PLACE, values.data() + at, static_cast<int>(count), MPI_UINT64_T, MPI_SUM, comm_);
    }
  }

  bool fail(const std::string& why) noexcept override {
    const int first = first_failed(rank_);
    static_cast<void>(broadcast_from(first, rank_ == first ? why : std::string()));
    return rank_ == first;
  }

 private:
  // The lowest rank that has failed, this one if it has; size_: none has.
  [[nodiscard]] int first_failed(int own) const {
    MPI_Allreduce(MPI_IN_PLACE, &own, 1, MPI_INT, MPI_MIN, comm_);
    return own;
  }

  void check_failures() const {
    const int first = first_failed(size_);
    if (first == size_) return;
    throw RankFailed("rank " + std::to_string(first) + ": " + broadcast_from(first, {}));
  }

  [[nodiscard]] std::string broadcast_from(int root, std::string bytes) const {
    std::uint64_t count = bytes.size();
    MPI_Bcast(&count, 1, MPI_UINT64_T, root, comm_);
    bytes.resize(count);
    for (std::size_t at = 0; at < count; at += block)
      MPI_Bcast(bytes.data() + at, static_cast<int>(std::min<std::size_t>(block, count - at)), MPI_BYTE, root, comm_);
    return bytes;
  }

  [[nodiscard]] std::vector<std::string> gather_at_once(const std::string& bytes,
                                                        const std::vector<std::uint64_t>& sizes) const {
    std::vector<int> counts(sizes.begin(), sizes.end());
    std::vector<int> begins(counts.size());
    std::exclusive_scan(counts.begin(), counts.end(), begins.begin(), 0);
    std::string joined(static_cast<std::size_t>(std::accumulate(counts.begin(), counts.end(), 0)), '\0');
    MPI_Gatherv(bytes.data(), static_cast<int>(bytes.size()), MPI_BYTE, joined.data(), counts.data(), begins.data(),
                MPI_BYTE, 0, comm_);
    std::vector<std::string> all;
    for (std::size_t r = 0; r < counts.size(); ++r)
      all.push_back(joined.substr(static_cast<std::size_t>(begins[r]), static_cast<std::size_t>(counts[r])));
    return all;
  }

  // Starts all blocks of a message: `start_one` is MPI_Irecv or MPI_Isend.
  template <class StartOne>
  void start(char* bytes, std::uint64_t size, int other, StartOne start_one, std::vector<MPI_Request>& requests) const {
    for (std::size_t at = 0; at < size; at += block) {
      const auto part = static_cast<int>(std::min<std::size_t>(block, size - at));
      start_one(bytes + at, part, MPI_BYTE, other, tag, comm_, &requests.emplace_back());
    }
  }

  MPI_Comm comm_ = MPI_COMM_NULL;
  int rank_ = 0;
  int size_ = 1;
};

}  // namespace

MpiSession::MpiSession() {
  int started = 0;
  MPI_Initialized(&started);
  if (started != 0) return;
  int level = 0;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &level);
  own_ = true;
}

MpiSession::~MpiSession() {
  if (own_) MPI_Finalize();
}

std::unique_ptr<Ranks> mpi_ranks(const void* communicator) {
  MPI_Comm comm = MPI_COMM_WORLD;
  if (communicator != nullptr) comm = *static_cast<const MPI_Comm*>(communicator);
  return std::make_unique<MpiRanks>(comm);
}

}  // namespace dartcast
