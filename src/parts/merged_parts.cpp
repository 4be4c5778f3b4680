// Puts parts of a mesh together by the numbers that points and cells have in the whole.
#include "parts/merged_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <map>
#include <set>
#include <utility>

#include "base/bytes.hpp"
#include "dartcast/error.hpp"
#include "mesh/baffles.hpp"
#include "mesh/faces.hpp"
#include "parts/part_cutter.hpp"

namespace dartcast {

namespace {

// An item of one of the parts, by its number in the whole.
struct Item {
  std::uint32_t number;
  std::uint32_t part;
  std::uint32_t place;
};

// All items, and the first of each number.
struct Items {
  std::vector<Item> all;
  std::vector<Item> first;

  Items(const std::vector<MeshPart>& from, std::vector<std::uint32_t> MeshPart::*numbers) {
    for (std::uint32_t k = 0; k < from.size(); ++k) {
      const auto& list = from[k].*numbers;
      for (std::uint32_t i = 0; i < list.size(); ++i) all.push_back({list[i], k, i});
    }
    std::sort(all.begin(), all.end(), [](const Item& a, const Item& b) {
      return std::pair{a.number, a.part} < std::pair{b.number, b.part};
    });
    for (const Item& item : all) {
      if (first.empty() || first.back().number != item.number) first.push_back(item);
    }
  }
};

bool same_bits(const Vec3& a, const Vec3& b) {
  const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };
  return bits(a.x) == bits(b.x) && bits(a.y) == bits(b.y) && bits(a.z) == bits(b.z);
}

class Merger {
 public:
  Merger(const std::vector<MeshPart>& from, std::uint32_t parts, std::uint32_t part)
      : from_(from), points_(from, &MeshPart::points), cells_(from, &MeshPart::cells) {
    out_.part = part;
    out_.parts = parts;
    for (const MeshPart& p : from) numbers_.emplace_back(p.points.size());
  }

  MeshPart merge() {
    add_points();
    add_cells();
    add_patches();
    return std::move(out_);
  }

 private:
  void add_points() {
    std::size_t at = 0;
    for (const Item& first : points_.first) {
      const Vec3& x = from_[first.part].mesh.points[first.place];
      for (; at < points_.all.size() && points_.all[at].number == first.number; ++at) {
        const Item& item = points_.all[at];
        if (!same_bits(from_[item.part].mesh.points[item.place], x))
          throw InvalidMesh(fmt::format("the parts are of different meshes: point {} is at two places", first.number));
        numbers_[item.part][item.place] = static_cast<std::uint32_t>(out_.points.size());
      }
      out_.points.push_back(first.number);
      out_.mesh.points.push_back(x);
    }
    out_.mesh.point_data = values_of(&MeshData::point_data, points_.first);
  }

  // A cell's connectivity by the points of the result.
  [[nodiscard]] std::vector<std::uint32_t> corners_of(const Item& item) const {
    std::vector<std::uint32_t> corners;
    for_each_entry(
        from_[item.part].mesh, item.place, [&](std::uint32_t p) { corners.push_back(numbers_[item.part][p]); },
        [&](std::uint32_t n) { corners.push_back(n); });
    return corners;
  }

  void add_cells() {
    MeshData& mesh = out_.mesh;
    const MeshData& like = from_.front().mesh;
    std::size_t at = 0;
    for (const Item& first : cells_.first) {
      const MeshPart& p = from_[first.part];
      const std::vector<std::uint32_t> corners = corners_of(first);
      for (; at < cells_.all.size() && cells_.all[at].number == first.number; ++at)
        check_same(cells_.all[at], first, corners);
      mesh.add_cell(p.mesh.types[first.place], corners);
      mesh.source.push_back(p.mesh.source[first.place]);
      if (!like.regions.empty()) mesh.regions.push_back(p.mesh.regions[first.place]);
      if (!like.free.empty()) mesh.free.push_back(p.mesh.free[first.place]);
      out_.cells.push_back(first.number);
      out_.owners.push_back(p.owners[first.place]);
      out_.handles.push_back(p.handles[first.place]);
    }
    mesh.region_names = like.region_names;
    mesh.cell_data = values_of(&MeshData::cell_data, cells_.first);
  }

  void check_same(const Item& item, const Item& first, const std::vector<std::uint32_t>& corners) const {
    const MeshPart& a = from_[item.part];
    const MeshPart& b = from_[first.part];
    if (item.part == first.part && item.place == first.place) return;
    if (a.mesh.types[item.place] != b.mesh.types[first.place] || a.owners[item.place] != b.owners[first.place] ||
        a.handles[item.place] != b.handles[first.place] || corners_of(item) != corners)
      throw InvalidMesh(fmt::format("the parts are of different meshes: there are two cells {}", first.number));
  }

  [[nodiscard]] std::vector<DataArray> values_of(std::vector<DataArray> MeshData::*arrays,
                                                 const std::vector<Item>& items) const {
    std::vector<DataArray> result;
    for (std::size_t k = 0; k < (from_.front().mesh.*arrays).size(); ++k) {
      const DataArray& like = (from_.front().mesh.*arrays)[k];
      DataArray& all = result.emplace_back(DataArray{like.name, like.components, {}});
      for (const Item& item : items) {
        const DataArray& a = (from_[item.part].mesh.*arrays)[k];
        const auto first = a.values.begin() + static_cast<std::ptrdiff_t>(item.place * a.components);
        all.values.insert(all.values.end(), first, first + static_cast<std::ptrdiff_t>(a.components));
      }
    }
    return result;
  }

  void add_patches() {
    MeshData& mesh = out_.mesh;
    const std::int32_t unknown = unknown_tag_of(from_.front().mesh);
    mesh.baffle_tags = from_.front().mesh.baffle_tags;
    std::set<std::pair<std::vector<std::uint32_t>, std::int32_t>> known;  // of baffles each side
    std::set<std::vector<std::uint32_t>> unknown_faces;
    for (std::size_t k = 0; k < from_.size(); ++k) {
      for (std::size_t f = 0; f < from_[k].mesh.patch_tags.size(); ++f) {
        std::vector<std::uint32_t> corners;
        for (const std::uint32_t p : from_[k].mesh.patch_face(f)) corners.push_back(numbers_[k][p]);
        std::vector<std::uint32_t> sorted = sorted_corners(corners);
        const std::int32_t tag = from_[k].mesh.patch_tags[f];
        if (tag == unknown)
          unknown_faces.insert(std::move(sorted));
        else if (known.emplace(is_baffle(mesh, tag) ? corners : std::move(sorted), tag).second)
          mesh.add_patch_face(corners, tag);
      }
    }
    mesh.patch_names = from_.front().mesh.patch_names;
    mesh.patch_order = from_.front().mesh.patch_order;
    const BoundaryFaces around = match_faces(mesh).boundary;
    for (std::size_t f = 0; f < around.size(); ++f) {
      if (!unknown_faces.contains(sorted_corners(around.face(f)))) continue;
      if (out_.owners[around.cells[f]] == out_.part)
        throw InvalidMesh(fmt::format("cell {} has an unknown cell beside it: a part is missing, or is another one",
                                      out_.cells[around.cells[f]]));
      mesh.add_patch_face(around.face(f), unknown);
    }
  }

  const std::vector<MeshPart>& from_;
  Items points_;
  Items cells_;
  std::vector<std::vector<std::uint32_t>> numbers_;  // of each part's points in the result
  MeshPart out_;
};

// A part as bytes is a sequence of fields. Writer and reader go through the same list of them, below.
class PartWriter {
 public:
  template <class T>
  void operator()(const T& value) {
    out_.put(value);
  }
  void operator()(const std::map<std::int32_t, std::string>& names) {
    out_.put(static_cast<std::uint64_t>(names.size()));
    for (const auto& [tag, name] : names) {
      out_.put(tag);
      out_.put(name);
    }
  }
  void operator()(const std::vector<DataArray>& arrays) {
    out_.put(static_cast<std::uint64_t>(arrays.size()));
    for (const DataArray& a : arrays) {
      out_.put(a.name);
      out_.put(static_cast<std::uint64_t>(a.components));
      out_.put(a.values);
    }
  }
  [[nodiscard]] const std::string& bytes() const { return out_.bytes(); }

 private:
  ByteWriter out_;
};

class PartReader {
 public:
  explicit PartReader(std::string_view bytes) : in_(bytes) {}
  void operator()(std::uint32_t& value) { value = in_.take<std::uint32_t>(); }
  template <class T>
  void operator()(std::vector<T>& values) {
    values = in_.take_list<T>();
  }
  void operator()(std::map<std::int32_t, std::string>& names) {
    for (auto left = in_.take<std::uint64_t>(); left > 0; --left) {
      const auto tag = in_.take<std::int32_t>();
      names[tag] = in_.take_text();
    }
  }
  void operator()(std::vector<DataArray>& arrays) {
    for (auto left = in_.take<std::uint64_t>(); left > 0; --left) {
      DataArray& a = arrays.emplace_back();
      a.name = in_.take_text();
      a.components = in_.take_size();
      a.values = in_.take_list<double>();
    }
  }

 private:
  ByteReader in_;
};

template <class Archive, class... T>
void in_turn(Archive& a, T&... fields) {
  (a(fields), ...);
}

// `Part`: MeshPart, or const.
template <class Archive, class Part>
void all_fields(Archive& a, Part& part) {
  auto& m = part.mesh;
  in_turn(a, part.part, part.parts, part.points, part.cells, part.owners, part.handles);
  in_turn(a, m.points, m.types, m.offsets, m.connectivity, m.source, m.regions, m.region_names);
  in_turn(a, m.patch_faces, m.patch_offsets, m.patch_tags, m.patch_names, m.patch_order, m.baffle_tags);
  in_turn(a, m.free, m.point_data, m.cell_data);
}

}  // namespace

MeshPart merged_parts(const std::vector<MeshPart>& from, std::uint32_t parts, std::uint32_t part) {
  return Merger(from, parts, part).merge();
}

std::string packed(const MeshPart& part) {
  PartWriter writer;
  all_fields(writer, part);
  return writer.bytes();
}

MeshPart unpacked_part(std::string_view bytes) {
  PartReader reader(bytes);
  MeshPart part;
  all_fields(reader, part);
  return part;
}

}  // namespace dartcast
