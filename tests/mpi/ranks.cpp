// Every function of ranks under MPI, with known answers: run by mpirun with any number of processes. Ends with 0 where all
// are right. The argument "fail": the last rank fails while the others wait.
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "dartcast/mpi_ranks.hpp"

namespace {

// Bytes that name their sender, their receiver and their length.
std::string message(unsigned from, unsigned to, std::size_t size) {
  std::string bytes(size, '\0');
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<char>(from * 31 + to * 7 + i * 13);
  return bytes;
}

// Some are empty, some longer than what MPI sends without a handshake.
std::size_t size_of(unsigned from, unsigned to) { return (from * 5 + to * 3) % 4 * 50'000; }

bool gathers(dartcast::Ranks& ranks) {
  const std::vector<std::string> all = ranks.gather(message(ranks.rank(), 0, size_of(ranks.rank(), 0)));
  if (ranks.rank() != 0) return all.empty();
  bool right = all.size() == ranks.size();
  for (unsigned r = 0; right && r < ranks.size(); ++r) right = all[r] == message(r, 0, size_of(r, 0));
  return right;
}

bool exchanges(dartcast::Ranks& ranks) {
  std::vector<std::string> to;
  for (unsigned r = 0; r < ranks.size(); ++r) to.push_back(message(ranks.rank(), r, size_of(ranks.rank(), r)));
  const std::vector<std::string> from = ranks.exchange(to);
  bool right = from.size() == ranks.size();
  for (unsigned r = 0; right && r < ranks.size(); ++r)
    right = from[r] == message(r, ranks.rank(), size_of(r, ranks.rank()));
  return right;
}

bool broadcasts(dartcast::Ranks& ranks) {
  return ranks.broadcast(message(ranks.rank(), 0, 1000)) == message(0, 0, 1000);
}

bool sums(dartcast::Ranks& ranks) {
  std::vector<std::uint64_t> values = {ranks.rank(), 1, ~std::uint64_t{0}};
  ranks.sum(values);
  const std::uint64_t n = ranks.size();
  return values == std::vector<std::uint64_t>{n * (n - 1) / 2, n, ~n + 1};
}

bool fails(dartcast::Ranks& ranks) {
  const unsigned last = ranks.size() - 1;
  if (ranks.rank() == last) return ranks.fail("out of paper");
  try {
    broadcasts(ranks);
  } catch (const dartcast::RankFailed& e) {
    return e.what() == "rank " + std::to_string(last) + ": out of paper";
  }
  return false;
}

}  // namespace

int main(int argc, char** argv) {
  const dartcast::MpiSession session;
  const auto ranks = dartcast::mpi_ranks();
  const bool right = argc > 1 && std::string_view(argv[1]) == "fail"
                         ? fails(*ranks)
                         : gathers(*ranks) && exchanges(*ranks) && broadcasts(*ranks) && sums(*ranks);
  if (!right) std::fprintf(stderr, "rank %u: a wrong answer\n", ranks->rank());
  return right ? 0 : 1;
}
