// Builds a map from mesh arrays: records, shapes, sewing, marks and patches.
#include <algorithm>
#include <map>
#include <string>
#include <unordered_map>

#include "dartcast/combinatorial_map.hpp"
#include "dartcast/error.hpp"
#include "mesh/baffles.hpp"
#include "mesh/cell_types.hpp"
#include "topology/cell_form.hpp"

namespace dartcast {

class MapBuilder {
 public:
  MapBuilder(CombinatorialMap& map, const MeshData& mesh, const SteinerPoints& steiner)
      : map_(map), mesh_(mesh), steiner_(steiner), baffles_(mesh) {}

  void build() {
    if (mesh_.dimension() == 2) enter_plane();
    map_.vertex_count_ = mesh_.points.size() + steiner_vertices();
    map_.wall_vertices_.resize(map_.vertex_count_);
    add_cells();
    sew();
    for (const Cell c : map_.cells()) map_.mark_walls(c);
    add_patches();
    for (std::uint32_t s = 0; s < map_.shapes_.size(); ++s) (void)map_.shapes_[s].stars();  // not in the first step
  }

 private:
  struct FaceEntry {
    std::uint64_t ends;  // the lowest vertex's two neighbours in the face, smaller one first
    CellFace face;
  };

  void enter_plane() {
    map_.dimension_ = 2;
    map_.pools_[0].stride = 8;  // triangles
    map_.pools_[1].stride = 10;
  }

  [[nodiscard]] std::size_t steiner_vertices() const {
    std::size_t next = mesh_.points.size();
    for (const auto& [cell, v] : steiner_.of_cells) next = std::max<std::size_t>(next, v.value + 1U);
    for (const auto& f : steiner_.of_faces) next = std::max<std::size_t>(next, f.point.value + 1U);
    return next - mesh_.points.size();
  }

  void add_cells() {
    place_cells();
    // Standard cells first: their shapes are few, and their numbers fit in 16 bits.
    for (std::uint32_t c = 0; c < mesh_.cell_count(); ++c) {
      if (place_[c].pool() != CombinatorialMap::general_pool) add_standard(c);
    }
    for (std::uint32_t c = 0; c < mesh_.cell_count(); ++c) {
      if (place_[c].pool() != CombinatorialMap::general_pool) continue;
      try {
        add_general(c);
      } catch (const InvalidMesh& e) {
        throw InvalidMesh("cell " + std::to_string(source(c)) + ": " + e.what());
      }
    }
  }

  // Chooses the pool of each cell. Cells with Steiner points do not fit in the records of their type.
  void place_cells() {
    std::vector<bool> general(mesh_.cell_count());
    for (const auto& entry : steiner_.of_cells) general[entry.first] = true;
    for (const auto& f : steiner_.of_faces) general[f.cell] = true;
    place_.resize(mesh_.cell_count());
    for (std::uint32_t c = 0; c < mesh_.cell_count(); ++c) {
      if (dimension(mesh_.types[c]) != map_.dimension_)
        throw InvalidMesh("cell " + std::to_string(source(c)) + " is of another dimension than the first one");
      const auto pool = general[c] ? CombinatorialMap::general_pool : CombinatorialMap::pool_of(mesh_.types[c]);
      const std::size_t index = map_.pools_[pool].count++;
      if (index >= Cell::index_mask) throw InvalidMesh("more than 2^29 - 1 cells of one type: split the mesh");
      place_[c] = Cell(pool, static_cast<std::uint32_t>(index));
    }
    for (std::uint32_t p = 0; p < 4; ++p) {
      map_.pools_[p].words.assign(map_.pools_[p].count * map_.pools_[p].stride, 0);
    }
    const bool identity =
        mesh_.source.empty() && std::any_of(map_.pools_.begin(), map_.pools_.end(),
                                            [&](const auto& pool) { return pool.count == mesh_.cell_count(); });
    if (identity) return;
    for (std::uint32_t c = 0; c < mesh_.cell_count(); ++c) map_.pools_[place_[c].pool()].source.push_back(source(c));
  }

  [[nodiscard]] std::uint32_t source(std::uint32_t c) const { return mesh_.source.empty() ? c : mesh_.source[c]; }
  [[nodiscard]] bool is_free(std::uint32_t c) const { return mesh_.free.empty() || mesh_.free[c] != 0; }

  void add_standard(std::uint32_t c) {
    const CellType type = mesh_.types[c];
    const StandardCorners best = turned(type, mesh_.cell(c));
    const std::span<const std::uint32_t> corners(best.data(), mesh_.cell(c).size());
    const auto shape =
        map_.shapes_.intern_standard(standard_signature(type, corners), [&] { return standard_key(type, corners); });
    map_.write_cell(place_[c], shape.number, corners, is_free(c));
  }

  void add_general(std::uint32_t c) {
    std::vector<std::uint32_t> vertices;
    std::vector<std::vector<std::uint16_t>> faces;
    local_faces(c, vertices, faces);
    ShapeKey key;
    key.corner_count = static_cast<std::uint16_t>(vertices.size());
    key.apex = lowest_corner(vertices);
    for (std::uint16_t f = 0; f < faces.size(); ++f) {
      set_from_lowest(key.faces.emplace_back().corners, faces[f], vertices);
      if (const Vertex point = face_point(c, f); point.valid()) {
        key.faces.back().has_point = true;
        vertices.push_back(point.value);
      }
    }
    if (const Vertex point = cell_point(c); point.valid()) {
      key.has_point = true;
      vertices.push_back(point.value);
    }
    const std::uint32_t shape = map_.shapes_.intern(key).number;
    map_.open_record(CombinatorialMap::general_pool, 2 + vertices.size() + 2 * faces.size());
    map_.write_cell(place_[c], shape, vertices, is_free(c));
  }

  // Local numbers: standard types in the mesh's order, polyhedra by first appearance.
  void local_faces(std::uint32_t c, std::vector<std::uint32_t>& vertices,
                   std::vector<std::vector<std::uint16_t>>& faces) const {
    std::unordered_map<std::uint32_t, std::uint16_t> local;
    const auto number = [&](std::uint32_t v) {
      const auto [found, fresh] = local.try_emplace(v, static_cast<std::uint16_t>(vertices.size()));
      if (fresh) vertices.push_back(v);
      return found->second;
    };
    if (mesh_.types[c] != CellType::polyhedron) {
      const auto corners = mesh_.cell(c);
      // A polygon starts at its lowest vertex. So all polygons of n corners share one shape.
      std::size_t first = 0;
      if (map_.dimension_ == 2)
        first = static_cast<std::size_t>(std::min_element(corners.begin(), corners.end()) - corners.begin());
      for (std::size_t i = 0; i < corners.size(); ++i) number(corners[(first + i) % corners.size()]);
    }
    std::size_t darts = 0;
    for_each_face(mesh_, c, [&](std::span<const std::uint32_t> corners) {
      darts += map_.dimension_ == 2 ? 1 : corners.size();
      if (darts > Shape::max_darts) throw InvalidMesh("more than 16383 darts: split the cell");
      auto& face = faces.emplace_back();
      for (const std::uint32_t v : corners) face.push_back(number(v));
    });
    if (map_.dimension_ == 2) {
      const auto first_edge = std::find_if(faces.begin(), faces.end(), [](const auto& edge) { return edge[0] == 0; });
      std::rotate(faces.begin(), first_edge, faces.end());
    }
  }

  [[nodiscard]] Vertex cell_point(std::uint32_t c) const {
    const auto& all = steiner_.of_cells;
    const auto found =
        std::lower_bound(all.begin(), all.end(), c, [](const auto& e, auto key) { return e.first < key; });
    return found != all.end() && found->first == c ? found->second : Vertex{};
  }

  [[nodiscard]] Vertex face_point(std::uint32_t c, std::uint16_t f) const {
    const auto& all = steiner_.of_faces;
    const auto found = std::lower_bound(all.begin(), all.end(), std::pair{c, f}, [](const auto& e, const auto& key) {
      return std::pair{e.cell, e.face} < key;
    });
    return found != all.end() && found->cell == c && found->face == f ? found->point : Vertex{};
  }

  [[nodiscard]] std::vector<std::uint32_t> face_vertices(CellFace f) const {
    const CellView v = map_.view(f.cell);
    std::vector<std::uint32_t> vertices;
    for (const std::uint16_t k : v.shape().corners(f.face)) vertices.push_back(v.vertex(k).value);
    return vertices;
  }

  // All faces, bucketed by their lowest vertex.
  void collect_faces(const std::vector<Cell>& cells) {
    const auto each = [&](auto&& visit) {
      for (const Cell c : cells) {
        const CellView v = map_.view(c);
        for (std::uint16_t f = 0; f < v.shape().face_count(); ++f) {
          const auto corners = v.shape().corners(f);
          if (corners.size() == 2) {
            const std::uint32_t from = v.vertex(corners[0]).value;
            const std::uint32_t to = v.vertex(corners[1]).value;
            const auto [low, high] = std::minmax(from, to);
            visit(low, high, high, CellFace{c, f});
            continue;
          }
          visit(v.vertex(corners[0]).value, v.vertex(corners[1]).value, v.vertex(corners.back()).value, CellFace{c, f});
        }
      }
    };
    bucket_.assign(mesh_.points.size() + 1, 0);
    each([&](std::uint32_t lowest, auto, auto, auto) { ++bucket_[lowest + 1U]; });
    for (std::size_t i = 1; i < bucket_.size(); ++i) bucket_[i] += bucket_[i - 1];
    entries_.resize(bucket_.back());
    auto next = bucket_;
    each([&](std::uint32_t lowest, std::uint32_t a, std::uint32_t b, CellFace face) {
      entries_[next[lowest]++] = {(std::uint64_t{std::min(a, b)} << 32U) | std::max(a, b), face};
    });
  }

  // Whether two faces with the same lowest vertex have the same corners, in opposite directions or in the same.
  [[nodiscard]] bool same_corners(CellFace f, CellFace g, bool opposite) const {
    const CellView a = map_.view(f.cell);
    const CellView b = map_.view(g.cell);
    const auto x = a.shape().corners(f.face);
    const auto y = b.shape().corners(g.face);
    if (x.size() != y.size()) return false;
    if (x.size() == 2) {
      const std::size_t first = opposite ? 1 : 0;
      return a.vertex(x[0]) == b.vertex(y[first]) && a.vertex(x[1]) == b.vertex(y[1 - first]);
    }
    for (std::size_t i = 0; i < x.size(); ++i) {
      const std::size_t j = opposite && i > 0 ? x.size() - i : i;
      if (a.vertex(x[i]) != b.vertex(y[j])) return false;
    }
    return true;
  }

  void sew() {
    collect_faces(map_.cells());
    for (std::size_t b = 0; b + 1 < bucket_.size(); ++b) {
      const auto begin = entries_.begin() + static_cast<std::ptrdiff_t>(bucket_[b]);
      const auto end = entries_.begin() + static_cast<std::ptrdiff_t>(bucket_[b + 1]);
      std::sort(begin, end, [](const FaceEntry& x, const FaceEntry& y) {
        return std::pair{x.ends, x.face} < std::pair{y.ends, y.face};
      });
      for (auto group = begin; group != end;) {
        auto last = group + 1;
        while (last != end && last->ends == group->ends) ++last;
        sew_group(std::span<FaceEntry>(&*group, static_cast<std::size_t>(last - group)));
        group = last;
      }
    }
  }

  // Faces with the same lowest vertex and the same two neighbours of it. Almost always they are the two sides of one
  // face.
  void sew_group(std::span<FaceEntry> group) {
    for (std::size_t i = 0; i < group.size(); ++i) {
      const CellFace f = group[i].face;
      std::vector<CellFace> others;
      bool opposite = true;
      for (std::size_t j = 0; j < group.size(); ++j) {
        if (j == i) continue;
        const CellFace g = group[j].face;
        const bool across = same_corners(f, g, true);
        if (!across && !same_corners(f, g, false)) continue;
        others.push_back(g);
        opposite = opposite && across;
        if (others.size() > 1)
          throw InvalidMesh(describe({f, others[0], others[1]}) + " share one face: at most two cells can");
      }
      if (others.empty()) continue;
      if (!opposite)
        throw InvalidMesh(describe({f, others[0]}) +
                          " lie on the same side of their common face: one of them is inverted");
      if (baffles_.contains(face_vertices(f))) continue;
      map_.set_neighbour(f, others[0]);
    }
  }

  [[nodiscard]] std::string describe(const std::vector<CellFace>& faces) const {
    std::string text = "cells";
    for (const CellFace& f : faces) text += " " + std::to_string(map_.source(f.cell));
    return text;
  }

  void add_patches() {
    std::map<std::int32_t, Patch> by_tag;
    for (const std::int32_t tag : mesh_.patch_order) by_tag.try_emplace(tag, patch_of(tag));
    for (std::size_t i = 0; i + 1 < mesh_.patch_offsets.size(); ++i) {
      const std::int32_t tag = mesh_.patch_tags[i];
      const auto [found, fresh] = by_tag.try_emplace(tag);
      if (fresh) found->second = patch_of(tag);
      const std::span<const std::uint32_t> corners(mesh_.patch_faces.data() + mesh_.patch_offsets[i],
                                                   mesh_.patch_offsets[i + 1] - mesh_.patch_offsets[i]);
      add_patch_face(corners, found->second);
    }
  }

  // The patch of a tag; tags of one name are one patch.
  Patch patch_of(std::int32_t tag) {
    const auto named = mesh_.patch_names.find(tag);
    const std::string name = named != mesh_.patch_names.end() ? named->second : std::to_string(tag);
    auto& names = map_.patch_names_;
    const auto [patch, fresh] = patches_.try_emplace(name, Patch{static_cast<std::uint16_t>(names.size())});
    if (!fresh) return patch->second;
    if (names.size() > 0xffffU)
      throw InvalidMesh("more than 65535 patches: give several groups of faces one name, or select those of interest");
    names.push_back(name);
    return patch->second;
  }

  // A patch face is matched to the cells' faces by its corners. One that belongs to no cell is not a wall, and is left
  // out.
  void add_patch_face(std::span<const std::uint32_t> corners, Patch patch) {
    const auto lowest = std::min_element(corners.begin(), corners.end());
    if (lowest == corners.end() || *lowest + 1U >= bucket_.size()) return;
    const std::size_t at = static_cast<std::size_t>(lowest - corners.begin());
    const std::uint32_t next = corners[(at + 1) % corners.size()];
    const std::uint32_t previous = corners[(at + corners.size() - 1) % corners.size()];
    const std::uint64_t ends = (std::uint64_t{std::min(next, previous)} << 32U) | std::max(next, previous);
    std::vector<std::uint32_t> sorted(corners.begin(), corners.end());
    std::sort(sorted.begin(), sorted.end());
    const auto end = entries_.begin() + static_cast<std::ptrdiff_t>(bucket_[*lowest + 1U]);
    auto entry = std::lower_bound(entries_.begin() + static_cast<std::ptrdiff_t>(bucket_[*lowest]), end, ends,
                                  [](const FaceEntry& e, std::uint64_t key) { return e.ends < key; });
    std::vector<CellFace> found;
    for (; entry != end && entry->ends == ends; ++entry) {
      auto candidate = face_vertices(entry->face);
      std::sort(candidate.begin(), candidate.end());
      if (candidate == sorted) found.push_back(entry->face);
    }
    const bool one_sided = found.size() > 1 && baffles_.contains(corners);
    for (const CellFace f : found) {
      const std::vector<std::uint32_t> own = face_vertices(f);
      if (one_sided && (corners.size() == 2 ? own[0] != corners[0] : own[1] != next)) continue;
      // A face that is listed twice keeps its first patch.
      if (map_.patch(f) == Patch{}) map_.set_patch(f, patch);
    }
  }

  CombinatorialMap& map_;
  const MeshData& mesh_;
  const SteinerPoints& steiner_;
  const Baffles baffles_;
  std::vector<Cell> place_;
  std::unordered_map<std::string, Patch> patches_ = {{"", Patch{}}};  // by name
  std::vector<std::size_t> bucket_;
  std::vector<FaceEntry> entries_;
};

CombinatorialMap::CombinatorialMap(const MeshData& mesh, const SteinerPoints& steiner) {
  MapBuilder(*this, mesh, steiner).build();
}

}  // namespace dartcast
