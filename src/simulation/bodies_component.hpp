// The bodies and catheters of a run, beside the flow in one environment.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bodies/carried_surface.hpp"
#include "dartcast/audit.hpp"
#include "dartcast/bodies.hpp"
#include "dartcast/catheter.hpp"
#include "dartcast/mesh_data.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/scene.hpp"

namespace dartcast {

/// What a body came to.
struct BodySummary {
  std::string name;
  std::size_t particles = 0;
  bool gone = false;  ///< it left at a wall; then nothing of what follows
  Vec3 centre;
  BodyEnergy energy;
};

/// Over all steps so far.
struct CatheterTotals {
  double worst_segment = 0.0;  ///< largest relative error of a segment's length
  double refused = 0.0;        ///< m of pushes and pulls that there was no way for
};

/// What a catheter came to.
struct CatheterSummary {
  std::string name;
  double inserted = 0.0;         ///< m
  double measured_length = 0.0;  ///< of the part in the lumen, m
  CatheterTotals totals;
  Vec3 tip;
};

/// All that solids go on from after a step.
struct SolidsCheckpoint {
  Bodies::Checkpoint bodies;
  std::vector<CatheterCheckpoint> catheters;
  std::vector<CatheterTotals> catheter_totals;
};

class Solids {
 public:
  /// A body's surface as it was put into the scene, and how it follows the particles.
  struct Skin {
    MeshData mesh;
    CarriedSurface carried;
  };

  /// Makes them where the scene puts them. All outlive it. Throws Error that names the body or catheter: its surface
  /// cannot be read (of the options `max_memory` counts) or sampled, a particle is in no free cell (how many, and the
  /// first), the entry is not in the lumen.
  Solids(const Scene& scene, Environment& environment, const WallResponses& responses, const ReadOptions& options = {});

  [[nodiscard]] bool empty() const { return scene_.bodies.empty() && scene_.catheters.empty(); }

  /// One step, to be called once after each move of the environment. `begin`: its time, s.
  void step(double begin);
  /// To be called after each edit of the environment.
  void update_after_edit(OrphanPolicy orphaned);

  /// None where the scene has none.
  [[nodiscard]] const std::optional<Bodies>& bodies() const { return bodies_; }
  /// Likewise, for spheres that meet them.
  [[nodiscard]] std::optional<Bodies>& bodies() { return bodies_; }
  /// What the last step was.
  [[nodiscard]] const BodiesStep& bodies_step() const { return bodies_step_; }
  [[nodiscard]] const std::string& name(std::size_t body) const { return scene_.bodies[bodies_->id(body)].name; }
  [[nodiscard]] const Skin& skin(std::size_t body) const { return skins_[bodies_->id(body)]; }

  [[nodiscard]] const std::deque<Catheter>& catheters() const { return catheters_; }
  [[nodiscard]] std::span<const CatheterStep> catheter_steps() const { return catheter_steps_; }
  [[nodiscard]] const Scene& scene() const { return scene_; }
  [[nodiscard]] Environment& environment() const { return environment_; }

  [[nodiscard]] std::vector<BodySummary> body_summaries() const;
  [[nodiscard]] std::vector<CatheterSummary> catheter_summaries() const;
  [[nodiscard]] Audit audit() const;
  [[nodiscard]] StateHash state_hash() const;
  [[nodiscard]] SolidsCheckpoint checkpoint() const;
  /// Goes on from a checkpoint of the same scene, in an environment that stands as it did then. Throws as
  /// Bodies::restore() and Catheter::restore().
  void restore(const SolidsCheckpoint& saved);

 private:
  void add(const BodyScene& scene, const ReadOptions& read);

  const Scene& scene_;
  Environment& environment_;
  std::optional<Bodies> bodies_;
  std::vector<Skin> skins_;         // by id
  std::deque<Catheter> catheters_;  // they stay where they are
  BodiesStep bodies_step_;
  std::vector<CatheterStep> catheter_steps_;
  std::vector<CatheterTotals> catheter_totals_;
};

}  // namespace dartcast
