// Responses of a step: checks of the arrays that they write, and their names.
#include "responding.hpp"

#include <algorithm>
#include <string>

#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python {
namespace {

std::span<ParticleStatus> status_span(const py::object& x) {
  if (!py::isinstance<py::array_t<std::uint8_t>>(x) || !py::reinterpret_borrow<py::array>(x).writeable())
    refuse_array(x, "statuses", "a writable uint8 (n,) array", "numpy.zeros(n, dtype=numpy.uint8)");
  static_assert(sizeof(ParticleStatus) == 1);
  const auto values = marks(x, "statuses");
  if (std::any_of(values.begin(), values.end(), [](std::uint8_t v) { return v > 3; }))
    throw InvalidArgument("statuses: each is a ParticleStatus, from 0 to 3");
  return {reinterpret_cast<ParticleStatus*>(const_cast<std::uint8_t*>(values.data())), values.size()};
}

void require_size(const char* name, std::size_t given, std::size_t size) {
  if (given != size) {
    throw InvalidArgument(std::string(name) + ": " + std::to_string(given) + " for " + std::to_string(size) +
                          " particles: one for each is needed");
  }
}

// Those that lead to the targets in the time dt. The step refuses targets of another number, or not finite.
std::vector<Vec3> velocities_to(std::span<const Vec3> targets, const Particles& particles, double dt) {
  std::vector<Vec3> velocities(particles.size());
  for (std::size_t i = 0; i < std::min(velocities.size(), targets.size()); ++i)
    velocities[i] = (targets[i] - particles[i].position) * (1.0 / dt);
  return velocities;
}

}  // namespace

ResponseArrays::ResponseArrays(const StepArguments& call, const Particles& particles, std::span<const Vec3> targets) {
  if (!(call.dt > 0.0)) throw InvalidArgument("dt is " + std::to_string(call.dt) + ": it must be positive");
  if (call.velocities.is_none()) own_velocities_ = velocities_to(targets, particles, call.dt);
  velocities_ = call.velocities.is_none() ? own_velocities_ : writable_vectors(call.velocities, "velocities");
  if (call.statuses.is_none()) own_statuses_.resize(particles.size());
  statuses_ = call.statuses.is_none() ? own_statuses_ : status_span(call.statuses);
  require_size("velocities", velocities_.size(), particles.size());
  require_size("statuses", statuses_.size(), particles.size());
}

std::optional<WallResponses> library_responses(const py::object& respond, const CombinatorialMap& map) {
  if (py::isinstance<py::dict>(respond)) {
    const auto by_patch = py::reinterpret_borrow<py::dict>(respond);
    WallResponses responses;
    if (by_patch.contains("")) responses = WallResponses(by_patch[""].cast<WallResponse>());
    for (const auto& [name, response] : by_patch) {
      const auto text = name.cast<std::string>();
      if (!text.empty()) responses.set(map.patch(text), response.cast<WallResponse>());
    }
    return responses;
  }
  py::detail::make_caster<WallResponse> caster;
  if (!caster.load(respond, true)) return std::nullopt;
  return WallResponses(py::detail::cast_op<WallResponse&>(caster));
}

void require_function(const py::object& respond) {
  if (PyCallable_Check(respond.ptr()) != 0) return;
  throw py::type_error(
      "respond: expected None, a response such as Reflect(0.5), a dict of them by patch, or a function; got " +
      py::repr(respond).cast<std::string>());
}

}  // namespace dartcast::python
