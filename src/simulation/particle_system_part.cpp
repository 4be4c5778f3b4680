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

void ParticleSystem::set_part(PartEnvironment& part) {
  part_ = &part;
  for (auto* counts : {&totals_.contacts_by_patch, &totals_.deposited_by_patch, &totals_.escaped_by_patch})
    counts->pop_back();  // behind the ghosts
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

void ParticleSystem::take_over(const std::vector<std::string>& packed) {
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
StepReport ParticleSystem::advance_in_part(const Acceleration& acceleration, std::vector<std::uint8_t>& departed) {
  const ContactCallback respond = [&](const Contact& c, std::span<const WallHit> walls,
                                      std::span<const WallHit> earlier) {
    return answer(acceleration)(c, walls, earlier);
  };
  TableTravel data(set_.table, set_.table.contact_count);
  return part_->advance(set_.states, aiming_.targets(), respond, options_.step, data, departed);
}

}  // namespace dartcast
