// Loops over independent items. Results never depend on the number of threads: a body writes only its own items.
#pragma once

#include <cstddef>
#include <type_traits>

#include "dartcast/threads.hpp"

namespace dartcast {

namespace detail {
using ChunkBody = void (*)(void* context, std::size_t begin, std::size_t end);
void parallel_chunks(std::size_t count, std::size_t grain, Threads threads, ChunkBody body, void* context);
}  // namespace detail

/// Calls body(begin, end) for consecutive chunks of at most `grain` items that cover [0, count). The chunks are the
/// same for any number of threads. The first exception by chunk order is thrown again after all chunks have ended.
/// Throws as check_threads(), before any chunk.
template <class Body>
void parallel_for(std::size_t count, std::size_t grain, Threads threads, Body&& body) {
  using B = std::remove_reference_t<Body>;
  detail::parallel_chunks(
      count, grain, threads,
      [](void* context, std::size_t begin, std::size_t end) { (*static_cast<B*>(context))(begin, end); },
      const_cast<std::remove_const_t<B>*>(&body));
}

/// Number of chunks that parallel_for makes.
constexpr std::size_t chunk_count(std::size_t count, std::size_t grain) { return (count + grain - 1) / grain; }

}  // namespace dartcast
