// Makes .vtp files of points, lines and polygons with data.
#include "formats/vtp_write.hpp"

#include <algorithm>
#include <numeric>

namespace dartcast {

VtpFile::VtpFile(std::vector<Vec3> points) : count_(points.size()) {
  data_ = {"PolyData", {{"NumberOfPoints", count_}}, {}, {{"PointData", {}}, {"CellData", {}}, {"Points", {}}}};
  data_.section("Points").arrays.emplace_back("Points", std::move(points));
  for (const auto& [section, attribute] : {std::pair("Verts", "NumberOfVerts"),
                                           {"Lines", "NumberOfLines"},
                                           {"Strips", "NumberOfStrips"},
                                           {"Polys", "NumberOfPolys"}}) {
    data_.counts.emplace_back(attribute, 0);
    data_.sections.push_back({section, {}});
    add_cells(section, {}, {});
  }
}

void VtpFile::add_cells(std::string_view section, std::vector<std::uint32_t> connectivity,
                        std::vector<std::int64_t> offsets) {
  const auto count =
      std::find_if(data_.counts.begin(), data_.counts.end(), [&](const auto& c) { return c.first.ends_with(section); });
  count->second = offsets.size();
  std::vector<XmlArray>& arrays = data_.section(section).arrays;
  arrays.clear();
  arrays.emplace_back("connectivity", std::move(connectivity));
  arrays.emplace_back("offsets", std::move(offsets));
}

void VtpFile::add_vertices() {
  std::vector<std::uint32_t> ids(count_);
  std::vector<std::int64_t> ends(count_);
  std::iota(ids.begin(), ids.end(), 0U);
  std::iota(ends.begin(), ends.end(), 1);
  add_cells("Verts", std::move(ids), std::move(ends));
}

void VtpFile::add_line() {
  if (count_ == 0) return;
  std::vector<std::uint32_t> ids(count_);
  std::iota(ids.begin(), ids.end(), 0U);
  add_cells("Lines", std::move(ids), {static_cast<std::int64_t>(count_)});
}

namespace {

std::vector<std::int64_t> ends_of(std::span<const std::size_t> offsets) {
  std::vector<std::int64_t> ends;
  for (std::size_t i = 1; i < offsets.size(); ++i) ends.push_back(static_cast<std::int64_t>(offsets[i]));
  return ends;
}

}  // namespace

void VtpFile::add_lines(std::span<const std::size_t> offsets, std::span<const std::uint32_t> corners) {
  add_cells("Lines", {corners.begin(), corners.end()}, ends_of(offsets));
}

void VtpFile::add_polygons(std::span<const std::size_t> offsets, std::span<const std::uint32_t> corners) {
  add_cells("Polys", {corners.begin(), corners.end()}, ends_of(offsets));
}

void VtpFile::add_texts(std::string name, std::span<const std::string> texts) {
  if (texts.empty()) return;
  std::vector<char> characters;  // each text ended by a 0
  for (const std::string& text : texts)
    characters.insert(characters.end(), text.c_str(), text.c_str() + text.size() + 1);
  data_.field.emplace_back(std::move(name), std::move(characters));
  data_.field.back().set_tuples(texts.size());
}

}  // namespace dartcast
