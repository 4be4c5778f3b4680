// Uses the installed package: makes a mesh and takes an exact sign that plain doubles get wrong.
#include <cstdio>

#include "dartcast/generators.hpp"
#include "dartcast/predicates.hpp"

int main() {
  const dartcast::MeshData bar = dartcast::generate_bar();
  std::printf("%zu cells\n", bar.cell_count());
  // The last point lies one unit in the last place above the plane x = y = z of the others' line.
  const dartcast::Sign sign =
      dartcast::orient3d({0.0, 0.0, 0.0}, {0.1, 0.1, 0.1}, {0.3, 0.3, 0.2}, {0.7, 0x1.6666666666667p-1, 0.5});
  std::printf("sign %d\n", static_cast<int>(sign));
  return 0;
}
