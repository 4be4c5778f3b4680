// Ranks that are processes under MPI. This header needs the library mpi (-DDARTCAST_MPI=ON), but no header of MPI.
#pragma once

#include <memory>

#include "dartcast/ranks.hpp"

namespace dartcast {

/// Starts MPI, and ends it. If the program has started MPI itself, both do nothing. One at a time; all communication is
/// by the thread that makes it.
class MpiSession {
 public:
  MpiSession();
  MpiSession(const MpiSession&) = delete;
  MpiSession& operator=(const MpiSession&) = delete;
  ~MpiSession();

 private:
  bool own_ = false;
};

/// The processes of a communicator: `communicator` is the address of an MPI_Comm; none: of all processes. It is
/// duplicated, so that other messages do not come in between. Collective. Precondition: MPI has been started, and ends after
/// the ranks.
std::unique_ptr<Ranks> mpi_ranks(const void* communicator = nullptr);

}  // namespace dartcast
