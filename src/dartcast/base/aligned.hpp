// A vector whose storage starts on a cache line, so that a 64-byte record never straddles two; some bytes behind its
// last element can be read, so that vector instructions may load more than they use.
#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace dartcast {

template <class T>
struct CacheLineAllocator {
  using value_type = T;
  static constexpr std::align_val_t alignment{64};

  CacheLineAllocator() = default;
  template <class U>
  // NOLINTNEXTLINE(google-explicit-constructor): allocators rebind by conversion
  constexpr CacheLineAllocator(const CacheLineAllocator<U>&) noexcept {}

  static constexpr std::size_t readable_behind = 64;

  [[nodiscard]] T* allocate(std::size_t n) {
    return static_cast<T*>(::operator new(n * sizeof(T) + readable_behind, alignment));
  }
  void deallocate(T* p, std::size_t) noexcept { ::operator delete(p, alignment); }
  constexpr bool operator==(const CacheLineAllocator&) const = default;
};

template <class T>
using AlignedVector = std::vector<T, CacheLineAllocator<T>>;

}  // namespace dartcast
