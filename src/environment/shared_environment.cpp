// The public face of an environment in parts: ids and data of particles that go along with them.
#include "dartcast/shared_environment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "base/bytes.hpp"
#include "base/kept_runs.hpp"
#include "base/put_in_order.hpp"
#include "dartcast/error.hpp"
#include "environment/audit_of_all.hpp"
#include "environment/part_environment.hpp"

namespace dartcast {

namespace {

// The arrays beside the particles.
class SharedData final : public TravelData {
 public:
  SharedData(std::vector<std::uint64_t>& ids, std::vector<double>& numbers, std::size_t width)
      : ids_(ids), numbers_(numbers), width_(width) {}

  [[nodiscard]] std::string leave(std::uint32_t i, std::uint32_t /*contacts*/) const override {
    ByteWriter out;
    out.put(ids_[i]);
    for (std::size_t k = 0; k < width_; ++k) out.put(numbers_[i * width_ + k]);
    return out.bytes();
  }
  void come(std::string_view data) override {
    ByteReader in(data);
    ids_.push_back(in.take<std::uint64_t>());
    for (std::size_t k = 0; k < width_; ++k) numbers_.push_back(in.take<double>());
  }

 private:
  std::vector<std::uint64_t>& ids_;
  std::vector<double>& numbers_;
  std::size_t width_;
};

}  // namespace

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
  std::vector<Place> places;
  for (const AddResult& a : members_->steps.add(particles.particles_, positions)) {
    places.push_back(a.location.place);
    if (a.location.place != Place::free) continue;
    if (a.particle == particles.ids_.size())
      particles.ids_.push_back(particles.next_id_);  // else it is on another rank
    ++particles.next_id_;
  }
  particles.user_data_.resize(particles.size() * particles.width_);
  return places;
}

void SharedEnvironment::move(std::span<const Vec3> positions) { members_->environment.move(positions); }

// Particles that have come are behind the others; all are put in the order of ids.
SharedStep SharedEnvironment::advance(SharedParticles& particles, std::span<const Vec3> targets,
                                      const ContactCallback& respond, const StepOptions& options) {
  const ContactCallback stay = [](const Contact&, std::span<const WallHit>, std::span<const WallHit>) {
    return AfterContact{};
  };
  SharedData data(particles.ids_, particles.user_data_, particles.width_);
  std::vector<std::uint8_t> gone;
  const std::size_t before = particles.size();
  SharedStep step;
  step.report = members_->steps.advance(particles.particles_, targets, respond ? respond : stay, options, data, gone);
  for (const Contact& c : step.report.contacts.contacts) step.contact_ids.push_back(particles.ids_[c.particle]);
  step.left = static_cast<std::uint64_t>(std::count(gone.begin(), gone.end(), 1));
  step.come = particles.size() - before;
  particles.particles_.remove(gone);
  const KeptRuns runs(gone);
  runs.keep_in(particles.ids_);
  runs.keep_in(particles.user_data_, particles.width_);
  const std::vector<std::uint32_t> order = order_of(particles.ids_);
  if (order.empty()) return step;
  particles.particles_.reorder(order);
  put_in_order(particles.ids_, order);
  put_in_order(particles.user_data_, order, particles.width_);
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
