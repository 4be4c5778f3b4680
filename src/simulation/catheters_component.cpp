// Runs catheters as a part of a simulation.
#include "simulation/catheters_component.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "catheter/catheter_moves.hpp"
#include "dartcast/error.hpp"
#include "simulation/simulation_state.hpp"
#include "simulation/with_name.hpp"

namespace dartcast {

namespace {

// Push and turn of a step of this duration.
CatheterInput input_at(const CatheterScene& scene, double begin, double dt) {
  const double middle = begin + 0.5 * dt;
  for (const CatheterScene::Move& move : scene.moves) {
    if (middle < move.until) return {move.push * dt, move.turn * dt, {}};
  }
  return {};
}

}  // namespace

void CathetersComponent::add(const CatheterScene& scene) {
  with_name("catheter", scene.name, [&] { catheters_.emplace_back(environment_, scene.options); });
  scenes_.push_back(scene);
  steered_.emplace_back();
  last_.emplace_back();
  totals_.emplace_back();
}

void CathetersComponent::steer(std::size_t i, const CatheterInput& input) {
  if (i >= catheters_.size())
    throw InvalidArgument(
        fmt::format("simulation: there is no catheter {} to steer: it has {}, counted from 0", i, catheters_.size()));
  CatheterMoves::check(catheters_[i], input);
  steered_[i] = input;
}

std::vector<MovePartner*> CathetersComponent::partners() {
  std::vector<MovePartner*> all;
  for (Catheter& c : catheters_) {
    if (c.options().edges) all.push_back(&CatheterMoves::prepare(c));
  }
  return all;
}

void CathetersComponent::step(double begin) {
  for (std::size_t i = 0; i < catheters_.size(); ++i) {
    const CatheterInput input = steered_[i] ? *steered_[i] : input_at(scenes_[i], begin, dt_);
    const CatheterStep& done = last_[i] = catheters_[i].step(input);
    totals_[i].worst_segment = std::max(totals_[i].worst_segment, done.worst_segment);
    totals_[i].refused += std::abs(input.push - done.pushed);
  }
}

void CathetersComponent::update_after_edit(const ComplexEditReport& /*edit*/, OrphanPolicy /*orphaned*/) {
  for (Catheter& c : catheters_) c.update_after_edit();
}

void CathetersComponent::save(SimulationState& state) const {
  for (const Catheter& c : catheters_) state.catheters.catheters.push_back(c.checkpoint());
  state.catheters.totals = totals_;
}

void CathetersComponent::restore(const SimulationState& state) {
  const CathetersState& saved = state.catheters;
  if (saved.catheters.size() != catheters_.size() || saved.totals.size() != catheters_.size())
    throw InvalidArgument(
        fmt::format("catheters: the checkpoint has {}, the simulation has {}: add the same catheters first",
                    saved.catheters.size(), catheters_.size()));
  for (std::size_t i = 0; i < catheters_.size(); ++i) catheters_[i].restore(saved.catheters[i]);
  totals_ = saved.totals;
}

Audit CathetersComponent::audit() const {
  Audit all;
  for (const Catheter& c : catheters_) {
    all += dartcast::audit(environment_.complex(), c.particles(), environment_.threads());
    const SolidAudit segments = c.audit();
    all += {segments.checked, segments.failed, segments.first};
  }
  return all;
}

StateHash CathetersComponent::state_hash() const {
  StateHash all;
  for (const Catheter& c : catheters_) all += c.state_hash();
  return all;
}

std::vector<CatheterSummary> CathetersComponent::summaries() const {
  std::vector<CatheterSummary> all;
  for (std::size_t i = 0; i < catheters_.size(); ++i) {
    const Catheter& c = catheters_[i];
    all.push_back({scenes_[i].name, c.inserted(), c.measured_length(), totals_[i], c.particles()[0].position});
  }
  return all;
}

CameraPath CathetersComponent::camera_path(std::size_t i) const {
  std::vector<Vec3> inwards = catheters_[i].points();
  std::reverse(inwards.begin(), inwards.end());
  if (inwards.size() < 2) return {};
  return dartcast::camera_path(environment_, inwards, {.spacing = scenes_[i].camera});
}

}  // namespace dartcast
