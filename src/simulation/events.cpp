// Carries out each kind of event on the environment of a simulation.
#include "dartcast/events.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <span>
#include <variant>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/simulation.hpp"
#include "dartcast/validity.hpp"
#include "simulation/timer.hpp"

namespace dartcast {

namespace {

class EventRun {
 public:
  EventRun(Simulation& simulation, const Event& event) : simulation_(simulation), event_(event) {}

  EventReport run() {
    report_.kind = kind_of(event_);
    report_.step = simulation_.steps();
    report_.time = simulation_.time();
    std::visit([&](const auto& what) { make(what); }, event_.what);
    return report_;
  }

 private:
  [[nodiscard]] const CellComplex& complex() const { return simulation_.environment().complex(); }

  // Cells or faces that are not there at this time are a reason to refuse the event, as cells that are not valid are.
  SimulationEdit edit(const std::function<void(ComplexEdit&)>& make) {
    const auto refusing = [&](ComplexEdit& e) {
      try {
        make(e);
      } catch (const InvalidArgument& why) {
        throw EditRefused(why.what());
      }
    };
    return simulation_.edit(refusing, event_.orphaned);
  }

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
    note(edit([&](ComplexEdit& e) { carved = dartcast::carve(e, near, tools, what, options); }));
    report_.cells_opened = carved.opened.size();
    report_.cells_whole = carved.whole.size();
  }

  void make(const Ligature& tie) {
    std::vector<Cell> section;
    const SimulationEdit done = edit([&](ComplexEdit& e) { section = ligature(e, tie.plane, tie.place); });
    note(done);
    report_.cells_blocked = section.size();
    for (Cell& c : section) c = done.edit.now(c);
    if (tie.tying.share > 0.0) draw(tie, section);
  }

  void draw(const Ligature& tie, const std::vector<Cell>& section) {
    const auto now = simulation_.environment().positions();
    std::vector<Vec3> drawn(now.begin(), now.end());
    draw_together(complex(), section, tie.plane, tie.tying, drawn);
    const auto inversion = simulation_.environment().first_inversion(drawn);
    constexpr double room = 0.75;  // of the way to where the first simplex inverts
    const double share = inversion ? room * inversion->how.safe_time : 1.0;
    for (std::size_t v = 0; v < drawn.size(); ++v) drawn[v] = (drawn[v] - now[v]) * share;
    simulation_.pull(drawn, tie.duration);
  }

  void make(const Reconnect& what) {
    const std::vector<Cell> all = simulation_.environment().map().cells();
    note(edit([&](ComplexEdit& e) {
      const auto end = [&](const char* name, const Plane& plane) {
        std::vector<CellFace> faces = open_faces(e, all, plane, what.within);
        if (faces.empty())
          throw EditRefused(fmt::format("no open face is within {:.4g} m of the plane of end {}", what.within, name));
        return faces;
      };
      reconnect(e, end("a", what.a), end("b", what.b), what.options);
    }));
  }

  void make(const OpenCells& what) { report_.cells_opened = set_free(what.cells, true); }
  void make(const CloseCells& what) { report_.cells_blocked = set_free(what.cells, false); }

  void make(const OpenWalls& what) {
    std::vector<CellFace> faces = inner_walls(complex().map());
    std::erase_if(faces, [&](CellFace f) { return complex().map().patch(f) != what.patch; });
    change_walls(faces, what.patch, [&](ComplexEdit& e) { remove_walls(e.topology(), faces); });
  }

  void make(const CloseWalls& what) {
    const CombinatorialMap& map = complex().map();
    std::vector<CellFace> faces;
    for (const Cell c : map.cells()) {
      const std::size_t count = map.shape(c).face_count();
      for (std::uint16_t f = 0; f < count; ++f) {
        if (map.patch({c, f}) == what.patch && map.opposite({c, f}).valid()) faces.push_back({c, f});
      }
    }
    change_walls(faces, what.patch, [&](ComplexEdit& e) { set_walls(e.topology(), faces, what.patch); });
  }

  void change_walls(std::span<const CellFace> faces, Patch patch, const std::function<void(ComplexEdit&)>& change) {
    if (faces.empty())
      throw EditRefused(fmt::format("the patch '{}' has no faces between two cells to {}",
                                    complex().map().patch_names()[patch.value], name_of(report_.kind)));
    note(edit(change));
  }

  // Returns how many cells changed.
  std::uint64_t set_free(std::vector<std::uint32_t> sources, bool free) {
    std::sort(sources.begin(), sources.end());
    std::uint64_t changed = 0;
    note(edit([&](ComplexEdit& e) {
      for (const Cell c : e.map().cells()) {
        if (e.map().is_free(c) == free || !std::binary_search(sources.begin(), sources.end(), e.map().source(c)))
          continue;
        e.topology().set_free(c, free);
        ++changed;
      }
    }));
    return changed;
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

  Simulation& simulation_;
  const Event& event_;
  EventReport report_;
};

}  // namespace

std::string_view name_of(EventKind kind) {
  switch (kind) {
    case EventKind::cut: return "cut";
    case EventKind::carve: return "carve";
    case EventKind::ligature: return "ligature";
    case EventKind::reconnect: return "reconnect";
    case EventKind::open: return "open";
    case EventKind::close: return "close";
  }
  return {};
}

EventKind kind_of(const Event& event) {
  return std::visit([](const auto& what) { return what.kind; }, event.what);
}

EventReport apply(Simulation& simulation, const Event& event) {
  double seconds = 0.0;
  EventReport report;
  {
    const ScopeTimer timer(seconds);
    report = EventRun(simulation, event).run();
  }
  report.seconds = seconds;
  return report;
}

}  // namespace dartcast
