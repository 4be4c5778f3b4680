// Checks of meshes that come from Python, where each array can be set by itself.
#include "support/meshes.hpp"

#include <array>
#include <cerrno>
#include <system_error>
#include <unordered_map>

#include "dartcast/error.hpp"
#include "support/in_use.hpp"

namespace py = pybind11;

namespace dartcast::python {
namespace {

// Calls that read each mesh; -1: one changes it. Python's lock protects it.
std::unordered_map<const MeshData*, int>& uses() {
  static std::unordered_map<const MeshData*, int> counts;
  return counts;
}

// Corners of a cell; 0: any number.
constexpr std::array<std::size_t, 8> corner_counts = {4, 8, 6, 5, 0, 3, 4, 0};

void expect(bool holds, const std::string& text) {
  if (!holds) throw InvalidArgument("the mesh: " + text);
}

void expect_size(std::size_t size, std::size_t count, const char* name, const char* of) {
  expect(size == 0 || size == count, std::string(name) + " has " + std::to_string(size) + " entries, but there are " +
                                         std::to_string(count) + " " + of);
}

void expect_offsets(std::span<const std::size_t> offsets, std::size_t count, std::size_t size, const char* name) {
  const bool right = offsets.size() == count + 1 && offsets.front() == 0 && offsets.back() == size &&
                     std::is_sorted(offsets.begin(), offsets.end());
  expect(right, std::string(name) +
                    " must start with 0, rise, have one entry more than there are items, and end with the "
                    "size of the array that it divides");
}

void expect_points(std::span<const std::uint32_t> numbers, std::size_t points, const char* name, std::size_t item) {
  for (const std::uint32_t p : numbers) {
    if (p < points) continue;
    expect(false, std::string(name) + " " + std::to_string(item) + " has point " + std::to_string(p) +
                      ", but there are " + std::to_string(points) + " points");
  }
}

// A polyhedron: the number of faces, then for each the number of corners and the corners.
void check_polyhedron(std::span<const std::uint32_t> words, std::size_t points, std::size_t cell) {
  const std::string text =
      "the polyhedron in cell " + std::to_string(cell) + " does not hold as many numbers as it says";
  expect(!words.empty(), text);
  std::size_t at = 1;
  for (std::uint32_t f = 0; f < words[0]; ++f) {
    expect(at < words.size() && words[at] < words.size() - at, text);
    expect_points(words.subspan(at + 1, words[at]), points, "cell", cell);
    at += std::size_t{1} + words[at];
  }
  expect(at == words.size(), text);
}

void check_data(std::span<const DataArray> arrays, std::size_t count, const char* of) {
  for (const DataArray& a : arrays) {
    expect(a.components > 0 && a.values.size() % a.components == 0 && a.values.size() / a.components == count,
           "the array '" + a.name + "' has no value for each of " + std::to_string(count) + " " + of);
  }
}

}  // namespace

MeshUse::MeshUse(const MeshData& mesh, bool changes) : mesh_(&mesh) {
  int& count = uses()[mesh_];
  if (count < 0 || (changes && count > 0)) {
    throw InUse("the mesh is in use by a call in another thread: let that end first, or use a copy in each thread");
  }
  count = changes ? -1 : count + 1;
}

MeshUse::~MeshUse() {
  const auto at = uses().find(mesh_);
  if (--at->second <= 0) uses().erase(at);
}

void check_arrays(const MeshData& mesh) {
  const std::size_t cells = mesh.types.size();
  const std::size_t points = mesh.points.size();
  expect_offsets(mesh.offsets, cells, mesh.connectivity.size(), "offsets");
  for (std::size_t c = 0; c < cells; ++c) {
    const auto type = static_cast<std::size_t>(mesh.types[c]);
    expect(type < corner_counts.size(), "cell " + std::to_string(c) + " has no type of CellType");
    const auto corners = mesh.cell(c);
    if (mesh.types[c] == CellType::polyhedron) {
      check_polyhedron(corners, points, c);
      continue;
    }
    expect(corner_counts[type] == 0 || corners.size() == corner_counts[type],
           "cell " + std::to_string(c) + " has " + std::to_string(corners.size()) + " corners, which its type has not");
    expect_points(corners, points, "cell", c);
  }
  expect_size(mesh.source.size(), cells, "source", "cells");
  expect_size(mesh.regions.size(), cells, "regions", "cells");
  expect_size(mesh.free.size(), cells, "free", "cells");
  const std::size_t faces = mesh.patch_tags.size();
  expect_offsets(mesh.patch_offsets, faces, mesh.patch_faces.size(), "patch_offsets");
  expect_size(mesh.patch_source.size(), faces, "patch_source", "patch faces");
  for (std::size_t f = 0; f < faces; ++f) expect_points(mesh.patch_face(f), points, "patch face", f);
  check_data(mesh.point_data, points, "points");
  check_data(mesh.cell_data, cells, "cells");
}

std::string first_defect(const MeshReport& report) {
  const Finding& f = report.defects.front();
  if (f.first.empty()) return f.message;
  std::string text = f.message + ": " + std::to_string(f.count) + ", the first: ";
  for (std::size_t i = 0; i < f.first.size(); ++i) text += (i > 0 ? ", " : "") + std::to_string(f.first[i]);
  return text;
}

void expect_mesh_file(const std::filesystem::path& path, const MeshFile& file) {
  if (file.mesh.cell_count() > 0) return;
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    PyErr_SetObject(PyExc_FileNotFoundError, py::make_tuple(ENOENT, "there is no such mesh file", path.string()).ptr());
    throw py::error_already_set();
  }
  if (is_surface_file(path))
    throw InvalidArgument(path.string() +
                          ": this is a surface: read_surface() reads it, and formats.mesh_surfaces() fills " +
                          "it with cells (needs tetgen or gmsh)");
}

MeshData checked_mesh(const MeshData& mesh) {
  MeshData checked = mesh;
  const MeshReport report = check_and_repair(checked);
  if (!report.valid()) throw InvalidMesh(first_defect(report));
  return checked;
}

void require_checked(const MeshData& mesh) {
  MeshData checked = mesh;
  const MeshReport report = check_and_repair(checked);
  if (!report.valid()) throw InvalidMesh(first_defect(report));
  if (!report.repairs.empty())
    throw InvalidArgument("the mesh needs repairs (" + report.repairs.front().message +
                          "): call check_and_repair() first");
}

}  // namespace dartcast::python
