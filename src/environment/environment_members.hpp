// The members of an environment, and the checks on the sets of particles given to it.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "dartcast/cell_complex.hpp"
#include "dartcast/complex_edit.hpp"
#include "dartcast/environment.hpp"
#include "tracking/locate.hpp"
#include "tracking/tallied.hpp"

namespace dartcast::detail {
class BatchStepper;
}  // namespace dartcast::detail

namespace dartcast {

/// An environment of cells that were once valid, in positions that they have come to: corners may turn inwards if all
/// simplices are positive. Throws InvalidMesh as Environment's constructor for all other defects.
std::unique_ptr<Environment> environment_as_it_is(const MeshData& mesh);

struct Environment::Members {
  Members(const MeshData& checked_mesh, Threads all);

  /// Throws InvalidMesh if cells have no positive simplices.
  static CellComplex valid_complex(const MeshData& checked_mesh, Threads threads);
  /// Makes an empty set one of this environment, as it is now.
  void adopt(Particles& particles) const;
  // These three throw InvalidArgument, with the name of the call. The first refuses sets of other environments, and
  // those that have missed a move or an edit.
  void check_known(const Particles& particles, const char* call) const;
  void check_edit_followed(const Particles& particles, const char* call) const;
  void check_current(const Particles& particles) const;
  void check_positions(std::span<const Vec3> positions) const;
  [[nodiscard]] std::vector<Vec3> with_steiner_points(std::span<const Vec3> positions) const;
  void add_to(Particles& particles, SimplexId simplex, const Vec3& position) const;
  void add_at(Particles& particles, SimplexId simplex, const Weights& weights) const;
  /// Precondition: check_advance() passes.
  StepReport advance(Particles& particles, std::span<const Vec3> targets, const detail::BatchStepper& stepper) const;

  /// Calls take(respond), which takes the step; watched, if there is a replay hook.
  template <class Callback, class Take>
  StepReport watched(const Environment& environment, Particles& particles, std::span<const Vec3> targets,
                     const StepOptions& options, const Callback& respond, const Take& take, bool simultaneous) const;

  CellComplex complex;
  Threads threads;
  std::uint64_t id;
  std::uint64_t moves = 0;
  std::uint64_t edits = 0;
  std::uint64_t moves_at_edit = 0;  ///< when the last edit was made
  ComplexEditReport last_edit;
  std::vector<Vec3> replaced_positions;  ///< of the mesh that the last edit replaced
  ReplayHook replay_hook;
  detail::Tallied tallied;
  CrossingCallback crossed;
  std::unique_ptr<Locator> locator;  ///< of the current positions, made by the first locate()
};

}  // namespace dartcast
