// Particles of a case, with numbers that they keep: what they head for and how walls answer depends on these alone.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "dartcast/environment.hpp"
#include "dartcast/response.hpp"
#include "soak/scene.hpp"

namespace dartcast::soak {

/// A call that throws in its middle, as it was asked to.
struct Thrown : std::runtime_error {
  Thrown() : std::runtime_error("thrown by the soak") {}
};

/// Answers contacts as the case says, the same in a batch and alone.
class Answers {
 public:
  /// `ids`: of the particles that contacts name. `velocities`: those before the step; changed by answers.
  Answers(const Case& c, std::uint64_t step, std::span<const std::uint64_t> ids, std::span<const Vec3> velocities,
          std::span<const ParticleStatus> statuses);
  Answers(const Answers&) = delete;
  Answers& operator=(const Answers&) = delete;
  /// Empty where particles stop at walls.
  [[nodiscard]] ContactCallback one_by_one();
  [[nodiscard]] RoundCallback in_rounds();

  std::vector<Vec3> velocities;
  std::vector<ParticleStatus> statuses;

 private:
  AfterContact answer(const Contact& c, std::span<const WallHit> walls, std::span<const WallHit> earlier);

  const Case& case_;
  std::uint64_t step_;
  std::vector<std::uint64_t> ids_;
  std::vector<unsigned> counts_;
  WallResponses responses_;
  ContactCallback library_;  // that answers; none: answer()
};

class Crowd {
 public:
  /// Crowds of one case differ by their kinds.
  static constexpr std::uint64_t points = 0, simultaneous = 1, spheres = 2;
  Crowd(const Case& c, const SceneMesh& scene, Environment& environment, std::uint64_t kind);

  [[nodiscard]] std::size_t size() const { return particles.size(); }
  [[nodiscard]] std::vector<Vec3> targets(const Environment& environment, std::uint64_t step) const;
  /// The velocities of a step to these targets.
  void head_for(std::span<const Vec3> targets);
  /// The answers to the contacts of some particles, of `first` on; all without numbers.
  [[nodiscard]] std::unique_ptr<Answers> answers(std::uint64_t step, std::size_t first, std::size_t count) const;
  [[nodiscard]] std::unique_ptr<Answers> answers(std::uint64_t step) const { return answers(step, 0, size()); }
  /// Takes what they have changed.
  void answered(const Answers& answers);
  /// Follows the last edit.
  void follow(const Environment& environment);
  /// As the case says: copies, restores, reorders. Returns what is wrong.
  std::string change_state(const Environment& environment, std::uint64_t step);
  /// Keeps the chambers of all particles, for stayed_in_chambers().
  void keep_chambers(const Chambers& chambers);
  /// The first fault of the particles, in integers: their simplices, their chambers, their numbers.
  [[nodiscard]] std::string check(const Environment& environment, const Chambers& chambers) const;
  /// In another environment, from the same places: for meshes that were made again.
  void add_again(Environment& environment);

  Particles particles;
  std::vector<std::uint64_t> ids;
  std::vector<Vec3> velocities;
  std::vector<ParticleStatus> statuses;

 private:
  void keep(const std::vector<bool>& stays);

  const Case& case_;
  const SceneMesh& scene_;
  std::uint64_t kind_;
  std::vector<std::uint32_t> chambers_;
};

/// The first fault of a report by itself: order of contacts, counts. `particles`: their number.
std::string check_report(const StepReport& report, std::size_t particles);

}  // namespace dartcast::soak
