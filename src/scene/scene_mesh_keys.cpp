// Reads the [environment] table of a scene.
#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "scene/scene_keys.hpp"

namespace dartcast {

namespace {

constexpr Range share = {0.0, 1.0};

template <std::size_t n>
void get_counts(TomlTable& t, std::string_view key, std::array<std::uint32_t, n>& counts) {
  std::vector<double> list;
  if (!t.get(key, list, n)) return;
  for (std::size_t i = 0; i < n; ++i) {
    if (!(list[i] >= 1.0 && list[i] <= 0x1p29 && list[i] == std::floor(list[i]))) {
      t.fail(key, fmt::format("{} must be {} whole numbers from 1 to 2^29", key, n));
    }
    counts[i] = static_cast<std::uint32_t>(list[i]);
  }
}

void get_seed(TomlTable& t, std::uint64_t& seed) { t.get("seed", seed, 0, max_seed); }

// The keys that the box and the octahedra share.
template <class Options>
void read_block(TomlTable& t, Options& o) {
  get_counts(t, "cells", o.cells);
  t.get("origin", o.origin);
  Vec3 size;
  if (t.get("size", size)) o.size = size;
  if (o.size && !(size.x > 0.0 && size.y > 0.0 && size.z > 0.0))
    t.fail("size", "size must be three numbers more than 0");
  t.get("blocked_layer", o.blocked_layer);
  t.get("blocked_share", o.blocked_share, share);
  get_seed(t, o.seed);
}

BoxOptions read_box(TomlTable& t) {
  BoxOptions o;
  read_block(t, o);
  std::optional<CellType> type = CellType::hexahedron;
  t.get("type", type,
        {{"tetrahedron", CellType::tetrahedron},
         {"hexahedron", CellType::hexahedron},
         {"prism", CellType::prism},
         {"pyramid", CellType::pyramid},
         {"mixed", std::nullopt}});
  o.mixed = !type;
  if (type) o.type = *type;
  t.get("jitter", o.jitter, share);
  return o;
}

OctahedraOptions read_octahedra(TomlTable& t) {
  OctahedraOptions o;
  read_block(t, o);
  return o;
}

VesselOptions read_vessel(TomlTable& t) {
  VesselOptions o;
  std::vector<double> lengths;
  t.get("radius", o.radius, Range::positive);
  t.get("trunk_length", o.trunk_length, Range::positive);
  if (t.get("branch_lengths", lengths, 2)) o.branch_lengths = {lengths[0], lengths[1]};
  t.get("branch_radius", o.branch_radius, Range::positive);
  t.get("branch_angle", o.branch_angle, Range::positive);
  t.get("out_of_plane", o.out_of_plane, {0.0, Range::unlimited});
  t.get("tissue_thickness", o.tissue_thickness, Range::positive);
  t.get("core", o.core, 2U, 64U);
  t.get("rings", o.rings, 1U, 32U);
  t.get("tissue_layers", o.tissue_layers, 1U, 32U);
  t.get("step_length", o.step_length, Range::positive);
  t.get("peak_speed", o.peak_speed, {-Range::unlimited, Range::unlimited});
  return o;
}

// The keys that the rectangle and the maze share.
template <class Options>
void read_squares(TomlTable& t, Options& o) {
  std::vector<double> list;
  if (t.get("origin", list, 2)) o.origin = {list[0], list[1]};
  if (t.get("size", list, 2)) {
    if (!(list[0] > 0.0 && list[1] > 0.0)) t.fail("size", "size must be two numbers more than 0");
    o.size = std::array{list[0], list[1]};
  }
  std::optional<CellType> type = CellType::quadrilateral;
  t.get("type", type,
        {{"triangle", CellType::triangle},
         {"quadrilateral", CellType::quadrilateral},
         {"polygon", CellType::polygon},
         {"mixed", std::nullopt}});
  o.mixed = !type;
  if (type) o.type = *type;
  const bool squares_alone = type == CellType::triangle || type == CellType::quadrilateral;
  t.get("jitter", o.jitter, {0.0, squares_alone ? largest_square_jitter : largest_polygon_jitter});
  get_seed(t, o.seed);
}

RectangleOptions read_rectangle(TomlTable& t) {
  RectangleOptions o;
  get_counts(t, "cells", o.cells);
  read_squares(t, o);
  t.get("blocked_share", o.blocked_share, share);
  return o;
}

MazeOptions read_maze(TomlTable& t) {
  MazeOptions o;
  get_counts(t, "rooms", o.rooms);
  t.get("room_cells", o.room_cells, 1U, 1U << 14U);
  t.get("door_cells", o.door_cells, 1U, o.room_cells);
  t.get("obstacles", o.obstacles, 0U, o.room_cells * o.room_cells - 1);
  t.get("extra_doors", o.extra_doors, share);
  const std::uint32_t pitch = o.room_cells + 1;
  for (const std::uint32_t n : o.rooms) {
    if (n > 0x1p29 / pitch) t.fail("rooms", "rooms and walls must be at most 2^29 squares along each axis");
  }
  read_squares(t, o);
  return o;
}

// One surface, whose region has a name of its own, or a table of regions and their surfaces.
SurfaceScene read_surfaces(TomlTable t, const std::filesystem::path& folder) {
  SurfaceScene scene;
  t.require("surface", "a closed surface, as \"vessel.stl\", or a table { lumen = \"vessel.stl\" }");
  if (t.is_table("surface")) {
    TomlTable named = t.table("surface");
    for (const std::string& region : named.keys()) {
      std::string file;
      named.get(region, file);
      scene.surfaces.push_back({region, folder / file});
    }
    if (scene.surfaces.empty()) t.fail("surface", "surface names no region");
    named.finish();
  } else {
    NamedSurface surface;
    std::string file;
    t.get("surface", file);
    t.get("inside", surface.region);
    surface.file = folder / file;
    scene.surfaces.push_back(surface);
  }
  t.get("outside", scene.outside);
  for (const NamedSurface& s : scene.surfaces) {
    if (s.region == scene.outside) t.fail("outside", fmt::format("\"{}\" is a region inside, too", s.region));
  }
  t.get("box", scene.box, {1.0, Range::unlimited, true});
  t.get("size", scene.size, Range::not_negative);
  if (t.is_table("cap")) {
    TomlTable cap = t.table("cap");
    scene.cap = true;
    cap.get("tolerance", scene.cap_tolerance, Range::not_negative);
    cap.finish();
  } else {
    t.get("cap", scene.cap);
  }
  t.get("repair", scene.repair);
  t.get("angle", scene.angle, {0.0, 180.0, true});
  t.get("with", scene.mesher, {{"tetgen", Mesher::tetgen}, {"gmsh", Mesher::gmsh}});
  t.get("seconds", scene.seconds, Range::positive);
  t.finish();
  return scene;
}

MeshSource read_source(TomlTable& t, const std::filesystem::path& folder) {
  if (t.is_table("mesh")) {
    if (t.has("generator")) t.fail("generator", "give either mesh or generator");
    return read_surfaces(t.table("mesh"), folder);
  }
  std::string mesh;
  MeshSource (*generator)(TomlTable&) = nullptr;
  const bool from_file = t.get("mesh", mesh);
  const bool generated = t.get("generator", generator,
                               {{"box", [](TomlTable& in) -> MeshSource { return read_box(in); }},
                                {"bar", [](TomlTable&) -> MeshSource { return bar_options(); }},
                                {"octahedra", [](TomlTable& in) -> MeshSource { return read_octahedra(in); }},
                                {"vessel", [](TomlTable& in) -> MeshSource { return read_vessel(in); }},
                                {"rectangle", [](TomlTable& in) -> MeshSource { return read_rectangle(in); }},
                                {"maze", [](TomlTable& in) -> MeshSource { return read_maze(in); }}});
  if (from_file == generated)
    t.fail("mesh",
           "give either mesh = \"FILE\" or generator = \"box\", \"bar\", \"octahedra\", \"vessel\", \"rectangle\" or "
           "\"maze\"");
  if (from_file) return folder / mesh;
  return generator(t);
}

void read_free(TomlTable t, EnvironmentScene& scene) {
  FreeRegions regions;
  FreeValues values;
  const bool by_region = t.get("region", regions.regions);
  const bool by_array = t.get("array", values.array);
  const bool has_values = t.get("values", values.values);
  if (by_region == by_array || by_array != has_values) {
    t.fail("", "give either region = [\"NAME\"], or array = \"NAME\" with values = [1]");
  }
  t.finish();
  if (by_region) {
    scene.free = regions;
  } else {
    scene.free = values;
  }
}

void read_patches(TomlTable t, EnvironmentScene& scene) {
  PatchArray array;
  PatchAngle angle;
  const bool by_array = t.get("array", array.name);
  const bool by_angle = t.get("angle", angle.degrees, {0.0, 180.0});
  if (by_array == by_angle) t.fail("", "give either array = \"NAME\", or angle = 30 (degrees)");
  t.finish();
  if (by_array && !std::holds_alternative<std::filesystem::path>(scene.mesh))
    t.fail("array", "patches from an array need mesh = \"FILE\"; a generator's patches have names");
  if (by_array) {
    scene.patches = array;
  } else {
    scene.patches = angle;
  }
}

}  // namespace

EnvironmentScene read_environment(TomlTable table, const std::filesystem::path& folder) {
  EnvironmentScene scene;
  scene.mesh = read_source(table, folder);
  table.get("scale", scene.scale, Range::positive);
  table.get("linearise", scene.linearise);
  table.get("skip_bad_cells", scene.skip_bad_cells);
  if (table.has("free")) read_free(table.table("free"), scene);
  table.get("walls", scene.walls);
  if (table.is_table("patches")) {
    read_patches(table.table("patches"), scene);
  } else if (std::vector<std::string> names; table.get("patches", names)) {
    scene.patches = names;
  }
  table.finish();
  return scene;
}

}  // namespace dartcast
