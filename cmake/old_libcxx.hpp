// Included before all else if emscripten's libc++ is old: what it lacks of C++20, for one thread.
#pragma once
#include <version>
#if defined(_LIBCPP_VERSION) && _LIBCPP_VERSION < 20000
#include <atomic>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <string>

namespace std {

#ifndef __cpp_lib_bit_cast
template <class To, class From>
constexpr To bit_cast(const From& from) noexcept {
  return __builtin_bit_cast(To, from);
}
#endif

#ifndef __cpp_lib_atomic_ref
template <class T>
class atomic_ref {
 public:
  explicit atomic_ref(T& object) : object_(object) {}
  T fetch_add(T more, memory_order /*order*/) { return __atomic_fetch_add(&object_, more, __ATOMIC_RELAXED); }

 private:
  T& object_;
};
#endif

// Decimal numbers, inf and nan, as in the general format. musl's strtod() rounds correctly.
template <class Real>
requires is_floating_point_v<Real> from_chars_result from_chars(const char* first, const char* last, Real& value) {
  const string text(first, last);
  const size_t digits = text.starts_with('-') ? 1 : 0;
  if (text.find_first_of("+ \t\n\v\f\r") == digits || text.find('-', digits) == digits)
    return {first, errc::invalid_argument};
  if (text.find_first_of("xX") == digits + 1) {  // hexadecimal is another format: the 0 alone is read
    value = digits == 1 ? Real(-0.0) : Real(0.0);
    return {first + digits + 1, errc()};
  }
  char* end = nullptr;
  errno = 0;
  const Real read = is_same_v<Real, float> ? static_cast<Real>(strtof(text.c_str(), &end))
                                           : static_cast<Real>(strtod(text.c_str(), &end));
  if (end == text.c_str()) return {first, errc::invalid_argument};
  if (errno == ERANGE) return {first + (end - text.c_str()), errc::result_out_of_range};
  value = read;
  return {first + (end - text.c_str()), errc()};
}

}  // namespace std
#endif
