// Rigid tools of a simulation. A step has three parts, in order. Each tool's wanted pose goes on by its move. The
// vertices of the wanted poses are the targets of the set of solids. A tool that was stopped takes the pose at the share
// of its way.
#include "simulation/solids_component.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "dartcast/error.hpp"
#include "simulation/refusal_reason.hpp"
#include "simulation/simulation_state.hpp"
#include "simulation/with_name.hpp"

namespace dartcast {

namespace {

SolidMesh shape_of(const SolidScene& scene) {
  if (std::holds_alternative<std::filesystem::path>(scene.shape))
    throw InvalidArgument("its surface is a file that has not been read; call load_scene_files() first");
  const auto* surface = std::get_if<MeshData>(&scene.shape);
  SolidMesh mesh =
      surface != nullptr ? solid_of_surface(*surface) : solid_of_polyline(std::get<std::vector<Vec3>>(scene.shape));
  const Quaternion rotation = rotation_of(scene.rotate);
  for (Vec3& x : mesh.points) x = rotated(rotation, x * scene.scale) + scene.at;
  return mesh;
}

RigidPose moved(const RigidPose& pose, const SolidScene& scene, double begin, double dt) {
  const double middle = begin + 0.5 * dt;
  for (const SolidScene::Move& move : scene.moves) {
    if (middle >= move.until) continue;
    return {pose.displacement + move.velocity * dt, normalized(rotation_of(move.turn * dt) * pose.rotation)};
  }
  return pose;
}

}  // namespace

void SolidsComponent::add(const SolidScene& scene) {
  with_name("solid", scene.name, [&] { add_named(scene); });
}

void SolidsComponent::add_named(const SolidScene& scene) {
  Tool tool;
  tool.scene = scene;
  tool.scene.shape = {};
  tool.mesh = shape_of(scene);
  if (!solids_) solids_.emplace(environment_);
  const SolidPlacement placed = solids_->add(tool.mesh);
  if (placed.refusal != SolidRefusal::none) {
    const std::span<const std::uint32_t> vertices(placed.vertices.data(), placed.count);
    const Vec3& x = tool.mesh.points[vertices.front()];
    throw Error(fmt::format("its part with the vertices {} at ({}, {}, {}) {}; move or turn it",
                            fmt::join(vertices, ", "), x.x, x.y, x.z, reason(placed.refusal)));
  }
  last_.made.push_back(1.0);
  tools_.push_back(std::move(tool));
}

std::vector<Vec3> SolidsComponent::targets(double begin) {
  std::vector<Vec3> all;
  for (Tool& tool : tools_) {
    tool.wanted = moved(tool.wanted, tool.scene, begin, dt_);
    const Vec3 pivot = tool.scene.pivot + tool.wanted.displacement;
    for (const Vec3& x : tool.mesh.points) all.push_back(pivot + rotated(tool.wanted.rotation, x - tool.scene.pivot));
  }
  return all;
}

// A tool that was cut is where a straight way to its target took its vertices. Its pose there is rigid, so that the next
// step gives it its shape again.
void SolidsComponent::follow(const SolidStep& step) {
  last_ = step;
  for (const SolidContact& c : last_.contacts) ++tools_[c.solid].contacts;
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    Tool& tool = tools_[i];
    const double made = last_.made[i];
    tool.pose = made == 1.0 ? tool.wanted : between(tool.pose, tool.wanted, made);
    if (!tool.scene.catch_up) tool.wanted = tool.pose;
    tool.stopped += made < 1.0 ? 1 : 0;
  }
}

void SolidsComponent::move_with(double begin, std::span<const Vec3> positions, std::vector<MovePartner*> partners) {
  if (solids_) partners.push_back(&JointMoves::prepare(*solids_, targets(begin), {.rounds = 0}));
  walls_before_ = std::exchange(walls_now_, move_together(environment_, partners, positions));
  if (!solids_) return;
  follow(JointMoves::last_step(*solids_));
  moved_ = true;
}

void SolidsComponent::step(double begin) {
  if (solids_ && !std::exchange(moved_, false)) follow(solids_->advance(targets(begin), {.rounds = 0}));
}

void SolidsComponent::update_after_edit(const ComplexEditReport& /*edit*/, OrphanPolicy /*orphaned*/) {
  if (solids_) solids_->update_after_edit();
  const bool known = !places_at_edits_.empty() && places_at_edits_.back().steps == particles_.steps();
  if (walls_were_stopped() && !known) places_at_edits_.push_back(particles_.vertex_places());
}

void SolidsComponent::save(SimulationState& state) const {
  if (solids_) state.solids.set = solids_->checkpoint();
  for (const Tool& tool : tools_) state.solids.tools.push_back({tool.pose, tool.wanted, tool.contacts, tool.stopped});
  state.solids.walls_before = walls_before_;
  state.solids.walls_now = walls_now_;
  state.solids.places = places_at_edits_;
  if (walls_were_stopped()) state.solids.places.push_back(particles_.vertex_places());
}

void SolidsComponent::restore(const SimulationState& state) {
  const SolidsState& saved = state.solids;
  if (saved.tools.size() != tools_.size())
    throw InvalidArgument(fmt::format("solids: the checkpoint has {}, the simulation has {}: add the same solids first",
                                      saved.tools.size(), tools_.size()));
  if (solids_) solids_->restore(saved.set);
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    tools_[i].pose = saved.tools[i].pose;
    tools_[i].wanted = saved.tools[i].wanted;
    tools_[i].contacts = saved.tools[i].contacts;
    tools_[i].stopped = saved.tools[i].stopped;
  }
  walls_before_ = saved.walls_before;
  walls_now_ = saved.walls_now;
  places_at_edits_ = saved.places;
  if (walls_were_stopped()) places_at_edits_.pop_back();
}

Audit SolidsComponent::audit() const {
  if (!solids_) return {};
  Audit all = dartcast::audit(environment_.complex(), solids_->particles(), environment_.threads());
  const SolidAudit parts = solids_->audit();
  return all += {parts.checked, parts.failed, parts.first};
}

StateHash SolidsComponent::state_hash() const {
  StateHash hash;
  for (std::size_t v = 0; solids_ && v < solids_->particles().size(); ++v) hash.add(v, solids_->particles()[v], {});
  return hash;
}

std::vector<SolidSummary> SolidsComponent::summaries() const {
  std::vector<SolidSummary> all;
  for (const Tool& tool : tools_) {
    const Vec3 pivot = tool.scene.pivot + tool.pose.displacement;
    all.push_back({tool.scene.name, tool.mesh.points.size(), pivot, tool.contacts, tool.stopped, false});
  }
  if (!solids_) return all;
  for (const SolidPlacement& stuck : solids_->stuck()) all[stuck.solid].stuck = true;
  return all;
}

}  // namespace dartcast
