// The result of a reader of one mesh format, before the mesh is checked.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_data.hpp"

namespace dartcast {

/// Ids that name no point are kept as 0xffffffff, for check_and_repair() to find. Readers put the cells of space into
/// `mesh`, all faces into its patch faces and all edges beside it. Then finish() turns them into the cells and patch
/// faces of this file.
struct ParsedMesh {
  MeshData mesh;
  std::vector<std::array<std::uint32_t, 2>> edges;
  std::vector<std::int32_t> edge_tags;
  std::vector<std::uint32_t> edge_source;  ///< per edge: its index in the file; empty: its own index
  std::map<std::int32_t, std::string> edge_names;
  std::string format;
  Finding second_order{"second_order",
                       0,
                       {},
                       "cells of second or higher order, with curved sides; write the mesh with linear "
                       "cells (Gmsh: -order 1), or take their corners (--linearise)"};
  Finding unsupported{"cell_type", 0, {}, "cells of a type that cannot be used"};
  bool linearise = false;  ///< the corners of second-order cells are taken
  Finding linearised{
      "linearised", 0, {}, "elements of second order, of which the corners are taken: their sides are flat here"};
  std::vector<Finding> warnings = {};  ///< of the format itself; they come before those of the check

  void add_edge(std::uint32_t a, std::uint32_t b, std::int32_t tag) {
    edges.push_back({a, b});
    edge_tags.push_back(tag);
  }
};

inline constexpr std::uint32_t no_point = 0xffffffffU;

/// In a file without cells of space its faces are the cells, with their tags and names as regions, and its edges the
/// patch faces. Returns whether that is so.
bool take_plane(ParsedMesh& parsed);

/// Last step of each reader; it calls take_plane(). Only patch faces with a tag are kept; without tags regions stay
/// empty.
void finish(ParsedMesh& parsed);

}  // namespace dartcast
