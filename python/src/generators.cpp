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

void bind_boxes(py::module_& m) {
  Record<BoxOptions>(m, "BoxOptions")
      .field("cells", &BoxOptions::cells)
      .field("origin", &BoxOptions::origin)
      .field("size", &BoxOptions::size)
      .field("type", &BoxOptions::type)
      .field("mixed", &BoxOptions::mixed)
      .field("blocked_layer", &BoxOptions::blocked_layer)
      .field("blocked_share", &BoxOptions::blocked_share)
      .field("jitter", &BoxOptions::jitter)
      .field("seed", &BoxOptions::seed)
      .finish();
  bind_generator(m, "generate_box", &generate_box);
  m.def("bar_options", &bar_options, doc("bar_options"));
  m.def("generate_bar", &generate_bar, py::call_guard<py::gil_scoped_release>(), doc("generate_bar"));
  Record<OctahedraOptions>(m, "OctahedraOptions")
      .field("cells", &OctahedraOptions::cells)
      .field("origin", &OctahedraOptions::origin)
      .field("size", &OctahedraOptions::size)
      .field("blocked_layer", &OctahedraOptions::blocked_layer)
      .field("blocked_share", &OctahedraOptions::blocked_share)
      .field("seed", &OctahedraOptions::seed)
      .finish();
  bind_generator(m, "generate_octahedra", &generate_octahedra);
}

void bind_vessels(py::module_& m) {
  Record<VesselOptions>(m, "VesselOptions")
      .field("radius", &VesselOptions::radius)
      .field("trunk_length", &VesselOptions::trunk_length)
      .field("branch_lengths", &VesselOptions::branch_lengths)
      .field("branch_radius", &VesselOptions::branch_radius)
      .field("branch_angle", &VesselOptions::branch_angle)
      .field("out_of_plane", &VesselOptions::out_of_plane)
      .field("tissue_thickness", &VesselOptions::tissue_thickness)
      .field("core", &VesselOptions::core)
      .field("rings", &VesselOptions::rings)
      .field("tissue_layers", &VesselOptions::tissue_layers)
      .field("step_length", &VesselOptions::step_length)
      .field("peak_speed", &VesselOptions::peak_speed)
      .finish();
  bind_generator(m, "generate_vessel", &generate_vessel);
  Record<BarrelOptions>(m, "BarrelOptions")
      .field("height", &BarrelOptions::height)
      .field("radius", &BarrelOptions::radius)
      .field("bulge", &BarrelOptions::bulge)
      .field("staves", &BarrelOptions::staves)
      .field("rows", &BarrelOptions::rows)
      .field("rings", &BarrelOptions::rings)
      .field("centre", &BarrelOptions::centre)
      .finish();
  bind_generator(m, "generate_barrel", &generate_barrel);
}

void bind_planar(py::module_& m) {
  m.attr("LARGEST_SQUARE_JITTER") = largest_square_jitter;
  m.attr("LARGEST_POLYGON_JITTER") = largest_polygon_jitter;
  Record<RectangleOptions>(m, "RectangleOptions")
      .field("cells", &RectangleOptions::cells)
      .field("origin", &RectangleOptions::origin)
      .field("size", &RectangleOptions::size)
      .field("type", &RectangleOptions::type)
      .field("mixed", &RectangleOptions::mixed)
      .field("blocked_share", &RectangleOptions::blocked_share)
      .field("jitter", &RectangleOptions::jitter)
      .field("seed", &RectangleOptions::seed)
      .finish();
  bind_generator(m, "generate_rectangle", &generate_rectangle);
  Record<MazeOptions>(m, "MazeOptions")
      .field("rooms", &MazeOptions::rooms)
      .field("room_cells", &MazeOptions::room_cells)
      .field("door_cells", &MazeOptions::door_cells)
      .field("obstacles", &MazeOptions::obstacles)
      .field("extra_doors", &MazeOptions::extra_doors)
      .field("origin", &MazeOptions::origin)
      .field("size", &MazeOptions::size)
      .field("type", &MazeOptions::type)
      .field("mixed", &MazeOptions::mixed)
      .field("jitter", &MazeOptions::jitter)
      .field("seed", &MazeOptions::seed)
      .finish();
  bind_generator(m, "generate_maze", &generate_maze);
}

}  // namespace

void bind(py::module_& m) {
  bind_boxes(m);
  bind_vessels(m);
  bind_planar(m);
}

}  // namespace dartcast::python::generators
