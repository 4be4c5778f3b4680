// The public face of an environment in parts: ids and data of particles that go along with them.
#include "dartcast/shared_environment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/table.hpp"
#include "dartcast/error.hpp"
#include "environment/audit_of_all.hpp"
#include "environment/part_environment.hpp"
#include "environment/table_travel.hpp"

namespace dartcast {

// The table beside the particles.
struct SharedParticles::Beside : Table {
  explicit Beside(std::size_t width) : id(add_column<std::uint64_t>()), user_data(add_column<double>(width)) {}

  Column<std::uint64_t> id;
  Column<double> user_data;
};

SharedParticles::SharedParticles(std::size_t width) : width_(width), beside_(std::make_unique<Beside>(width)) {}
SharedParticles::SharedParticles(const SharedParticles& other)
    : width_(other.width_),
      particles_(other.particles_),
      beside_(std::make_unique<Beside>(*other.beside_)),
      next_id_(other.next_id_) {}
SharedParticles& SharedParticles::operator=(const SharedParticles& other) { return *this = SharedParticles(other); }
SharedParticles::SharedParticles(SharedParticles&& other) noexcept = default;
SharedParticles& SharedParticles::operator=(SharedParticles&& other) noexcept = default;
SharedParticles::~SharedParticles() = default;

std::span<const std::uint64_t> SharedParticles::ids() const { return std::as_const(*beside_)[beside_->id]; }
std::span<double> SharedParticles::user_data(std::size_t particle) {
  return beside_->row(beside_->user_data, particle);
}
std::span<const double> SharedParticles::user_data(std::size_t particle) const {
  return std::as_const(*beside_).row(beside_->user_data, particle);
}

struct SharedEnvironment::Members {
  Members(MeshPart mesh, Ranks& all, Threads threads)
      : ranks(all), part(std::move(mesh)), environment(part.mesh, threads), steps(environment, part, all) {}

  Ranks& ranks;
  MeshPart part;
  Environment environment;
  PartEnvironment steps;
};

SharedEnvironment::SharedEnvironment(MeshPart part, Ranks& ranks, Threads threads) {
  if (part.part != ranks.rank() || part.parts != ranks.size())
    throw InvalidArgument(fmt::format("SharedEnvironment: part {} of {} on rank {} of {}", part.part, part.parts,
                                      ranks.rank(), ranks.size()));
  members_ = std::make_unique<Members>(std::move(part), ranks, threads);
}

SharedEnvironment::~SharedEnvironment() = default;

const MeshPart& SharedEnvironment::part() const { return members_->part; }
const Environment& SharedEnvironment::environment() const { return members_->environment; }
Cell SharedEnvironment::whole(Cell here) const { return members_->steps.cells().whole(here); }

std::vector<Place> SharedEnvironment::add(SharedParticles& particles, std::span<const Vec3> positions) {
  SharedParticles::Beside& beside = *particles.beside_;
  std::vector<Place> places;
  for (const AddResult& a : members_->steps.add(particles.particles_, positions)) {
    places.push_back(a.location.place);
    if (a.location.place != Place::free) continue;
    const std::uint64_t id = particles.next_id_++;
    if (a.particle != beside.rows()) continue;  // it is on another rank
    beside.append_zeros(1);
    beside[beside.id].back() = id;
  }
  return places;
}

void SharedEnvironment::move(std::span<const Vec3> positions) { members_->environment.move(positions); }

// Particles that have come are behind the others; all are put in the order of ids.
SharedStep SharedEnvironment::advance(SharedParticles& particles, std::span<const Vec3> targets,
                                      const ContactCallback& respond, const StepOptions& options) {
  const ContactCallback stay = [](const Contact&, std::span<const WallHit>, std::span<const WallHit>) {
    return AfterContact{};
  };
  TableTravel data(*particles.beside_);
  std::vector<std::uint8_t> gone;
  const std::size_t before = particles.size();
  SharedStep step;
  step.report = members_->steps.advance(particles.particles_, targets, respond ? respond : stay, options, data, gone);
  for (const Contact& c : step.report.contacts.contacts) step.contact_ids.push_back(particles.ids()[c.particle]);
  step.left = static_cast<std::uint64_t>(std::count(gone.begin(), gone.end(), 1));
  step.come = particles.size() - before;
  particles.particles_.remove(gone);
  particles.beside_->remove(gone);
  const std::vector<std::uint32_t> order = particles.beside_->sort_by(particles.beside_->id);
  if (!order.empty()) particles.particles_.reorder(order);
  return step;
}

std::uint64_t SharedEnvironment::count(const SharedParticles& particles) const {
  std::uint64_t count = particles.size();
  members_->ranks.sum({&count, 1});
  return count;
}

Audit SharedEnvironment::audit(const SharedParticles& particles) const {
  const Environment& e = members_->environment;
  return audit_of_all(&members_->ranks, dartcast::audit(e.complex(), particles.particles_, e.threads()));
}

}  // namespace dartcast
