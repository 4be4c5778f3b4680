// Makes bodies from plain data, and runs them as a part of a simulation.
#include "simulation/bodies_component.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "base/elementary.hpp"
#include "bodies/bodies_moves.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "simulation/refusal_reason.hpp"
#include "simulation/simulation_state.hpp"
#include "simulation/with_name.hpp"
#include "surface/triangles.hpp"

namespace dartcast {

namespace {

// `turn`: axis times angle.
Vec3 turned_about(const Vec3& x, const Vec3& turn) {
  const double angle = norm(turn);
  if (angle == 0.0) return x;
  const Vec3 axis = turn * (1.0 / angle);
  const SineCosine turned = sine_cosine(angle);
  return x * turned.cosine + cross(axis, x) * turned.sine + axis * (dot(axis, x) * (1.0 - turned.cosine));
}

MeshData placed_surface(const BodyScene& scene) {
  if (std::holds_alternative<std::filesystem::path>(scene.surface))
    throw InvalidArgument("its surface is a file that has not been read; call load_scene_files() first");
  const auto* given = std::get_if<MeshData>(&scene.surface);
  MeshData mesh = given != nullptr ? *given : generate_barrel(std::get<BarrelOptions>(scene.surface));
  for (Vec3& x : mesh.points) x = turned_about(x * scene.scale, scene.rotate) + scene.at;
  return mesh;
}

std::vector<Vec3> sampled(const BodyScene& scene, const MeshData& mesh) {
  switch (scene.samples) {
    case BodySamples::surface: return sample_surface(mesh, scene.sampling);
    case BodySamples::volume: return sample_volume(mesh, scene.sampling);
    case BodySamples::solid: return sample_solid(mesh, scene.sampling).points;
  }
  return {};
}

}  // namespace

Bodies& BodiesComponent::made() {
  if (options_.collisions && options_.substeps != 1)
    throw InvalidArgument("simulation: spheres and bodies meet once in a step: substeps must be 1");
  if (!bodies_) {
    BodiesOptions options;
    options.dt = options_.dt;
    options.gravity = options_.gravity;
    options.drag = options_.drag;
    options.collisions = options_.body_collisions;
    options.step = options_.step;
    bodies_.emplace(environment_, options, responses_);
  }
  return *bodies_;
}

AddBodyResult BodiesComponent::add(std::span<const Vec3> points, const BodyOptions& options) {
  AddBodyResult added = made().add(points, options);
  if (added.refused.empty()) {
    names_.emplace_back();
    skins_.emplace_back();
  }
  return added;
}

void BodiesComponent::add(const BodyScene& scene) {
  with_name("body", scene.name, [&] { add_named(scene); });
}

void BodiesComponent::add_named(const BodyScene& scene) {
  MeshData mesh = placed_surface(scene);
  const std::vector<Vec3> points = sampled(scene, mesh);
  if (points.empty()) throw Error("no particle fits into it; make its spacing smaller");
  BodyOptions options = scene.body;
  if (scene.cluster > 0.0) options.match.clusters = overlapping_clusters(points, scene.cluster);
  if (scene.edges) options.surface = {mesh.points, {}, surface_triangles(mesh)};
  const AddBodyResult added = made().add(points, options);
  if (!added.refused.empty()) {
    const Vec3& x = points[added.refused.front()];
    throw Error(fmt::format("{} of its {} particles are in no free cell, the first at ({}, {}, {}); move or turn it",
                            added.refused.size(), points.size(), x.x, x.y, x.z));
  }
  if (added.surface.refusal != SolidRefusal::none) {
    const Vec3& x = mesh.points[added.surface.vertices[0]];
    throw Error(fmt::format("its surface at ({}, {}, {}) {}; move or turn it, or set edges = false", x.x, x.y, x.z,
                            reason(added.surface.refusal)));
  }
  CarriedSurface carried(mesh.points, points);
  names_.push_back(scene.name);
  skins_.emplace_back(Skin{std::move(mesh), std::move(carried)});
}

void BodiesComponent::step(double /*begin*/) {
  if (bodies_) last_ = bodies_->step();
}

void BodiesComponent::update_after_edit(const ComplexEditReport& /*edit*/, OrphanPolicy orphaned) {
  if (bodies_) bodies_->update_after_edit(orphaned);
}

void BodiesComponent::save(SimulationState& state) const {
  if (bodies_) state.bodies = bodies_->checkpoint();
}

void BodiesComponent::restore(const SimulationState& state) {
  if (bodies_) bodies_->restore(state.bodies);
}

Audit BodiesComponent::audit() const {
  if (!bodies_) return {};
  Audit all = dartcast::audit(environment_.complex(), bodies_->particles(), environment_.threads());
  const SolidAudit surfaces = bodies_->audit();
  return all += {surfaces.checked, surfaces.failed, surfaces.first};
}

std::vector<Vec3> BodiesComponent::surface_points(std::size_t body) const {
  const auto with_edges = bodies_->surface(body);
  if (!with_edges.empty()) return {with_edges.begin(), with_edges.end()};
  const Skin& own = *skin(body);
  std::vector<Vec3> points(own.mesh.points.size());
  const auto particles = bodies_->positions().subspan(bodies_->first_particle(body), bodies_->particle_count(body));
  own.carried.positions(particles, points, environment_.threads());
  return points;
}

MovePartner* BodiesComponent::partner() { return bodies_ ? BodiesMoves::prepare(*bodies_) : nullptr; }

StateHash BodiesComponent::state_hash() const { return bodies_ ? bodies_->state_hash() : StateHash{}; }

std::vector<BodySummary> BodiesComponent::summaries() const {
  std::vector<BodySummary> all;
  for (const std::string& name : names_) all.push_back({name, 0, true, {}, {}});
  for (std::size_t b = 0; bodies_ && b < bodies_->size(); ++b) {
    all[bodies_->id(b)] = {name(b), bodies_->particle_count(b), false, bodies_->rigid_motion_of(b).centre,
                           bodies_->energy(b)};
  }
  return all;
}

}  // namespace dartcast
