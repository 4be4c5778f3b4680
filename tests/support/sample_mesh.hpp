// Small meshes and files for the tests of readers and writers.
#pragma once

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <string>
#include <vector>

#include "dartcast/mesh_data.hpp"
#include "dartcast/mesh_files.hpp"

namespace dartcast::test {

inline void add(MeshData& mesh, CellType type, std::vector<std::uint32_t> corners) { mesh.add_cell(type, corners); }
inline void add_face(MeshData& mesh, std::vector<std::uint32_t> corners, std::int32_t tag) {
  mesh.add_patch_face(corners, tag);
}

/// A hexahedron, a prism beside it, a pyramid on top and a tetrahedron on that: every standard type, three regions, two
/// patches, coordinates that need all their digits.
inline MeshData sample_mesh() {
  MeshData mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0},  {0, 1, 0},  {0, 0, 1},   {1, 0, 1},
                 {1, 1, 1}, {0, 1, 1}, {2, .5, 0}, {2, .5, 1}, {.5, .5, 2}, {.5, -1, 1.5}};
  for (Vec3& p : mesh.points) p = {p.x / 3.0 + 0.1, p.y * 0.7 - 0.2, p.z * 1.1e-3};
  add(mesh, CellType::hexahedron, {0, 1, 2, 3, 4, 5, 6, 7});
  add(mesh, CellType::prism, {1, 8, 2, 5, 9, 6});
  add(mesh, CellType::pyramid, {4, 5, 6, 7, 10});
  add(mesh, CellType::tetrahedron, {4, 5, 10, 11});
  mesh.regions = {1, 1, 2, 3};
  mesh.region_names = {{1, "lumen"}, {2, "a wall, thick"}, {3, "rest"}};
  add_face(mesh, {0, 3, 2, 1}, 10);
  add_face(mesh, {1, 2, 8}, 11);
  mesh.patch_names = {{10, "inlet"}, {11, "outlet"}};
  return mesh;
}

/// A cube as a polyhedron, with a tetrahedron-like cap of five faces (a pyramid as polyhedron) on top.
inline MeshData polyhedra() {
  MeshData mesh = sample_mesh();
  MeshData out;
  out.points.assign(mesh.points.begin(), mesh.points.begin() + 8);
  out.points.push_back(mesh.points[10]);
  add(out, CellType::polyhedron,
      {6, 4, 0, 3, 2, 1, 4, 4, 5, 6, 7, 4, 0, 1, 5, 4, 4, 1, 2, 6, 5, 4, 2, 3, 7, 6, 4, 3, 0, 4, 7});
  add(out, CellType::polyhedron, {5, 4, 4, 7, 6, 5, 3, 4, 5, 8, 3, 5, 6, 8, 3, 6, 7, 8, 3, 7, 4, 8});
  return out;
}

/// Squares and triangles of the plane: three regions, two patches, coordinates that need all their digits.
inline MeshData planar_mesh() {
  MeshData mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, .5, 0}, {1, 2, 0}, {0, 2, 0}, {-.5, 3, 0}};
  for (Vec3& p : mesh.points) p = {p.x / 3.0 + 0.1, p.y * 0.7 - 0.2, 0.0};
  add(mesh, CellType::quadrilateral, {0, 1, 2, 3});
  add(mesh, CellType::triangle, {1, 4, 2});
  add(mesh, CellType::quadrilateral, {3, 2, 5, 6});
  add(mesh, CellType::triangle, {6, 5, 7});
  mesh.regions = {1, 1, 2, 3};
  mesh.region_names = {{1, "lumen"}, {2, "a wall, thick"}, {3, "rest"}};
  add_face(mesh, {0, 1}, 10);
  add_face(mesh, {4, 2}, 11);
  add_face(mesh, {3, 0}, 10);
  mesh.patch_names = {{10, "inlet"}, {11, "outlet"}};
  return mesh;
}

/// The same with a pentagon of which one corner is straight.
inline MeshData planar_polygons() {
  MeshData mesh = planar_mesh();
  mesh.points.push_back((mesh.points[0] + mesh.points[1]) * 0.5);
  mesh.points.push_back({mesh.points[1].x, mesh.points[1].y - 1.0, 0.0});
  mesh.points.push_back({mesh.points[0].x, mesh.points[0].y - 1.0, 0.0});
  mesh.points.push_back({mesh.points[0].x - 1.0, mesh.points[0].y - 0.5, 0.0});
  MeshData out = mesh;
  out.types.clear();
  out.connectivity.clear();
  out.offsets = {0};
  add(out, CellType::polygon, {0, 8, 1, 2, 3});
  for (std::size_t c = 1; c < mesh.cell_count(); ++c) out.add_cell(mesh.types[c], mesh.cell(c));
  add(out, CellType::polygon, {0, 11, 10, 9, 1, 8});
  out.regions.push_back(2);
  out.patch_faces = {0, 3, 2, 4, 9, 10};
  return out;
}

/// A folder that is removed with its content.
class Folder {
 public:
  Folder() {
    static int number = 0;
    const std::string name = "dartcast_io_" + std::to_string(::getpid()) + "_" + std::to_string(number++);
    path_ = std::filesystem::temp_directory_path() / name;
    std::filesystem::create_directories(path_);
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

  /// Writes a file and returns its path.
  [[nodiscard]] std::filesystem::path file(const std::string& name, const std::string& content) const {
    std::filesystem::remove(path_ / name);  // a new file is written much faster than an old one is overwritten
    write_bytes(path_ / name, content);
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

/// Bytes of numbers, in this machine's order or the other one.
class Bytes {
 public:
  explicit Bytes(bool swapped = false) : swapped_(swapped) {}

  Bytes& text(const std::string& s) {
    out += s;
    return *this;
  }
  template <class T>
  Bytes& number(T value) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    if (swapped_) std::reverse(raw, raw + sizeof(T));
    out.append(raw, sizeof(T));
    return *this;
  }

  std::string out;

 private:
  bool swapped_;
};

/// Gmsh's number of a cell type.
inline int gmsh_type(CellType type) {
  if (type == CellType::triangle) return 2;
  return type == CellType::quadrilateral ? 3 : 4 + static_cast<int>(type);
}

/// Its number of a face or an edge.
inline int gmsh_face_type(std::size_t corners) { return static_cast<int>(corners) - 1; }

/// The mixed or planar mesh in Gmsh 2.2 binary, one block per element.
inline std::string gmsh_22_binary(const MeshData& mesh, bool swapped) {
  Bytes b(swapped);
  b.text("$MeshFormat\n2.2 1 8\n").number<std::int32_t>(1).text("\n$EndMeshFormat\n$Nodes\n");
  b.text(std::to_string(mesh.points.size()) + "\n");
  for (std::size_t p = 0; p < mesh.points.size(); ++p) {
    b.number(static_cast<std::int32_t>(p + 1))
        .number(mesh.points[p].x)
        .number(mesh.points[p].y)
        .number(mesh.points[p].z);
  }
  b.text("\n$EndNodes\n$Elements\n" + std::to_string(mesh.cell_count() + mesh.patch_tags.size()) + "\n");
  std::int32_t number = 1;
  const auto element = [&](int type, std::int32_t tag, std::span<const std::uint32_t> corners) {
    b.number(type).number(std::int32_t{1}).number(std::int32_t{2}).number(number++).number(tag).number(tag);
    for (const std::uint32_t v : corners) b.number(static_cast<std::int32_t>(v + 1));
  };
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    const std::size_t n = mesh.patch_offsets[f + 1] - mesh.patch_offsets[f];
    element(gmsh_face_type(n), mesh.patch_tags[f], {mesh.patch_faces.data() + mesh.patch_offsets[f], n});
  }
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) element(gmsh_type(mesh.types[c]), mesh.regions[c], mesh.cell(c));
  return b.text("\n$EndElements\n").out;
}

/// Writes Gmsh 4.0 or 4.1, binary, section by section.
class Gmsh4Writer {
 public:
  Gmsh4Writer(const MeshData& mesh, bool v41, bool swapped, bool short_sizes)
      : mesh_(mesh), v41_(v41), short_sizes_(short_sizes), b_(swapped) {}

  std::string write() {
    head();
    entities();
    nodes();
    elements();
    return b_.out;
  }

 private:
  void size(std::size_t n) {
    short_sizes_ ? b_.number(static_cast<std::uint32_t>(n)) : b_.number(static_cast<std::uint64_t>(n));
  }
  void integer(std::int64_t n) { b_.number(static_cast<std::int32_t>(n)); }
  void node(std::size_t n) { v41_ ? size(n) : integer(static_cast<std::int64_t>(n)); }

  void head() {
    b_.text(v41_ ? (short_sizes_ ? "$MeshFormat\n4.1 1 4\n" : "$MeshFormat\n4.1 1 8\n") : "$MeshFormat\n4 1 8\n")
        .number<std::int32_t>(1)
        .text("\n$EndMeshFormat\n");
  }

  void entity(int tag, int group, int boundary) {
    integer(tag);
    for (int k = 0; k < 6; ++k) b_.number(0.5);
    size(group != 0 ? 1 : 0);
    if (group != 0) integer(group);
    size(boundary != 0 ? 1 : 0);
    if (boundary != 0) integer(boundary);
  }
  void entities() {
    b_.text("$Entities\n");
    const bool planar = mesh_.dimension() == 2;
    for (const std::size_t n : planar ? std::array<std::size_t, 4>{1, 2, 3, 0} : std::array<std::size_t, 4>{1, 1, 2, 3})
      size(n);
    integer(1);  // a point
    for (int k = 0; k < (v41_ ? 3 : 6); ++k) b_.number(0.5);
    size(0);
    if (!planar) entity(7, 0, 1);
    entity(1, 10, -7);
    entity(2, -11, 0);
    for (const int tag : {1, 2, 3}) entity(tag, tag, 1);
    b_.text("\n$EndEntities\n");
  }

  // The first point alone, with a parameter on its curve; then the others.
  void nodes() {
    b_.text("$Nodes\n");
    size(2);
    size(mesh_.points.size());
    if (v41_) {
      size(1);
      size(mesh_.points.size());
    }
    for (const bool first : {true, false}) {
      const std::size_t begin = first ? 0 : 1;
      const std::size_t end = first ? 1 : mesh_.points.size();
      integer(v41_ ? (first ? 1 : 3) : 7);
      integer(v41_ ? 7 : (first ? 1 : 3));
      integer(first ? 1 : 0);
      size(end - begin);
      for (std::size_t p = begin; v41_ && p < end; ++p) size(p + 1);
      for (std::size_t p = begin; p < end; ++p) {
        if (!v41_) node(p + 1);
        b_.number(mesh_.points[p].x).number(mesh_.points[p].y).number(mesh_.points[p].z);
        if (first) b_.number(0.25);
      }
    }
    b_.text("\n$EndNodes\n");
  }

  void element(int of, int tag, int type, std::span<const std::uint32_t> corners) {
    integer(v41_ ? of : tag);
    integer(v41_ ? tag : of);
    integer(type);
    size(1);
    node(number_++);
    for (const std::uint32_t v : corners) node(v + 1);
  }
  void elements() {
    b_.text("$Elements\n");
    const std::size_t count = mesh_.cell_count() + mesh_.patch_tags.size();
    size(count);
    size(count);
    if (v41_) {
      size(1);
      size(count);
    }
    const int dimension = static_cast<int>(mesh_.dimension());
    for (std::size_t f = 0; f < mesh_.patch_tags.size(); ++f) {
      const std::size_t n = mesh_.patch_offsets[f + 1] - mesh_.patch_offsets[f];
      element(dimension - 1, mesh_.patch_tags[f] - 9, gmsh_face_type(n),
              {mesh_.patch_faces.data() + mesh_.patch_offsets[f], n});
    }
    for (std::size_t c = 0; c < mesh_.cell_count(); ++c)
      element(dimension, mesh_.regions[c], gmsh_type(mesh_.types[c]), mesh_.cell(c));
    b_.text("\n$EndElements\n");
  }

  const MeshData& mesh_;
  bool v41_;
  bool short_sizes_;
  Bytes b_;
  std::size_t number_ = 1;
};

/// The mixed or planar mesh in Gmsh 4.0 or 4.1, binary. One entity for each tag. `short_sizes`: of 4 bytes (4.1).
inline std::string gmsh_4_binary(const MeshData& mesh, bool v41, bool swapped, bool short_sizes = false) {
  return Gmsh4Writer(mesh, v41, swapped, short_sizes).write();
}

/// The mixed or planar mesh in Gmsh 1, with node numbers far apart.
inline std::string gmsh_1(const MeshData& mesh) {
  std::string out = "$NOD\n" + std::to_string(mesh.points.size()) + "\n";
  char line[200];
  const auto number = [](std::size_t p) { return std::to_string(1000000 - 7 * p); };
  for (std::size_t p = 0; p < mesh.points.size(); ++p) {
    std::snprintf(line, sizeof line, " %.17g %.17g %.17g\n", mesh.points[p].x, mesh.points[p].y, mesh.points[p].z);
    out += number(p) + line;
  }
  out += "$ENDNOD\n$ELM\n" + std::to_string(mesh.cell_count() + mesh.patch_tags.size() + 1) + "\n1 15 9 9 1 " +
         number(0) + "\n";
  const auto element = [&](int type, std::int32_t tag, std::span<const std::uint32_t> corners) {
    out += "5 " + std::to_string(type) + " " + std::to_string(tag) + " 1 " + std::to_string(corners.size());
    for (const std::uint32_t v : corners) out += " " + number(v);
    out += "\n";
  };
  for (std::size_t f = 0; f < mesh.patch_tags.size(); ++f) {
    const std::size_t n = mesh.patch_offsets[f + 1] - mesh.patch_offsets[f];
    element(gmsh_face_type(n), mesh.patch_tags[f], {mesh.patch_faces.data() + mesh.patch_offsets[f], n});
  }
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) element(gmsh_type(mesh.types[c]), mesh.regions[c], mesh.cell(c));
  return out + "$ENDELM\n";
}

inline std::string base64(const std::string& bytes) {
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned bits = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      bits = (bits << 8U) | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) out += i + k > bytes.size() ? '=' : digits[(bits >> (18U - 6U * k)) & 63U];
  }
  return out;
}

/// Two tetrahedra in a .vtu with 64-bit headers and arrays that are not compressed: `format` is "binary" (inline
/// base64) or "appended" (raw).
inline std::string binary_vtu(const std::string& format, bool big_endian) {
  std::string appended;
  const auto array = [&](const std::string& tag, const std::string& data) {
    Bytes head(big_endian);
    head.number(static_cast<std::uint64_t>(data.size()));
    const std::string out = "<DataArray " + tag + " format=\"" + format + "\"";
    if (format == "binary") return out + ">\n" + base64(head.out + data) + "\n</DataArray>\n";
    const std::string offset = std::to_string(appended.size());
    appended += head.out + data;
    return out + " offset=\"" + offset + "\"/>\n";
  };
  Bytes points(big_endian);
  for (const double x : {0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 1., 0., 0., -1. / 3.}) points.number(x);
  Bytes corners(big_endian);
  for (const std::int32_t v : {0, 1, 2, 3, 0, 2, 1, 4}) corners.number(v);
  Bytes ends(big_endian);
  ends.number(std::int32_t{4}).number(std::int32_t{8});
  std::string out = "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" header_type=\"UInt64\" byte_order=\"" +
                    std::string(big_endian ? "BigEndian" : "LittleEndian") + "\"><UnstructuredGrid>\n" +
                    "<Piece NumberOfPoints=\"5\" NumberOfCells=\"2\"><Points>\n";
  out += array("type=\"Float64\" NumberOfComponents=\"3\"", points.out) + "</Points><Cells>\n";
  out +=
      array("type=\"Int32\" Name=\"connectivity\"", corners.out) + array("type=\"Int32\" Name=\"offsets\"", ends.out);
  out += array("type=\"UInt8\" Name=\"types\"", "\x0a\x0a") + "</Cells></Piece></UnstructuredGrid>\n";
  if (format == "appended") out += "<AppendedData encoding=\"raw\">\n_" + appended + "\n</AppendedData>\n";
  return out + "</VTKFile>\n";
}

inline std::string slurp(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

}  // namespace dartcast::test
