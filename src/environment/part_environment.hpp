// Steps in an environment that is a part of one that is spread over ranks. Not installed.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/bytes.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/ranks.hpp"
#include "parts/part_of_rank.hpp"

namespace dartcast {

/// The data of particles that their user keeps beside their states, which goes along when they leave.
class TravelData {
 public:
  TravelData() = default;
  TravelData(const TravelData&) = delete;
  TravelData& operator=(const TravelData&) = delete;
  virtual ~TravelData() = default;

  /// The data of a particle that leaves. It stays in its place until the end of the step, and has had so many contacts
  /// there, which the report will have.
  [[nodiscard]] virtual std::string leave(std::uint32_t particle, std::uint32_t contacts) const = 0;
  /// Adds a particle with this data behind the others.
  virtual void come(std::string_view data) = 0;
};

/// The traffic between ranks in one step, for the report of a test or a plan.
struct TrafficCounts {
  std::uint64_t rounds = 0;  ///< exchanges
  std::uint64_t sent = 0;    ///< particles
  std::uint64_t bytes = 0;
};

/// One rank's part. Its functions are collective.
class PartEnvironment {
 public:
  /// `environment`: made of the part's mesh. All outlive it. Throws InvalidMesh if the ranks' parts are not of one
  /// mesh. Each ghost must be, corner by corner, a cell of the rank that should have it. Throws InvalidArgument in the
  /// plane, and if cells need Steiner points.
  PartEnvironment(Environment& environment, const MeshPart& part, Ranks& ranks);

  /// Replaces the environment by one of this part, which the rank has from now on, as PartEnvironment() takes it. References
  /// to it stay valid, and sets of particles are of another environment.
  void change(const MeshPart& part);

  [[nodiscard]] const PartCells& cells() const { return cells_; }
  [[nodiscard]] const TrafficCounts& traffic() const { return traffic_; }  ///< so far

  /// As Environment::add(), with the same positions on all ranks. The one that has the cell as its own adds the particle, and
  /// it alone gets its index; all get its place. Throws as that, nothing added, and InvalidArgument if a cell is not valid.
  std::vector<AddResult> add(Particles& particles, std::span<const Vec3> positions);

  /// Environment::advance() over all parts, to the same bits, for points in space. Particles must be in own cells; they
  /// are afterwards, too. Marks in `gone` those that are now on another rank; those that have come are behind the others.
  /// The report has the contacts that were met here. `respond`: not empty; it is called on a rank that knows all cells around the contact. It uses one thread. Counts of
  /// tests are those of one process but for walks to far targets.
  StepReport advance(Particles& particles, std::span<const Vec3> targets, const ContactCallback& respond,
                     const StepOptions& options, TravelData& data, std::vector<std::uint8_t>& gone);

 private:
  void check(const MeshPart& part) const;
  void check_ghosts(const MeshPart& part) const;
  [[nodiscard]] bool moves_any(const Particles& particles) const;

  Environment& environment_;
  Ranks& ranks_;
  PartCells cells_;
  std::vector<ByteWriter> to_;  // by rank
  TrafficCounts traffic_;
};

}  // namespace dartcast
