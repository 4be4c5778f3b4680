// The verb mesh: tetrahedra inside and around closed surfaces.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "commands.hpp"
#include "dartcast/error.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/scene.hpp"
#include "limits.hpp"
#include "max_memory.hpp"
#include "output/mesh_report_text.hpp"
#include "terminal.hpp"

namespace dartcast::app {

namespace {

struct MeshArguments {
  std::vector<std::string> surfaces;
  std::string inside = "inside";
  std::string out;
  std::string with;
  SurfaceScene scene;
  std::uint64_t max_memory = 0;
};

// As "lumen=a.stl"; a path alone is the region of --inside.
NamedSurface named_surface(const std::string& text, const std::string& inside) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) return {inside, text};
  return {text.substr(0, equals), text.substr(equals + 1)};
}

// Before the mesher runs.
void check_ending(const std::string& file) {
  const std::vector<std::string> endings = writable_mesh_endings();
  const bool known =
      std::any_of(endings.begin(), endings.end(), [&](const std::string& e) { return file.ends_with(e); });
  if (!known)
    throw InvalidArgument(fmt::format("{}: a mesh is written to files that end in {}", file, fmt::join(endings, ", ")));
}

int mesh(const MeshArguments& a) {
  check_ending(a.out);
  SurfaceScene scene = a.scene;
  if (!a.with.empty()) scene.mesher = a.with == "gmsh" ? Mesher::gmsh : Mesher::tetgen;
  for (const std::string& text : a.surfaces) scene.surfaces.push_back(named_surface(text, a.inside));
  const MeshFile made = while_waiting("meshing " + scene.surfaces.front().file.string(), true, {{}, a.max_memory},
                                      [&](const ReadOptions& options) { return mesh_surfaces(scene, options); });
  fmt::print("{}", report_text(made.report));
  if (!made.report.valid()) return failed;
  write_noting_loss(made.mesh, a.out);
  fmt::print("{}\n", a.out);
  return done;
}

}  // namespace

void add_mesh(CLI::App& app, int& status) {
  const auto a = std::make_shared<MeshArguments>();
  CLI::App* verb = app.add_subcommand("mesh", "Fill closed surfaces, and the space around them, with tetrahedra.");
  verb->add_option(
          "SURFACE", a->surfaces,
          fmt::format("closed surfaces: {}; NAME=FILE names the region inside", fmt::join(surface_endings(), " ")))
      ->type_name("FILE")
      ->required();
  verb->add_option("-o,--output", a->out, fmt::format("the mesh to write: {}", fmt::join(writable_mesh_endings(), " ")))
      ->type_name("FILE")
      ->required();
  verb->add_option("--box", a->scene.box, "edges of the box around, as a multiple of the surfaces' own")
      ->type_name("N")
      ->capture_default_str();
  verb->add_option("--size", a->scene.size, "length of the tetrahedra's edges, about; 0: as the mesher likes")
      ->type_name("LENGTH")
      ->capture_default_str();
  verb->add_option("--inside", a->inside, "the region inside a surface without a name")
      ->type_name("NAME")
      ->capture_default_str();
  verb->add_option("--outside", a->scene.outside, "the region up to the box")->type_name("NAME")->capture_default_str();
  verb->add_flag("--cap", a->scene.cap, "close flat holes: patches inlet, outlet ...");
  verb->add_option("--cap-tolerance", a->scene.cap_tolerance,
                   "how far a hole may be off a plane, as a share of its width")
      ->capture_default_str();
  verb->add_flag("--repair", a->scene.repair, "replace a few triangles that cross or touch, and those around them");
  verb->add_option("--angle", a->scene.angle, "degrees: sharper edges divide a surface without groups into patches")
      ->type_name("N")
      ->capture_default_str();
  const std::vector<std::string> meshers = {"tetgen", "gmsh"};
  verb->add_option("--with", a->with, "the program that makes the tetrahedra; without it the first one that can")
      ->type_name(alternatives(meshers))
      ->check(one_of(meshers));
  verb->add_option("--seconds", a->scene.seconds, "the mesher is stopped after this time")
      ->type_name("SECONDS")
      ->capture_default_str();
  add_max_memory(*verb, a->max_memory);
  verb->callback([a, &status] { status = mesh(*a); });
}

}  // namespace dartcast::app
