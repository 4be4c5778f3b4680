// Files of surfaces, written by hand: a cube in each format and variant.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "dartcast/mesh_files.hpp"
#include "support/sample_mesh.hpp"

namespace dartcast::test {

using Xyz = std::array<double, 3>;
using Loop = std::vector<Xyz>;
using Ids = std::vector<std::uint32_t>;

inline const std::vector<Xyz> cube_points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                             {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
inline const std::vector<Ids> cube_squares = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                              {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};

inline std::vector<Ids> cube_triangles() {
  std::vector<Ids> out;
  for (const Ids& s : cube_squares) {
    out.push_back({s[0], s[1], s[2]});
    out.push_back({s[0], s[2], s[3]});
  }
  return out;
}

/// Each face by the coordinates of its corners, from the least one on.
inline std::vector<Loop> sorted_loops(std::vector<Loop> loops) {
  for (Loop& loop : loops) std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
  std::sort(loops.begin(), loops.end());
  return loops;
}

inline std::vector<Loop> loops_of(const MeshData& mesh) {
  std::vector<Loop> loops;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    Loop loop;
    for (const std::uint32_t v : mesh.cell(c)) loop.push_back({mesh.points[v].x, mesh.points[v].y, mesh.points[v].z});
    loops.push_back(loop);
  }
  return sorted_loops(loops);
}

inline std::vector<Loop> loops_of(const std::vector<Ids>& faces) {
  std::vector<Loop> loops;
  for (const Ids& face : faces) {
    Loop loop;
    for (const std::uint32_t v : face) loop.push_back(cube_points[v]);
    loops.push_back(loop);
  }
  return sorted_loops(loops);
}

inline std::string words(const Xyz& p) {
  const auto digits = [](double x) { return std::to_string(static_cast<int>(x)); };
  return digits(p[0]) + " " + digits(p[1]) + " " + digits(p[2]);
}

template <class T>
std::string bytes_of(T value, bool big = false) {
  std::string out(sizeof(T), '\0');
  std::memcpy(out.data(), &value, sizeof(T));
  if (big) std::reverse(out.begin(), out.end());
  return out;
}

inline std::string stl_facet(const std::array<std::string, 3>& corners) {
  std::string out = "facet normal nan -nan(ind) 0\nouter loop\n";
  for (const std::string& corner : corners) out += "vertex " + corner + "\n";
  return out + "endloop\nendfacet\n";
}

// `size`: of the cube's edges, around the same middle; odd.
inline std::string stl_text(double size = 1.0) {
  std::string out = "solid cube\n";
  const auto corner = [size](std::uint32_t i) {
    Xyz p = cube_points[i];
    for (double& x : p) x = 0.5 + size * (x - 0.5);
    return words(p);
  };
  for (const Ids& t : cube_triangles()) out += stl_facet({corner(t[0]), corner(t[1]), corner(t[2])});
  return out + "endsolid\n";
}

inline std::string stl_binary(const std::string& comment, const std::vector<std::array<Xyz, 3>>& triangles) {
  std::string out = comment + std::string(80 - comment.size(), ' ');
  out += bytes_of(static_cast<std::uint32_t>(triangles.size()));
  for (const auto& t : triangles) {
    for (int k = 0; k < 3; ++k) out += bytes_of(std::numeric_limits<float>::quiet_NaN());
    for (const Xyz& p : t) {
      for (const double x : p) out += bytes_of(static_cast<float>(x));
    }
    out += "ab";
  }
  return out;
}

inline std::string stl_binary_cube(const std::string& comment) {
  std::vector<std::array<Xyz, 3>> triangles;
  for (const Ids& t : cube_triangles()) triangles.push_back({cube_points[t[0]], cube_points[t[1]], cube_points[t[2]]});
  return stl_binary(comment, triangles);
}

inline std::string obj(const std::vector<Ids>& faces, const std::string& behind = "") {
  std::string out = "# a cube\nmtllib none.mtl\no cube\n";
  for (const Xyz& p : cube_points) out += "v " + words(p) + "\n";
  out += "vt 0 0\nvn 0 0 1\ns off\n";
  for (const Ids& face : faces) {
    out += "f";
    for (const std::uint32_t v : face) out += " " + std::to_string(v + 1) + behind;
    out += "\n";
  }
  return out;
}

inline std::string ply_header(const std::string& format, std::size_t faces, const std::string& real,
                              const std::string& list) {
  return "ply\nformat " + format + " 1.0\ncomment end_header element\nobj_info x\nelement vertex 8\nproperty " + real +
         " x\nproperty " + real + " y\nproperty " + real + " z\nelement face " + std::to_string(faces) +
         "\nproperty list " + list + " vertex_indices\nend_header\n";
}

inline std::string ply_text(const std::vector<Ids>& faces) {
  std::string out = ply_header("ascii", faces.size(), "float", "uchar int");
  for (const Xyz& p : cube_points) out += words(p) + "\n";
  for (const Ids& face : faces) {
    out += std::to_string(face.size());
    for (const std::uint32_t v : face) out += " " + std::to_string(v);
    out += "\n";
  }
  return out;
}

template <class Real, class Count, class Id>
std::string ply_binary(bool big, const std::vector<Ids>& faces, const std::string& types, const std::string& list) {
  std::string out = ply_header(big ? "binary_big_endian" : "binary_little_endian", faces.size(), types, list);
  for (const Xyz& p : cube_points) {
    for (const double x : p) out += bytes_of(static_cast<Real>(x), big);
  }
  for (const Ids& face : faces) {
    out += bytes_of(static_cast<Count>(face.size()), big);
    for (const std::uint32_t v : face) out += bytes_of(static_cast<Id>(v), big);
  }
  return out;
}

inline std::string off(const std::vector<Ids>& faces, const std::string& header = "OFF\n",
                       const std::string& edges = " 0", const std::string& behind_point = "",
                       const std::string& behind_face = "") {
  std::string out = header + "8 " + std::to_string(faces.size()) + edges + "\n";
  for (const Xyz& p : cube_points) out += words(p) + behind_point + "\n";
  for (const Ids& face : faces) {
    out += std::to_string(face.size());
    for (const std::uint32_t v : face) out += " " + std::to_string(v);
    out += behind_face + "\n";
  }
  return out;
}

struct SurfaceSample {
  std::string name;
  std::string content;
  bool triangles = false;
};

/// A cube in each format and variant.
inline std::vector<SurfaceSample> cube_files() {
  const std::vector<Ids> t = cube_triangles();
  const std::vector<Ids>& s = cube_squares;
  return {{"a.stl", stl_text(), true},
          {"b.stl", stl_binary_cube("made by hand"), true},
          {"c.STL", stl_binary_cube("solid, but binary"), true},
          {"d.obj", obj(s)},
          {"e.obj", obj(t, "/1/1"), true},
          {"f.obj", obj(s, "//1")},
          {"g.obj", obj(s, "/1")},
          {"h.ply", ply_text(s)},
          {"i.ply", ply_text(t), true},
          {"j.ply", ply_binary<float, std::uint8_t, std::int32_t>(false, s, "float", "uchar int")},
          {"k.ply", ply_binary<double, std::int8_t, std::uint32_t>(true, t, "float64", "int8 uint32"), true},
          {"l.ply", ply_binary<std::int16_t, std::uint32_t, std::uint8_t>(true, s, "short", "uint uint8")},
          {"m.ply", ply_binary<std::uint8_t, std::int16_t, std::int8_t>(false, s, "uchar", "int16 char")},
          {"n.ply", ply_binary<std::int8_t, std::uint16_t, std::uint16_t>(true, s, "int8", "ushort uint16")},
          {"o.ply", ply_binary<std::uint32_t, std::int32_t, std::int16_t>(true, s, "uint32", "int32 short")},
          {"p.off", off(s)},
          {"q.off", off(t, "", ""), true},
          {"r.off", off(s, "COFF\n\n# colours\n", "\t24 # edges", "  255 0 0 255", "  1.0 0 0 # red")},
          {"s.off", off(s, "STCNOFF ", " 24", " 0 0 1 1 1 1 1 0 0")}};
}

/// The surface of a file with this name and content.
inline MeshFile read(const std::string& name, const std::string& content) {
  const Folder folder;
  return read_surface(folder.file(name, content));
}

}  // namespace dartcast::test
