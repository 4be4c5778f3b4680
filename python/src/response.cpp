// Binds dartcast/response.hpp.
#include "dartcast/response.hpp"

#include <algorithm>

#include "bind.hpp"
#include "support/map_checks.hpp"
#include "support/python.hpp"
#include "support/respond.hpp"

namespace py = pybind11;

namespace dartcast::python::response {
namespace {

// Where a call takes a WallResponse it takes these.
template <class... Response>
void convert_to_response() {
  (class_of<WallResponse>().def(py::init([](const Response& r) { return WallResponse(r); }), py::arg("response"),
                                py::prepend()),
   ...);
  (py::implicitly_convertible<Response, WallResponse>(), ...);
}

void bind_responses(py::module_& m) {
  py::class_<WallResponses>(m, "WallResponses",
                            about("WallResponses",
                                  "general: a response; or a dict of responses by the number of their patch, with the "
                                  "general one at None. With a map the keys may be names of its patches. Wherever a "
                                  "call takes WallResponses it takes a response or a dict, too."))
      .def(py::init([](const Typed<"Responses | None">& general, const MapHandle* map) {
             if (general.is_none()) return WallResponses();
             if (map == nullptr) return responses_of(general, nullptr);
             return read(*map, [&](const CombinatorialMap& patches) { return responses_of(general, &patches); });
           }),
           py::arg("general") = py::none(), py::arg("map") = py::none(), doc("WallResponses::WallResponses"))
      .def(
          "set",
          [](WallResponses& r, Patch patch, const Typed<"WallResponse">& response) {
            WallResponse one;
            if (!load_response(response, one)) refuse_member("response", "a response such as Reflect(0.5)", response);
            r.set(patch, one);
          },
          py::arg("patch"), py::arg("response"), "Gives a patch its response.")
      .def(
          "of", [](const WallResponses& r, Patch patch) { return r.of(patch); }, py::arg("patch"),
          "The response of a patch.");
}

void bind_callback(py::module_& m) {
  const py::class_<LibraryAnswers, std::shared_ptr<LibraryAnswers>> callback(
      m, "ContactCallback", "What respond_with() makes: to be passed as `respond`.");
  m.def(
      "respond_with",
      [](const Typed<"Responses">& responses, const Typed<"Points">& velocities,
         const Typed<"NDArray[uint8] | None">& statuses, double dt, const Acceleration& acceleration) {
        return std::make_shared<LibraryAnswers>(responses_of(responses, nullptr), velocities, statuses, dt,
                                                acceleration);
      },
      py::arg("responses"), py::arg("velocities"), py::arg("statuses"), py::arg("dt"),
      py::arg("acceleration") = Acceleration(),
      about(
          "respond_with",
          "velocities: float64 (n, 3), written in place. statuses: uint8 (n,) of ParticleStatus, written in place; or "
          "None. The arrays are kept alive. advance(..., respond=Reflect(0.5), velocities=v, dt=dt) does the same."));
}

// Every index that hold_stopped() reads must be below the number of velocities.
void expect_report_of(const StepReport& report, std::size_t count) {
  const auto fits = [count](const auto& item) { return item.particle < count; };
  if (std::all_of(report.contacts.contacts.begin(), report.contacts.contacts.end(), fits) &&
      std::all_of(report.stopped.begin(), report.stopped.end(), fits))
    return;
  throw InvalidArgument("hold_stopped: the report names a particle that has no velocity: give one for each particle");
}

void bind_functions(py::module_& m) {
  m.def(
      "hold_stopped",
      [](const StepReport& report, const Typed<"Responses">& responses, const Typed<"NDArray[float64]">& given,
         const Typed<"NDArray[uint8] | None">& statuses, double dt, const Acceleration& acceleration) {
        const auto velocities = writable_vectors(given, "velocities");
        const std::vector<ParticleStatus> alive(statuses.is_none() ? velocities.size() : 0);
        const auto now = statuses.is_none() ? std::span<const ParticleStatus>(alive) : statuses_of(statuses);
        if (now.size() != velocities.size())
          throw InvalidArgument("hold_stopped: one velocity and one status per particle are needed");
        expect_report_of(report, velocities.size());
        hold_stopped(report, responses_of(responses, nullptr), velocities, now, dt, acceleration);
      },
      about("hold_stopped",
            "velocities: float64 (n, 3), written in place. statuses: uint8 (n,), or None where all are alive."));
  m.def(
      "reflected",
      [](const Vec3& v, const std::vector<WallHit>& walls, double restitution, double friction) {
        return reflected(v, walls, restitution, friction);
      },
      py::arg("v"), py::arg("walls"), py::arg("restitution"), py::arg("friction"), doc("reflected"));
  m.def(
      "slid",
      [](const Vec3& v, const std::vector<WallHit>& walls, const std::vector<WallHit>& earlier) {
        return slid(v, walls, earlier);
      },
      py::arg("v"), py::arg("walls"), py::arg("earlier"), doc("slid"));
}

}  // namespace

void bind(py::module_& m) {
  convert_to_response<Reflect, Slide, Stick, Absorb, Escape>();
  bind_responses(m);
  bind_callback(m);
  bind_functions(m);
}

}  // namespace dartcast::python::response
