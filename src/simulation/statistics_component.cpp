// Keeps the statistics of a simulation up to date, step by step and edit by edit.
//
// Phases of a step, in order:
//  1. after the injection: positions and new particles are noted;
//  2. after the particles' step: crossings, residence times of those that left, points of pathlines are found;
//  3. count() adds them and the hits to the totals.
#include "simulation/statistics_component.hpp"

#include <algorithm>
#include <utility>

#include "dartcast/combinatorial_map.hpp"
#include "dartcast/error.hpp"
#include "simulation/gathered_step.hpp"
#include "simulation/parcels.hpp"
#include "simulation/timer.hpp"

namespace dartcast {

namespace {

constexpr std::uint32_t left_the_scene = 0xffffffffU;

std::vector<Vec3> positions_of(const Particles& particles) {
  std::vector<Vec3> positions;
  positions.reserve(particles.size());
  for (const ParticleState& s : particles.states()) positions.push_back(s.position);
  return positions;
}

}  // namespace

void StatisticsComponent::set_options(const StatisticsOptions& options) {
  dartcast::check(options.planes);
  check_cell_quantities(options.cells);
  if (options.impacts && !options.hits) throw InvalidArgument("statistics: impacts are sums of hits: set hits, too");
  std::optional<TallyPlan> plan;
  if (options.cells.empty() && options.cells_every > 0)
    throw InvalidArgument("statistics: a number of steps is for sums by cell: name quantities in cells");
  if (!options.cells.empty() || !options.classes_of.empty() || !options.class_bounds.empty())
    plan.emplace(options, particles_.options(), starts_);
  options_ = options;
  std::sort(options_.pathlines_of.begin(), options_.pathlines_of.end());
  statistics_ = {};
  statistics_.planes.resize(options.planes.size());
  if (options.residence) statistics_.left.resize(particles_.environment().map().patch_names().size());
  starts_ = {};
  tally_.reset();
  plan_.reset();
  if (!plan) return;
  plan_.emplace(*plan);
  if (options.residence && !options.classes_of.empty())
    statistics_.left_by_class.resize(statistics_.left.size() * plan_->classes());
  if (options.cells.empty()) return;
  tally_.emplace(particles_.environment().complex(), plan_->classes(), plan_->amounts());
}

void StatisticsComponent::note_start() {
  const std::uint64_t every = options_.cells_every;
  if (tally_ && every > 0 && particles_.motion().steps() % every == 0)
    tally_->reset(particles_.environment().complex());
  if (!observes_motion()) return;
  const ScopeTimer timer(statistics_.seconds);
  const std::span<const std::uint64_t> ids = particles_.set().ids();
  const std::span<const Vec3> velocities = particles_.set().velocities();
  ids_.assign(ids.begin(), ids.end());
  before_ = positions_of(particles_.set().states);
  numbers_ = particles_.parcels().numbers(particles_.set());
  if (!statistics_.left_by_class.empty()) classes_ = plan_->classes_of(particles_.set());
  first_new_ = static_cast<std::size_t>(std::lower_bound(ids.begin(), ids.end(), starts_.next_id()) - ids.begin());
  start_velocities_.assign(velocities.begin() + static_cast<std::ptrdiff_t>(first_new_), velocities.end());
  starts_.add(particles_.set().next_id, particles_.motion().time());
}

void StatisticsComponent::step(double begin) {
  if (!observes_motion()) return;
  find_ends();
  find_passages(begin);
  find_leavings(begin);
  add_path_points(begin);
}

void StatisticsComponent::count() {
  const ScopeTimer timer(statistics_.seconds);
  const SimulationStep& step = particles_.last_step();
  if (options_.hits) {
    std::vector<Impact> impacts;
    if (!step.parcels.empty()) impacts = impacts_of(step, particles_.options());
    statistics_.hits.add(particles_.environment(), step.report.contacts, impacts);
  }
  const double dt = particles_.options().dt;
  for (const PlanePassage& passage : statistics_.passages) {
    PlaneTotals& totals = statistics_.planes[passage.crossing.plane];
    (passage.crossing.forward ? totals.forward : totals.backward).add(passage.age, dt, passage.number);
  }
  for (const Leaving& p : leavings_) {
    LeaveTotals& totals = statistics_.left[p.patch.value];
    (p.status == ParticleStatus::escaped ? totals.escaped : totals.absorbed).add(p.age, dt, p.number);
    if (statistics_.left_by_class.empty()) continue;
    LeaveTotals& own = statistics_.left_by_class[p.of_class * statistics_.left.size() + p.patch.value];
    (p.status == ParticleStatus::escaped ? own.escaped : own.absorbed).add(p.age, dt, p.number);
  }
}

void StatisticsComponent::set_found(std::vector<PlanePassage> passages, std::vector<PathPoint> points,
                                    std::vector<Leaving> leavings) {
  statistics_.passages = std::move(passages);
  statistics_.path_points = std::move(points);
  leavings_ = std::move(leavings);
}

// Both lists of ids ascend. The particles that are in the first alone have left.
void StatisticsComponent::find_ends() {
  const std::span<const std::uint64_t> ids = particles_.set().ids();
  auto left = particles_.last_step().left.begin();
  after_.resize(ids_.size());
  now_.resize(ids_.size());
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < ids_.size(); ++i) {
    const bool stays = next < ids.size() && ids[next] == ids_[i];
    now_[i] = stays ? next : left_the_scene;
    after_[i] = stays ? particles_.set().states[next].position : left->position;
    if (stays)
      ++next;
    else
      ++left;
  }
}

void StatisticsComponent::find_passages(double begin) {
  const double dt = particles_.options().dt;
  statistics_.passages.clear();
  if (options_.planes.empty()) return;
  for (const PlaneCrossing& c : find_crossings(options_.planes, before_, after_, particles_.environment().threads())) {
    PlanePassage passage{c, ids_[c.particle], begin + c.share * dt, 0.0, number_of(c.particle)};
    passage.age = passage.time - starts_.of(passage.id);
    statistics_.passages.push_back(passage);
  }
}

void StatisticsComponent::find_leavings(double begin) {
  leavings_.clear();
  if (!options_.residence) return;
  const double dt = particles_.options().dt;
  const ContactList& list = particles_.last_step().report.contacts;
  for (const LeftParticle& p : particles_.last_step().left) {
    const Contact& last = list.contacts[p.contact];
    const double time = begin + last.time_of_impact * dt;
    const auto i = static_cast<std::size_t>(std::lower_bound(ids_.begin(), ids_.end(), p.id) - ids_.begin());
    leavings_.push_back({p.id, p.status, list.walls_of(last).front().patch, time - starts_.of(p.id), number_of(i),
                         classes_.empty() ? 0 : classes_[i]});
  }
}

bool StatisticsComponent::has_pathline(std::uint64_t id) const {
  return (options_.pathlines_every > 0 && id % options_.pathlines_every == 0) ||
         std::binary_search(options_.pathlines_of.begin(), options_.pathlines_of.end(), id);
}

void StatisticsComponent::add_path_points(double begin) {
  std::vector<PathPoint>& points = statistics_.path_points;
  points.clear();
  if (!options_.pathlines()) return;
  const std::vector<Contact>& contacts = particles_.last_step().report.contacts.contacts;
  std::size_t first = 0;
  for (std::size_t i = 0; i < ids_.size(); ++i) {
    if (!has_pathline(ids_[i])) continue;
    if (i >= first_new_) points.push_back({ids_[i], begin, before_[i], start_velocities_[i - first_new_], false});
    while (first < contacts.size() && contacts[first].particle < i) ++first;
    std::size_t end = first;
    while (end < contacts.size() && contacts[end].particle == i) ++end;
    add_contacts(i, first, end, begin);
    first = end;
    if (now_[i] != left_the_scene)
      points.push_back({ids_[i], particles_.motion().time(), after_[i], particles_.set().velocities()[now_[i]], false});
  }
}

void StatisticsComponent::add_contacts(std::size_t i, std::size_t first, std::size_t end, double begin) {
  const double dt = particles_.options().dt;
  double time = begin;
  Vec3 position = before_[i];
  for (std::size_t k = first; k < end; ++k) {
    const Contact& c = particles_.last_step().report.contacts.contacts[k];
    PathPoint point{ids_[i], begin + c.time_of_impact * dt, c.point, {}, true};
    if (point.time > time) point.velocity = (point.position - position) * (1.0 / (point.time - time));
    time = point.time;
    position = point.position;
    statistics_.path_points.push_back(point);
  }
}

void StatisticsComponent::update_after_edit(const ComplexEditReport& edit, OrphanPolicy /*orphaned*/) {
  if (tally_) {
    std::vector<std::uint64_t> words = tally_->words();
    sum_over(particles_.options().ranks, words);
    keep_on_first(words);  // shares of a sum are rounded: they are not sums of shares
    tally_->update_after_edit(particles_.environment().complex(), edit);
  }
  if (options_.hits) statistics_.hits.update_after_edit(particles_.environment());
  if (!options_.residence) return;
  starts_.add(particles_.set().next_id, particles_.motion().time());
  std::vector<Leaving> absorbed;
  for (const auto& [id, number] : particles_.edited().absorbed)
    absorbed.push_back({id, ParticleStatus::absorbed, {}, particles_.motion().time() - starts_.of(id), number});
  for (const Leaving& p : gathered_by_id(particles_.options().ranks, std::move(absorbed)))
    statistics_.absorbed_by_edits.add(p.age, particles_.options().dt, p.number);
}

// The sums of all ranks.
void StatisticsComponent::keep_on_first(std::vector<std::uint64_t> words) {
  if (!particles_.share().is_first()) std::fill(words.begin(), words.end(), 0);
  tally_->set_words(words);
}

Audit StatisticsComponent::audit() const {
  Audit audit;
  if (!tally_ || tally_->adds_up()) return audit;
  audit.failed = 1;
  audit.first = "the sums of all cells are not those of all particles";
  return audit;
}

void StatisticsComponent::check(const SimulationState& state) const {
  const StatisticsState& saved = state.statistics;
  if (saved.has_hits != options_.hits || saved.has_impacts != options_.impacts ||
      saved.observes_motion != observes_motion() || saved.planes.size() != options_.planes.size() ||
      saved.left.size() != statistics_.left.size() || saved.left_by_class.size() != statistics_.left_by_class.size() ||
      saved.cells.empty() == tally_.has_value())
    throw InvalidArgument("simulation: the checkpoint has other statistics: set those that it was saved with");
}

void StatisticsComponent::save(SimulationState& state) const {
  StatisticsState& saved = state.statistics;
  saved.has_hits = options_.hits;
  saved.has_impacts = options_.impacts;
  saved.hits = statistics_.hits.faces();
  saved.ended_hits = statistics_.hits.ended_by_patch();
  saved.observes_motion = observes_motion();
  saved.planes = statistics_.planes;
  saved.left = statistics_.left;
  saved.left_by_class = statistics_.left_by_class;
  saved.absorbed_by_edits = statistics_.absorbed_by_edits;
  saved.starts = starts_.starts();
  saved.next_id = starts_.next_id();
  saved.cells = tally_ ? tally_->words() : std::vector<std::uint64_t>();
}

void StatisticsComponent::restore(const SimulationState& state) {
  const StatisticsState& saved = state.statistics;
  if (tally_) {
    tally_->reset(particles_.environment().complex());
    keep_on_first(saved.cells);
  }
  statistics_.hits.restore(particles_.environment(), saved.hits, saved.ended_hits);
  statistics_.planes = saved.planes;
  statistics_.left = saved.left;
  statistics_.left_by_class = saved.left_by_class;
  statistics_.absorbed_by_edits = saved.absorbed_by_edits;
  statistics_.passages.clear();
  statistics_.path_points.clear();
  leavings_.clear();
  starts_ = StartTimes(saved.starts, saved.next_id);
}

}  // namespace dartcast
