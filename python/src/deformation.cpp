// Binds dartcast/deformation.hpp.
//
// A thread of the library may read frames by a function of Python. It needs Python's lock for that, so a call that
// waits for a frame, or for the end of that thread, has released the lock.
#include "dartcast/deformation.hpp"

#include <optional>

#include "bind.hpp"
#include "support/edit_reports.hpp"
#include "support/motions.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::deformation {
namespace {

constexpr const char* the_deformation = "the deformation";

// The destructor waits for the thread that reads ahead.
std::shared_ptr<DeformationHandle> make(Deformation&& deformation) {
  return {new DeformationHandle{std::move(deformation), {}}, [](DeformationHandle* h) {
            const py::gil_scoped_release release;
            delete h;
          }};
}

void bind_steps(py::module_& m) {
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
  m.def("deformation_kind", &deformation_kind, py::arg("name"), doc("deformation_kind"));
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
      .field("interpolation", &DeformationStep::interpolation)
      .field("cycle", &DeformationStep::cycle)
      .field("reader", &DeformationStep::reader)
      .finish();
}

py::object positions(const DeformationHandle& h, double time, const py::object& given, Threads threads) {
  check_threads(threads);
  const Use use(h.usage, the_deformation);
  py::object out =
      given.is_none()
          ? py::object(py::array_t<double>({static_cast<py::ssize_t>(h.deformation.size()), py::ssize_t{3}}))
          : given;
  const std::span<Vec3> written = writable_vectors(out, "out");
  const py::gil_scoped_release release;
  h.deformation.positions(time, written, threads);
  return out;
}

void update_after_edit(DeformationHandle& h, const ComplexEditReport& edit, std::size_t size) {
  const Use use(h.usage, the_deformation);
  if (size < h.deformation.size())
    throw InvalidArgument("size: an edit leaves at least as many positions as before, " +
                          std::to_string(h.deformation.size()) + "; got " + std::to_string(size));
  expect_report(edit, size);
  h.deformation.update_after_edit(edit, size);
}

}  // namespace

void bind(py::module_& m) {
  bind_steps(m);
  py::class_<DeformationHandle, std::shared_ptr<DeformationHandle>> c(m, "Deformation", doc("Deformation"));
  c.def(py::init([](const std::vector<DeformationStep>& steps, const py::object& given) {
          const auto rest = vectors(given, "rest");
          const py::gil_scoped_release release;
          return make(Deformation(steps, rest));
        }),
        py::arg("steps"), py::arg("rest"), doc("Deformation::Deformation"));
  const auto size = [](const DeformationHandle& h) { return h.deformation.size(); };
  c.def("__len__", size);
  c.def_property_readonly("size", size, "The number of positions.");
  const auto copy = [](const DeformationHandle& h) {
    const Use use(h.usage, the_deformation);
    return make(Deformation(h.deformation));
  };
  c.def("__copy__", copy);
  c.def("__deepcopy__", [copy](const DeformationHandle& h, const py::dict& /*memo*/) { return copy(h); });
  c.def(
      "check_plane",
      [](DeformationHandle& h) {
        const Use use(h.usage, the_deformation);
        const py::gil_scoped_release release;
        h.deformation.check_plane();
      },
      doc("Deformation::check_plane"));
  c.def("update_after_edit", &update_after_edit, py::arg("edit"), py::arg("size"),
        doc("Deformation::update_after_edit"));
  c.def(
      "add_pull",
      [](DeformationHandle& h, const py::object& given, double begin, double end) {
        const auto displacement = vectors(given, "displacement");
        const Use use(h.usage, the_deformation);
        const py::gil_scoped_release release;
        h.deformation.add_pull(displacement, begin, end);
      },
      py::arg("displacement"), py::arg("begin"), py::arg("end"), doc("Deformation::add_pull"));
  c.def(
      "load_frames",
      [](const DeformationHandle& h, double time) {
        const Use use(h.usage, the_deformation);
        const py::gil_scoped_release release;
        h.deformation.load_frames(time);
      },
      py::arg("time"), doc("Deformation::load_frames"));
  c.def("positions", &positions, py::arg("time"), py::arg("out") = py::none(), py::arg("threads") = Threads{},
        (std::string(doc("Deformation::positions")) +
         "\n\nout: float64 (size, 3), written in place and returned; None: a fresh array.")
            .c_str());
}

}  // namespace dartcast::python::deformation
