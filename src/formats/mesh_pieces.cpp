// Meshes in pieces, each a .vtu file with the numbers of its points and cells in the whole.
//
// Writing: patches get the tags 1, 2 ... in the order of their numbers, and all regions a name. So each piece also
// knows those of which it has no face or cell. Reading: each piece is checked as a mesh of its own; its numbers are
// checked; then parts are put together by these.
#include "formats/mesh_pieces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "dartcast/combinatorial_map.hpp"
#include "dartcast/error.hpp"
#include "formats/checked_file.hpp"
#include "formats/file_text.hpp"
#include "formats/format_table.hpp"
#include "formats/vtk.hpp"
#include "formats/vtu_write.hpp"
#include "formats/xml_pieces.hpp"
#include "mesh/baffles.hpp"
#include "parts/merged_parts.hpp"
#include "parts/part_cutter.hpp"
#include "parts/part_of_rank.hpp"

namespace dartcast {

namespace {

// The arrays of a piece, beside those of the mesh.
constexpr const char* point_numbers = "point_of_whole";
constexpr const char* cell_numbers = "cell_of_whole";
constexpr const char* cell_sources = "source_of_whole";
constexpr const char* cell_handles = "handle_of_whole";
constexpr const char* cell_owners = "piece_of_cell";

// ---- writing

void number_patches(MeshData& mesh) {
  std::vector<std::int32_t> order = mesh.patch_order;
  for (const std::int32_t tag : mesh.patch_tags) {
    if (std::find(order.begin(), order.end(), tag) == order.end()) order.push_back(tag);
  }
  std::map<std::int32_t, std::int32_t> number;
  std::map<std::pair<std::string, bool>, std::int32_t> of_name;  // and whether they are baffles
  std::map<std::int32_t, std::string> names;
  for (const std::int32_t tag : order) {
    const auto named = mesh.patch_names.find(tag);
    const std::string name = named != mesh.patch_names.end() ? named->second : std::to_string(tag);
    number[tag] =
        of_name.try_emplace({name, is_baffle(mesh, tag)}, static_cast<std::int32_t>(of_name.size()) + 1).first->second;
    names[number[tag]] = name;
  }
  for (std::int32_t& tag : mesh.patch_tags) tag = number[tag];
  for (std::int32_t& tag : mesh.baffle_tags) tag = number[tag];
  mesh.patch_names = std::move(names);
  mesh.patch_order.clear();
}

void name_regions(MeshData& mesh) {
  if (mesh.regions.empty()) return;
  for (const std::int32_t tag : std::set<std::int32_t>(mesh.regions.begin(), mesh.regions.end()))
    mesh.region_names.try_emplace(tag, std::to_string(tag));
}

template <class T, class Number>
DataArray numbers(const char* name, const std::vector<T>& list, Number&& number) {
  DataArray array{name, 1, {}};
  for (const T& item : list) array.values.push_back(static_cast<double>(number(item)));
  return array;
}

MeshData piece_of(MeshPart part) {
  const auto plain = [](std::uint32_t n) { return n; };
  MeshData mesh = std::move(part.mesh);
  mesh.point_data.push_back(numbers(point_numbers, part.points, plain));
  mesh.cell_data.push_back(numbers(cell_numbers, part.cells, plain));
  mesh.cell_data.push_back(numbers(cell_sources, mesh.source, plain));
  mesh.cell_data.push_back(numbers(cell_handles, part.handles, [](Cell c) { return c.value; }));
  mesh.cell_data.push_back(numbers(cell_owners, part.owners, plain));
  return mesh;
}

// ---- reading

DataArray take_array(std::vector<DataArray>& arrays, const std::string& name, std::size_t items) {
  const auto found = std::find_if(arrays.begin(), arrays.end(), [&](const DataArray& a) { return a.name == name; });
  if (found == arrays.end() || found->components != 1 || found->values.size() != items)
    throw InvalidMesh(fmt::format("it has no array '{}': pieces are read that dartcast partition has written", name));
  DataArray array = std::move(*found);
  arrays.erase(found);
  return array;
}

std::vector<std::uint32_t> take_numbers(std::vector<DataArray>& arrays, const char* name, std::size_t items) {
  std::vector<std::uint32_t> result;
  for (const double value : take_array(arrays, name, items).values) {
    if (!(value >= 0.0 && value < 0xffffffffU && value == std::floor(value)))
      throw InvalidMesh(fmt::format("array '{}' has the value {}, which is no number of an item", name, value));
    result.push_back(static_cast<std::uint32_t>(value));
  }
  return result;
}

void check_ascending(const std::vector<std::uint32_t>& list, const char* name) {
  if (std::adjacent_find(list.begin(), list.end(), std::greater_equal<>()) != list.end())
    throw InvalidMesh(fmt::format("the numbers in array '{}' do not ascend", name));
}

MeshPart part_of(MeshData mesh, std::uint32_t pieces, std::uint32_t piece) {
  MeshPart part;
  part.part = piece;
  part.parts = pieces;
  const std::size_t cells = mesh.cell_count();
  part.points = take_numbers(mesh.point_data, point_numbers, mesh.points.size());
  part.cells = take_numbers(mesh.cell_data, cell_numbers, cells);
  mesh.source = take_numbers(mesh.cell_data, cell_sources, cells);
  for (const std::uint32_t value : take_numbers(mesh.cell_data, cell_handles, cells)) part.handles.emplace_back(value);
  part.owners = take_numbers(mesh.cell_data, cell_owners, cells);
  check_ascending(part.points, point_numbers);
  check_ascending(part.cells, cell_numbers);
  for (std::size_t c = 0; c < cells; ++c) {
    const std::uint32_t pool = CombinatorialMap::pool_of(mesh.types[c]);
    const bool follows = c == 0 || part.handles[c].pool() != part.handles[c - 1].pool() ||
                         part.handles[c - 1].index() < part.handles[c].index();
    if (part.handles[c].pool() != pool || !follows || part.owners[c] >= pieces)
      throw InvalidMesh(fmt::format("cell {} has a handle or a piece that cannot be", c));
  }
  for (const auto& [tag, name] : mesh.patch_names) mesh.patch_order.push_back(tag);
  part.mesh = std::move(mesh);
  return part;
}

MeshPart read_piece(const std::filesystem::path& path, std::uint32_t pieces, std::uint32_t piece,
                    const ReadOptions& options) {
  ReadOptions plain;
  plain.max_memory = options.max_memory;
  MeshFile file = read_valid_mesh(path, plain);
  try {
    if (!file.report.repairs.empty()) throw InvalidMesh("it is damaged: " + file.report.repairs.front().message);
    return part_of(std::move(file.mesh), pieces, piece);
  } catch (const InvalidMesh& e) {
    throw InvalidMesh(fmt::format("{}: {}", path.string(), e.what()));
  }
}

// Pieces of one mesh have the same arrays, and know the same patches.
void check_like(const MeshPart& part, const MeshPart& first, const std::filesystem::path& path) {
  const auto same = [](const std::vector<DataArray>& a, const std::vector<DataArray>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const DataArray& x, const DataArray& y) {
      return x.name == y.name && x.components == y.components;
    });
  };
  const MeshData& a = part.mesh;
  const MeshData& b = first.mesh;
  if (!same(a.point_data, b.point_data) || !same(a.cell_data, b.cell_data) || a.patch_names != b.patch_names ||
      a.baffle_tags != b.baffle_tags || a.regions.empty() != b.regions.empty() || a.free.empty() != b.free.empty())
    throw InvalidMesh(fmt::format("{}: the piece has other arrays or patches than the first one", path.string()));
}

// The pieces [first, last), whose cells belong to parts by owner(piece).
template <class Owner>
MeshPart read_range(const std::vector<std::filesystem::path>& pieces, std::size_t first, std::size_t last,
                    std::uint32_t parts, std::uint32_t part, const ReadOptions& options, Owner&& owner) {
  std::vector<MeshPart> read;
  const auto count = static_cast<std::uint32_t>(pieces.size());
  for (std::size_t k = first; k < last; ++k) {
    MeshPart& p = read.emplace_back(read_piece(pieces[k], count, static_cast<std::uint32_t>(k), options));
    for (std::uint32_t& o : p.owners) o = owner(o);
    check_like(p, read.front(), pieces[k]);
  }
  return merged_parts(read, parts, part);
}

}  // namespace

void write_mesh_parts(const MeshData& mesh, std::uint32_t parts, const std::filesystem::path& path) {
  if (ending_of(path) != ".pvtu")
    throw InvalidArgument(fmt::format("{}: pieces are named by a file that ends in .pvtu", path.string()));
  MeshData whole = mesh;
  number_patches(whole);
  name_regions(whole);
  const std::vector<std::uint32_t> owners = partition(whole, parts);
  PartCutter cutter(whole, owners, parts);
  std::vector<std::string> names;
  XmlDataSet like;
  for (std::uint32_t part = 0; part < parts; ++part) {
    names.push_back(fmt::format("{}_{:0{}}.vtu", path.stem().string(), part, std::to_string(parts - 1).size()));
    const auto piece = std::make_shared<const MeshData>(piece_of(cutter.cut(cutter.cells_of(part), part)));
    write_vtu(*piece, path.parent_path() / names.back());
    if (part == 0) like = vtu_data_set(piece);
  }
  write_xml_of_pieces(path, like, names);
}

MeshPart read_mesh_part(const std::filesystem::path& path, std::uint32_t parts, std::uint32_t part,
                        const ReadOptions& options) {
  try {
    const std::vector<std::filesystem::path> pieces = named_pieces(path, read_bytes(path), ".vtu");
    if (pieces.size() < parts)
      throw InvalidMesh(
          fmt::format("{} pieces cannot be shared by {} processes: start at most as many", pieces.size(), parts));
    const auto owner = [&](std::uint64_t piece) { return static_cast<std::uint32_t>(piece * parts / pieces.size()); };
    std::size_t first = 0;
    while (owner(first) < part) ++first;
    std::size_t last = first;
    while (last < pieces.size() && owner(last) == part) ++last;
    return read_range(pieces, first, last, parts, part, options, owner);
  } catch (const InvalidMesh& e) {
    throw InvalidMesh(fmt::format("{}: {}", path.string(), e.what()));
  }
}

ParsedMesh read_pieces(const std::filesystem::path& path, std::string_view content, const ReadOptions& options) {
  const std::vector<std::filesystem::path> pieces = named_pieces(path, std::string(content), ".vtu");
  if (pieces.empty()) throw InvalidMesh("it names no pieces");
  if (content.find(point_numbers) == std::string_view::npos) return parse_vtu_pieces(pieces, options);  // of others
  MeshPart all = read_range(pieces, 0, pieces.size(), 1, 0, options, [](std::uint32_t) { return 0U; });
  for (std::size_t c = 0; c < all.cells.size(); ++c) {
    if (all.cells[c] != c) throw InvalidMesh(fmt::format("cell {} is in no piece: a piece is missing", c));
  }
  ParsedMesh parsed;
  parsed.mesh = whole_mesh(std::move(all));
  parsed.format = "VTK, in pieces";
  return parsed;
}

}  // namespace dartcast
