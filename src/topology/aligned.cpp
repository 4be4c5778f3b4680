// Memory that starts on a cache line, on huge pages if it is large.
#include <cstdint>
#include <new>

#include "dartcast/storage.hpp"

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace dartcast::detail {

namespace {

constexpr std::align_val_t cache_line{64};

#if defined(__linux__)

constexpr std::size_t huge_page = std::size_t{1} << 21U;

std::size_t whole_pages(std::size_t bytes) {
  constexpr std::size_t page = huge_page;
  return (bytes + page - 1) / page * page;
}

// Large arrays come from the system itself. Memory from the heap may already have small pages, which stay small. The
// result starts on a huge page.
void* map_pages(std::size_t bytes) {
  const std::size_t size = whole_pages(bytes);
  const std::size_t room = size + huge_page;
  void* p = ::mmap(nullptr, room, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (p == MAP_FAILED) throw std::bad_alloc();
  auto* const begin = static_cast<char*>(p);
  const std::size_t before = (huge_page - reinterpret_cast<std::uintptr_t>(begin) % huge_page) % huge_page;
  if (before > 0) ::munmap(begin, before);
  if (before < huge_page) ::munmap(begin + before + size, huge_page - before);
  ::madvise(begin + before, size, MADV_HUGEPAGE);  // advice: without it everything works the same
  return begin + before;
}

#endif

}  // namespace

void* allocate_aligned(std::size_t bytes) {
#if defined(__linux__)
  if (bytes >= huge_page) return map_pages(bytes);
#endif
  return ::operator new(bytes, cache_line);
}

void deallocate_aligned(void* p, [[maybe_unused]] std::size_t bytes) noexcept {
#if defined(__linux__)
  if (bytes >= huge_page) {
    ::munmap(p, whole_pages(bytes));
    return;
  }
#endif
  ::operator delete(p, cache_line);
}

}  // namespace dartcast::detail
