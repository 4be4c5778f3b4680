// How particles follow an edit.
#include <algorithm>
#include <utility>

#include "dartcast/base/error.hpp"
#include "dartcast/environment/environment.hpp"
#include "dartcast/walk/nearest_free.hpp"
#include "dartcast/walk/ride.hpp"

namespace dartcast {

/// One call of Environment::follow().
class Following {
 public:
  Following(const Environment& environment, Particles& particles, Stranded stranded)
      : complex_(environment.complex_), edit_(environment.last_edit_), particles_(particles), stranded_(stranded) {
    for (const CellHandle& h : edit_.map.removed) removed_.push_back(h.cell);
    std::sort(removed_.begin(), removed_.end());
  }

  FollowReport follow() {
    if (!particles_.residents_) particles_.residents_.emplace(particles_.states_);
    const std::vector<std::uint32_t> touched = residents(removed_, edit_.map.marked);
    for (const Cell c : removed_) particles_.residents_->clear(c);  // another cell may take its number
    for (const std::uint32_t i : touched) take_along(i);
    for (const std::uint32_t i : residents(edit_.around, edit_.map.added)) leave_walls(particles_.states_[i]);
    remove_absorbed();
    return std::move(report_);
  }

 private:
  [[nodiscard]] const Map& map() const { return complex_.map(); }

  // In the order of their numbers.
  [[nodiscard]] std::vector<std::uint32_t> residents(std::span<const Cell> some, std::span<const Cell> others) const {
    std::vector<std::uint32_t> found;
    for (const std::span<const Cell> cells : {some, others}) {
      for (const Cell c : cells) particles_.residents_->for_each(c, [&](std::uint32_t i) { found.push_back(i); });
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
    State& s = particles_.states_[i];
    const bool gone = is_removed(s.cell);
    const bool marked = !gone && is_marked(s.cell);
    if (!gone && !marked && !touches_any(s)) return;  // it has left since it was listed
    ++report_.touched;
    leave_walls(s);
    if (gone) locate(i);
    if (marked && !map().is_free(s.cell)) strand(i, Place::blocked, s.at());
    if (marked && map().is_free(s.cell) && s.held) release(i);
    if (gone || marked) keep_up(i);
  }

  [[nodiscard]] bool touches_any(const State& s) const {
    return std::any_of(s.touching.begin(), s.touching.begin() + s.touching_count,
                       [&](CellFace f) { return is_removed(f.cell) || is_marked(f.cell); });
  }

  // Forgets walls touched that are none any more.
  void leave_walls(State& s) const {
    const auto end = s.touching.begin() + s.touching_count;
    const auto kept = std::remove_if(
        s.touching.begin(), end, [&](CellFace f) { return is_removed(f.cell) || !map().view(f.cell).is_wall(f.face); });
    s.touching_count = static_cast<std::uint8_t>(kept - s.touching.begin());
  }

  void locate(std::uint32_t i) {
    if (!locator_) locator_.emplace(complex_, edit_.map.added);
    State& s = particles_.states_[i];
    const SimplexId at = locator_->find(complex_, s.position);
    if (!at.valid()) return strand(i, Place::outside, at);
    if (!map().is_free(at.cell)) return strand(i, Place::blocked, at);
    s.put(at, s.position);
    s.held = false;
    ++report_.located;
  }

  // `at`: the simplex of the blocked cell, invalid outside.
  void strand(std::uint32_t i, Place place, SimplexId at) {
    State& s = particles_.states_[i];
    StrandedParticle& p = report_.stranded.emplace_back();
    p.particle = i;
    p.place = place;
    p.position = s.position;
    p.became = stranded_;
    if (stranded_ == Stranded::stay && at.valid()) return hold(i, at);
    if (stranded_ != Stranded::absorb && move_to_free(s, at, p.distance)) {
      p.became = Stranded::move;
      return;
    }
    p.became = Stranded::absorb;
  }

  void hold(std::uint32_t i, SimplexId at) {
    State& s = particles_.states_[i];
    if (!s.held || s.at() != at) particles_.weights_[i] = detail::barycentric(complex_.corners(at), s.position);
    s.put(at, s.position);
    s.held = true;
  }

  bool move_to_free(State& s, SimplexId at, double& distance) const {
    std::vector<Cell> start;
    if (at.valid()) {
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

  // Where rounding put a held particle beside its simplex, it is put back.
  void release(std::uint32_t i) {
    State& s = particles_.states_[i];
    const Corners corners = complex_.corners(s.at());
    if (volume_sign(corners) != Sign::positive) return;
    const Settled settled = settle(complex_, s.at(), s.position);
    s.put(settled.simplex, settled.position);
    s.held = false;
  }

  // What is kept beside a state.
  void keep_up(std::uint32_t i) {
    const State& s = particles_.states_[i];
    if (is_removed(s.cell)) return;  // it is absorbed
    particles_.residents_->add(i, s);
    particles_.vertices_[i] = detail::vertex_numbers(complex_, s.at());
    if (particles_.memo_kind_ != detail::MemoKind::none)
      particles_.memos_.put(
          i, detail::memo_of(particles_.memo_kind_, complex_.positions(), particles_.vertices_[i], s.position));
  }

  void remove_absorbed() {
    const auto absorbed = [](const StrandedParticle& p) { return p.became == Stranded::absorb; };
    if (std::any_of(report_.stranded.begin(), report_.stranded.end(), absorbed)) {
      std::vector<std::uint8_t> marks(particles_.size(), 0);
      for (const StrandedParticle& p : report_.stranded) marks[p.particle] = absorbed(p) ? 1 : 0;
      particles_.remove(marks);
    }
  }

  const Complex& complex_;
  const ComplexEditReport& edit_;
  Particles& particles_;
  Stranded stranded_;
  std::vector<Cell> removed_;  // sorted
  std::optional<Locator> locator_;
  FollowReport report_;
};

FollowReport Environment::follow(Particles& particles, Stranded stranded) const {
  if (particles.size() == 0) {
    particles.moves_ = moves_;
    particles.edits_ = edits_;
  }
  if (particles.edits_ == edits_) return {};
  if (particles.moves_ != moves_)
    throw InvalidArgument("follow: advance the particles first, they have not followed the last move");
  if (particles.edits_ + 1 != edits_)
    throw InvalidArgument("follow: the particles missed an edit: every set must follow each edit before the next");
  FollowReport report = Following(*this, particles, stranded).follow();
  particles.edits_ = edits_;
  particles.walls_changed_ = true;
  return report;
}

}  // namespace dartcast
