// Scenes with the command's defaults, as a user runs them: all of the documents, and a matrix of what a scene can have.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <regex>
#include <string>
#include <vector>

#include "dartcast/generators.hpp"
#include "dartcast/mesh_files.hpp"
#include "mesh/cell_types.hpp"
#include "support/command.hpp"
#include "support/foam_case.hpp"
#include "support/simvascular_case.hpp"
#include "support/surface_files.hpp"
#include "support/tier.hpp"

namespace dartcast::default_runs_test {

namespace fs = std::filesystem;

using test::Result;

// A box whose patches are named as those of a vessel, with a velocity at its points.
MeshData vessel(CellType type, double moved = 0.0) {
  BoxOptions options;
  options.cells = {4, 4, 4};
  options.size = {1.0, 1.0, 1.0};
  options.type = type;
  MeshData mesh = generate_box(options);
  mesh.regions.assign(mesh.cell_count(), 1);
  mesh.region_names = {{1, "lumen"}};
  mesh.patch_names = {{1, "side"}, {2, "wall"}, {3, "back"}, {4, "front"}, {5, "inlet"}, {6, "outlet"}};
  for (Vec3& p : mesh.points) p.x += moved * p.z;
  for (const char* name : {"velocity", "velocity_0", "velocity_1"})
    mesh.point_data.push_back({name, 3, std::vector<double>(3 * mesh.points.size(), 0.1)});
  return mesh;
}

// The scenes of a page that are whole.
std::vector<std::string> scenes_of(const std::string& page) {
  const std::regex block("```toml\n([^`]*)```");
  std::vector<std::string> scenes;
  for (std::sregex_iterator i(page.begin(), page.end(), block), end; i != end; ++i) {
    if ((*i)[1].str().find("[environment]") != std::string::npos) scenes.push_back((*i)[1]);
  }
  return scenes;
}

// The matrix: each scene has one text of each list.
const std::vector<std::string> deformations = {"", R"([[deformation]]
kind = "twist"
amplitude = 0.3
period = 2.0
centre = [3.0, 3.0, 3.0]
length = 6.0
)"};
const std::string simultaneous = "wall_motion = \"simultaneous\"\n";  // for points alone
const std::vector<std::string> motions = {"", simultaneous, "substeps = 3\n", "drag = 0.5\n"};
const std::vector<std::string> responses = {"response = \"reflect\"\nrestitution = 0.5\nfriction = 0.2\n",
                                            "response = \"slide\"\n", "response = \"stick\"\n",
                                            "response = \"absorb\"\n"};
const std::string with_radius = "# spheres\n";
const std::vector<std::string> components = {"",
                                             with_radius,
                                             with_radius + R"([collisions]
restitution = 0.3
friction = 0.4
)",
                                             R"([adaptive_subdivision]
every = 5
most = 1
least = 0
edits = 8
)",
                                             R"([remesh]
every = 2
most_cells = 32
)",
                                             R"([statistics]
hits = true
residence = true
crossings = true
pathlines = { every = 10 }
[[statistics.plane]]
name = "m"
point = [3.0, 3.0, 3.0]
normal = [1.0, 0.0, 0.0]
)",
                                             R"([[body]]
generator = "barrel"
radius = 0.3
bulge = 0.05
height = 0.8
staves = 12
spacing = 0.25
at = [3.0, 3.0, 3.0]
)",
                                             R"([[catheter]]
entry = [3.0, 3.0, 1.5]
direction = [0.0, 0.0, 1.0]
length = 2.0
spacing = 0.1
moves = [{ until = 1.0, push = 1.0 }]
)",
                                             R"([[solid]]
points = [[0, 0, 0], [0, 0, 1]]
at = [3.0, 3.0, 2.5]
moves = [{ until = 1.0, velocity = [2.0, 0.0, 0.0], turn = [0, 1, 0] }]
)",
                                             R"([[event]]
at = 0.1
kind = "cut"
required = false
surface = "disc"
point = [3.0, 3.0, 0.5]
normal = [1.0, 0.0, 0.0]
radius = 1.0
width = 0.25
)",
                                             R"([output]
every = 5
contacts = true
compression = "small"
)"};

std::string scene_of(const std::string& deformation, const std::string& motion, const std::string& response,
                     const std::string& component) {
  return "[environment]\ngenerator = \"box\"\ncells = [6, 6, 6]\nblocked_layer = true\n" + deformation +
         "[[particles]]\ncount = 60\nvelocity = [1.0, 0.5, 0.25]\n" +
         (component.starts_with(with_radius) ? "radius = 0.05\n" : "") +
         "[motion]\ndt = 0.02\nsteps = 12\ngravity = [0.0, 0.0, -5.0]\n" + motion + "[contact]\n" + response +
         component;
}

// Scenes with the keys that no other scene here has.
const std::vector<std::string> other_scenes = {R"([environment]
generator = "vessel"
radius = 3e-3
trunk_length = 20e-3
branch_lengths = [20e-3, 20e-3]
branch_radius = 0.8
branch_angle = 0.5
out_of_plane = 0.3
tissue_thickness = 1e-3
core = 2
rings = 1
tissue_layers = 1
step_length = 1.5e-3
peak_speed = 0.2
[[deformation]]
kind = "swing"
amplitude = 0.2
[[deformation]]
kind = "stretch"
amplitude = 0.1
[[particles]]
count = 50
[motion]
dt = 1e-3
steps = 10
field = { array = "velocity", at = "points", frame = "mesh" }
integrator = "rk4"
)",
                                               R"([environment]
mesh = "heart_00.vtu"
[[particles]]
count = 50
[motion]
dt = 1e-2
steps = 10
field = { array = "velocity", files = "heart_*.vtu", steady = true }
)",
                                               R"([environment]
mesh = "vessel.vtu"
linearise = true
skip_bad_cells = true
scale = 2.0
free = { region = ["lumen"] }
patches = { angle = 30 }
[[particles]]
count = 50
[motion]
dt = 1e-2
steps = 10
drag = 2.0
field = { array = "velocity_*", spacing = 0.05, interpolation = "cubic", period = 0.2 }
force = "velocity"
[output]
report = false
compression = "fast"
)",
                                               R"([environment]
generator = "maze"
rooms = [2, 2]
room_cells = 6
door_cells = 2
obstacles = 2
extra_doors = 0.5
origin = [1.0, 2.0]
type = "polygon"
jitter = 0.2
seed = 3
[[particles]]
count = 50
radius = 0.1
velocity = [3.0, 1.0, 0.0]
[collisions]
push_iterations = 2
[motion]
dt = 0.05
steps = 10
)",
                                               R"([environment]
generator = "rectangle"
cells = [8, 6]
blocked_share = 0.2
type = "triangle"
[[particles]]
count = 50
velocity = [1.0, 2.0, 0.0]
[motion]
dt = 0.1
steps = 10
wall_motion = "simultaneous"
)",
                                               R"([environment]
mesh = { surface = { lumen = "my.stl" }, outside = "tissue", box = 1.5, size = 0.5, cap = { tolerance = 0.1 }, repair = true, angle = 30, with = "tetgen", seconds = 60 }
[[particles]]
count = 50
velocity = [1.0, 2.0, 3.0]
[motion]
dt = 0.05
steps = 10
)",
                                               R"([environment]
generator = "box"
cells = [6, 6, 6]
[[particles]]
count = 20
radius = 0.2
[[body]]
surface = "ball.obj"
at = [1.0, 1.0, 1.0]
spacing = 0.25
sample = "surface"
most_particles = 1000
pull = 0.2
linear = 0.5
keep_volume = false
edges = false
cluster = 0.6
particle_radius = 0.1
damping = 0.1
stiffness = 100.0
spin = [1.0, 2.0, 3.0]
[[body]]
surface = "ball.obj"
scale = 0.5
at = [4.0, 4.0, 1.0]
spacing = 0.25
sample = "volume"
[[catheter]]
entry = [0.5, 4.5, 4.5]
direction = [1.0, 0.0, 0.0]
length = 2.0
spacing = 0.2
edges = false
rounds = 12
tip_length = 0.5
tip_curvature = 1.0
friction = 0.1
camera = 0.1
moves = [{ until = 1.0, push = 4.0, turn = 1.0 }]
[[solid]]
surface = "ball.obj"
scale = 0.5
rotate = [0.3, 0.0, 0.0]
at = [3.0, 3.0, 5.0]
pivot = [3.0, 3.0, 4.0]
catch_up = true
meets = []
moves = [{ until = 1.0, velocity = [0.0, 0.0, 9.0], turn = [0.0, 0.0, 2.0] }]
[motion]
dt = 0.02
steps = 12
gravity = [0.0, 0.0, -9.81]
[collisions]
iterations = 20
body_restitution = 0.5
body_friction = 0.2
)",
                                               R"([environment]
generator = "box"
cells = [12, 6, 6]
blocked_layer = true
[[particles]]
count = 100
[motion]
dt = 0.02
steps = 12
gravity = [0.0, 0.0, -1.0]
[[event]]
at = 0.02
kind = "cut"
surface = "blade"
places = [{ a = [5.0, 2.0, 0.2], b = [5.0, 2.0, 0.8] }, { a = [5.0, 4.0, 0.2], b = [5.0, 4.0, 0.8] }]
width = 0.2
[[event]]
at = 0.06
kind = "carve"
tool = "ball"
point = [8.0, 3.0, 0.5]
radius = 0.8
whole_cells = true
stranded = "stay"
[[event]]
at = 0.1
kind = "ligature"
point = [3.5, 3.0, 3.0]
normal = [1.0, 0.0, 0.0]
place = [3.5, 2.0, 2.0]
draw = 0.5
reach = 1.0
duration = 0.1
[[event]]
at = 0.14
kind = "carve"
tool = "box"
low = [10.0, -1.0, -1.0]
high = [11.0, 7.0, 7.0]
what = "remove"
stranded = "absorb"
[[event]]
at = 0.18
kind = "reconnect"
a = { point = [10.0, 0.0, 0.0], normal = [1.0, 0.0, 0.0] }
b = { point = [11.0, 0.0, 0.0], normal = [1.0, 0.0, 0.0] }
within = 0.01
tolerance = 0.2
patch = "xmin"
)",
                                               R"([environment]
mesh = "vessel.vtu"
[[particles]]
count = 50
[motion]
dt = 0.02
steps = 6
[[event]]
at = 0.04
kind = "close"
region = "lumen"
stranded = "stay"
[[event]]
at = 0.08
kind = "open"
region = "lumen"
)",
                                               R"([environment]
mesh = "membrane.vtu"
walls = ["membrane"]
[fluid]
density = 1.2
viscosity = 1.8e-5
[[particles]]
count = 50
diameter = 1e-4
density = 1000.0
charge_per_mass = 0.1
[motion]
dt = 0.02
steps = 6
forces = ["stokes", "lorentz"]
electric_field = [10.0, 0.0, 0.0]
magnetic_field = [0.0, 0.0, 1.0]
[[event]]
at = 0.04
kind = "open"
patch = "membrane"
)",
                                               R"([environment]
generator = "vessel"
[fluid]
density = 1000.0
viscosity = 1e-3
temperature = 300.0
[[particles]]
inlet = "inlet"
mass_rate = 1e-9
diameter = { law = "table", diameters = [1e-6, 4e-6], shares = [3.0, 1.0] }
density = 1100.0
[[particles]]
count = 20
diameter = { law = "normal", mean = 2e-6, deviation = 5e-7 }
density = 1100.0
[motion]
dt = 1e-3
steps = 6
field = "velocity"
forces = ["stokes", "brownian"]
turbulence = { k = "path_length", epsilon = "path_length", lagrangian = 0.2 }
)",
                                               R"([environment]
generator = "vessel"
[[particles]]
count = 20
[motion]
dt = 1e-3
steps = 6
field = "velocity"
diffusion = 1e-9
brownian_bridge = true
turbulence = { k = "path_length", omega = "path_length", wall_distance = "path_length" }
[fluid]
density = 1000.0
viscosity = 1e-3
[contact]
stick_below = 1e-3
)"};

class DefaultRuns : public test::CommandTest {
 protected:
  // No -j and no other option that has a default.
  void expect_run(const std::string& text, const std::string& options = "") const {
    (void)write("s.toml", text);
    const Result r = run("run s.toml -o out -q --audit " + options);
    const bool refused =
        text.find(simultaneous) != std::string::npos && text.find("radius = 0.05") != std::string::npos;
    EXPECT_EQ(r.status, refused ? 1 : 0) << r.error << "\n" << text;
    if (refused) EXPECT_NE(r.error.find("take the wall motion carried"), std::string::npos) << r.error;
  }

  // All files that the scenes of the documents name.
  void write_files() const {
    write_mesh(vessel(CellType::hexahedron), folder / "vessel.vtu");
    write_mesh(vessel(CellType::tetrahedron), folder / "lung.vtu");
    MeshData halves = vessel(CellType::hexahedron);
    halves.patch_names[7] = "membrane";
    for (std::size_t c = 0; c < halves.cell_count(); ++c) {
      for_each_face(halves, c, [&](std::span<const std::uint32_t> face) {
        const auto is_middle = [&](std::uint32_t v) { return halves.points[v].x == 0.5; };
        if (c % 4 == 1 && std::all_of(face.begin(), face.end(), is_middle)) halves.add_patch_face(face, 7);
      });
    }
    write_mesh(halves, folder / "membrane.vtu");
    for (int k = 0; k < 3; ++k) {
      for (const std::string& name : {fmt::format("heart_0{}.vtu", k), fmt::format("frame_00{}.vtu", k)})
        write_mesh(vessel(CellType::prism, 0.1 * k), folder / name);
    }
    (void)write("seeds.csv", "x,y,z\n0.3,0.4,0.5\n0.7,0.6,0.5\n");
    for (const char* name : {"my.stl", "aneurysm.stl", "tumour.stl"}) (void)write(name, test::stl_text());
    (void)write("organ.stl", test::stl_text(3.0));
    for (const char* name : {"aneurysm.obj", "ball.obj"}) (void)write(name, test::obj(test::cube_squares));
    const test::FoamMesh pipe = test::foam_mesh(vessel(CellType::hexahedron));
    const test::FoamWriter writer(folder / "pipe", {});
    writer.write(pipe);
    writer.points("0.5", pipe.points);
    const test::FoamWriter flow(folder / "case", {});
    flow.write(pipe);
    flow.field("0", "U", std::vector<Vec3>(vessel(CellType::hexahedron).cell_count(), {0.1, 0.0, 0.0}));
    MeshData mesh = vessel(CellType::tetrahedron);
    mesh.patch_names[5] = "inflow";
    mesh.patch_names[6] = "outflow";
    (void)test::write_simvascular_case(folder / "mesh-complete", mesh, true);
    write_mesh(mesh, folder / "all_results.vtu");
  }

  [[nodiscard]] std::vector<std::string> documented_scenes() const {
    const fs::path root = fs::path(scenes_folder).parent_path();
    std::vector<std::string> scenes = scenes_of(content(root / "README.md"));
    for (const auto& entry : fs::recursive_directory_iterator(root / "docs")) {
      if (entry.path().extension() != ".md") continue;
      for (const std::string& scene : scenes_of(content(entry.path()))) scenes.push_back(scene);
    }
    EXPECT_GE(scenes.size(), 18U);
    return scenes;
  }
};

TEST_F(DefaultRuns, ScenesOfTheDocuments) {
  write_files();
  for (const std::string& scene : documented_scenes()) {
    const bool whole = test::full_tier() || scene.find("[[event]]") != std::string::npos;
    expect_run(scene, whole ? "" : "--steps 10");
  }
}

TEST_F(DefaultRuns, AMatrixOfScenes) {
  std::size_t number = 0;
  for (const std::string& deformation : deformations) {
    for (const std::string& motion : motions) {
      for (const std::string& response : responses) {
        for (const std::string& component : components) {
          if (number++ % test::stride(1, 20) == 0) expect_run(scene_of(deformation, motion, response, component));
        }
      }
    }
  }
}

TEST_F(DefaultRuns, ScenesWithTheOtherKeys) {
  write_files();
  for (const std::string& scene : other_scenes) expect_run(scene);
}

// The tables of docs/scene.md begin with the keys, and with the kinds of deformations.
TEST_F(DefaultRuns, EveryKeyIsInASceneThatRuns) {
  std::vector<std::string> scenes = documented_scenes();
  scenes.insert(scenes.end(), other_scenes.begin(), other_scenes.end());
  for (const std::string& component : components)
    scenes.push_back(scene_of(deformations[1], motions[1], responses[0], component));
  const std::string page = content(fs::path(scenes_folder).parent_path() / "docs/scene.md");
  const std::regex row("\n\\| (`[a-z_]+`(, `[a-z_]+`)*) \\|"), name("[a-z_]+");
  std::size_t count = 0;
  for (std::sregex_iterator i(page.begin(), page.end(), row), end; i != end; ++i) {
    const std::string keys = (*i)[1];
    for (std::sregex_iterator k(keys.begin(), keys.end(), name); k != end; ++k, ++count) {
      const std::regex use("\\b" + k->str() + " = |\"" + k->str() + "\"");
      EXPECT_TRUE(std::any_of(scenes.begin(), scenes.end(), [&](const auto& s) { return std::regex_search(s, use); }))
          << "no scene here runs the key " << k->str();
    }
  }
  EXPECT_GT(count, 150U);
}

}  // namespace dartcast::default_runs_test
