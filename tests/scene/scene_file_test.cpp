#include "dartcast/scene_file.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>

#include "dartcast/error.hpp"
#include "dartcast/run.hpp"
#include "scene/scene_mesh.hpp"
#include "support/scene_text.hpp"

namespace dartcast::scene_file_test {

using test::box;
using test::error_of;
using test::expect_error;

TEST(SceneFile, DefaultsAreThoseOfTheDocumentation) {
  const Scene s = parse_scene(box, "folder/scene.toml");
  EXPECT_EQ(s.name, "scene");
  EXPECT_EQ(s.seed, 1U);
  EXPECT_EQ(s.motion.dt, 1e-3);
  EXPECT_EQ(s.motion.steps, 1000U);
  EXPECT_EQ(s.motion.gravity, Vec3());
  EXPECT_EQ(s.motion.drag, 0.0);
  EXPECT_EQ(s.motion.substeps, 1U);
  EXPECT_EQ(s.contact.general.kind, WallResponseKind::reflect);
  EXPECT_EQ(s.contact.general.restitution, 1.0);
  EXPECT_EQ(s.contact.general.friction, 0.0);
  EXPECT_EQ(s.output.every, std::nullopt);
  EXPECT_EQ(s.output.compression, std::nullopt);
  EXPECT_FALSE(s.output.contacts);
  EXPECT_TRUE(s.particles.empty());
  const auto& b = std::get<BoxOptions>(s.environment.mesh);
  EXPECT_EQ(b.cells, (std::array<std::uint32_t, 3>{1, 1, 1}));
  EXPECT_EQ(b.type, CellType::hexahedron);
}

TEST(SceneFile, SpheresAndTheirCollisionsAreRead) {
  const Scene s = parse_scene(box + R"(
[[particles]]
count = 10
radius = 0.01
[collisions]
restitution = 0.5
friction = 0.25
density = 2500.0
iterations = 30
push_iterations = 6
body_restitution = 0.0
body_friction = 0.75
[crowding]
every = 10
most = 40
least = 4
smallest = 0.1
edits = 7
)",
                              "folder/scene.toml");
  EXPECT_EQ(s.particles[0].radius, 0.01);
  ASSERT_TRUE(s.collisions);
  EXPECT_EQ(s.collisions->restitution, 0.5);
  EXPECT_EQ(s.collisions->friction, 0.25);
  EXPECT_EQ(s.collisions->density, 2500.0);
  EXPECT_EQ(s.collisions->iterations, 30U);
  EXPECT_EQ(s.collisions->position_iterations, 6U);
  EXPECT_EQ(s.body_collisions.restitution, 0.0);
  EXPECT_EQ(s.body_collisions.friction, 0.75);
  EXPECT_FALSE(parse_scene(box, "folder/scene.toml").body_collisions.restitution);
  EXPECT_EQ(s.adaptive_subdivision.every, 10U);
  EXPECT_EQ(s.adaptive_subdivision.options.max_particles, 40U);
  EXPECT_EQ(s.adaptive_subdivision.options.min_particles, 4U);
  EXPECT_EQ(s.adaptive_subdivision.options.smallest, 0.1);
  EXPECT_EQ(s.adaptive_subdivision.options.edits, 7U);
  EXPECT_FALSE(parse_scene(box, "folder/scene.toml").collisions);
}

TEST(SceneFile, BodiesAndCathetersAreRead) {
  const Scene s = parse_scene("seed = 7\n" + box + R"(
[[body]]
surface = "a.stl"
scale = 2.0
rotate = [0.0, 1.0, 0.0]
at = [1.0, 2.0, 3.0]
spacing = 0.1
sample = "volume"
mass = 3.0
cluster = 0.5
[[body]]
name = "second"
generator = "barrel"
height = 2.0
spacing = 0.2
particle_radius = 0.0
[[catheter]]
entry = [0.5, 0.5, 0.5]
direction = [0.0, 0.0, 1.0]
length = 0.3
camera = 0.01
moves = [{ until = 1.0, push = 0.1 }, { until = 2.0, push = -0.1, turn = 0.5 }]
)",
                              "folder/scene.toml");
  ASSERT_EQ(s.bodies.size(), 2U);
  EXPECT_EQ(s.bodies[0].name, "body1");
  EXPECT_EQ(std::get<std::filesystem::path>(s.bodies[0].surface), "folder/a.stl");
  EXPECT_EQ(s.bodies[0].scale, 2.0);
  EXPECT_EQ(s.bodies[0].rotate, (Vec3{0.0, 1.0, 0.0}));
  EXPECT_EQ(s.bodies[0].at, (Vec3{1.0, 2.0, 3.0}));
  EXPECT_EQ(s.bodies[0].samples, BodySamples::volume);
  EXPECT_EQ(s.bodies[0].sampling.spacing, 0.1);
  EXPECT_EQ(s.bodies[0].sampling.seed, 7U);
  EXPECT_EQ(s.bodies[0].body.mass, 3.0);
  EXPECT_EQ(s.bodies[0].body.radius, 0.05);
  EXPECT_EQ(s.bodies[0].cluster, 0.5);
  EXPECT_EQ(s.bodies[1].name, "second");
  EXPECT_EQ(std::get<BarrelOptions>(s.bodies[1].surface).height, 2.0);
  EXPECT_EQ(s.bodies[1].body.radius, 0.0);
  ASSERT_EQ(s.catheters.size(), 1U);
  EXPECT_EQ(s.catheters[0].name, "catheter1");
  EXPECT_EQ(s.catheters[0].options.length, 0.3);
  EXPECT_EQ(s.catheters[0].camera, 0.01);
  ASSERT_EQ(s.catheters[0].moves.size(), 2U);
  EXPECT_EQ(s.catheters[0].moves[1].push, -0.1);
  EXPECT_EQ(s.catheters[0].moves[1].turn, 0.5);
}

const std::string events_text = R"(
[remesh]
every = 5
most_cells = 12
[[event]]
at = 2.0
kind = "ligature"
point = [1.0, 2.0, 3.0]
normal = [0.0, 0.0, 2.0]
draw = 0.5
reach = 3.0
duration = 0.25
stranded = "stay"
[[event]]
at = 1.0
kind = "cut"
surface = "blade"
places = [{ a = [0.0, 0.0, 0.0], b = [0.0, 0.0, 1.0] }, { a = [1.0, 0.0, 0.0], b = [1.0, 0.0, 1.0] }]
width = 0.125
[[event]]
at = 3.0
kind = "carve"
tool = "ball"
point = [0.5, 0.5, 0.5]
radius = 0.25
what = "remove"
whole_cells = true
stranded = "absorb"
[[event]]
at = 4.0
kind = "reconnect"
a = { point = [0.0, 0.0, 0.0], normal = [1.0, 0.0, 0.0] }
b = { point = [1.0, 0.0, 0.0], normal = [1.0, 0.0, 0.0] }
within = 0.5
tolerance = 0.25
patch = "xmin"
)";

TEST(SceneFile, PeriodicPairsAreRead) {
  const Scene s = parse_scene(box + R"(
[[periodic]]
a = "left"
b = "right"
translate = [1.0, 2.0, 3.0]
[[periodic]]
a = "top"
b = "bottom"
axis = [0.0, 0.0, 1.0]
centre = [4.0, 5.0, 6.0]
angle = 30.0
tolerance = 1e-3
)",
                              "scene.toml");
  const PeriodicPair moved{"left", "right", {1.0, 2.0, 3.0}};
  const PeriodicPair turned{"top", "bottom", {}, {0.0, 0.0, 1.0}, {4.0, 5.0, 6.0}, 30.0, 1e-3};
  EXPECT_EQ(s.environment.periodic, (std::vector<PeriodicPair>{moved, turned}));
  const auto refused = [](const std::string& keys, const std::string& words) {
    expect_error(box + "[[periodic]]\n" + keys, "", words);
  };
  refused("a = \"left\"\n", "the patch that a particle enters by");
  refused("a = \"left\"\nb = \"right\"\n", "say how a comes to b");
  refused("a = \"left\"\nb = \"right\"\nangle = 30.0\n", "an angle needs an axis");
}

TEST(SceneFile, EventsAreReadInOrderOfTime) {
  const Scene s = parse_scene(box + events_text, "folder/scene.toml");
  EXPECT_EQ(s.remesh.every, 5U);
  EXPECT_EQ(s.remesh.options.max_cells, 12U);
  ASSERT_EQ(s.events.size(), 4U);
  const auto& cut = std::get<Cut>(s.events[0].event.what);
  EXPECT_EQ(s.events[0].event.at, 1.0);
  EXPECT_EQ(cut.width, 0.125);
  ASSERT_EQ(std::get<BladePath>(cut.surface).places.size(), 2U);
  EXPECT_EQ(std::get<BladePath>(cut.surface).places[1][1], (Vec3{1.0, 0.0, 1.0}));
  const auto& tie = std::get<Ligature>(s.events[1].event.what);
  EXPECT_EQ(tie.plane.normal, (Vec3{0.0, 0.0, 1.0}));
  EXPECT_EQ(tie.plane.offset, 3.0);
  EXPECT_EQ(tie.place, (Vec3{1.0, 2.0, 3.0}));
  EXPECT_EQ(tie.tying.share, 0.5);
  EXPECT_EQ(tie.tying.reach, 3.0);
  EXPECT_EQ(tie.duration, 0.25);
  EXPECT_EQ(s.events[1].event.orphaned, OrphanPolicy::hold);
  const auto& carve = std::get<Carve>(s.events[2].event.what);
  EXPECT_EQ(carve.what, Carving::remove);
  EXPECT_TRUE(carve.whole_cells);
  EXPECT_EQ(carve.tool.planes.size(), 26U);
  EXPECT_EQ(s.events[2].event.orphaned, OrphanPolicy::absorb);
  const auto& reconnect = std::get<Reconnect>(s.events[3].event.what);
  EXPECT_EQ(reconnect.b.offset, 1.0);
  EXPECT_EQ(reconnect.within, 0.5);
  EXPECT_EQ(reconnect.options.tolerance, 0.25);
  EXPECT_EQ(s.events[3].patch, "xmin");
}

TEST(SceneFile, AValveIsARegionOrAPatch) {
  const Scene s = parse_scene(box +
                                  "walls = ['leaflet']\n[[event]]\nat = 2.0\nkind = 'close'\nregion = 'valve'\n"
                                  "stranded = 'stay'\n[[event]]\nat = 1.0\nkind = 'open'\nregion = '7'\n"
                                  "[[event]]\nat = 3.0\nkind = 'open'\npatch = 'leaflet'\n",
                              "folder/scene.toml");
  EXPECT_EQ(s.environment.walls, std::vector<std::string>{"leaflet"});
  ASSERT_EQ(s.events.size(), 3U);
  EXPECT_TRUE(std::holds_alternative<OpenWalls>(s.events[2].event.what));
  EXPECT_EQ(s.events[2].patch, "leaflet");
  EXPECT_TRUE(std::holds_alternative<OpenCells>(s.events[0].event.what));
  EXPECT_EQ(s.events[0].region, "7");
  EXPECT_TRUE(std::holds_alternative<CloseCells>(s.events[1].event.what));
  EXPECT_EQ(s.events[1].region, "valve");
  EXPECT_EQ(s.events[1].event.orphaned, OrphanPolicy::hold);
}

TEST(SceneFile, EventsThatCannotBeSayWhy) {
  expect_error(box + "[[event]]\nat = 1.0\nkind = 'open'\n", "5", "region");
  expect_error(box + "[[event]]\nat = 1.0\nkind = 'open'\nregion = 'a'\npatch = 'b'\n", "5", "patch");
  expect_error(box + "[[event]]\nat = 1.0\nkind = 'sew'\n", "5", "one of");
  expect_error(box + "[[event]]\nkind = 'cut'\n", "3", "at");
  expect_error(box +
                   "[[event]]\nat = 1.0\nkind = 'cut'\nsurface = 'plane'\npoint = [0, 0, 0]\nnormal = [0, 0, 0]\n"
                   "width = 1.0\n",
               "8", "normal");
  expect_error(box + "[[event]]\nat = 1.0\nkind = 'ligature'\npoint = [0, 0, 0]\nnormal = [0, 0, 1]\ndraw = 0.5\n", "3",
               "reach");
  expect_error(box + "[[event]]\nat = 1.0\nkind = 'carve'\ntool = 'box'\nlow = [1, 1, 1]\nhigh = [0, 2, 2]\n", "8",
               "box to cut");
  expect_error(box + "[[event]]\nat = 1.0\nkind = 'ligature'\npoint = [0, 0, 0]\nnormal = [0, 0, 1]\nwidth = 1\n", "8",
               "width");
}

const std::string all_keys_text = R"(
seed = 5
[environment]
mesh = "a/vessel.vtu"
free = { region = ["lumen", "2"] }
patches = ["inlet", "wall"]
[[deformation]]
kind = "bend"
amplitude = 0.5
period = 2
axis = [0, 1, 0]
centre = [1, 2, 3]
direction = [0, 0, 1]
length = 4.0
[[deformation]]
kind = "pulse"
amplitude = 0.1
wavelength = 3.0
field = "f"
path = "p"
[[particles]]
count = 10
radius = 0.0
velocity = [1, 2, 3.5]
[[particles]]
positions = "seeds.csv"
[[particles]]
inlet = "inlet"
rate = 2.5
[motion]
dt = 0.25
steps = 7
gravity = [0, 0, -1]
field = "velocity"
field_frame = "mesh"
drag = 3
substeps = 4
[contact]
response = "slide"
restitution = 0.25
friction = 0.5
[contact.patch.outlet]
response = "escape"
[contact.patch."a wall, thick"]
restitution = 0.75
[output]
every = 3
contacts = true
)";

TEST(SceneFile, EveryKeyIsRead) {
  const Scene s = parse_scene(all_keys_text, "folder/scene.toml");
  EXPECT_EQ(std::get<std::filesystem::path>(s.environment.mesh), "folder/a/vessel.vtu");
  EXPECT_EQ(std::get<FreeRegions>(s.environment.free).regions, (std::vector<std::string>{"lumen", "2"}));
  EXPECT_EQ(std::get<std::vector<std::string>>(s.environment.patches), (std::vector<std::string>{"inlet", "wall"}));
  ASSERT_EQ(s.deformation.size(), 2U);
  const DeformationStep& bend = s.deformation[0].step;
  EXPECT_EQ(bend.kind, DeformationKind::bend);
  EXPECT_EQ(bend.amplitude, 0.5);
  EXPECT_EQ(bend.period, 2.0);
  EXPECT_EQ(bend.axis, (Vec3{0, 1, 0}));
  EXPECT_EQ(bend.centre, (Vec3{1, 2, 3}));
  EXPECT_EQ(bend.direction, (Vec3{0, 0, 1}));
  EXPECT_EQ(bend.length, 4.0);
  EXPECT_EQ(s.deformation[1].step.wavelength, 3.0);
  EXPECT_EQ(s.deformation[1].field, "f");
  EXPECT_EQ(s.deformation[1].path, "p");
  ASSERT_EQ(s.particles.size(), 3U);
  EXPECT_EQ(std::get<RandomParticles>(s.particles[0].source).count, 10U);
  EXPECT_EQ(s.particles[0].velocity, (Vec3{1, 2, 3.5}));
  EXPECT_EQ(std::get<std::filesystem::path>(std::get<PlacedParticles>(s.particles[1].source).positions),
            "folder/seeds.csv");
  EXPECT_EQ(std::get<InletParticles>(s.particles[2].source).patch, "inlet");
  EXPECT_EQ(std::get<InletParticles>(s.particles[2].source).rate, 2.5);
  EXPECT_EQ(s.motion.dt, 0.25);
  EXPECT_EQ(s.motion.steps, 7U);
  EXPECT_EQ(s.motion.gravity, (Vec3{0, 0, -1}));
  EXPECT_EQ(s.motion.field.array, "velocity");
  EXPECT_EQ(s.motion.field.frame, FieldFrame::mesh);
  EXPECT_EQ(s.motion.drag, 3.0);
  EXPECT_EQ(s.motion.substeps, 4U);
  EXPECT_EQ(s.motion.wall_motion, WallMotion::carried);
  EXPECT_EQ(s.contact.general.kind, WallResponseKind::slide);
  EXPECT_EQ(s.contact.by_patch.at("outlet").kind, WallResponseKind::escape);
  EXPECT_EQ(s.contact.by_patch.at("outlet").friction, 0.5);  // the rest as in [contact]
  EXPECT_EQ(s.contact.by_patch.at("a wall, thick").kind, WallResponseKind::slide);
  EXPECT_EQ(s.contact.by_patch.at("a wall, thick").restitution, 0.75);
  EXPECT_EQ(s.output.every, 3U);
  EXPECT_TRUE(s.output.contacts);
}

TEST(SceneFile, GeneratorsTakeTheirParameters) {
  const Scene s = parse_scene(
      "[environment]\ngenerator = 'box'\ncells = [5, 5, 28]\nsize = [5.0, 5.0, 14.0]\norigin = [1, 2, 3]\ntype = "
      "'tetrahedron'\n"
      "blocked_layer = true\nblocked_share = 0.1\nseed = 3\njitter = 0.2\n",
      "s.toml");
  const auto& b = std::get<BoxOptions>(s.environment.mesh);
  EXPECT_EQ(b.cells, (std::array<std::uint32_t, 3>{5, 5, 28}));
  EXPECT_EQ(b.size, (Vec3{5, 5, 14}));
  EXPECT_EQ(b.origin, (Vec3{1, 2, 3}));
  EXPECT_EQ(b.type, CellType::tetrahedron);
  EXPECT_TRUE(b.blocked_layer);
  EXPECT_EQ(b.blocked_share, 0.1);
  EXPECT_EQ(b.seed, 3U);
  EXPECT_EQ(b.jitter, 0.2);
  const Scene o = parse_scene("[environment]\ngenerator = 'octahedra'\ncells = [2, 3, 4]\n", "s.toml");
  EXPECT_EQ(std::get<OctahedraOptions>(o.environment.mesh).size, std::nullopt);
  const Scene v =
      parse_scene("[environment]\ngenerator = 'vessel'\ncore = 4\nbranch_lengths = [0.03, 0.04]\n", "s.toml");
  EXPECT_EQ(std::get<VesselOptions>(v.environment.mesh).core, 4U);
  EXPECT_EQ(std::get<VesselOptions>(v.environment.mesh).branch_lengths[1], 0.04);
}

TEST(SceneFile, GeneratorsOfThePlaneTakeTheirParameters) {
  const Scene r = parse_scene(
      "[environment]\ngenerator = 'rectangle'\ncells = [5, 6]\nsize = [5.0, 3.0]\norigin = [1, 2]\ntype = 'polygon'\n"
      "blocked_share = 0.1\nseed = 3\njitter = 0.2\n",
      "s.toml");
  const auto& o = std::get<RectangleOptions>(r.environment.mesh);
  EXPECT_EQ(o.cells, (std::array<std::uint32_t, 2>{5, 6}));
  EXPECT_EQ(o.size, (std::array{5.0, 3.0}));
  EXPECT_EQ(o.origin, (std::array{1.0, 2.0}));
  EXPECT_EQ(o.type, CellType::polygon);
  EXPECT_FALSE(o.mixed);
  EXPECT_EQ(o.blocked_share, 0.1);
  EXPECT_EQ(o.seed, 3U);
  EXPECT_EQ(o.jitter, 0.2);
  const Scene s = parse_scene(
      "[environment]\ngenerator = 'maze'\nrooms = [3, 2]\nroom_cells = 7\ndoor_cells = 3\nobstacles = 5\n"
      "extra_doors = 0.5\ntype = 'mixed'\n",
      "s.toml");
  const auto& m = std::get<MazeOptions>(s.environment.mesh);
  EXPECT_EQ(m.rooms, (std::array<std::uint32_t, 2>{3, 2}));
  EXPECT_EQ(m.size, std::nullopt);
  EXPECT_EQ(m.room_cells, 7U);
  EXPECT_EQ(m.door_cells, 3U);
  EXPECT_EQ(m.obstacles, 5U);
  EXPECT_EQ(m.extra_doors, 0.5);
  EXPECT_TRUE(m.mixed);
  EXPECT_EQ(load_scene_mesh(s.environment).report.dimension, 2);

  const std::string maze = "[environment]\ngenerator = 'maze'\n";
  expect_error(maze + "rooms = [1, 2, 3]\n", "3:", "2 numbers");
  expect_error(maze + "rooms = [1, 0]\n", "3:", "whole numbers");
  expect_error(maze + "rooms = [1, 536870912]\n", "3:", "2^29 squares");
  expect_error(maze + "room_cells = 4\ndoor_cells = 5\n", "4:", "door_cells");
  expect_error(maze + "room_cells = 2\ndoor_cells = 1\nobstacles = 4\n", "5:", "obstacles");
  expect_error(maze + "jitter = 0.46\n", "3:", "jitter");
  expect_error(maze + "type = 'mixed'\njitter = 0.31\n", "4:", "jitter");
  expect_error(maze + "type = 'prism'\n", "3:", "triangle, quadrilateral, polygon, mixed");
  expect_error(maze + "size = [1, 0]\n", "3:", "more than 0");
  expect_error(maze + "blocked_share = 0.5\n", "3:", "unknown");
}

TEST(SceneFile, MistakesAreNamedWithLineAndRemedy) {
  expect_error("x = [", "1:", "not TOML");
  expect_error("", "", "environment is missing");
  expect_error("[environment]\n", "1:", "mesh");
  expect_error("[environment]\nmesh = 'a.vtu'\ngenerator = 'box'\n", "2:", "either");
  expect_error("[environment]\ngenerator = 'sphere'\n", "2:", "box, bar, octahedra, vessel, rectangle, maze");
  expect_error(box + "cells = [1, 2]\n", "3:", "3 numbers");
  expect_error(box + "cells = [1, 2, 0]\n", "3:", "whole numbers");
  expect_error(box + "cells = [1, 2, 2.5]\n", "3:", "whole numbers");
  expect_error(box + "cells = [1, 2, 1e12]\n", "3:", "whole numbers");
  expect_error(box + "size = [1, 2, -1]\n", "3:", "more than 0");
  expect_error(box + "radius = 1\n", "3:", "the key 'radius' is unknown");
  expect_error(box + "free = { values = [1] }\n", "3:", "region");
  expect_error(box + "[motion]\ndt = 0\n", "4:", "more than 0");
  expect_error(box + "[motion]\ndt = 'fast'\n", "4:", "number");
  expect_error(box + "[motion]\ndt = inf\n", "4:", "finite");
  expect_error(box + "[motion]\ndt = nan\n", "4:", "finite");
  expect_error(box + "[motion]\nsteps = 1.5\n", "4:", "whole number");
  expect_error(box + "[motion]\nsteps = -1\n", "4:", "between 0");
  expect_error(box + "[motion]\nfield_frame = 'mesh'\n", "4:", "needs a field");
  expect_error(box + "[motion]\ndrags = 1\n", "4:", "'drags' is unknown");
  expect_error(box + "[motion]\nwall_motion = 'both'\n", "4:", "carried, simultaneous");
  expect_error(box + "[motion]\nwall_motion = 'simultaneous'\nsubsteps = 2\n", "4:", "leave substeps out");
  expect_error(box + "[contact]\nresponse = 'bounce'\n", "4:", "reflect, slide, stick, absorb, escape");
  expect_error(box + "[contact]\nrestitution = 1.5\n", "4:", "at most 1");
  expect_error(box + "[contact.patch.a]\nrestitutions = 1\n", "4:", "unknown");
  expect_error(box + "[[particles]]\nradius = -0.1\ncount = 1\n", "4:", "at least 0");
  expect_error(box + "[collisions]\ndensity = 0\n", "4:", "more than 0");
  expect_error(box + "[collisions]\nbounce = 0\n", "4:", "unknown");
  expect_error(box + "[adaptive_subdivision]\nmost = 5\nleast = 5\n", "5:", "less than most");
  expect_error(box + "[[particles]]\nvelocity = [1, 2, 3]\n", "3:", "one of count");
  expect_error(box + "[[particles]]\ncount = 1\npositions = 'a.csv'\n", "3:", "one of count");
  expect_error(box + "[[particles]]\ninlet = 'a'\n", "3:", "rate");
  expect_error(box + "[[particles]]\ncount = 1\nrate = 2\n", "5:", "belong together");
  expect_error(box + "[[deformation]]\nkind = 'wobble'\n", "4:", "must be one of");
  expect_error(box + "[[deformation]]\nkind = 'bend'\nlength = 1\n", "3:", "amplitude is missing");
  expect_error(box + "[[deformation]]\nkind = 'rotate'\namplitude = 1\n", "5:", "unknown");
  expect_error(box + "[[deformation]]\nkind = 'frames'\nfiles = ['a.vtu']\ntimes = [0, 1]\n",
               "6:", "2 times for 1 files");
  const std::string body = box + "[[body]]\ngenerator = 'barrel'\n";
  expect_error(body, "3:", "spacing is missing");
  expect_error(box + "[[body]]\nspacing = 0.1\n", "3:", "surface = ");
  expect_error(body + "surface = 'a.stl'\nspacing = 0.1\n", "5:", "either");
  expect_error(body + "spacing = 0\n", "5:", "more than 0");
  expect_error(body + "spacing = 0.1\nname = 'a/b'\n", "6:", "names files");
  expect_error(body + "spacing = 0.1\n[[body]]\nname = 'body1'\ngenerator = 'barrel'\nspacing = 0.1\n",
               "7:", "another has this name");
  expect_error(body + "spacing = 0.1\nlinear = 2\n", "6:", "at most 1");
  const std::string catheter = box + "[[catheter]]\nentry = [0.5, 0.5, 0.5]\n";
  expect_error(catheter, "3:", "direction is missing");
  expect_error(catheter + "direction = [0, 0, 1]\nmoves = [{ push = 1 }]\n", "6:", "until is missing");
  expect_error(catheter + "direction = [0, 0, 1]\nmoves = [{ until = 1 }, { until = 1 }]\n",
               "6:", "must end after the one before");
  expect_error(catheter + "direction = [0, 0, 1]\nlenght = 1\n", "6:", "unknown");
  expect_error(box + "[output]\nevery = true\n", "4:", "whole number");
  expect_error(box + "[outputs]\n", "3:", "unknown");
  expect_error("particles = 3\n" + box, "1:", "tables");
}

TEST(SceneFile, StatisticsAreRead) {
  const Scene s = parse_scene(box + R"(
[statistics]
hits = true
residence = true
crossings = true
pathlines = { every = 100, ids = [3, 1] }
cells = { quantities = ["visits", "residence"] }
[[statistics.plane]]
name = "outlet-left"
point = [1.0, 2.0, 3.0]
normal = [0.0, 0.0, -2.0]
radius = 0.5
[[statistics.plane]]
name = "whole"
point = [0.0, 0.0, 0.0]
normal = [1.0, 0.0, 0.0]
)",
                              "folder/scene.toml");
  const StatisticsOptions& options = s.statistics.options;
  EXPECT_TRUE(options.hits);
  EXPECT_TRUE(options.residence);
  EXPECT_TRUE(s.statistics.crossings);
  EXPECT_EQ(options.pathlines_every, 100U);
  EXPECT_EQ(options.pathlines_of, (std::vector<std::uint64_t>{3, 1}));
  EXPECT_EQ(options.cells, (std::vector<std::string>{"visits", "residence"}));
  ASSERT_EQ(options.planes.size(), 2U);
  EXPECT_EQ(options.planes[0].name, "outlet-left");
  EXPECT_EQ(options.planes[0].point, (Vec3{1.0, 2.0, 3.0}));
  EXPECT_EQ(options.planes[0].normal, (Vec3{0.0, 0.0, -2.0}));
  EXPECT_EQ(options.planes[0].radius, 0.5);
  EXPECT_EQ(options.planes[1].radius, 0.0);
  EXPECT_FALSE(parse_scene(box, "folder/scene.toml").statistics.options.any());
}

TEST(SceneFile, StatisticsThatAreWrongAreRefusedWithTheirLine) {
  const std::string plane = box + "[[statistics.plane]]\nname = 'a'\npoint = [0, 0, 0]\nnormal = [1, 0, 0]\n";
  EXPECT_EQ(error_of(plane), "");
  expect_error(box + "[statistics]\nhit = true\n", "4: [statistics]", "unknown");
  expect_error(box + "[statistics]\nhits = 1\n", "4: [statistics]", "true or false");
  expect_error(box + "[statistics]\ncrossings = true\n", "4: [statistics]", "no plane");
  expect_error(box + "[statistics]\npathlines = true\n", "4: [statistics]", "must be a table");
  expect_error(box + "[statistics]\ncells = { quantities = ['visit'] }\n", "4: [statistics.cells]", "did you mean");
  expect_error(box + "[statistics]\npathlines = {}\n", "4: [statistics.pathlines]", "give every = N");
  expect_error(box + "[statistics]\npathlines = { every = 0 }\n", "4: [statistics.pathlines]", "between 1");
  expect_error(box + "[statistics]\npathlines = { ids = [1, 2.5] }\n", "4: [statistics.pathlines]", "2.5 is in it");
  expect_error(box + "[statistics]\npathlines = { ids = [-1] }\n", "4: [statistics.pathlines]", "-1 is in it");
  expect_error(box + "[[statistics.plane]]\nname = 'a'\npoint = [0, 0, 0]\n", "3: [[statistics.plane]]",
               "normal is missing");
  expect_error(plane + "radius = 0\n", "7: [[statistics.plane]]", "more than 0");
  expect_error(plane + "size = 1\n", "7: [[statistics.plane]]", "unknown");
  expect_error(plane + plane.substr(box.size()), "8: [[statistics.plane]]", "another plane has this name");
  expect_error(box + "[[statistics.plane]]\nname = 'a b'\npoint = [0, 0, 0]\nnormal = [1, 0, 0]\n",
               "4: [[statistics.plane]]", "letters");
  expect_error(box + "[[statistics.plane]]\nname = 'a'\npoint = [0, 0, 0]\nnormal = [0, 0, 0]\n",
               "4: [[statistics.plane]]", "not zero");
}

TEST(SceneFile, AMissingFileIsNamed) {
  try {
    read_scene("no/such/scene.toml");
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("no/such/scene.toml"), std::string::npos);
  }
  EXPECT_THROW(read_scene("."), Error);
}

// The scenes that come with the project, and those in its documentation, are valid.
TEST(SceneFile, ScenesOfTheProjectAreRead) {
  const char* folder = std::getenv("DARTCAST_SCENES");
  ASSERT_NE(folder, nullptr);
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".toml") continue;
    EXPECT_NO_THROW(read_scene(entry.path())) << entry.path();
    ++count;
  }
  EXPECT_GE(count, 4);
  std::ifstream file(std::filesystem::path(folder) / "../docs/scene.md");
  std::stringstream text;
  text << file.rdbuf();
  const std::string page = text.str();
  const std::regex block("```toml\n([^`]*)```");
  int blocks = 0;
  for (std::sregex_iterator i(page.begin(), page.end(), block), end; i != end; ++i, ++blocks) {
    EXPECT_EQ(error_of((*i)[1].str()), "") << (*i)[1].str();
  }
  EXPECT_GE(blocks, 6);
}

// The scenes of docs/howto.md are those beside it, without their comments, in the same order.
TEST(SceneFile, ScenesOfTheHowToPageAreRead) {
  const char* folder = std::getenv("DARTCAST_SCENES");
  ASSERT_NE(folder, nullptr);
  const std::filesystem::path docs = std::filesystem::path(folder) / "../docs";
  const auto content = [](const std::filesystem::path& path) {
    std::ifstream file(path);
    std::string text, line;
    while (std::getline(file, line)) {
      if (!line.starts_with("#") && !line.starts_with("seed")) text += line + "\n";
    }
    return text.substr(text.find_first_not_of('\n'));
  };
  std::ifstream file(docs / "howto.md");
  std::stringstream text;
  text << file.rdbuf();
  const std::string page = text.str();
  const std::regex block("```toml\n([^`]*)```");
  std::sregex_iterator i(page.begin(), page.end(), block);
  for (const char* name : {"aneurysm.toml", "pipe.toml", "contraction.toml"}) {
    ASSERT_NE(i, std::sregex_iterator()) << name;
    EXPECT_EQ((*i)[1].str(), content(docs / "howto" / name));
    EXPECT_NO_THROW(read_scene(docs / "howto" / name)) << name;
    ++i;
  }
}

}  // namespace dartcast::scene_file_test
