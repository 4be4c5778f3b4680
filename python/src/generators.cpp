// Binds dartcast/generators.hpp. Each generator takes its options as a record, or the members of that by name.
#include "dartcast/generators.hpp"

#include "bind.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::generators {
namespace {

template <class Options>
void bind_generator(py::module_& m, const char* name, MeshData (*generate)(const Options&)) {
  const std::string text = std::string(doc(name)) + "\n\nThe options may also be given by name, without a record.";
  m.def(
      name,
      [generate](const std::optional<Options>& options, const py::kwargs& named) {
        if (options && !named.empty()) throw py::type_error("give the options as a record or by name, not both");
        Options chosen{};
        if (options) {
          chosen = *options;
        } else if (!named.empty()) {
          chosen = py::type::of<Options>()(**named).template cast<Options>();
        }
        const py::gil_scoped_release release;
        return generate(chosen);
      },
      py::arg("options") = py::none(), text.c_str());
}

}  // namespace

void bind(py::module_& m) {
  bind_generator(m, "generate_box", &generate_box);
  bind_generator(m, "generate_octahedra", &generate_octahedra);
  bind_generator(m, "generate_vessel", &generate_vessel);
  bind_generator(m, "generate_barrel", &generate_barrel);
  bind_generator(m, "generate_rectangle", &generate_rectangle);
  bind_generator(m, "generate_maze", &generate_maze);
}

}  // namespace dartcast::python::generators
