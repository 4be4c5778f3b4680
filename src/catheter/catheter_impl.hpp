// The members of Catheter, and the functions of its step.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "catheter/chain_solver.hpp"
#include "catheter/chain_surroundings.hpp"
#include "dartcast/catheter.hpp"
#include "dynamics/near_walls.hpp"
#include "solids/element_touches.hpp"
#include "solids/joint_move.hpp"

namespace dartcast {

struct Catheter::Impl final : MovePartner {
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
    double worst = 0.0;  // error of a segment's length at the end; with edges infinite if no way was free
    double now = 0.0;    // with edges: that of the way looked at last; infinite if it is not free
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
  void check_current(const char* caller) const;
  void move_with_vessel(CatheterStep& result);
  [[nodiscard]] Vec3 carried(std::size_t i) const;
  void turn_with_vessel(const Corners& before, const Corners& now);
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
  [[nodiscard]] double worst_segment(std::span<const Vec3> all) const;
  [[nodiscard]] std::uint32_t points_at_walls() const;
  // catheter_edges.cpp: with edges.
  [[nodiscard]] bool is_stuck() const { return stuck_; }
  [[nodiscard]] std::size_t segments() const;
  bool find_touches();
  double find_touches(const VertexMotion& walls);
  void add_touched_walls(std::size_t free);
  double look_ahead(std::size_t free, Outcome& outcome);
  bool go_ahead(Outcome& outcome);
  void carry_along(const VertexMotion& walls);
  double plan(const VertexMotion& walls) override;
  double solve_way(const VertexMotion& walls);
  bool shorten(double share, const VertexMotion& walls) override;
  void after_move() override;
  double move_with(std::span<const Vec3> positions);
  void find_stuck();
  [[nodiscard]] SolidAudit audit() const;
  // catheter_frames.cpp: its points and frames, checkpoints, edits.
  [[nodiscard]] std::vector<Vec3> points() const;
  [[nodiscard]] std::vector<CatheterFrame> frames() const;
  [[nodiscard]] std::vector<SolidContact> contacts() const;
  [[nodiscard]] std::optional<SolidContact> contact_at(const ChainWall& w, NearWalls& near) const;
  [[nodiscard]] double measured_length() const;
  [[nodiscard]] StateHash state_hash() const;
  [[nodiscard]] CatheterCheckpoint checkpoint() const;
  void restore(const CatheterCheckpoint& saved);
  UpdateReport update_after_edit();
  [[nodiscard]] Vec3 base_normal() const;

  // Shares of the spacing.
  static constexpr double reach = 0.5;  // largest displacement of a point in one solve, and range of a wall's plane
  static constexpr double look_margin = 0.0625;  // of ways that are looked at together
  static constexpr double same_wall = 0.9999;    // cosine between normals of one wall; no exact decision depends on it
  static constexpr std::uint32_t max_idle = 3;   // walks after which a wall that is not met is forgotten

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
  // With edges.
  bool stuck_ = false;
  std::size_t inserted_before_ = 0;  // points, before the substep
  std::vector<Vec3> ends_;           // of the way that is looked at, from start_
  std::vector<Vec3> planned_;        // of the way that will be made
  std::vector<ElementTouch> touches_;
  ChainSurroundings surroundings_{look_margin * options_.spacing};  // for one step
  std::vector<Cell> cells_;
  TouchFinder finder_;
};

}  // namespace dartcast
