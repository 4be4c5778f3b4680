// The processes that share a run. MPI is one way to make them: dartcast/mpi_ranks.hpp.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "dartcast/error.hpp"

namespace dartcast {

/// Another rank has failed, and says why.
class RankFailed : public Error {
 public:
  using Error::Error;
};

/// Processes of equal rights but for the first, which writes what all have done. They are numbered from 0, their ranks.
///
/// Every function but rank() and size() is collective: all ranks call the same functions in the same order, and each
/// call waits for the others. Bytes are those of one kind of machine. A rank that cannot go on calls fail(). Then the
/// next call of the others throws RankFailed, so that none waits for a rank that has ended.
class Ranks {
 public:
  Ranks() = default;
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;
  virtual ~Ranks() = default;

  [[nodiscard]] virtual unsigned rank() const = 0;
  [[nodiscard]] virtual unsigned size() const = 0;

  /// The first rank gets what each gives, by rank; the others get nothing.
  virtual std::vector<std::string> gather(std::string bytes) = 0;
  /// All get what the first rank gives.
  virtual std::string broadcast(std::string bytes) = 0;
  /// Each rank gives something for every rank, itself included, and gets what they give to it, by rank.
  virtual std::vector<std::string> exchange(std::vector<std::string> bytes) = 0;
  /// Each value becomes the sum of those of all ranks, modulo 2^64.
  virtual void sum(std::span<std::uint64_t> values) = 0;
  /// Says to the others that this rank has failed, and why. Returns whether it is the lowest of those that have failed
  /// now: it alone should print why. No other function is called after it.
  virtual bool fail(const std::string& why) noexcept = 0;
};

}  // namespace dartcast
