// Binds dartcast/deformation.hpp. A reader of frames may be a function of Python: it is called by another thread.
#include "dartcast/deformation.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "bind.hpp"
#include "motion_handles.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python {
namespace {

constexpr const char* the_deformation = "the Deformation";
using Class = py::class_<DeformationHandle, std::shared_ptr<DeformationHandle>>;

void bind_step_record(py::module_& m) {
  Record<DeformationStep>(m, "DeformationStep")
      .field("kind", &DeformationStep::kind)
      .field("amplitude", &DeformationStep::amplitude)
      .field("period", &DeformationStep::period)
      .field("axis", &DeformationStep::axis)
      .field("centre", &DeformationStep::centre)
      .field("direction", &DeformationStep::direction)
      .field("length", &DeformationStep::length)
      .field("wavelength", &DeformationStep::wavelength)
      .field("field", &DeformationStep::field)
      .field("path", &DeformationStep::path)
      .field("times", &DeformationStep::times)
      .field("frames", &DeformationStep::frames)
      .field("reader", &DeformationStep::reader)
      .finish();
}

py::array positions(DeformationHandle& h, double time, Threads threads) {
  const Use use(*h.usage, the_deformation);
  std::vector<Vec3> out(h.deformation.size());
  {
    const py::gil_scoped_release release;
    h.deformation.positions(time, out, threads);
  }
  return array_of(std::span<const Vec3>(out));
}

void add_changes(Class& c) {
  c.def(
      "check_plane",
      [](DeformationHandle& h) {
        const Use use(*h.usage, the_deformation);
        h.deformation.check_plane();
      },
      doc("Deformation::check_plane"));
  c.def(
      "update_after_edit",
      [](DeformationHandle& h, const ComplexEditReport& edit, std::size_t size) {
        require_edit(edit, size);
        const Use use(*h.usage, the_deformation);
        h.deformation.update_after_edit(edit, size);
      },
      py::arg("edit"), py::arg("size"), doc("Deformation::update_after_edit"));
  c.def(
      "add_pull",
      [](DeformationHandle& h, const py::object& displacement, double begin, double end) {
        const auto vertices = vectors(displacement, "displacement");
        const Use use(*h.usage, the_deformation);
        h.deformation.add_pull(vertices, begin, end);
      },
      py::arg("displacement"), py::arg("begin"), py::arg("end"), doc("Deformation::add_pull"));
  c.def(
      "load_frames",
      [](DeformationHandle& h, double time) {
        const Use use(*h.usage, the_deformation);
        const py::gil_scoped_release release;
        h.deformation.load_frames(time);
      },
      py::arg("time"), doc("Deformation::load_frames"));
}

}  // namespace

void require_edit(const ComplexEditReport& edit, std::size_t size) {
  const auto is_older = [&](Vertex v) { return v.value < size; };
  for (const PlacedVertex& p : edit.placed) {
    const bool fits =
        !p.of.empty() && p.of.size() == p.weights.size() && std::all_of(p.of.begin(), p.of.end(), is_older);
    if (!fits) {
      throw InvalidArgument("update_after_edit: the edit places vertex " + std::to_string(p.vertex.value) +
                            " between vertices that there are not: it is of another environment");
    }
  }
}

void bind_deformation(py::module_& m) {
  bind_enum<DeformationKind>(m, "DeformationKind",
                             {{"ROTATE", DeformationKind::rotate},
                              {"SWING", DeformationKind::swing},
                              {"BEND", DeformationKind::bend},
                              {"TWIST", DeformationKind::twist},
                              {"STRETCH", DeformationKind::stretch},
                              {"PULSE", DeformationKind::pulse},
                              {"BUMP", DeformationKind::bump},
                              {"FRAMES", DeformationKind::frames}});
  m.attr("FRAME_MEMORY") = frame_memory;
  m.attr("MAX_FRAMES_HELD") = max_frames_held;
  bind_step_record(m);
  Class c(m, "Deformation", doc("Deformation"));
  c.def(py::init([](const std::vector<DeformationStep>& steps, const py::object& rest) {
          return std::make_shared<DeformationHandle>(DeformationHandle{Deformation(steps, vectors(rest, "rest"))});
        }),
        py::arg("steps"), py::arg("rest"), doc("Deformation::Deformation"));
  c.def("__len__", [](const DeformationHandle& h) { return h.deformation.size(); });
  c.def("positions", &positions, py::arg("time"), py::arg("threads") = 0,
        (std::string(doc("Deformation::positions")) + "\n\nReturns float64 (n, 3).").c_str());
  add_changes(c);
}

}  // namespace dartcast::python
