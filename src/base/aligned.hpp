// A vector whose storage starts on a cache line, so that a 64-byte record never straddles two; some bytes behind its
// last element can be read, so that vector instructions may load more than they use.
#pragma once

#include <cstddef>
#include <vector>

namespace dartcast {

namespace detail {
// On a cache line; large arrays on huge pages where the system has them: without, most of the time in a large scene
// goes into finding pages.
void* allocate_aligned(std::size_t bytes);
void deallocate_aligned(void* p, std::size_t bytes) noexcept;
}  // namespace detail

template <class T>
struct CacheLineAllocator {
  using value_type = T;
  CacheLineAllocator() = default;
  template <class U>
  // NOLINTNEXTLINE(google-explicit-constructor): allocators rebind by conversion
  constexpr CacheLineAllocator(const CacheLineAllocator<U>&) noexcept {}

  static constexpr std::size_t readable_behind = 64;

  [[nodiscard]] T* allocate(std::size_t n) {
    return static_cast<T*>(detail::allocate_aligned(n * sizeof(T) + readable_behind));
  }
  void deallocate(T* p, std::size_t n) noexcept { detail::deallocate_aligned(p, n * sizeof(T) + readable_behind); }
  constexpr bool operator==(const CacheLineAllocator&) const = default;
};

template <class T>
using AlignedVector = std::vector<T, CacheLineAllocator<T>>;

}  // namespace dartcast
