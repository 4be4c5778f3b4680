// Prescribed motion: where every vertex is at a time, computed from where it rests. Nothing accumulates, so nothing
// drifts.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include "dartcast/complex_edit.hpp"
#include "dartcast/threads.hpp"
#include "dartcast/vec3.hpp"
#include "dartcast/vector_field.hpp"

namespace dartcast {

/// How a step moves a point x. Below: a the axis and d the direction as unit vectors, d made perpendicular to a; r =
/// x - centre, s = r.a the height of x along the axis, h = r.d; A the amplitude; w(t) = sin(2 pi t / period), so that
/// at t = 0 all is at rest.
enum class DeformationKind : std::uint8_t {
  rotate,  ///< steady turns about the axis through the centre, one a period: by the angle 2 pi t / period. No
           ///< amplitude.
  swing,   ///< to and fro about that axis: by the angle A w(t)
  bend,    ///< the axis becomes a circle's arc towards d, of curvature k = A w(t) / length. A point at height s on the
  ///< axis goes to centre + a sin(ks) / k + d (1 - cos(ks)) / k, and its cross-section turns with it. Valid if
  ///< k h < 1.
  twist,    ///< cross-sections turn about the axis by A w(t) s / length
  stretch,  ///< along the axis by f = 1 + A w(t), across it by 1 / sqrt(f): volumes stay. |A| < 1.
  pulse,    ///< x + A sin(2 pi (t / period - p / wavelength)) e, a wave that travels with p. e is the vertex's `field`;
            ///< without one r - a s (away from the axis), or r (away from the centre) if the axis is 0. p is the
            ///< vertex's `path`; without one s. No wave travels if wavelength is 0; if
            ///< one does, points are off their rest at t = 0 too.
  bump,     ///< x + a A w(t) (1 - |r|^2 / length^2)^2 within `length` of the centre: a smooth bulge along the axis
  frames,   ///< positions given at `times`, interpolated between them, the first before and the last after them, or
            ///< again and again (`cycle`): held in `frames`, or read one by one by `reader`. First in a list only.
};
inline constexpr std::array deformation_kinds = {
    DeformationKind::rotate,  DeformationKind::swing, DeformationKind::bend, DeformationKind::twist,
    DeformationKind::stretch, DeformationKind::pulse, DeformationKind::bump, DeformationKind::frames};
/// The name of a kind in scenes, such as "rotate".
[[nodiscard]] std::string_view name_of(DeformationKind kind);

/// The kind of that name; none if there is no such kind.
std::optional<DeformationKind> deformation_kind(std::string_view name);

/// Reads a frame: the position of every vertex at times[frame]. It may be called by another thread than the caller's,
/// and by several at once if several deformations are made with it. Its exceptions reach the caller who needs the
/// frame.
using FrameReader = std::function<std::vector<Vec3>(std::size_t frame)>;

/// Bytes of frames that a deformation holds at most, the two (cubic: four) that it needs and those read ahead; three
/// (five) if these are more. One more is being read.
inline constexpr std::size_t frame_memory = std::size_t{32} << 20U;
/// And their number.
inline constexpr std::size_t max_frames_held = 64;

/// SI units: metres, seconds, radians.
struct DeformationStep {
  DeformationKind kind = DeformationKind::rotate;
  double amplitude = 0.0;       ///< an angle (swing, bend, twist), a length (bump) or a share (stretch, pulse)
  double period = 1.0;          ///< > 0
  Vec3 axis = {0.0, 0.0, 1.0};  ///< of any length but 0 (pulse: may be 0)
  Vec3 centre = {0.0, 0.0, 0.0};
  Vec3 direction = {1.0, 0.0, 0.0};            ///< bend only: not along the axis
  double length = 1.0;                         ///< bend, twist, bump: > 0
  double wavelength = 0.0;                     ///< pulse: >= 0
  std::vector<Vec3> field = {};                ///< pulse: one per vertex, or empty
  std::vector<double> path = {};               ///< pulse: one per vertex, or empty
  std::vector<double> times = {};              ///< frames: increasing
  std::vector<std::vector<Vec3>> frames = {};  ///< frames: all positions, one list per time; or none and a reader
  FrameReader reader = {};                     ///< frames: instead of `frames`
  Interpolation interpolation = Interpolation::linear;  ///< frames
  /// frames: above 0, s: they repeat after this time, at least that from the first to the last. With just that, the last
  /// frame should be the first one again.
  double cycle = 0.0;
};

class DeformationFrames;

/// A list of steps, each applied to the result of those before it.
///
/// Frames with a reader are read ahead by a thread, in the order in which time increases, within `frame_memory` and
/// `max_frames_held`. The thread starts with the first frame that is needed and ends with the last copy of the
/// deformation. Copies share the thread and its frames: each gets the right positions, but two that are at different
/// times read frames twice.
class Deformation {
 public:
  /// Copies the positions at rest. Throws InvalidArgument, naming the step and the member, if one is out of the range
  /// above or not finite. It also throws if a list has not one entry per vertex. Frames with a reader are checked
  /// when they are read.
  Deformation(std::vector<DeformationStep> steps, std::span<const Vec3> rest);

  [[nodiscard]] std::size_t size() const { return size_; }

  /// For a mesh of the plane. Throws InvalidArgument, naming the step and the member, unless every point with z = 0
  /// keeps z = 0 exactly at all times. Every centre is in the plane. Rotate, swing and twist are about [0, 0, 1]. Bend
  /// and bump have vectors of the plane. Stretch and pulse have an axis in the plane or across it. Fields and frames
  /// have z = 0. Cost: linear if there are fields, frames or pulls. Frames with a reader are checked, too, from now on
  /// when they are needed.
  void check_plane();

  /// After an edit: vertices that it made go with those that they were made between, so that nothing jumps. `size`: of
  /// the environment's positions now.
  void update_after_edit(const ComplexEditReport& edit, std::size_t size);
  /// Adds a displacement of some vertices on top of everything else. It grows smoothly from 0 at the time `begin` to
  /// all of it at `end` (s), and stays. `displacement`: one per vertex so far. Throws InvalidArgument if the number
  /// does not match, one is not finite, or the end is not after the beginning.
  void add_pull(std::span<const Vec3> displacement, double begin, double end);

  /// Waits for the frames that positions() needs at `time`, so that it does not throw for them. Nothing without a
  /// reader. Throws as positions().
  void load_frames(double time) const;

  /// Writes the position of every vertex at `time` (s). The same bits for any number of threads. Throws
  /// InvalidArgument, and writes nothing, if time is not finite or out has not one place per vertex. If a frame
  /// must be read, throws as the reader. Throws InvalidMesh, which names the frame, if it has not one finite position
  /// per vertex or, after check_plane(), leaves the plane. A frame that could not be read is read again by the next
  /// call. Cost: 10 to 60 ns per vertex and step.
  void positions(double time, std::span<Vec3> out, Threads threads = {}) const;

 private:
  struct Pull {
    std::vector<std::uint32_t> vertex;  // those that it displaces
    std::vector<Vec3> displacement;
    double begin, end;
  };
  // The effects of edits and pulls, in their order.
  using Later = std::variant<PlacedVertex, Pull>;

  friend class MovingVertices;
  void at_rest(std::span<Vec3> out) const;  // before the first step
  void add_later(double time, std::span<Vec3> out) const;

  std::vector<DeformationStep> steps_;         // axis and direction made unit vectors; without frames
  std::shared_ptr<DeformationFrames> frames_;  // none: the motion starts from rest
  bool in_plane_ = false;
  std::vector<Vec3> rest_;
  std::vector<Later> later_;
  std::size_t size_;
};

/// Displacements of points for Simulation::pull(): `by` at the place `at`. It fades out at the distance `reach` (m) as (1 - d^2 /
/// reach^2)^2. Throws InvalidArgument if a number is not finite or the reach is not positive. Cost: linear.
std::vector<Vec3> pull_around(std::span<const Vec3> positions, const Vec3& at, const Vec3& by, double reach);

}  // namespace dartcast
