// Many points: a batch of walks takes those that prove to touch no wall, and SimultaneousStep the others.
#include <memory>
#include <mutex>
#include <vector>

#include "complex/periodic_faces.hpp"
#include "dartcast/combinatorial_map.hpp"
#include "dartcast/spheres.hpp"
#include "environment/environment_members.hpp"
#include "spheres/simultaneous_step.hpp"
#include "tracking/batch/step_decider.hpp"

namespace dartcast {

struct SimultaneousStepper::Buffers {
  MovingWalls walls;
  std::mutex mutex;
  // Memories that no thread uses. No result depends on which one a thread gets.
  std::vector<std::unique_ptr<SimultaneousStep::Memory>> idle;
};

namespace {

class SimultaneousDecider final : public detail::StepDecider {
 public:
  SimultaneousDecider(const CellComplex& complex, const StepOptions& options, const ContactCallback& respond,
                      const MovingWalls* walls, SimultaneousStepper::Buffers& buffers)
      : step_(complex, options, respond, walls), buffers_(buffers) {}

  void choose(std::span<const ParticleState> states, std::span<const Vec3> targets,
              std::span<detail::StepTaker> takers) const override {
    const Borrowed borrowed(buffers_);
    SimultaneousStep::Memory& memory = borrowed.memory();
    memory.free.resize(states.size());
    for (std::size_t i = 0; i < states.size(); ++i)
      memory.free[i] = states[i].held || states[i].touching_count > 0 ? 0 : 1;
    step_.find_free(states, targets, memory.free, memory);
    for (std::size_t i = 0; i < states.size(); ++i) {
      takers[i] = states[i].held || states[i].touching_count > 0 ? detail::StepTaker::carried
                  : memory.free[i] != 0                          ? detail::StepTaker::walk
                                                                 : detail::StepTaker::decider;
    }
  }
  StepResult step(std::uint32_t particle, ParticleState& state, Weights& weights, const Vec3& target,
                  ContactList& contacts, Counters& counters) const override {
    const Borrowed memory(buffers_);
    return step_.step(particle, state, weights, target, contacts, counters, memory.memory());
  }

 private:
  class Borrowed {
   public:
    explicit Borrowed(SimultaneousStepper::Buffers& buffers) : buffers_(buffers) {
      const std::lock_guard lock(buffers_.mutex);
      if (buffers_.idle.empty()) {
        memory_ = std::make_unique<SimultaneousStep::Memory>();
      } else {
        memory_ = std::move(buffers_.idle.back());
        buffers_.idle.pop_back();
      }
    }
    Borrowed(const Borrowed&) = delete;
    Borrowed& operator=(const Borrowed&) = delete;
    ~Borrowed() {
      const std::lock_guard lock(buffers_.mutex);
      buffers_.idle.push_back(std::move(memory_));
    }
    [[nodiscard]] SimultaneousStep::Memory& memory() const { return *memory_; }

   private:
    SimultaneousStepper::Buffers& buffers_;
    std::unique_ptr<SimultaneousStep::Memory> memory_;
  };

  SimultaneousStep step_;
  SimultaneousStepper::Buffers& buffers_;
};

}  // namespace

SimultaneousStepper::SimultaneousStepper() = default;
SimultaneousStepper::~SimultaneousStepper() = default;
SimultaneousStepper::SimultaneousStepper(SimultaneousStepper&&) noexcept = default;
SimultaneousStepper& SimultaneousStepper::operator=(SimultaneousStepper&&) noexcept = default;

StepReport SimultaneousStepper::advance(Environment& environment, Particles& particles, std::span<const Vec3> targets,
                                        const ContactCallback& respond, const StepOptions& options) {
  if (particles.size() == 0 || !environment.awaits_advance(particles))
    return environment.advance(particles, targets, respond, options);
  detail::refuse_periodic(environment.complex(), "points that move at the same time as the walls");
  if (!buffers_) buffers_ = std::make_unique<Buffers>();
  // A look at all walls costs some 250 instructions for each, and a search through cells some 6,000 for each point. Before
  // that the walls have to be found among the cells.
  constexpr std::size_t cells_for_a_point = 64;
  constexpr std::size_t walls_for_a_point = 16;
  const CombinatorialMap& map = environment.map();
  bool lists_walls = map.dimension() == 3 && map.cell_count() <= cells_for_a_point * particles.size();
  if (lists_walls) {
    buffers_->walls.list(environment.complex(), {environment.members_->id, environment.members_->edits});
    lists_walls = buffers_->walls.size() <= walls_for_a_point * particles.size();
  }
  if (lists_walls) buffers_->walls.update(environment.complex(), environment.threads());
  const auto make = [&](const ContactCallback& answer) {
    return std::make_unique<SimultaneousDecider>(environment.complex(), options, answer,
                                                 lists_walls ? &buffers_->walls : nullptr, *buffers_);
  };
  return environment.advance_by(make, particles, targets, respond, options);
}

}  // namespace dartcast
