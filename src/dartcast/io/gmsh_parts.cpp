#include "dartcast/io/gmsh_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "dartcast/base/error.hpp"

namespace dartcast::gmsh {

template <class T>
T Numbers::raw(std::string_view what) {
  const std::string_view bytes = text.raw(sizeof(T), what);
  std::array<char, sizeof(T)> copy{};
  std::copy(bytes.begin(), bytes.end(), copy.begin());
  if (swapped) std::reverse(copy.begin(), copy.end());
  T value{};
  std::memcpy(&value, copy.data(), sizeof(T));
  return value;
}

std::int32_t Numbers::int32(std::string_view what) {
  return binary ? raw<std::int32_t>(what) : static_cast<std::int32_t>(text.integer(what, INT32_MIN, INT32_MAX));
}

std::uint64_t Numbers::size(std::string_view what) {
  return binary ? raw<std::uint64_t>(what) : static_cast<std::uint64_t>(text.integer(what, 0, INT64_MAX));
}

double Numbers::real(std::string_view what) { return binary ? raw<double>(what) : text.number(what); }

std::size_t Numbers::count(std::string_view what, std::size_t text_bytes, std::size_t binary_bytes) {
  const std::uint64_t n = size(what);
  text.check_count(what, n, binary ? binary_bytes : text_bytes);
  return n;
}

void NodeTable::add(std::uint64_t number, const Vec3& point, MeshData& mesh) {
  if (mesh.points.size() >= no_point) throw InvalidMesh("more than 2^32 - 2 points");
  numbers_.emplace_back(number, static_cast<std::uint32_t>(mesh.points.size()));
  mesh.points.push_back(point);
}

void NodeTable::close() {
  std::sort(numbers_.begin(), numbers_.end());
  const auto same = [](const auto& a, const auto& b) { return a.first == b.first; };
  const auto twice = std::adjacent_find(numbers_.begin(), numbers_.end(), same);
  if (twice != numbers_.end()) throw InvalidMesh(fmt::format("node number {} occurs twice", twice->first));
  if (!numbers_.empty() && numbers_.back().first < 4 * numbers_.size() + 1024) {
    dense_.assign(numbers_.back().first + 1, no_point);
    for (const auto& [number, index] : numbers_) dense_[number] = index;
    numbers_.clear();
  }
  closed_ = true;
}

std::uint32_t NodeTable::find(std::uint64_t number) const {
  if (!dense_.empty()) return number < dense_.size() ? dense_[number] : no_point;
  const auto at = std::lower_bound(numbers_.begin(), numbers_.end(), std::pair{number, std::uint32_t{0}});
  return at != numbers_.end() && at->first == number ? at->second : no_point;
}

int node_count(int type) {
  static constexpr std::array<int, 32> counts = {0, 2,  3,  4,  4, 8,  6,  5,  3,  6,  9, 10, 27, 18, 14, 1,
                                                 8, 20, 15, 13, 9, 10, 12, 15, 15, 21, 4, 5,  6,  20, 35, 56};
  if (type == 92) return 64;
  if (type == 93) return 125;
  return type > 0 && type < static_cast<int>(counts.size()) ? counts[static_cast<std::size_t>(type)] : 0;
}

void Model::add_element(int type, std::span<const std::uint64_t> numbers, std::int32_t physical_tag) {
  const std::size_t place = elements++;
  const bool curve_or_point = type == 8 || type == 15 || (type >= 26 && type <= 28);
  if (curve_or_point) return;
  if (type < 1 || type > 7) {
    parsed.second_order.add(place);
    return;
  }
  std::array<std::uint32_t, 8> corners{};
  for (std::size_t k = 0; k < numbers.size(); ++k) corners[k] = nodes.find(numbers[k]);
  const std::span<const std::uint32_t> used(corners.data(), numbers.size());
  if (type == 1) {
    parsed.add_edge(corners[0], corners[1], physical_tag);
    return;
  }
  if (type == 2 || type == 3) {
    parsed.mesh.add_patch_face(used, physical_tag);
    parsed.face_source.push_back(static_cast<std::uint32_t>(place));
    return;
  }
  static constexpr std::array<CellType, 4> types = {CellType::tetrahedron, CellType::hexahedron, CellType::prism,
                                                    CellType::pyramid};
  parsed.mesh.add_cell(types[static_cast<std::size_t>(type - 4)], used);
  parsed.mesh.regions.push_back(physical_tag);
  parsed.mesh.source.push_back(static_cast<std::uint32_t>(place));
}

}  // namespace dartcast::gmsh
