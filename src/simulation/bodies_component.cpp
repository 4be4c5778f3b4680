#include "simulation/solids.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "dartcast/error.hpp"
#include "dartcast/mesh_files.hpp"

namespace dartcast {

namespace {

// `turn`: axis times angle.
Vec3 turned_about(const Vec3& x, const Vec3& turn) {
  const double angle = norm(turn);
  if (angle == 0.0) return x;
  const Vec3 axis = turn * (1.0 / angle);
  return x * std::cos(angle) + cross(axis, x) * std::sin(angle) + axis * (dot(axis, x) * (1.0 - std::cos(angle)));
}

MeshData placed_surface(const BodyScene& scene, const ReadOptions& options) {
  const auto* file = std::get_if<std::filesystem::path>(&scene.surface);
  MeshData mesh =
      file != nullptr ? read_surface(*file, options).mesh : generate_barrel(std::get<BarrelOptions>(scene.surface));
  for (Vec3& x : mesh.points) x = turned_about(x * scene.scale, scene.rotate) + scene.at;
  return mesh;
}

std::vector<Vec3> sampled(const BodyScene& scene, const MeshData& mesh) {
  switch (scene.samples) {
    case BodySamples::surface: return sample_surface(mesh, scene.sampling);
    case BodySamples::volume: return sample_volume(mesh, scene.sampling);
    case BodySamples::solid: break;
  }
  return sample_solid(mesh, scene.sampling).points;
}

BodiesOptions bodies_options(const Scene& scene) {
  BodiesOptions options;
  options.dt = scene.motion.dt;
  options.gravity = scene.motion.gravity;
  options.drag = scene.motion.drag;
  options.collisions = scene.body_collisions;
  return options;
}

// Push and turn of a step of so long.
CatheterInput input_at(const CatheterScene& scene, double begin, double dt) {
  const double middle = begin + 0.5 * dt;
  for (const CatheterScene::Move& move : scene.moves) {
    if (middle < move.until) return {move.push * dt, move.turn * dt, {}};
  }
  return {};
}

// What the making of a body or catheter throws is told with its name.
template <class Make>
auto with_name(const char* kind, const std::string& name, Make&& make) {
  try {
    return make();
  } catch (const Error& e) {
    throw Error(fmt::format("{} \"{}\": {}", kind, name, e.what()));
  }
}

}  // namespace

Solids::Solids(const Scene& scene, Environment& environment, const WallResponses& responses, const ReadOptions& options)
    : scene_(scene), environment_(environment) {
  if (!scene.bodies.empty()) bodies_.emplace(environment, bodies_options(scene), responses);
  for (const BodyScene& body : scene.bodies) with_name("body", body.name, [&] { add(body, options); });
  for (const CatheterScene& c : scene.catheters) {
    with_name("catheter", c.name, [&] { catheters_.emplace_back(environment, c.options); });
  }
  catheter_steps_.resize(catheters_.size());
  catheter_totals_.resize(catheters_.size());
}

void Solids::add(const BodyScene& scene, const ReadOptions& read) {
  MeshData mesh = placed_surface(scene, read);
  const std::vector<Vec3> points = sampled(scene, mesh);
  if (points.empty()) throw Error("no particle fits into it; make its spacing smaller");
  BodyOptions options = scene.body;
  if (scene.cluster > 0.0) options.match.clusters = overlapping_clusters(points, scene.cluster);
  const AddBodyResult added = bodies_->add(points, options);
  if (!added.refused.empty()) {
    const Vec3& x = points[added.refused.front()];
    throw Error(fmt::format("{} of its {} particles are in no free cell, the first at ({}, {}, {}); move or turn it",
                            added.refused.size(), points.size(), x.x, x.y, x.z));
  }
  CarriedSurface carried(mesh.points, points);
  skins_.push_back({std::move(mesh), std::move(carried)});
}

void Solids::step(double begin) {
  if (bodies_) bodies_step_ = bodies_->step();
  for (std::size_t i = 0; i < catheters_.size(); ++i) {
    const CatheterInput input = input_at(scene_.catheters[i], begin, scene_.motion.dt);
    const CatheterStep& done = catheter_steps_[i] = catheters_[i].step(input);
    CatheterTotals& totals = catheter_totals_[i];
    totals.worst_segment = std::max(totals.worst_segment, done.worst_segment);
    totals.refused += std::abs(input.push - done.pushed);
  }
}

void Solids::update_after_edit(OrphanPolicy orphaned) {
  if (bodies_) bodies_->update_after_edit(orphaned);
  for (Catheter& c : catheters_) c.update_after_edit();
}

std::vector<BodySummary> Solids::body_summaries() const {
  std::vector<BodySummary> all;
  for (const BodyScene& body : scene_.bodies) all.push_back({body.name, 0, true, {}, {}});
  for (std::size_t b = 0; bodies_ && b < bodies_->size(); ++b) {
    all[bodies_->id(b)] = {name(b), bodies_->particle_count(b), false, bodies_->rigid_motion_of(b).centre,
                           bodies_->energy(b)};
  }
  return all;
}

std::vector<CatheterSummary> Solids::catheter_summaries() const {
  std::vector<CatheterSummary> all;
  for (std::size_t i = 0; i < catheters_.size(); ++i) {
    const Catheter& c = catheters_[i];
    all.push_back(
        {scene_.catheters[i].name, c.inserted(), c.measured_length(), catheter_totals_[i], c.particles()[0].position});
  }
  return all;
}

Audit Solids::audit() const {
  Audit all;
  const auto add = [&](const Particles& particles) {
    all += dartcast::audit(environment_.complex(), particles, environment_.threads());
  };
  if (bodies_) add(bodies_->particles());
  for (const Catheter& c : catheters_) add(c.particles());
  return all;
}

StateHash Solids::state_hash() const {
  StateHash all;
  if (bodies_) all += bodies_->state_hash();
  for (const Catheter& c : catheters_) all += c.state_hash();
  return all;
}

SolidsCheckpoint Solids::checkpoint() const {
  SolidsCheckpoint saved;
  if (bodies_) saved.bodies = bodies_->checkpoint();
  saved.catheter_totals = catheter_totals_;
  for (const Catheter& c : catheters_) saved.catheters.push_back(c.checkpoint());
  return saved;
}

void Solids::restore(const SolidsCheckpoint& saved) {
  if (saved.catheters.size() != catheters_.size() || saved.catheter_totals.size() != catheters_.size())
    throw InvalidArgument(
        fmt::format("{} catheters were saved, there are {}", saved.catheters.size(), catheters_.size()));
  if (bodies_) bodies_->restore(saved.bodies);
  for (std::size_t i = 0; i < catheters_.size(); ++i) catheters_[i].restore(saved.catheters[i]);
  catheter_totals_ = saved.catheter_totals;
}

}  // namespace dartcast
