// The parts of Gmsh's format that all versions share: numbers, element types, groups.
#include "formats/gmsh_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "dartcast/error.hpp"
#include "formats/second_order.hpp"

namespace dartcast::gmsh {

template <class T>
T NumberReader::raw(std::string_view what) {
  const std::string_view bytes = text.raw(sizeof(T), what);
  std::array<char, sizeof(T)> copy{};
  std::copy(bytes.begin(), bytes.end(), copy.begin());
  if (swapped) std::reverse(copy.begin(), copy.end());
  T value{};
  std::memcpy(&value, copy.data(), sizeof(T));
  return value;
}

std::int32_t NumberReader::int32(std::string_view what) {
  return binary ? raw<std::int32_t>(what) : static_cast<std::int32_t>(text.integer(what, INT32_MIN, INT32_MAX));
}

std::uint64_t NumberReader::size(std::string_view what) {
  if (binary) return short_sizes ? raw<std::uint32_t>(what) : raw<std::uint64_t>(what);
  return static_cast<std::uint64_t>(text.integer(what, 0, short_sizes ? UINT32_MAX : INT64_MAX));
}

double NumberReader::real(std::string_view what) { return binary ? raw<double>(what) : text.number(what); }

std::size_t NumberReader::count(std::string_view what, std::size_t text_bytes, std::size_t binary_bytes) {
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

namespace {

// Gmsh's element types by number, from 0 on (GmshDefines.h): 0 if there is none, or none with a fixed number of
// nodes.
constexpr std::array<int, 141> node_counts = {
    0,  2,   3,   4,   4,   8,   6,   5,   3,   6,   9,   10,  27,  18,  14,  1,   8,   20,  15,   13,  //
    9,  10,  12,  15,  15,  21,  4,   5,   6,   20,  35,  56,  22,  28,  0,   0,   16,  25,  36,   12,  //
    16, 20,  28,  36,  45,  55,  66,  49,  64,  81,  100, 121, 18,  21,  24,  27,  30,  24,  28,   32,  //
    36, 40,  7,   8,   9,   10,  11,  0,   0,   0,   0,   84,  120, 165, 220, 286, 0,   0,   0,    34,  //
    40, 46,  52,  58,  1,   1,   1,   1,   1,   1,   40,  75,  64,  125, 216, 343, 512, 729, 1000, 32,  //
    44, 56,  68,  80,  92,  104, 126, 196, 288, 405, 550, 24,  33,  42,  51,  60,  69,  78,  30,   55,  //
    91, 140, 204, 285, 385, 21,  29,  37,  45,  53,  61,  69,  1,   0,   0,   0,   0,   16,  4,    5,   //
    4};

constexpr std::array<int, 11> curves_and_points = {8, 15, 26, 27, 28, 62, 63, 64, 65, 66, 84};
/// Types of order 0, with one node; and the wedge of two triangles and a quadrangle.
constexpr std::array<int, 7> unusable = {85, 86, 87, 88, 89, 132, 140};

/// The type with the same corners as one of second order; 0 for others.
int linear_type(int type) {
  switch (type) {
    case 8: return 1;
    case 9: return 2;
    case 10:
    case 16: return 3;
    case 11: return 4;
    case 12:
    case 17: return 5;
    case 13:
    case 18: return 6;
    case 14:
    case 19: return 7;
    default: return 0;
  }
}

template <std::size_t n>
bool contains(const std::array<int, n>& types, int type) {
  return std::find(types.begin(), types.end(), type) != types.end();
}

}  // namespace

int node_count(int type) {
  return type > 0 && type < static_cast<int>(node_counts.size()) ? node_counts[static_cast<std::size_t>(type)] : 0;
}

int known_node_count(const NumberReader& in, int type) {
  const int n = node_count(type);
  if (n != 0) return n;
  if (type == 34 || type == 35)
    in.text.fail(fmt::format("element type {}: Gmsh's polygons and polyhedra are not supported", type));
  in.text.fail(fmt::format("element type {} is unknown", type));
}

void Model::add_element(int type, std::span<const std::uint64_t> numbers, std::int32_t physical_tag) {
  const std::size_t place = elements++;
  if (const int linear = linear_type(type); linear != 0 && parsed.linearise) {
    take_higher_order(parsed, place);
    numbers = numbers.first(static_cast<std::size_t>(node_count(linear)));
    type = linear;
  }
  if (contains(curves_and_points, type)) return;
  if (type < 1 || type > 7) {
    (contains(unusable, type) ? parsed.unsupported : parsed.second_order).add(place);
    return;
  }
  const std::int32_t group_before = std::exchange(last_group_, physical_tag);
  if (repeats_elements && type == last_type_ && physical_tag != group_before &&
      std::equal(numbers.begin(), numbers.end(), last_.begin(), last_.end())) {
    repeated.add(place);
    return;
  }
  last_type_ = type;
  last_.assign(numbers.begin(), numbers.end());
  std::array<std::uint32_t, 8> corners{};
  for (std::size_t k = 0; k < numbers.size(); ++k) corners[k] = nodes.find(numbers[k]);
  const std::span<const std::uint32_t> used(corners.data(), numbers.size());
  if (type == 1) {
    parsed.add_edge(corners[0], corners[1], physical_tag);
    parsed.edge_source.push_back(static_cast<std::uint32_t>(place));
    return;
  }
  if (type == 2 || type == 3) {
    parsed.mesh.add_patch_face(used, physical_tag);
    parsed.mesh.patch_source.push_back(static_cast<std::uint32_t>(place));
    return;
  }
  static constexpr std::array<CellType, 4> types = {CellType::tetrahedron, CellType::hexahedron, CellType::prism,
                                                    CellType::pyramid};
  parsed.mesh.add_cell(types[static_cast<std::size_t>(type - 4)], used);
  parsed.mesh.regions.push_back(physical_tag);
  parsed.mesh.source.push_back(static_cast<std::uint32_t>(place));
}

}  // namespace dartcast::gmsh
