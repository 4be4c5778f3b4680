#include "dartcast/events.hpp"

#include <algorithm>
#include <chrono>
#include <vector>

#include "dartcast/validity.hpp"

namespace dartcast {

namespace {

class Surgeon {
 public:
  Surgeon(Simulation& flow, const Event& event) : flow_(flow), event_(event) {}

  EventReport operate() {
    report_.kind = static_cast<std::uint32_t>(event_.what.index());
    report_.step = flow_.steps();
    report_.time = flow_.time();
    std::visit([&](const auto& what) { make(what); }, event_.what);
    return report_;
  }

 private:
  [[nodiscard]] const CellComplex& complex() const { return flow_.environment().complex(); }

  void make(const Cut& cut) {
    carve(std::visit([&](const auto& surface) { return thicken(surface, cut.width); }, cut.surface), Carving::open, {});
  }

  void make(const Carve& what) {
    CarveOptions options;
    options.whole_cells = what.whole_cells;
    carve({what.tool}, what.what, options);
  }

  void carve(const std::vector<ConvexTool>& tools, Carving what, const CarveOptions& options) {
    const std::vector<Cell> near = cells_near(complex(), tools);
    Carved carved;
    note(flow_.edit([&](ComplexEdit& e) { carved = dartcast::carve(e, near, tools, what, options); }, event_.orphaned));
    report_.cells_opened = carved.opened.size();
    report_.cells_whole = carved.whole.size();
  }

  void make(const Ligature& tie) {
    std::vector<Cell> section;
    const SimulationEdit done =
        flow_.edit([&](ComplexEdit& e) { section = ligature(e, tie.plane, tie.place); }, event_.orphaned);
    note(done);
    report_.cells_blocked = section.size();
    for (Cell& c : section) c = done.edit.now(c);
    if (tie.tying.share > 0.0) draw(tie, section);
  }

  void draw(const Ligature& tie, const std::vector<Cell>& section) {
    const auto now = flow_.environment().positions();
    std::vector<Vec3> drawn(now.begin(), now.end());
    draw_together(complex(), section, tie.plane, tie.tying, drawn);
    const auto inversion = flow_.environment().first_inversion(drawn);
    constexpr double room = 0.75;  // of the way to where a simplex is flattened
    const double share = inversion ? room * inversion->how.safe_time : 1.0;
    for (std::size_t v = 0; v < drawn.size(); ++v) drawn[v] = (drawn[v] - now[v]) * share;
    flow_.pull(drawn, tie.duration);
  }

  void make(const Reconnect& what) {
    const std::vector<Cell> all = flow_.environment().map().cells();
    note(flow_.edit(
        [&](ComplexEdit& e) {
          reconnect(e, open_faces(e, all, what.a, what.within), open_faces(e, all, what.b, what.within), what.options);
        },
        event_.orphaned));
  }

  void note(const SimulationEdit& done) {
    report_.cells_removed = done.edit.map.removed.size();
    report_.cells_added = done.edit.map.added.size();
    report_.boundary_shift = done.edit.boundary_shift;
    report_.particles_touched = done.particles.touched;
    report_.particles_located = done.particles.located;
    const auto count = [&](OrphanPolicy outcome) {
      return static_cast<std::uint64_t>(std::count_if(done.particles.orphaned.begin(), done.particles.orphaned.end(),
                                                      [&](const OrphanedParticle& p) { return p.outcome == outcome; }));
    };
    report_.particles_moved = count(OrphanPolicy::relocate);
    report_.particles_held = count(OrphanPolicy::hold);
    report_.particles_absorbed = count(OrphanPolicy::absorb);
  }

  Simulation& flow_;
  const Event& event_;
  EventReport report_;
};

}  // namespace

EventReport apply(Simulation& flow, const Event& event) {
  const auto start = std::chrono::steady_clock::now();
  EventReport report = Surgeon(flow, event).operate();
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return report;
}

}  // namespace dartcast
