// The public functions of Bodies. Each calls the function of its members that does the work.
#include "dartcast/bodies.hpp"

#include <utility>

#include "bodies/bodies_impl.hpp"
#include "complex/periodic_faces.hpp"

namespace dartcast {

Bodies::Bodies(Environment& environment, const BodiesOptions& options, WallResponses responses)
    : impl_(std::make_unique<Impl>(environment, options, std::move(responses))) {}
Bodies::~Bodies() = default;
Bodies::Bodies(const Bodies& other) : impl_(std::make_unique<Impl>(*other.impl_)) {}
// Allocates, for the other one keeps members: it can be used again.
Bodies::Bodies(Bodies&& other)  // NOLINT(performance-noexcept-move-constructor)
    : impl_(std::make_unique<Impl>(std::move(*other.impl_))) {}

AddBodyResult Bodies::add(std::span<const Vec3> points, const BodyOptions& options) {
  detail::refuse_periodic(impl_->environment_.complex(), "bodies");
  return impl_->add(points, options);
}
const BodiesStep& Bodies::step() { return impl_->step(); }
double Bodies::move_with(std::span<const Vec3> positions) { return impl_->move_with(positions); }
RigidMover Bodies::predicted_state(std::size_t body) const { return impl_->predicted_state(body); }
void Bodies::apply_impulse(std::size_t body, const RigidMover& solved) { impl_->apply_impulse(body, solved); }
UpdateReport Bodies::update_after_edit(OrphanPolicy orphaned) { return impl_->update_after_edit(orphaned); }

const Environment& Bodies::environment() const { return impl_->environment_; }
const BodiesOptions& Bodies::options() const { return impl_->options_; }
std::uint64_t Bodies::steps() const { return impl_->steps_; }
std::size_t Bodies::size() const { return impl_->bodies_.size(); }
std::uint32_t Bodies::id(std::size_t body) const { return impl_->bodies_[body].id; }
std::size_t Bodies::first_particle(std::size_t body) const { return impl_->bodies_[body].first; }
std::size_t Bodies::particle_count(std::size_t body) const { return impl_->bodies_[body].shape.size(); }
std::span<const Fit> Bodies::fits(std::size_t body) const { return impl_->bodies_[body].fits; }
BodyEnergy Bodies::energy(std::size_t body) const { return impl_->energy(body); }
RigidMotion Bodies::rigid_motion_of(std::size_t body) const { return impl_->rigid_motion_of(body); }

std::span<const Vec3> Bodies::surface(std::size_t body) const { return impl_->surface(body); }
SolidAudit Bodies::audit() const { return impl_->surfaces_.set ? impl_->surfaces_.set->audit() : SolidAudit{}; }
const Particles& Bodies::particles() const { return impl_->particles_; }
std::span<const Vec3> Bodies::positions() const { return impl_->positions_; }
std::span<const Vec3> Bodies::velocities() const { return std::as_const(impl_->velocities_); }
std::span<Vec3> Bodies::velocities() { return impl_->velocities_; }
std::span<const double> Bodies::masses() const { return impl_->masses_; }
std::span<const double> Bodies::radii() const { return impl_->radii_; }
std::span<const std::uint32_t> Bodies::body_of() const { return impl_->body_of_; }
std::span<const ParticleStatus> Bodies::statuses() const { return impl_->fates_; }

const Counters& Bodies::counters() const { return impl_->counters_; }
StateHash Bodies::state_hash() const { return impl_->state_hash(); }
BodiesCheckpoint Bodies::checkpoint() const { return impl_->checkpoint(); }
void Bodies::restore(const BodiesCheckpoint& saved) { impl_->restore(saved); }

}  // namespace dartcast
