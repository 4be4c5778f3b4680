// Steps in rounds: all steps wait at their next contacts, one call answers these, and the steps continue.
//
// The phases, in order:
// 1. The chunks of the batch, where each deferred step goes to its first contact.
// 2. For each round: ask for the answers, and continue each step up to its next contact.
// 3. Sort what the rounds have reported by particle.
#include <algorithm>
#include <utility>

#include "base/parallel.hpp"
#include "tracking/batch/batch_stepper.hpp"

namespace dartcast::detail {

namespace {

constexpr std::size_t continued_at_once = 128;  // steps, by one thread

const ContactCallback no_response;

// The contacts of all rounds. Round k has the k-th contact of each particle.
ContactList by_particle(std::vector<ContactList> rounds) {
  if (rounds.size() == 1) return std::move(rounds.front());
  ContactList all;
  std::size_t contact_count = 0;
  for (const ContactList& round : rounds) contact_count += round.contacts.size();
  all.contacts.reserve(contact_count);
  std::vector<std::size_t> next(rounds.size());
  for (const Contact& first : rounds.front().contacts) {
    std::span<const WallHit> walls;
    const auto add_walls = [&] { all.walls.insert(all.walls.end(), walls.begin(), walls.end()); };
    for (std::size_t k = 0; k < rounds.size(); ++k) {
      const std::vector<Contact>& contacts = rounds[k].contacts;
      if (next[k] == contacts.size() || contacts[next[k]].particle != first.particle) break;
      Contact& contact = all.contacts.emplace_back(contacts[next[k]++]);
      if (contact.earlier < walls.size()) add_walls();  // a periodic crossing has ended what joins
      walls = all_walls_of(rounds[k], contact);
      contact.first_wall = static_cast<std::uint32_t>(all.walls.size()) + contact.earlier;
    }
    add_walls();
  }
  return all;
}

template <class Entry>
void merge_by_particle(std::vector<Entry>& all, const std::vector<Entry>& more) {
  const auto middle = static_cast<std::ptrdiff_t>(all.size());
  all.insert(all.end(), more.begin(), more.end());
  std::inplace_merge(all.begin(), all.begin() + middle, all.end(),
                     [](const Entry& a, const Entry& b) { return a.particle < b.particle; });
}

}  // namespace

BatchStepper::BatchStepper(const CellComplex& complex, bool moved, Threads threads, const StepOptions& options,
                           const RoundCallback& respond, const CrossingCallback* crossed)
    : complex_(complex),
      moved_(moved),
      threads_(threads),
      options_(options),
      may_throw_(true),
      rounds_(&respond),
      stepper_(complex, moved, options, no_response, crossed) {}

ChunkSteps BatchStepper::answer(const BatchParticles& particles, std::span<const StepState> waiting,
                                const ContactList& met, std::span<const AfterContact> after) const {
  std::vector<ChunkSteps> chunks(chunk_count(waiting.size(), continued_at_once));
  parallel_for(waiting.size(), continued_at_once, threads_, [&](std::size_t begin, std::size_t end) {
    ChunkSteps& steps = chunks[begin / continued_at_once];
    for (std::size_t i = begin; i < end; ++i) {
      StepState step = waiting[i];
      const std::uint32_t p = step.particle;
      stepper_.answer(met, met.contacts[i], after[i], step,
                      {particles.states[p], particles.weights[p], steps.report.contacts, steps.report.counters});
      add(particles, step, steps);
    }
  });
  return joined(std::move(chunks));
}

StepReport BatchStepper::answer_in_rounds(const BatchParticles& particles, ChunkSteps steps) const {
  StepReport report = std::move(steps.report);
  std::vector<ContactList> rounds;
  std::vector<PeriodicCrossing> crossings = std::move(report.contacts.crossings);
  rounds.push_back(std::move(report.contacts));
  while (!steps.waiting.empty()) {
    std::vector<AfterContact> after(steps.waiting.size());
    (*rounds_)(rounds.back(), after);
    steps = answer(particles, steps.waiting, rounds.back(), after);
    merge_by_particle(report.held, steps.report.held);
    merge_by_particle(report.stopped, steps.report.stopped);
    merge_by_particle(crossings, steps.report.contacts.crossings);
    report.counters += steps.report.counters;
    if (!steps.report.contacts.contacts.empty()) rounds.push_back(std::move(steps.report.contacts));
  }
  report.contacts = by_particle(std::move(rounds));
  report.contacts.crossings = std::move(crossings);
  return report;
}

}  // namespace dartcast::detail
