// An environment that ranks share by cells: each has a part of it, and the particles there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "dartcast/audit.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/mesh_part.hpp"
#include "dartcast/ranks.hpp"

namespace dartcast {

/// The particles of a SharedEnvironment in this rank's own cells, by id. One that goes to another rank takes its id along,
/// and the numbers that its user keeps.
class SharedParticles {
 public:
  /// `width`: numbers of the user for each particle: the same on all ranks.
  explicit SharedParticles(std::size_t width = 0);
  SharedParticles(const SharedParticles& other);
  SharedParticles& operator=(const SharedParticles& other);
  // One that was moved from can only be assigned to.
  SharedParticles(SharedParticles&& other) noexcept;
  SharedParticles& operator=(SharedParticles&& other) noexcept;
  ~SharedParticles();

  [[nodiscard]] std::size_t size() const { return particles_.size(); }
  /// Cells are those of the rank's own map: SharedEnvironment::whole() gives their handles in the whole.
  [[nodiscard]] const Particles& particles() const { return particles_; }
  /// In the order of adding, from 0.
  [[nodiscard]] std::span<const std::uint64_t> ids() const;
  [[nodiscard]] std::size_t width() const { return width_; }
  /// Precondition: there is a particle of this index.
  [[nodiscard]] std::span<double> user_data(std::size_t particle);
  [[nodiscard]] std::span<const double> user_data(std::size_t particle) const;

 private:
  friend class SharedEnvironment;
  struct Beside;

  std::size_t width_;
  Particles particles_;
  std::unique_ptr<Beside> beside_;
  std::uint64_t next_id_ = 0;
};

/// The results of one step on this rank.
struct SharedStep {
  /// The contacts and particles here. It names them by their index during the step.
  StepReport report;
  std::vector<std::uint64_t> contact_ids;  ///< the id of each contact's particle
  std::uint64_t left = 0;                  ///< particles that have gone to other ranks
  std::uint64_t come = 0;
};

/// Steps as those of an Environment of the whole mesh, to the same bits, for points in space. Positions, cells, contacts and
/// their order for each particle do not depend on the parts, or on their number.
///
/// Every function that is not const is collective, and so is a const one that says so. All ranks call it, in the same
/// order, and wait for each other. A function that throws on one rank alone must be followed by Ranks::fail() there.
class SharedEnvironment {
 public:
  /// `ranks` outlive it. Throws as Environment(); InvalidArgument if the part is of another rank, in the plane, and if
  /// cells need Steiner points; InvalidMesh if the ranks' parts are not of one mesh.
  SharedEnvironment(MeshPart part, Ranks& ranks, Threads threads = {});
  SharedEnvironment(const SharedEnvironment&) = delete;
  SharedEnvironment& operator=(const SharedEnvironment&) = delete;
  ~SharedEnvironment();

  /// This rank's part. Its positions are in the order of the part's points, whose numbers in the whole it has.
  [[nodiscard]] const MeshPart& part() const;
  [[nodiscard]] const Environment& environment() const;
  /// The handle in the map of the whole mesh, of a cell of environment().
  [[nodiscard]] Cell whole(Cell here) const;

  /// As Environment::add(), with the same positions on all ranks: the one that has the cell adds the particle, of the next id.
  /// Returns where each is. Throws as Environment::add(), nothing added.
  std::vector<Place> add(SharedParticles& particles, std::span<const Vec3> positions);

  /// As Environment::move(): new positions of the part's points, ghosts included. Precondition: all ranks that have a point
  /// give it the same position.
  void move(std::span<const Vec3> positions);

  /// As Environment::advance(), with a target for each particle here. Then each particle is on the rank that has its cell, and
  /// indices have changed. `respond` is called on a rank that knows all cells around the contact, with an index into ids()
  /// as they are during the step. It uses one thread.
  SharedStep advance(SharedParticles& particles, std::span<const Vec3> targets, const ContactCallback& respond = {},
                     const StepOptions& options = {});

  /// The number of particles on all ranks.
  [[nodiscard]] std::uint64_t count(const SharedParticles& particles) const;
  /// Checks the particles of all ranks.
  [[nodiscard]] Audit audit(const SharedParticles& particles) const;

 private:
  struct Members;
  std::unique_ptr<Members> members_;
};

}  // namespace dartcast
