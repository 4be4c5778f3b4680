// Binds dartcast/deformation.hpp.
//
// A thread of the library may read frames by a function of Python. It needs Python's lock for that, so a call that
// waits for a frame, or for the end of that thread, has released the lock.
#include "dartcast/deformation.hpp"

#include "bind.hpp"
#include "support/edit_reports.hpp"
#include "support/members.hpp"
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

void bind_steps(py::module_& m) { m.def("deformation_kind", &deformation_kind, about("deformation_kind")); }

Typed<"Points"> positions(const DeformationHandle& h, double time, const Typed<"Points | None">& given,
                          Threads threads) {
  check_threads(threads);
  const Use use(h.usage, the_deformation);
  py::object out =
      given.is_none()
          ? py::object(py::array_t<double>({static_cast<py::ssize_t>(h.deformation.size()), py::ssize_t{3}}))
          : py::object(given);
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
  c.def(py::init([](const std::vector<DeformationStep>& steps, const Typed<"Points">& given) {
          const auto rest = vectors(given, "rest");
          const py::gil_scoped_release release;
          return make(Deformation(steps, rest));
        }),
        about("Deformation::Deformation"));
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
      "check_plane", [](DeformationHandle& h) { change(h, [](Deformation& d) { d.check_plane(); }); },
      doc("Deformation::check_plane"));
  c.def("update_after_edit", &update_after_edit, about("Deformation::update_after_edit"));
  members_of_Deformation(c);
  c.def(
      "load_frames", [](DeformationHandle& h, double time) { change(h, [&](Deformation& d) { d.load_frames(time); }); },
      about("Deformation::load_frames"));
  c.def("positions", &positions, py::arg("time"), py::arg("out") = py::none(), py::arg("threads") = Threads{},
        about("Deformation::positions", "out: float64 (size, 3), written in place and returned; None: a fresh array."));
}

}  // namespace dartcast::python::deformation
