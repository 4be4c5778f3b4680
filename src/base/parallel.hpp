// Loops over independent items. Results never depend on the number of threads: a body writes only its own items.
#pragma once

#include <cstddef>
#include <span>
#include <type_traits>

#include "dartcast/threads.hpp"

namespace dartcast {

namespace detail {
using ChunkBody = void (*)(void* context, std::size_t begin, std::size_t end);
void parallel_chunks(std::size_t count, std::size_t grain, Threads threads, ChunkBody body, void* context);
using StageBody = void (*)(void* context, std::size_t stage, std::size_t begin, std::size_t end);
void parallel_stages(std::span<const std::size_t> counts, std::size_t grain, Threads threads, StageBody body,
                     void* context);
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

/// A sequence of short loops on the same threads. Stage s is a loop over counts[s] items. Calls body(s, begin, end) for
/// parts of it; a stage starts when the stage before has ended. One thread gets a stage in one part, several get chunks
/// of `grain` items: the body's result must not depend on it. The body must not throw. Threads that wait for a stage
/// keep their core, so this is for stages of 1 to 100 us. Cost: some 0.3 us a stage. Throws as check_threads(), before
/// any stage.
template <class Body>
void parallel_stages(std::span<const std::size_t> counts, std::size_t grain, Threads threads, Body&& body) {
  using B = std::remove_reference_t<Body>;
  detail::parallel_stages(
      counts, grain, threads,
      [](void* context, std::size_t stage, std::size_t begin, std::size_t end) {
        (*static_cast<B*>(context))(stage, begin, end);
      },
      const_cast<std::remove_const_t<B>*>(&body));
}

/// The number of threads that a loop may use, where 0 stands for all.
unsigned thread_count(Threads threads);

/// Number of chunks that parallel_for makes.
constexpr std::size_t chunk_count(std::size_t count, std::size_t grain) { return (count + grain - 1) / grain; }

}  // namespace dartcast
