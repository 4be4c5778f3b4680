// Particles of an environment that ranks share by cells: each rank has those in its own cells.
//
// A step: particles that end in another rank's cell, or cross one on their way to a wall, go there with all their data.
// At the end of the step their former entries are removed, and the others are put in the order of ids.
#include <algorithm>
#include <utility>

#include "base/bytes.hpp"
#include "dartcast/error.hpp"
#include "dartcast/predicates.hpp"
#include "environment/table_travel.hpp"
#include "simulation/particle_system.hpp"
#include "tracking/batch/traveller.hpp"

namespace dartcast {

namespace {

class PartTravel final : public TableTravel {
 public:
  explicit PartTravel(ParticleTable& table) : TableTravel(table), table_(table) {}

  // The row that stays here is removed after the step.
  [[nodiscard]] std::string leave(std::uint32_t i, std::uint32_t contacts) const override {
    std::uint32_t& count = table_[table_.contact_count][i];
    count += std::min(contacts, UINT32_MAX - count);
    return TableTravel::leave(i, contacts);
  }

 private:
  ParticleTable& table_;
};

}  // namespace

void ParticleSystem::set_part(PartEnvironment& part) {
  part_ = &part;
  totals_.contacts_by_patch.pop_back();  // behind the ghosts
}

std::vector<std::string> ParticleSystem::packed_for(const std::function<std::uint32_t(Cell)>& owner) const {
  SimulationState all;
  save(all);
  const SavedParticles& saved = all.particles.table;
  std::vector<ByteWriter> to(options_.ranks->size());
  for (std::size_t i = 0; i < saved.rows(); ++i) saved.pack(i, to[owner(set_.states[i].cell)]);
  std::vector<std::string> packed;
  for (const ByteWriter& out : to) packed.push_back(out.bytes());
  return packed;
}

// Inlets draw from the areas at rest.
void ParticleSystem::take_over(const std::vector<std::string>& packed) {
  std::vector<Inlet> inlets;
  for (Inlet& i : inlets_)
    inlets.push_back({i.patch, PatchSampler(environment_.complex(), i.patch, sampled_part()), i.rate, i.velocity,
                      i.radius, std::move(i.user_data)});
  inlets_ = std::move(inlets);
  SavedParticles all(set_.table);
  all.truncate(0);
  for (const std::string& bytes : packed) {
    for (ByteReader in(bytes); !in.at_end();) all.append(in);
  }
  put_in_place_of_all(all);
  set_.put_in_order_of_ids();
}

std::optional<SampledPart> ParticleSystem::sampled_part() const {
  if (part_ == nullptr) return {};
  return SampledPart{part_->cells(), *options_.ranks};
}

ParticleState ParticleSystem::whole_state(std::size_t i) const {
  return part_ == nullptr ? set_.states[i] : dartcast::whole_state(part_->cells(), set_.states[i]);
}

// The arrays that responses change may move while particles come.
StepReport ParticleSystem::advance_in_part(const Acceleration& acceleration) {
  const ContactCallback respond = [&](const Contact& c, std::span<const WallHit> walls,
                                      std::span<const WallHit> earlier) {
    return respond_with(responses_, set_.velocities(), set_.fates(), options_.dt, acceleration)(c, walls, earlier);
  };
  PartTravel data(set_.table);
  return part_->advance(set_.states, aiming_.targets(), respond, options_.step, data, departed_);
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
      (environment_.add(set_.states, s->simplex, flushed(s->position)) ? placed : failed).push_back(w.id);
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

}  // namespace dartcast
