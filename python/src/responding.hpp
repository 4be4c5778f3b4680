// What a step is told about responses: those of the library with the arrays that they write, or functions of Python.
#pragma once

#include <pybind11/pybind11.h>

#include <optional>
#include <span>
#include <vector>

#include "dartcast/combinatorial_map.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/response.hpp"

namespace dartcast::python {

/// The arguments of a step besides the targets.
struct StepArguments {
  pybind11::object velocities;
  pybind11::object statuses;
  double dt = 1.0;
  Acceleration acceleration;
  bool per_contact = false;
  StepOptions options;
};

/// The arrays that a response of the library writes: those of the caller, or its own where none are given.
class ResponseArrays {
 public:
  /// Throws where an array does not fit the particles, or dt is not positive.
  ResponseArrays(const StepArguments& call, const Particles& particles, std::span<const Vec3> targets);

  [[nodiscard]] std::span<Vec3> velocities() const { return velocities_; }
  [[nodiscard]] std::span<ParticleStatus> statuses() const { return statuses_; }

 private:
  std::vector<Vec3> own_velocities_;
  std::vector<ParticleStatus> own_statuses_;
  std::span<Vec3> velocities_;
  std::span<ParticleStatus> statuses_;
};

/// One response for all walls, or a dict by the patches' names, where "" stands for all other walls. None: it is neither.
std::optional<WallResponses> library_responses(const pybind11::object& respond, const CombinatorialMap& map);

/// Throws TypeError where a response is nothing that can be called.
void require_function(const pybind11::object& respond);

}  // namespace dartcast::python
