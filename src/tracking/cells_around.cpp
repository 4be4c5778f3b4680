// Cuts the cells around a particle's way out of a scene.
//
// Phases: Choose the cells. Number their points in the order of the whole scene. Copy the cells. Mark walls between
// free cells, and faces whose other side is left out. Number the state's cells anew.
#include "tracking/cells_around.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <unordered_map>

#include "complex/cells_as_mesh.hpp"
#include "parts/part_cutter.hpp"

namespace dartcast::detail {

namespace {

using Component = double Vec3::*;
constexpr std::array<Component, 3> axes = {&Vec3::x, &Vec3::y, &Vec3::z};

struct CellBox {
  Vec3 low, high;

  void add(const Vec3& p) {
    for (const Component a : axes) {
      low.*a = std::min(low.*a, p.*a);
      high.*a = std::max(high.*a, p.*a);
    }
  }
  void grow() {
    const Vec3 size = high - low;
    low -= size;
    high += size;
  }
};

// By the box's slabs. Rounding does not matter: boxes have been grown by their size.
bool meets(const CellBox& box, const Vec3& from, const Vec3& to) {
  double first = 0.0;
  double last = 1.0;
  for (const Component a : axes) {
    const double way = to.*a - from.*a;
    if (way == 0.0) {
      if (from.*a < box.low.*a || from.*a > box.high.*a) return false;
      continue;
    }
    const auto [enter, leave] = std::minmax({(box.low.*a - from.*a) / way, (box.high.*a - from.*a) / way});
    first = std::max(first, enter);
    last = std::min(last, leave);
  }
  return first <= last;
}

class CellsAround {
 public:
  CellsAround(const CombinatorialMap& map, const ReplayPlaces& places) : map_(map), places_(places) {}

  void choose(std::span<const std::pair<Vec3, Vec3>> ways, std::vector<Cell> cells) {
    for (const Cell c : map_.cells()) {
      const CellView cell = map_.view(c);
      const Vec3 any = places_.before[cell.vertex(0).value];
      CellBox box = {any, any};
      for (const std::uint32_t v : cell.vertices()) {
        box.add(places_.before[v]);
        box.add(places_.after[v]);
      }
      box.grow();
      if (std::any_of(ways.begin(), ways.end(), [&](const auto& w) { return meets(box, w.first, w.second); }))
        cells.push_back(c);
    }
    std::sort(cells.begin(), cells.end(), [](Cell a, Cell b) { return a.value < b.value; });
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
    cells_ = std::move(cells);
  }

  void copy_to(StepReplay& replay) {
    CellsAsMesh copy(map_, places_.before);
    std::vector<std::uint32_t> vertices;
    for (const Cell c : cells_) {
      const CellView cell = map_.view(c);
      for (std::uint16_t k = 0; k < cell.shape().corner_count(); ++k) vertices.push_back(cell.vertex(k).value);
    }
    std::sort(vertices.begin(), vertices.end());
    for (const std::uint32_t v : vertices) copy.number(Vertex{v});
    for (const Cell c : cells_) copy.add(c);
    const std::vector<Cell> here = handles_of(copy.mesh());
    for (std::size_t i = 0; i < cells_.size(); ++i) here_[cells_[i].value] = here[i];
    for (const Cell c : cells_) mark_faces(copy, c);
    MeshData& mesh = copy.mesh();
    mesh.source.clear();
    mesh.patch_names = {{wall, "wall"}, {cut, StepReplay::cut_patch}};
    mesh.baffle_tags = {wall};
    if (places_.before.data() != places_.after.data())
      for (const Vertex v : copy.vertices()) replay.moved.push_back(places_.after[v.value]);
    if (map_.dimension() == 2) {
      for (Vec3& p : mesh.points) p.z = 0.0;
      for (Vec3& p : replay.moved) p.z = 0.0;
    }
    replay.mesh = std::move(mesh);
  }

  [[nodiscard]] Cell here(Cell c) const {
    const auto found = here_.find(c.value);
    return found == here_.end() ? Cell{} : found->second;
  }

 private:
  static constexpr std::int32_t wall = 1, cut = 2;

  void mark_faces(CellsAsMesh& copy, Cell c) const {
    const CellView cell = map_.view(c);
    for (std::uint16_t f = 0; f < cell.shape().face_count(); ++f) {
      const Cell other = cell.neighbour(f);
      const bool is_cut = other.valid() && !here(other).valid();
      const bool parts_free = cell.is_free() && cell.is_wall(f) && (!other.valid() || map_.is_free(other));
      if (!parts_free && !is_cut) continue;
      std::vector<std::uint32_t> corners;
      for (const std::uint16_t k : cell.shape().corners(f)) corners.push_back(copy.number(cell.vertex(k)));
      copy.mesh().add_patch_face(corners, parts_free ? wall : cut);
    }
  }

  const CombinatorialMap& map_;
  const ReplayPlaces& places_;
  std::vector<Cell> cells_;
  std::unordered_map<std::uint32_t, Cell> here_;  // the numbers of the cells in the replay
};

}  // namespace

StepReplay replay_of(const CombinatorialMap& map, const ReplayPlaces& places, const ParticleState& state,
                     const Vec3& target, std::span<const std::pair<Vec3, Vec3>> ways, std::vector<Cell> passed) {
  passed.push_back(state.cell);
  for (unsigned i = 0; i < state.touching_count; ++i) passed.push_back(state.touching[i].cell);
  CellsAround around(map, places);
  around.choose(ways, std::move(passed));
  StepReplay replay;
  around.copy_to(replay);
  replay.state = state;
  replay.state.cell = around.here(state.cell);
  for (unsigned i = 0; i < state.touching_count; ++i)
    replay.state.touching[i].cell = around.here(state.touching[i].cell);
  replay.target = target;
  return replay;
}

InternalError error_with_replay(const std::string& what, StepReplay replay) {
  replay.reason = what;
  return {what + "; please report this with its replay", std::make_shared<const StepReplay>(std::move(replay))};
}

}  // namespace dartcast::detail
