// Rigid tools of a simulation. A step has three parts, in order. Each tool's wanted pose goes on by its move. The
// vertices of the wanted poses are the targets of the set of solids. A tool that was stopped takes the pose at the share
// of its way.
//
// A tool that turns goes on chords, from pose to pose. Its step is cut into slices, so that no point leaves its chord by
// more than half of the tool's separation from walls. The chords keep that separation, so the arcs are free. If it stops
// in a slice, the set tries poses of the slice until the chord to one is free. So a tool is rigid in every state.
#include "simulation/solids_component.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <limits>
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

// A tool that walls hold back by more than this angle, which is less than a half turn, loses the rest. So the shorter way
// to its wanted pose goes the same way round as its moves.
constexpr double max_lag = 3.125;

// The way of a step: from the pose to where a move takes the wanted one.
RigidWay way_of(const RigidPose& pose, const RigidPose& wanted, const SolidScene& scene, double begin, double dt) {
  RigidWay way = {pose, wanted, {}};
  const Vec3 lag = turn_between(pose.rotation, wanted.rotation);
  const double middle = begin + 0.5 * dt;
  const auto move =
      std::find_if(scene.moves.begin(), scene.moves.end(), [&](const auto& m) { return middle < m.until; });
  if (move != scene.moves.end()) {
    way.turn = move->turn * dt;
    way.to = {wanted.displacement + move->velocity * dt, turned(wanted.rotation, way.turn)};
  }
  if (lag == Vec3{}) return way;
  const bool is_short = norm(lag) + norm(way.turn) <= max_lag;
  way.turn = is_short ? turn_between(pose.rotation, way.to.rotation) : lag + way.turn;
  if (!is_short) way.to.rotation = turned(pose.rotation, way.turn);
  return way;
}

// The largest distance of a tool's points from the pivot.
double arm_of(const SolidMesh& mesh, const Vec3& pivot) {
  double arm = 0.0;
  for (const Vec3& x : mesh.points) arm = std::max(arm, norm(x - pivot));
  return arm;
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
  const SolidPlacement placed = solids_->add(tool.mesh, met_by(scene));
  if (placed.refusal != SolidRefusal::none) {
    const std::span<const std::uint32_t> vertices(placed.vertices.data(), placed.count);
    const Vec3& x = tool.mesh.points[vertices.front()];
    const bool overlaps = placed.refusal == SolidRefusal::meets_solid;
    const std::string why =
        overlaps ? fmt::format("overlaps the solid \"{}\"; move or turn one of them, or leave it out of meets",
                               name(placed.other))
                 : fmt::format("{}; move or turn it", reason(placed.refusal));
    throw Error(
        fmt::format("its part with the vertices {} at ({}, {}, {}) {}", fmt::join(vertices, ", "), x.x, x.y, x.z, why));
  }
  tool.separation = JointMoves::separation(*solids_, placed.solid);
  if (tool.separation == 0.0) tool.separation = JointMoves::default_separation * arm_of(tool.mesh, scene.pivot);
  try {
    check_turns(tool);
  } catch (...) {
    solids_->remove(placed.solid);
    throw;
  }
  last_.made.push_back(1.0);
  tools_.push_back(std::move(tool));
}

// The tools so far that it meets.
std::vector<std::uint32_t> SolidsComponent::met_by(const SolidScene& scene) const {
  const auto leaves_out = [](const SolidScene& one, const SolidScene& other) {
    return one.meets && std::find(one.meets->begin(), one.meets->end(), other.name) == one.meets->end();
  };
  std::vector<std::uint32_t> met;
  for (std::uint32_t i = 0; i < tools_.size(); ++i) {
    if (!leaves_out(scene, tools_[i].scene) && !leaves_out(tools_[i].scene, scene)) met.push_back(i);
  }
  return met;
}

// How many slices a step with this turn takes.
double SolidsComponent::slices(const Tool& tool, const Vec3& turn) const {
  const double arm = arm_of(tool.mesh, tool.scene.pivot);
  const double angle = norm(turn) * dt_;
  return angle == 0.0 || arm == 0.0 ? 0.0 : slices_of(bend_of(angle, arm), tool.separation);
}

void SolidsComponent::check_turns(const Tool& tool) const {
  for (std::size_t i = 0; i < tool.scene.moves.size(); ++i) {
    const Vec3& turn = tool.scene.moves[i].turn;
    if (!(slices(tool, turn) <= max_slices))
      throw InvalidArgument(fmt::format(
          "its move {} turns it by {} rad in a step, which takes {} slices; {} is the limit: make dt smaller, "
          "or turn more slowly",
          i + 1, norm(turn) * dt_, slices(tool, turn), max_slices));
  }
}

void SolidsComponent::steer(std::size_t solid, const Vec3& velocity, const Vec3& turn) {
  if (solid >= tools_.size())
    throw InvalidArgument(
        fmt::format("simulation: there is no solid {} to steer: it has {}, counted from 0", solid, tools_.size()));
  Tool& tool = tools_[solid];
  if (!is_finite(velocity) || !is_finite(turn))
    throw InvalidArgument("simulation: the velocity and the turn of a steered solid must be finite");
  if (!(slices(tool, turn) <= max_slices))
    throw InvalidArgument(
        fmt::format("simulation: the solid turns by {} rad in a step, which takes {} slices; {} is the "
                    "limit: turn more slowly",
                    norm(turn) * dt_, slices(tool, turn), max_slices));
  tool.scene.moves = {{std::numeric_limits<double>::infinity(), velocity, turn}};
  tool.steered = true;
}

// Gives each tool its way of the step, and the set the way of all.
SolidWay SolidsComponent::way(double begin) {
  SolidWay all;
  for (Tool& tool : tools_) {
    tool.way = way_of(tool.pose, tool.wanted, tool.scene, begin, dt_);
    tool.wanted = tool.way.to;
    tool.put(tool.wanted, std::back_inserter(all.targets));
  }
  if (std::none_of(tools_.begin(), tools_.end(), turns)) return all;
  for (const Tool& tool : tools_) all.arcs.push_back(arc_of(tool));
  all.place = [this](std::uint32_t solid, double share, std::span<Vec3> vertices) {
    tools_[solid].put(tools_[solid].way.at(share), vertices.begin());
  };
  return all;
}

// One that turns at any time, or is steered, keeps its separation in all steps: so it has the room when it turns.
bool SolidsComponent::turns(const Tool& tool) {
  const auto& moves = tool.scene.moves;
  return tool.separation > 0.0 &&
         (tool.steered ||
          std::any_of(moves.begin(), moves.end(), [](const SolidScene::Move& m) { return m.turn != Vec3{}; }));
}

SolidArc SolidsComponent::arc_of(const Tool& tool) {
  if (!turns(tool)) return {};
  const double angle = norm(tool.way.turn);
  double arm = 0.0;
  for (const Vec3& x : tool.mesh.points) {
    if (angle == 0.0) break;
    arm = std::max(arm, norm(cross(tool.way.turn, rotated(tool.pose.rotation, x - tool.scene.pivot))) / angle);
  }
  return {bend_of(angle, arm), tool.separation};
}

// The lag of a tool that makes up for it is limited.
void SolidsComponent::follow(const SolidStep& step) {
  last_ = step;
  for (const SolidContact& c : last_.contacts) ++tools_[c.solid].contacts;
  for (const SolidMeeting& m : last_.meetings) {
    ++tools_[m.solid].contacts;
    ++tools_[m.other].contacts;
  }
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    Tool& tool = tools_[i];
    const double made = last_.made[i];
    const double angle = norm(tool.way.turn);
    tool.pose = tool.way.at(made);
    if (!tool.scene.catch_up) tool.wanted = tool.pose;
    if (tool.scene.catch_up && angle * (1.0 - made) > max_lag)
      tool.wanted.rotation = turned(tool.pose.rotation, tool.way.turn * (max_lag / angle));
    tool.stopped += made < 1.0 ? 1 : 0;
  }
}

void SolidsComponent::move_with(double begin, std::span<const Vec3> positions, std::vector<MovePartner*> partners) {
  if (solids_) partners.push_back(&JointMoves::prepare(*solids_, way(begin), {.rounds = 0}));
  walls_before_ = std::exchange(walls_now_, move_together(environment_, partners, positions));
  if (!solids_) return;
  follow(JointMoves::last_step(*solids_));
  moved_ = true;
}

void SolidsComponent::step(double begin) {
  if (solids_ && !std::exchange(moved_, false)) follow(JointMoves::advance(*solids_, way(begin), {.rounds = 0}));
}

void SolidsComponent::update_after_edit(const ComplexEditReport& /*edit*/, OrphanPolicy /*orphaned*/) {
  if (solids_) solids_->update_after_edit();
  const bool known = !places_at_edits_.empty() && places_at_edits_.back().steps == motion_.steps();
  if (walls_were_stopped() && !known) places_at_edits_.push_back(motion_.places());
}

void SolidsComponent::save(SimulationState& state) const {
  if (solids_) state.solids.set = solids_->checkpoint();
  for (const Tool& tool : tools_) state.solids.tools.push_back({tool.pose, tool.wanted, tool.contacts, tool.stopped});
  state.solids.walls_before = walls_before_;
  state.solids.walls_now = walls_now_;
  state.solids.places = places_at_edits_;
  if (walls_were_stopped()) state.solids.places.push_back(motion_.places());
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
