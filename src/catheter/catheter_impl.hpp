// The members of Catheter, and the functions of its step.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "catheter/chain_solver.hpp"
#include "dartcast/catheter.hpp"

namespace dartcast {

struct Catheter::Impl {
  // Where a point was in its simplex at the last look.
  struct Hold {
    Corners corners;
    Weights weights;
  };
  // The state before a substep, which a failure goes back to.
  struct Saved {
    Particles particles;
    double inserted = 0.0;
    double turned = 0.0;
    std::vector<ChainWall> walls;
  };
  enum class Bending : std::uint8_t { stiff, limp };
  struct Outcome {
    double worst = 0.0;
    std::uint32_t rounds = 0;
    std::uint32_t held = 0;
    std::uint64_t contacts = 0;
  };

  Impl(Environment& environment, const CatheterOptions& options);

  // catheter.cpp: a step.
  CatheterStep step(const CatheterInput& input);
  [[nodiscard]] Vec3 entry() const { return particles_[count_].position; }
  [[nodiscard]] double total_length() const;
  [[nodiscard]] std::size_t inserted_points() const;
  [[nodiscard]] std::size_t free_points() const;
  [[nodiscard]] Vec3 base(std::size_t i) const;
  void check(const CatheterInput& input) const;
  bool attempt(const CatheterInput& piece, double share, Bending bending, double limit, CatheterStep& result);
  bool make(const CatheterInput& piece, double share, CatheterStep& result);
  void make_less(const CatheterInput& piece, double share, CatheterStep& result);
  void relax(const Vec3& load, CatheterStep& result);
  void move_with_vessel(CatheterStep& result);
  [[nodiscard]] Vec3 carried(std::size_t i) const;
  void turn_with_vessel(const Corners& now);
  void hold();
  void save();
  void take_back();
  // catheter_substep.cpp: a part of it.
  static AfterContact slide_at_walls(const Contact& contact, std::span<const WallHit> walls,
                                     std::span<const WallHit> earlier);
  Outcome substep(const CatheterInput& piece, double share, Bending bending);
  void follow_path(double push, std::size_t free);
  void bend_tip(std::size_t free);
  double walk(std::size_t free, Outcome& outcome);
  void keep_walls(const ContactList& contacts);
  [[nodiscard]] double worst_segment() const;
  [[nodiscard]] std::uint32_t points_at_walls() const;
  // catheter_frames.cpp: its points and frames, checkpoints, edits.
  [[nodiscard]] std::vector<Vec3> points() const;
  [[nodiscard]] std::vector<CatheterFrame> frames() const;
  [[nodiscard]] double measured_length() const;
  [[nodiscard]] StateHash state_hash() const;
  [[nodiscard]] CatheterCheckpoint checkpoint() const;
  void restore(const CatheterCheckpoint& saved);
  UpdateReport update_after_edit();
  [[nodiscard]] Vec3 base_normal() const;

  Environment& environment_;
  CatheterOptions options_;
  std::size_t count_ = 0;  // points of the chain, without the entry
  Particles particles_;
  double inserted_ = 0.0;
  double turned_ = 0.0;
  Vec3 direction_;  // unit
  Vec3 reference_;  // unit, perpendicular to it: the normal of a frame that is not turned
  std::vector<Hold> holds_;
  std::uint64_t edits_ = 0;
  std::vector<Vec3> targets_;  // of all particles; between walks the chain as it is solved for
  std::vector<Vec3> wanted_;
  std::vector<Vec3> start_;
  std::vector<Vec3> bends_;
  std::vector<Vec3> before_;
  std::vector<ChainWall> walls_;
  ChainSolver solver_;
  Saved saved_;
};

}  // namespace dartcast
