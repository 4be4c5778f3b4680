// Particles of an environment that ranks share by cells: each rank has those in its own cells.
//
// A step: particles that end in another rank's cell, or cross one on their way to a wall, go there with all their data.
// At the end of the step their former entries are removed, and the others are put in the order of ids.
#include <fmt/format.h>

#include <algorithm>
#include <type_traits>
#include <utility>

#include "base/bytes.hpp"
#include "base/put_in_order.hpp"
#include "dartcast/error.hpp"
#include "dartcast/predicates.hpp"
#include "simulation/particle_system.hpp"
#include "tracking/batch/traveller.hpp"

namespace dartcast {

// The arrays beside the particles, one entry at a time.
class ParticleSystem::PartData final : public TravelData {
 public:
  explicit PartData(ParticleSystem& system) : s_(system) {}

  [[nodiscard]] std::string leave(std::uint32_t i, std::uint32_t contacts) const override {
    ByteWriter out;
    out.put(s_.ids_[i]);
    out.put(s_.velocities_[i]);
    out.put(s_.fates_[i]);
    out.put(contacts + std::min(s_.contact_counts_[i], UINT32_MAX - contacts));
    for (const double value : std::as_const(s_).user_data(i)) out.put(value);
    return out.bytes();
  }

  void come(std::string_view data) override {
    ByteReader in(data);
    s_.ids_.push_back(in.take<std::uint64_t>());
    s_.velocities_.push_back(in.take<Vec3>());
    s_.fates_.push_back(in.take<ParticleStatus>());
    s_.contact_counts_.push_back(in.take<std::uint32_t>());
    s_.radii_.push_back(0.0);
    s_.held_.push_back(0);
    for (std::size_t k = 0; k < s_.width(); ++k) s_.user_data_.push_back(in.take<double>());
  }

 private:
  ParticleSystem& s_;
};

void ParticleSystem::set_part(PartEnvironment& part) {
  part_ = &part;
  totals_.contacts_by_patch.pop_back();  // behind the ghosts
}

std::vector<std::string> ParticleSystem::packed_for(const std::function<std::uint32_t(Cell)>& owner) const {
  static_assert(std::is_trivially_copyable_v<ParticleSystemState::Particle>);
  SimulationState all;
  save(all);
  const std::vector<ParticleSystemState::Particle>& particles = all.particles.particles;
  std::vector<std::vector<ParticleSystemState::Particle>> lists(options_.ranks->size());
  std::vector<std::vector<double>> data(lists.size());
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const std::uint32_t to = owner(particles_[i].cell);
    lists[to].push_back(particles[i]);
    const std::span<const double> own = user_data(i);
    data[to].insert(data[to].end(), own.begin(), own.end());
  }
  std::vector<std::string> packed;
  for (std::size_t r = 0; r < lists.size(); ++r) {
    ByteWriter out;
    out.put(lists[r]);
    out.put(data[r]);
    packed.push_back(out.bytes());
  }
  return packed;
}

// Inlets draw from the areas at rest.
void ParticleSystem::take_over(const std::vector<std::string>& packed) {
  std::vector<Inlet> inlets;
  for (Inlet& i : inlets_)
    inlets.push_back({i.patch, PatchSampler(environment_.complex(), i.patch, sampled_part()), i.rate, i.velocity,
                      i.radius, std::move(i.user_data)});
  inlets_ = std::move(inlets);
  stand_at(steps_);
  ParticleSystemState all;
  for (const std::string& bytes : packed) {
    ByteReader in(bytes);
    const auto particles = in.take_list<ParticleSystemState::Particle>();
    const auto data = in.take_list<double>();
    all.particles.insert(all.particles.end(), particles.begin(), particles.end());
    all.user_data.insert(all.user_data.end(), data.begin(), data.end());
  }
  put_in_place_of_all(all);
  put_in_order_of_ids();
}

std::optional<SampledPart> ParticleSystem::sampled_part() const {
  if (part_ == nullptr) return {};
  return SampledPart{part_->cells(), *options_.ranks};
}

ParticleState ParticleSystem::whole_state(std::size_t i) const {
  return part_ == nullptr ? particles_[i] : dartcast::whole_state(part_->cells(), particles_[i]);
}

// The arrays that responses change may move while particles come.
StepReport ParticleSystem::advance_in_part(const Acceleration& acceleration) {
  const ContactCallback respond = [&](const Contact& c, std::span<const WallHit> walls,
                                      std::span<const WallHit> earlier) {
    return respond_with(responses_, velocities_, fates_, options_.dt, acceleration)(c, walls, earlier);
  };
  PartData data(*this);
  return part_->advance(particles_, targets_, respond, options_.step, data, departed_);
}

// All ranks draw for each particle. The one whose cell it is adds it; where rounding has put the point outside, all draw
// again, with the next numbers of the same id.
template <class Sampler>
std::vector<std::uint64_t> ParticleSystem::place_in_part(const Sampler& sampler, std::uint64_t first,
                                                         std::uint64_t count) {
  constexpr int max_tries = 1000;
  struct Waiting {
    std::uint64_t id;
    KeyedRandom random;
  };
  std::vector<Waiting> waiting;
  for (std::uint64_t id = first; id < first + count; ++id)
    waiting.push_back({id, KeyedRandom(options_.seed, RandomPurpose::place, id)});
  std::vector<std::uint64_t> placed;
  for (int tries = 0; !waiting.empty(); ++tries) {
    if (tries == max_tries)
      throw InvalidArgument(
          "simulation: random points fall outside the free cells again and again: their cells are too thin or not "
          "valid");
    std::vector<std::uint64_t> failed;
    for (Waiting& w : waiting) {
      const std::optional<Sample> s = sampler.sample(environment_.complex(), w.random);
      if (!s) continue;
      (environment_.add(particles_, s->simplex, flushed(s->position)) ? placed : failed).push_back(w.id);
    }
    const std::vector<std::uint64_t> again = of_all_ranks(failed);
    std::erase_if(waiting, [&](const Waiting& w) { return !std::binary_search(again.begin(), again.end(), w.id); });
  }
  return placed;
}

template std::vector<std::uint64_t> ParticleSystem::place_in_part(const VolumeSampler&, std::uint64_t, std::uint64_t);
template std::vector<std::uint64_t> ParticleSystem::place_in_part(const PatchSampler&, std::uint64_t, std::uint64_t);

std::vector<std::uint64_t> ParticleSystem::of_all_ranks(const std::vector<std::uint64_t>& ids) const {
  ByteWriter out;
  out.put(ids);
  std::vector<std::uint64_t> all;
  for (const std::string& b : options_.ranks->exchange(std::vector<std::string>(options_.ranks->size(), out.bytes()))) {
    const auto list = ByteReader(b).take_list<std::uint64_t>();
    all.insert(all.end(), list.begin(), list.end());
  }
  std::sort(all.begin(), all.end());
  return all;
}

void ParticleSystem::put_in_order_of_ids() {
  const std::vector<std::uint32_t> order = order_of(ids_);
  if (order.empty()) return;
  particles_.reorder(order);
  put_in_order(ids_, order);
  put_in_order(velocities_, order);
  put_in_order(fates_, order);
  put_in_order(contact_counts_, order);
  put_in_order(radii_, order);
  put_in_order(held_, order);
  put_in_order(user_data_, order, width());
}

}  // namespace dartcast
