// How particles follow an edit: those in cells that were replaced get a place in the cells that took theirs.
#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "base/parallel.hpp"
#include "complex/simplex.hpp"
#include "dartcast/environment.hpp"
#include "dartcast/error.hpp"
#include "environment/environment_members.hpp"
#include "environment/particle_details.hpp"
#include "mesh/box_tree.hpp"
#include "tracking/carry.hpp"
#include "tracking/nearest_free.hpp"
#include "tracking/step.hpp"

namespace dartcast {

namespace {

// x, rounded out of a positive simplex, put back into it.
template <std::size_t N>
Vec3 placed_inside(const std::array<Vec3, N>& v, const Vec3& x) {
  if (detail::in_closed_simplex(v, x)) return x;
  const Vec3 middle = flushed(detail::mean_of(v));
  if (const auto lifted = detail::lifted_inside(v, middle, x)) return *lifted;
  return detail::representable_inside(v, x).value_or(detail::in_closed_simplex(v, middle) ? middle : v[0]);
}

}  // namespace

/// One call of Environment::update_after_edit().
class EditFollower {
 public:
  // `complex`: the one that was edited, with the positions that the particles have gone along to.
  // `replaced`: the positions of the mesh before, if that was replaced; they must outlive it.
  EditFollower(const CellComplex& complex, const ComplexEditReport& edit, std::span<const Vec3> replaced,
               Particles& particles, OrphanPolicy orphaned)
      : complex_(complex),
        edit_(edit),
        positions_before_(edit.replaced ? replaced : complex.positions()),
        particles_(particles),
        states_(particles.states_),
        details_(particles.details()),
        orphaned_(orphaned) {
    for (const CellHandle& h : edit_.map.removed) removed_.push_back(h.cell);
    std::sort(removed_.begin(), removed_.end());
  }

  // For particles that were not advanced between a move and the edit. The vertices carry them along, as in a step
  // without a motion of their own. Those in removed cells get their new positions, and keep the names of these cells
  // for update_after_edit().
  void carry_with_mesh(Threads threads) {
    constexpr std::size_t edit_grain = 256;
    const StepOptions options;
    const ContactCallback stop;
    const Stepper stepper(complex_, true, options, stop);
    details_.index.reset();
    details_.cache.forget();
    parallel_for(particles_.size(), edit_grain, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        if (is_removed(states_[i].cell))
          states_[i].position = map().dimension() == 2 ? carried<3>(i) : carried<4>(i);
        else
          step(stepper, i);
      }
    });
  }

  UpdateReport update_after_edit() {
    if (edit_.replaced) return update_after_replacement();
    if (!details_.index || details_.index->is_outdated()) details_.index.emplace(states_);
    const std::vector<std::uint32_t> touched = particles_near(removed_, edit_.map.marked);
    for (const Cell c : removed_) details_.index->clear(c);  // another cell may take its number
    for (const std::uint32_t i : touched) take_along(i);
    for (const std::uint32_t i : particles_near(edit_.around, edit_.map.added)) leave_walls(states_[i]);
    remove_absorbed();
    return std::move(report_);
  }

 private:
  UpdateReport update_after_replacement() {
    locator_.emplace(complex_);
    details_.index.reset();
    details_.cache.forget();
    report_.touched = particles_.size();
    for (std::uint32_t i = 0; i < particles_.size(); ++i) {
      states_[i].touching_count = 0;
      locate(i);
      const bool orphaned = !report_.orphaned.empty() && report_.orphaned.back().particle == i;
      const bool leaves = orphaned && report_.orphaned.back().outcome == OrphanPolicy::absorb;
      if (!leaves) details_.cache.place(i, complex_, states_[i]);
    }
    remove_absorbed();
    return std::move(report_);
  }

  void step(const Stepper& stepper, std::size_t i) const {
    ParticleState& s = states_[i];
    Weights& weights = details_.weights[i];
    const Corners before = complex_.previous_corners(s.at());
    const Weights kept = s.held ? weights : detail::barycentric(before, s.position);
    const bool positive = volume_sign(complex_.corners(s.at())) == Sign::positive;
    const Vec3 target = positive ? detail::carried(complex_, s.at(), kept).position : s.position;
    ContactList contacts;
    Counters counters;
    stepper.step(static_cast<std::uint32_t>(i), s, weights, target, contacts, counters);
    details_.cache.place(i, complex_, s);
  }

  // The new position of a particle whose simplex was removed. The vertices of the simplex still have their positions:
  // their numbers are used again by the next edit at the earliest. The result lies exactly in the moved simplex if
  // that is positive.
  template <std::size_t N>
  [[nodiscard]] Vec3 carried(std::size_t i) const {
    const ParticleState& s = states_[i];
    std::array<Vec3, N> before;
    std::array<Vec3, N> after;
    for (std::size_t k = 0; k < N; ++k) {
      before[k] = complex_.previous_positions()[details_.cache.vertices(i)[k]];
      after[k] = complex_.positions()[details_.cache.vertices(i)[k]];
    }
    const Vec3 x =
        flushed(detail::combine(after, s.held ? details_.weights[i] : detail::barycentric(before, s.position)));
    if (volume_sign(after) == Sign::positive) return placed_inside(after, x);
    return in_exact_range(x) ? x : s.position;
  }

  [[nodiscard]] const CombinatorialMap& map() const { return complex_.map(); }

  // In the order of their numbers.
  [[nodiscard]] std::vector<std::uint32_t> particles_near(std::span<const Cell> some,
                                                          std::span<const Cell> others) const {
    std::vector<std::uint32_t> found;
    for (const std::span<const Cell> cells : {some, others}) {
      for (const Cell c : cells) details_.index->for_each(c, [&](std::uint32_t i) { found.push_back(i); });
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

  [[nodiscard]] bool is_removed(Cell c) const { return std::binary_search(removed_.begin(), removed_.end(), c); }

  [[nodiscard]] bool is_marked(Cell c) const {
    return std::binary_search(edit_.map.marked.begin(), edit_.map.marked.end(), c);
  }

  void take_along(std::uint32_t i) {
    ParticleState& s = states_[i];
    const bool gone = is_removed(s.cell);
    const bool marked = !gone && is_marked(s.cell);
    if (!gone && !marked && !touches_any(s)) return;  // it has left since it was listed
    ++report_.touched;
    leave_walls(s);
    if (gone) locate(i);
    if (marked && !map().is_free(s.cell)) orphan(i, Place::blocked, s.at());
    if (marked && map().is_free(s.cell) && s.held) release(i);
    if (gone || marked) keep_up(i);
  }

  [[nodiscard]] bool touches_any(const ParticleState& s) const {
    return std::any_of(s.touching.begin(), s.touching.begin() + s.touching_count,
                       [&](CellFace f) { return is_removed(f.cell) || is_marked(f.cell); });
  }

  // Forgets walls touched that are none any more.
  void leave_walls(ParticleState& s) const {
    const auto end = s.touching.begin() + s.touching_count;
    const auto kept = std::remove_if(
        s.touching.begin(), end, [&](CellFace f) { return is_removed(f.cell) || !map().view(f.cell).is_wall(f.face); });
    s.touching_count = static_cast<std::uint8_t>(kept - s.touching.begin());
  }

  // Among the cells that took the place of the particle's own. One on a wall stays on its side: the way from there to
  // the middle of its old simplex begins in the new one.
  template <std::size_t N>
  [[nodiscard]] SimplexId place_of(std::uint32_t i) const {
    const ParticleState& s = states_[i];
    std::array<Vec3, N> old;
    for (std::size_t k = 0; k < N; ++k) old[k] = positions_before_[details_.cache.vertices(i)[k]];
    const Vec3 middle = flushed(detail::mean_of(old));
    if (!s.held && detail::in_closed_simplex(old, middle)) {
      const SimplexId at = locator_->find(complex_, s.position, middle);
      const bool on_border = edit_.replaced && at.valid() && !map().is_free(at.cell);  // perhaps of a free cell, too
      if (at.valid() && !on_border) return at;
    }
    return locator_->find(complex_, s.position);
  }

  void locate(std::uint32_t i) {
    if (!locator_) locator_.emplace(complex_, edit_.map.added);
    ParticleState& s = states_[i];
    const SimplexId at = map().dimension() == 2 ? place_of<3>(i) : place_of<4>(i);
    if (!at.valid()) return orphan(i, Place::outside, at);
    if (!map().is_free(at.cell)) return orphan(i, Place::blocked, at);
    s.put(at, s.position);
    s.held = false;
    ++report_.located;
  }

  // `at`: the simplex of the blocked cell, invalid outside.
  void orphan(std::uint32_t i, Place place, SimplexId at) {
    ParticleState& s = states_[i];
    OrphanedParticle& p = report_.orphaned.emplace_back();
    p.particle = i;
    p.place = place;
    p.position = s.position;
    p.outcome = orphaned_;
    if (orphaned_ == OrphanPolicy::hold && at.valid()) return hold(i, at);
    if (orphaned_ != OrphanPolicy::absorb && move_to_free(s, at, p.distance)) {
      p.outcome = OrphanPolicy::relocate;
      return;
    }
    p.outcome = OrphanPolicy::absorb;
  }

  // Those whose boxes come as near as one that is found by doubling a distance, among them that of the nearest free cell.
  std::vector<Cell> free_cells_near(const Vec3& x) {
    if (!boxes_) list_free_cells();
    std::vector<Cell> found;
    const auto find = [&](double reach) {
      found.clear();
      const Vec3 r = {reach, reach, reach};
      boxes_->query({x - r, x + r}, [&](std::uint32_t i) {
        found.push_back(free_cells_[i]);
        return true;
      });
    };
    constexpr double farthest = 0x1p+200;  // beyond the exact range
    double reach = 0x1p-200;
    for (find(reach); found.empty() && reach < farthest; find(reach)) reach *= 2.0;
    const auto nearest = nearest_free(complex_, found, x);
    if (nearest) find(nearest->distance * (1.0 + 0x1p-20));
    return found;
  }

  void list_free_cells() {
    std::vector<Box> boxes;
    for (const Cell c : map().cells()) {
      const CellView v = map().view(c);
      if (!v.is_free()) continue;
      const Vec3& first = complex_.positions()[v.vertex(0).value];
      Box box = {first, first};
      for (std::uint16_t k = 1; k < v.shape().corner_count(); ++k) {
        const Vec3& p = complex_.positions()[v.vertex(k).value];
        box = join(box, {p, p});
      }
      boxes.push_back(box);
      free_cells_.push_back(c);
    }
    boxes_.emplace(std::move(boxes));
  }

  void hold(std::uint32_t i, SimplexId at) {
    ParticleState& s = states_[i];
    if (!s.held || s.at() != at) details_.weights[i] = detail::barycentric(complex_.corners(at), s.position);
    s.put(at, s.position);
    s.held = true;
  }

  bool move_to_free(ParticleState& s, SimplexId at, double& distance) {
    std::vector<Cell> start;
    if (edit_.replaced) {
      start = free_cells_near(s.position);
    } else if (at.valid()) {
      start = {at.cell};
    } else {
      start = edit_.map.added;
      start.insert(start.end(), edit_.around.begin(), edit_.around.end());
    }
    const auto nearest = nearest_free(complex_, start, s.position);
    if (!nearest) return false;
    s.put(nearest->place.simplex, nearest->place.position);
    s.held = false;
    distance = nearest->distance;
    return true;
  }

  // If rounding put a held particle beside its simplex, it is put back.
  void release(std::uint32_t i) {
    ParticleState& s = states_[i];
    const Corners corners = complex_.corners(s.at());
    if (volume_sign(corners) != Sign::positive) return;
    const SimplexPlacement placed = place_in_simplex(complex_, s.at(), s.position);
    s.put(placed.simplex, placed.position);
    s.held = false;
  }

  // Updates the data that belongs to a state.
  void keep_up(std::uint32_t i) {
    const ParticleState& s = states_[i];
    if (is_removed(s.cell)) return;  // it is absorbed
    details_.index->add(i, s);
    details_.cache.place(i, complex_, s);
  }

  void remove_absorbed() {
    const auto absorbed = [](const OrphanedParticle& p) { return p.outcome == OrphanPolicy::absorb; };
    if (std::any_of(report_.orphaned.begin(), report_.orphaned.end(), absorbed)) {
      std::vector<std::uint8_t> marks(particles_.size(), 0);
      for (const OrphanedParticle& p : report_.orphaned) marks[p.particle] = absorbed(p) ? 1 : 0;
      particles_.remove(marks);
    }
  }

  const CellComplex& complex_;
  const ComplexEditReport& edit_;
  std::span<const Vec3> positions_before_;
  Particles& particles_;
  std::vector<ParticleState>& states_;
  Particles::Details& details_;
  OrphanPolicy orphaned_;
  std::vector<Cell> removed_;  // sorted
  std::optional<Locator> locator_;
  std::optional<BoxTree> boxes_;  // of the free cells
  std::vector<Cell> free_cells_;
  UpdateReport report_;
};

UpdateReport Environment::update_after_edit(Particles& particles, OrphanPolicy orphaned) const {
  const Members& m = *members_;
  m.adopt(particles);
  m.check_known(particles, "update_after_edit");
  Particles::Details& details = particles.details();
  if (details.edits == m.edits) return {};
  if (m.last_edit.replaced && details.moves != m.moves_at_edit)
    throw InvalidArgument(
        "update_after_edit: the particles missed the move before the mesh was replaced: add() their positions to a new "
        "set; advance() every set before replace()");
  UpdateReport report;
  if (details.moves == m.moves_at_edit && m.moves != m.moves_at_edit) {
    const CellComplex before = m.complex.before_move();
    report = EditFollower(before, m.last_edit, m.replaced_positions, particles, orphaned).update_after_edit();
  } else {
    EditFollower follower(m.complex, m.last_edit, m.replaced_positions, particles, orphaned);
    if (details.moves != m.moves) follower.carry_with_mesh(m.threads);
    details.moves = m.moves;
    report = follower.update_after_edit();
  }
  details.edits = m.edits;
  details.cache.note_changed_walls();
  return report;
}

}  // namespace dartcast
