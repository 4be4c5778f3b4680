// Moves vertices step by step, and to where they stood after other steps.
#include "simulation/moving_vertices.hpp"

#include <algorithm>

#include "dartcast/error.hpp"

namespace dartcast {

MovingVertices::MovingVertices(Environment& environment, Followers& followers, double dt)
    : environment_(environment), dt_(dt) {
  followers.add([this](const ComplexEditReport& edit, OrphanPolicy /*orphaned*/) {
    if (deformation_) deformation_->update_after_edit(edit, environment_.positions().size());
  });
}

void MovingVertices::set_deformation(Deformation deformation) {
  if (deformation.size() != environment_.positions().size()) {
    throw InvalidArgument(
        "simulation: the deformation has another number of points than the environment: make it for this mesh");
  }
  if (environment_.map().dimension() == 2) deformation.check_plane();
  deformation_ = std::move(deformation);
}

void MovingVertices::pull(std::span<const Vec3> displacement, double duration) {
  const auto positions = environment_.positions();
  const bool plane = environment_.map().dimension() == 2;
  if (plane && std::any_of(displacement.begin(), displacement.end(), [](const Vec3& d) { return d.z != 0.0; }))
    throw InvalidArgument("simulation: a pull moves points out of the plane: in the plane every z must be 0");
  if (!deformation_) deformation_.emplace(std::vector<DeformationStep>{}, positions);
  deformation_->add_pull(displacement, time(), time() + duration);
}

void MovingVertices::load(std::uint64_t steps) const {
  if (deformation_) deformation_->load_frames(static_cast<double>(steps) * dt_);
}

void MovingVertices::move_to(std::uint64_t steps) {
  if (!deformation_) return;
  if (steps == 0) {
    for (int i = 0; i < 2; ++i) {  // where they stand now, and where they stood before
      deformation_->at_rest(environment_.next_positions());
      environment_.move();
    }
    return;
  }
  deformation_->positions(static_cast<double>(steps) * dt_, environment_.next_positions(), environment_.threads());
  environment_.move();
}

void MovingVertices::move() {
  if (!deformation_) return;
  if (!mover_) return move_to(steps_ + 1);
  next_.resize(environment_.positions().size());
  deformation_->positions(static_cast<double>(steps_ + 1) * dt_, next_, environment_.threads());
  mover_(next_);
}

void MovingVertices::go_to(std::uint64_t steps) {
  // Edits of one step follow each other where the vertices stand. Those that the first of them made are in no known place.
  if (steps_ == steps) return;
  stand_at(steps);
  // The first of this step: later ones have the vertices that later edits gave the numbers of others.
  const auto known =
      std::find_if(known_places_.begin(), known_places_.end(), [&](const VertexPlaces& p) { return p.steps == steps; });
  if (known != known_places_.end()) put_back(*known);
  steps_ = steps;
}

void MovingVertices::stand_at(std::uint64_t steps) {
  if (steps > 0) load(steps);
  if (steps > 1 && steps_ + 1 != steps) move_to(steps - 1);
  move_to(steps);
}

void MovingVertices::restore(const SimulationState& state) {
  const std::uint64_t steps = state.particles.steps;
  if (steps_ != steps) stand_at(steps);
  const std::vector<VertexPlaces>& places = state.solids.places;
  if (!places.empty() && places.back().steps == steps) put_back(places.back());
  steps_ = steps;
}

VertexPlaces MovingVertices::places() const {
  const auto before = environment_.complex().previous_positions();
  const auto now = environment_.positions();
  return {steps_, {before.begin(), before.end()}, {now.begin(), now.end()}};
}

void MovingVertices::put_back(const VertexPlaces& places) {
  for (const std::vector<Vec3>* positions : {&places.before, &places.now}) {
    const std::span<Vec3> next = environment_.next_positions();  // without Steiner points
    std::copy_n(positions->begin(), next.size(), next.begin());
    environment_.move();
  }
  steps_ = places.steps;
}

}  // namespace dartcast
