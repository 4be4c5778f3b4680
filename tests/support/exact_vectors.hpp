// Vectors of exact numbers: integers of the lattice, or dyadic numbers.
#pragma once

#include <array>

namespace dartcast::test {

template <class T>
using Exact3 = std::array<T, 3>;

template <class T>
Exact3<T> minus(const Exact3<T>& a, const Exact3<T>& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <class T>
Exact3<T> cross(const Exact3<T>& a, const Exact3<T>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
template <class T>
T dot(const Exact3<T>& a, const Exact3<T>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

}  // namespace dartcast::test
