#include "support/remesh_checks.hpp"

#include <gtest/gtest.h>

namespace dartcast::test {

void expect_sound(const CellComplex& complex) {
  const auto violations = check_integrity(complex.map(), 3);
  for (const Violation& v : violations) ADD_FAILURE() << v.constraint << ": " << v.message;
  const Validity validity = check_validity(complex, Threads{1}, 3);
  for (const InvalidCell& c : validity.first) ADD_FAILURE() << c.message;
}

std::vector<std::string> written(const CombinatorialMap& map) {
  return written(map, [](Vertex v) { return std::to_string(v.value); });
}

std::vector<std::string> written_by_place(const CellComplex& complex) {
  return written(complex.map(), [&](Vertex v) {
    const Vec3 x = complex.positions()[v.value];
    return std::to_string(x.x) + "," + std::to_string(x.y) + "," + std::to_string(x.z);
  });
}

}  // namespace dartcast::test
