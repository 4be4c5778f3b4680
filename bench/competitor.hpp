// The interface of a competitor: it keeps the walls' triangles, and finds the first one that a segment meets.
#pragma once

#include <cstdint>
#include <span>

#include "dartcast/particle_state.hpp"
#include "dartcast/vec3.hpp"

namespace dartcast::bench {

struct Segment {
  Vec3 from;
  Vec3 to;
  /// For a segment that starts on a wall which the particle has just met: the share of the segment in which floats
  /// cannot distinguish that wall from others. Hits there are ignored, as in every program that casts rays from walls.
  /// Else 0.
  double self_hit_epsilon = 0.0;
};

/// The first wall triangle met, by its number (walls.hpp), or none; `time` is the fraction of the segment.
struct Hit {
  static constexpr std::uint32_t none = 0xffffffffU;
  static constexpr std::uint32_t failed = 0xfffffffeU;  ///< the competitor found no answer

  std::uint32_t triangle = none;
  double time = 1.0;
};

/// A way to find contacts that stands beside dartcast. Runs on one thread, and is not for use by several at once.
class Competitor {
 public:
  Competitor() = default;
  Competitor(const Competitor&) = delete;
  Competitor& operator=(const Competitor&) = delete;
  virtual ~Competitor() = default;

  /// Takes over the walls' points after a move, before refit(): writing vertices counts for nobody. Not timed.
  virtual void write(std::span<const Vec3> points) = 0;
  /// Makes the hierarchy follow the points written. Timed.
  virtual void refit() = 0;
  /// Where the particles of the next segments are, for those who remember particles. Not timed.
  virtual void place(std::span<const ParticleState> /*states*/) {}
  /// The first hit of every segment. Timed. `hits`: as many as segments.
  virtual void cast(std::span<const Segment> segments, std::span<Hit> hits) = 0;
  /// Writes into the hits what cast() knew by other names. Not timed.
  virtual void translate(std::span<Hit> /*hits*/) {}
  /// Orientation tests so far; 0 for those who make none.
  [[nodiscard]] virtual std::uint64_t tests() const { return 0; }
  /// Particles so far that arrived in a cell that does not hold their target, by exact signs; 0 for those who know no
  /// cells, and for the paper's scheme in space, whose cells have other faces where these are warped.
  [[nodiscard]] virtual std::uint64_t wrong_cells() const { return 0; }
};

}  // namespace dartcast::bench
