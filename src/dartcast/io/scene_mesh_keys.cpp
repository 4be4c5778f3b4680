#include "dartcast/io/scene_mesh_keys.hpp"

#include <cmath>
#include <limits>

namespace dartcast {

namespace {

constexpr double unlimited = std::numeric_limits<double>::max();
constexpr Range positive = {0.0, unlimited, true};
constexpr Range share = {0.0, 1.0};

void get_cells(TomlTable& t, std::array<std::uint32_t, 3>& cells) {
  std::vector<double> list;
  if (!t.get("cells", list, 3)) return;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(list[i] >= 1.0 && list[i] <= 0x1p29 && list[i] == std::floor(list[i]))) {
      t.fail("cells", "cells must be three whole numbers from 1 to 2^29");
    }
    cells[i] = static_cast<std::uint32_t>(list[i]);
  }
}

// What the box and the octahedra have in common. Cells are of unit size unless `size` is given.
template <class Options>
void read_block(TomlTable& t, Options& o) {
  get_cells(t, o.cells);
  o.size = {static_cast<double>(o.cells[0]), static_cast<double>(o.cells[1]), static_cast<double>(o.cells[2])};
  t.get("origin", o.origin);
  t.get("size", o.size);
  if (!(o.size.x > 0.0 && o.size.y > 0.0 && o.size.z > 0.0)) t.fail("size", "size must be three numbers more than 0");
  t.get("blocked_layer", o.blocked_layer);
  t.get("blocked_share", o.blocked_share, share);
  t.get("seed", o.seed, 0, std::numeric_limits<std::int64_t>::max());
}

BoxOptions read_box(TomlTable& t) {
  BoxOptions o;
  read_block(t, o);
  std::size_t type = 1;
  t.get("type", type, {"tetrahedron", "hexahedron", "prism", "pyramid", "mixed"});
  o.mixed = type == 4;
  if (!o.mixed) o.type = static_cast<CellType>(type);
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
  t.get("radius", o.radius, positive);
  t.get("trunk_length", o.trunk_length, positive);
  if (t.get("branch_lengths", lengths, 2)) o.branch_lengths = {lengths[0], lengths[1]};
  t.get("branch_radius", o.branch_radius, positive);
  t.get("branch_angle", o.branch_angle, positive);
  t.get("out_of_plane", o.out_of_plane, {0.0, unlimited});
  t.get("tissue_thickness", o.tissue_thickness, positive);
  t.get("core", o.core, 2U, 64U);
  t.get("rings", o.rings, 1U, 32U);
  t.get("tissue_layers", o.tissue_layers, 1U, 32U);
  t.get("step_length", o.step_length, positive);
  t.get("peak_speed", o.peak_speed, {-unlimited, unlimited});
  return o;
}

MeshSource read_source(TomlTable& t, const std::filesystem::path& folder) {
  std::string mesh;
  std::size_t generator = 0;
  const bool from_file = t.get("mesh", mesh);
  const bool generated = t.get("generator", generator, {"box", "bar", "octahedra", "vessel"});
  if (from_file == generated)
    t.fail("mesh", "give either mesh = \"FILE\" or generator = \"box\", \"bar\", \"octahedra\" or \"vessel\"");
  if (from_file) return folder / mesh;
  if (generator == 0) return read_box(t);
  if (generator == 1) return bar_options();
  if (generator == 2) return read_octahedra(t);
  return read_vessel(t);
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

}  // namespace

EnvironmentScene read_environment(TomlTable table, const std::filesystem::path& folder) {
  EnvironmentScene scene;
  scene.mesh = read_source(table, folder);
  if (table.has("free")) read_free(table.table("free"), scene);
  std::vector<std::string> patches;
  if (table.get("patches", patches)) scene.patches = patches;
  table.finish();
  return scene;
}

}  // namespace dartcast
