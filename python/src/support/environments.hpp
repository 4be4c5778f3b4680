// Calls on environments and particles, from several files.
#pragma once

#include <memory>

#include "support/handles.hpp"
#include "support/python.hpp"
#include "support/respond.hpp"

namespace dartcast::python {

using EnvironmentPointer = std::shared_ptr<EnvironmentHandle>;
using ParticlesPointer = std::shared_ptr<ParticlesHandle>;

/// The result of add(): bool (n,), whether each position was added; uint32 (m,), the indices of those that were.
using Added = Typed<"tuple[NDArray[bool], NDArray[uint32]]">;
/// Warns if more than half were not.
Added added_of(std::span<const AddResult> results);

/// An environment and particles for the time of one call.
struct UseBoth {
  Use environment;
  Use particles;

  UseBoth(const EnvironmentHandle& e, const ParticlesHandle& p)
      : environment(*e.usage, "the environment"), particles(*p.usage, "the set of particles") {}
};

/// Throws InvalidArgument while a next_points() block is open, and if the particles need positions that a block has
/// overwritten.
void expect_positions_before(const EnvironmentHandle& e, const ParticlesHandle& p, const char* call);

/// Parameters of a call that answers contacts.
#define DARTCAST_RESPOND_PARAMETERS                                                                       \
  const RespondArgument &respond, const VelocitiesArgument &velocities, const StatusesArgument &statuses, \
      const TimeArgument &dt, const AccelerationArgument &acceleration, bool per_contact, const StepOptions &options
/// The answers' arguments of a call, by name, for the last arguments of its definition.
#define DARTCAST_RESPOND_ARGUMENTS                                                                                  \
  pybind11::arg("respond") = pybind11::none(), pybind11::kw_only(), pybind11::arg("velocities") = pybind11::none(), \
  pybind11::arg("statuses") = pybind11::none(), pybind11::arg("dt") = pybind11::none(),                             \
  pybind11::arg("acceleration") = pybind11::none(), pybind11::arg("per_contact") = false,                           \
  pybind11::arg("options") = StepOptions {}

/// How docstrings explain these arguments.
extern const char* const respond_text;

/// Targets that a function of Python cannot change while the call runs.
class Targets {
 public:
  Targets(const pybind11::object& given, const RespondArguments& arguments, const char* name = "targets");
  [[nodiscard]] std::span<const Vec3> get() const { return targets_; }

 private:
  std::vector<Vec3> own_;
  std::span<const Vec3> targets_;
};

namespace particles {
void bind(pybind11::module_& m);
}
using EnvironmentClass = pybind11::class_<EnvironmentHandle, EnvironmentPointer>;
namespace environment_adding {
void bind(EnvironmentClass& c);
}
namespace environment_moves {
void bind(pybind11::module_& m, EnvironmentClass& c);
}
namespace environment_steps {
void bind(EnvironmentClass& c);
}

}  // namespace dartcast::python
