// Counts contacts by wall face, and decides which faces continue over an edit.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <span>
#include <unordered_set>
#include <utility>

#include "dartcast/combinatorial_map.hpp"
#include "dartcast/complex_edit.hpp"
#include "dartcast/error.hpp"
#include "dartcast/statistics.hpp"

namespace dartcast {

namespace {

// The sines of 10, 20, ... 80 degrees.
constexpr std::array<double, 8> sines_of_tens = {0.17364817766693033, 0.3420201433256687, 0.5,
                                                 0.6427876096865393,  0.766044443118978,  0.8660254037844386,
                                                 0.9396926207859083,  0.984807753012208};

bool is_wall_of_free_cell(const CombinatorialMap& map, CellFace f) {
  if (!map.contains(f.cell)) return false;
  const CellView view = map.view(f.cell);
  return view.is_free() && f.face < view.shape().face_count() && view.is_wall(f.face);
}

// Counterclockwise as seen from the outside: the same wall seen from its other side has another order.
std::vector<Vertex> corners_of(const CellView& view, std::uint16_t face) {
  std::vector<Vertex> corners;
  for (const std::uint16_t k : view.shape().corners(face)) corners.push_back(view.vertex(k));
  return corners;
}

/// The corners of faces as they were before an edit and are after it, in the same terms.
class LastingCorners {
 public:
  explicit LastingCorners(const EditReport& edit) {
    for (const MergedVertex& m : edit.merged) merged_[m.gone.value] = m.merged_into;
    for (const CreatedVertex& c : edit.created) {
      if (c.from == c.other)
        merged_[c.vertex.value] = c.from;  // a copy stands for the vertex that it was copied from
      else
        passing_.insert(c.vertex.value);
    }
    for (const Vertex v : edit.deleted) passing_.insert(v.value);
  }

  // Without vertices that the edit made or removed, from the lowest on. Empty if too few remain to name a face.
  [[nodiscard]] std::vector<Vertex> operator()(std::span<const Vertex> corners, unsigned dimension) const {
    std::vector<Vertex> lasting;
    for (Vertex v : corners) {
      for (auto m = merged_.find(v.value); m != merged_.end(); m = merged_.find(v.value)) v = m->second;
      if (!passing_.contains(v.value)) lasting.push_back(v);
    }
    if (lasting.size() < dimension) return {};
    if (dimension == 3) std::rotate(lasting.begin(), std::min_element(lasting.begin(), lasting.end()), lasting.end());
    return lasting;
  }

 private:
  std::unordered_map<std::uint32_t, Vertex> merged_;
  std::unordered_set<std::uint32_t> passing_;  // they may lie on edges of faces that continue
};

void add_to(FaceHits& sums, const FaceHits& more) {
  sums.hits += more.hits;
  sums.mass += more.mass;
  sums.energy += more.energy;
  for (std::size_t i = 0; i < sums.angles.size(); ++i) sums.angles[i] += more.angles[i];
}

}  // namespace

void WallHits::add(const Environment& environment, const ContactList& contacts, std::span<const Impact> impacts) {
  if (!impacts.empty() && impacts.size() != contacts.contacts.size())
    throw InvalidArgument(
        fmt::format("wall hits: {} impacts for {} contacts", impacts.size(), contacts.contacts.size()));
  for (std::size_t i = 0; i < contacts.contacts.size(); ++i) {
    FaceHits& sums = record(environment, contacts.walls_of(contacts.contacts[i]).front().face).sums;
    if (impacts.empty()) {
      ++sums.hits;
      continue;
    }
    const Impact& impact = impacts[i];
    sums.hits += impact.number;
    sums.mass += impact.mass;
    sums.energy += impact.energy;
    const auto angle = std::upper_bound(sines_of_tens.begin(), sines_of_tens.end(), impact.sine);
    sums.angles[static_cast<std::size_t>(angle - sines_of_tens.begin())] += impact.number;
  }
}

WallHits::Record& WallHits::record(const Environment& environment, CellFace face) {
  std::vector<Record>& records = cells_[face.cell.value];
  const auto found = std::find_if(records.begin(), records.end(), [&](const Record& r) { return r.sums.face == face; });
  if (found != records.end()) return *found;
  const CombinatorialMap& map = environment.map();
  return records.emplace_back(Record{{face, map.patch(face)}, corners_of(map.view(face.cell), face.face)});
}

void WallHits::end(const Record& record) {
  const FaceHits& sums = record.sums;
  if (ended_.size() <= sums.patch.value) ended_.resize(sums.patch.value + std::size_t{1});
  ended_[sums.patch.value] += sums.hits;
}

std::vector<WallHits::Record> WallHits::take_removed(const Environment& environment) {
  std::vector<Record> taken;
  for (const CellHandle& h : environment.last_edit().map.removed) {
    const auto found = cells_.find(h.cell.value);
    if (found == cells_.end()) continue;
    std::move(found->second.begin(), found->second.end(), std::back_inserter(taken));
    cells_.erase(found);
  }
  return taken;
}

void WallHits::end_former_walls(const Environment& environment, Cell cell) {
  const auto found = cells_.find(cell.value);
  if (found == cells_.end()) return;
  std::erase_if(found->second, [&](const Record& r) {
    const bool ends = !is_wall_of_free_cell(environment.map(), r.sums.face);
    if (ends) end(r);
    return ends;
  });
  if (found->second.empty()) cells_.erase(found);
}

void WallHits::update_after_edit(const Environment& environment) {
  const ComplexEditReport& edit = environment.last_edit();
  for (const Cell c : edit.map.marked) end_former_walls(environment, c);
  for (const Cell c : edit.around) end_former_walls(environment, c);
  const std::vector<Record> taken = take_removed(environment);
  if (taken.empty()) return;
  const CombinatorialMap& map = environment.map();
  const LastingCorners lasting(edit.map);
  std::map<std::vector<Vertex>, CellFace> walls;
  for (const Cell c : edit.map.added) {
    const CellView view = map.view(c);
    for (std::uint16_t f = 0; view.is_free() && f < view.shape().face_count(); ++f) {
      if (view.is_wall(f)) walls[lasting(corners_of(view, f), map.dimension())] = {c, f};
    }
  }
  walls.erase(std::vector<Vertex>{});
  for (const Record& r : taken) {
    const auto found = walls.find(lasting(r.corners, map.dimension()));
    if (found == walls.end())
      end(r);
    else
      add_to(record(environment, found->second).sums, r.sums);
  }
}

FaceHits WallHits::at(CellFace face) const {
  const auto found = cells_.find(face.cell.value);
  if (found == cells_.end()) return {face, {}};
  for (const Record& r : found->second) {
    if (r.sums.face == face) return r.sums;
  }
  return {face, {}};
}

std::vector<FaceHits> WallHits::faces() const {
  std::vector<FaceHits> all;
  for (const auto& [cell, records] : cells_) {
    for (const Record& r : records) all.push_back(r.sums);
  }
  std::sort(all.begin(), all.end(), [](const FaceHits& a, const FaceHits& b) { return a.face < b.face; });
  return all;
}

std::vector<std::uint64_t> WallHits::by_patch(const Environment& environment) const {
  std::vector<std::uint64_t> sums = ended_;
  sums.resize(environment.map().patch_names().size());
  for (const auto& [cell, records] : cells_) {
    for (const Record& r : records) sums[r.sums.patch.value] += r.sums.hits;
  }
  return sums;
}

void WallHits::restore(const Environment& environment, const std::vector<FaceHits>& faces,
                       std::vector<std::uint64_t> ended) {
  for (const FaceHits& f : faces) {
    if (!is_wall_of_free_cell(environment.map(), f.face))
      throw InvalidArgument(fmt::format(
          "wall hits: face {} of cell {} is no wall of a free cell here: go on in the environment that they were saved "
          "in, with the same edits",
          f.face.face, f.face.cell.value));
  }
  cells_.clear();
  for (const FaceHits& f : faces) {
    FaceHits& sums = record(environment, f.face).sums;
    const Patch patch = sums.patch;
    sums = f;
    sums.patch = patch;
  }
  ended_ = std::move(ended);
}

}  // namespace dartcast
