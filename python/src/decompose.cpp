// Binds dartcast/decompose.hpp.
#include "dartcast/decompose.hpp"

#include "bind.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::decompose {

void bind(py::module_& m) {
  Record<Ring>(m, "Ring").field("points", &Ring::points).field("name", &Ring::name).finish();
  Record<DecomposeOptions>(m, "DecomposeOptions")
      .field("with_outside", &DecomposeOptions::with_outside)
      .field("margin", &DecomposeOptions::margin)
      .field("max_corners", &DecomposeOptions::max_corners)
      .finish();
  m.def(
      "decompose",
      [](const std::vector<Ring>& rings, const DecomposeOptions& options) {
        const DecomposeOptions own = options;
        const py::gil_scoped_release release;
        return dartcast::decompose(rings, own);
      },
      py::arg("rings"), py::arg("options") = DecomposeOptions{}, doc("decompose"));
}

}  // namespace dartcast::python::decompose
