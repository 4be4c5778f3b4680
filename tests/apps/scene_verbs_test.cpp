// The verbs that bring scenes in and particles out: mesh, lagrangian.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "dartcast/generators.hpp"
#include "dartcast/mesh_files.hpp"
#include "report/page_reader.hpp"
#include "support/command.hpp"
#include "support/foam_case.hpp"
#include "support/surface_files.hpp"

namespace dartcast::scene_verbs_test {

using test::Result;

class SceneVerbs : public test::CommandTest {};

TEST_F(SceneVerbs, AMeshAroundASurface) {
  (void)write(
      "cube.off",
      "OFF\n8 6 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n4 0 3 2 1\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 "
      "5\n4 2 3 7 6\n4 3 0 4 7\n");
  const Result r = run("mesh lumen=cube.off -o cube.msh --box 2 --outside tissue");
  ASSERT_EQ(r.status, 0) << r.error;
  EXPECT_NE(r.out.find("tetrahedra by"), std::string::npos);
  EXPECT_NE(r.out.find("cube.msh\n"), std::string::npos);
  const auto json = nlohmann::json::parse(run("info cube.msh --json").out);
  EXPECT_EQ(json["regions"].size(), 2U) << json;
  (void)write("open.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  const Result open = run("mesh open.off -o open.vtu");
  EXPECT_EQ(open.status, 1);
  EXPECT_NE(open.out.find("defect: open: 1 holes"), std::string::npos) << open.out;
  expect_failure("mesh cube.off -o a.doc", 1, "a.doc: a mesh is written to files that end in");
  expect_failure("mesh cube.off", 2, "-o");
  expect_failure("mesh cube.off -o a.vtu --with netgen", 2, "netgen");
}

// A mesher that takes long. The signal ends it, too.
TEST_F(SceneVerbs, ASignalLeavesNothingOfAMesh) {
  (void)write("cube.off", test::off(test::cube_squares));
  (void)write("tetgen", "#!/bin/sh\necho $$ > ../../started\nexec sleep 60\n");
  (void)write("s.toml", "[environment]\nmesh = { surface = 'cube.off' }\n[[particles]]\ncount = 1\n");
  for (const std::string signal : {"TERM", "HUP", "KILL"}) {
    for (const std::string verb : {"mesh cube.off -o a.vtu", "run s.toml -q -o out"}) {
      if (signal == "TERM" && verb.starts_with("run")) continue;  // it asks a run for its end
      const Result r =
          run("--version; chmod +x tetgen; rm -rf started tmp out; mkdir tmp; TMPDIR=$PWD/tmp PATH=$PWD:$PATH '" +
              binary + "' " + verb + " & for i in $(seq 400); do test -s started && break; sleep 0.05; done; " +
              "kill -" + signal + " $!; wait $!; echo ended $?; for i in $(seq 100); do test -z \"$(ls tmp)\" " +
              "&& break; sleep 0.05; done; ls tmp; grep '^State' /proc/$(cat started)/status");
      EXPECT_NE(r.out.find("ended 1"), std::string::npos) << r.out;
      const std::string left = r.out.substr(r.out.find("ended 1") + 10);
      EXPECT_TRUE(left.empty() || left.starts_with("State:\tZ")) << signal << ", " << verb << ": " << left;
    }
  }
}

// A run says how much it will write, about, and where particles ended.
TEST_F(SceneVerbs, ARunSaysHowMuchItWritesAndWhereParticlesEnd) {
  (void)write("s.toml",
              "[environment]\ngenerator = 'box'\ncells = [4, 2, 2]\n[[particles]]\ncount = 2000\nvelocity = [2, 0, 0]\n"
              "[[deformation]]\nkind = 'bend'\namplitude = 0.1\nlength = 2\n[motion]\ndt = 0.005\nsteps = 1200\n"
              "[contact.patch.xmax]\nresponse = 'absorb'\n");
  const Result r = run("run s.toml -o out");
  ASSERT_EQ(r.status, 0) << r.error;
  EXPECT_NE(r.out.find("output       about "), std::string::npos) << r.out;
  EXPECT_NE(r.out.find("101 frames, one every 12 steps\n"), std::string::npos) << r.out;
  EXPECT_NE(r.out.find("deposition   xmax: 2,000 (100.00 %), 500 per unit of area"), std::string::npos) << r.out;
  EXPECT_NE(content(folder / "out/deposition.csv").find("\nxmax,2000,0,1,4"), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(folder / "out/particles_001200.vtp"));
  EXPECT_EQ(run("run s.toml -o out -q").out, "");
  EXPECT_EQ(run("run s.toml -o out --json --steps 3").out.find("{"), 0U);
}

TEST_F(SceneVerbs, ARunIsConverted) {
  (void)write("s.toml",
              "[environment]\ngenerator = 'box'\ncells = [2, 2, 2]\n[[deformation]]\nkind = 'bend'\namplitude = "
              "0.1\nlength = 2\n"
              "[[particles]]\ncount = 7\nradius = 0.05\nvelocity = [1, 0, 0]\n[motion]\ndt = 0.1\nsteps = "
              "4\n[output]\nevery = 2\n");
  ASSERT_EQ(run("run s.toml -o out -q").status, 0);
  for (const char* name : {"a.usda", "a.ply", "a.obj", "a.vtkhdf"}) {
    const Result r = run(std::string("convert out -o ") + name);
    if (r.error.find("built without HDF5") != std::string::npos) continue;
    ASSERT_EQ(r.status, 0) << r.error;
    EXPECT_EQ(r.out, std::string("3 frames in ") + name + "\n");
  }
  const std::string usda = content(folder / "a.usda");
  for (const char* part : {"timeCodesPerSecond = 5\n", "def Points \"particles\"", "vector3f[] velocities.timeSamples",
                           "            2: [(", "int[] faceVertexCounts = [4, 4", "point3f[] points.timeSamples"})
    EXPECT_NE(usda.find(part), std::string::npos) << part;
  for (const char* name : {"a_000000.ply", "a_000002.ply", "a_000004.ply"})
    EXPECT_NE(content(folder / name).find("element vertex 7\n"), std::string::npos) << name;
  EXPECT_EQ(run("check a_walls_000004.ply").status, 0);
  EXPECT_EQ(run("check a_walls_000004.obj").status, 0);
  expect_failure("convert out -o a.xyz", 1, ".vtkhdf");
}

// A mesh of USD has no faces of two corners: walls of the plane are curves, each with its own points.
TEST_F(SceneVerbs, ARunInThePlaneIsConverted) {
  (void)write("s.toml",
              "[environment]\ngenerator = 'rectangle'\ncells = [2, 1]\n[[particles]]\ncount = 3\n[motion]\ndt = "
              "0.1\nsteps = 4\n[output]\nevery = 2\n");
  ASSERT_EQ(run("run s.toml -o out -q").status, 0);
  ASSERT_EQ(run("convert out -o a.usda").status, 0);
  const std::string usda = content(folder / "a.usda");
  for (const char* part : {"def BasisCurves \"walls\"", "uniform token type = \"linear\"",
                           "int[] curveVertexCounts = [2, 2, 2, 2, 2, 2]\n"})
    EXPECT_NE(usda.find(part), std::string::npos) << part;
  EXPECT_EQ(usda.find("faceVertex"), std::string::npos);
  const std::size_t at = usda.find("point3f[] points = [");  // the walls stand still
  ASSERT_NE(at, std::string::npos);
  const std::string points = usda.substr(at, usda.find('\n', at) - at);
  EXPECT_EQ(std::count(points.begin(), points.end(), '('), 12);
}

TEST_F(SceneVerbs, SurfacesAreShownAndConverted) {
  (void)write("a.off", "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n");
  const Result info = run("info a.off");
  EXPECT_EQ(info.status, 0);
  EXPECT_NE(info.out.find("dartcast mesh a.off -o"), std::string::npos) << info.out;
  EXPECT_NE(info.out.find("mesh = { surface = \"a.off\" }"), std::string::npos) << info.out;
  const Result none = run("info none.off");
  EXPECT_EQ(none.status, 1);
  EXPECT_EQ(none.out.find("to move particles"), std::string::npos) << none.out;
  for (const char* name : {"a.stl", "a.obj", "a.ply", "b.off", "a.vtp"}) {
    ASSERT_EQ(run(std::string("convert a.off ") + name).status, 0) << name;
    ASSERT_EQ(run(std::string("convert ") + name + " c.vtu").status, 0) << name;
    EXPECT_NE(run(std::string("check ") + name).out.find("4 triangle"), std::string::npos) << name;
  }
}

TEST_F(SceneVerbs, ParticlesGoBackIntoAnOpenFoamCase) {
  BoxOptions options;
  options.cells = {3, 3, 3};
  options.size = {1.0, 1.0, 1.0};
  test::FoamWriter(folder / "case", {}).write(test::foam_mesh(generate_box(options)));
  (void)write("s.toml",
              "[environment]\nmesh = 'case'\n[[particles]]\ncount = 20\nvelocity = [0.1, 0, 0]\n[motion]\ndt = "
              "0.25\nsteps = 4\n[output]\nevery = 2\n");
  ASSERT_EQ(run("run s.toml -o out").status, 0);
  const Result r = run("lagrangian out case --cloud dust");
  ASSERT_EQ(r.status, 0) << r.error;
  EXPECT_EQ(r.out, "3 frames in case/*/lagrangian/dust\n");
  for (const char* time : {"0", "0.5", "1"}) {
    for (const char* file : {"positions", "U", "origId"}) {
      const std::string text = content(folder / "case" / time / "lagrangian/dust" / file);
      EXPECT_NE(text.find("\n20\n(\n"), std::string::npos) << text;
    }
  }
  // Each particle is in the cell that the file names: cell i + 3 j + 9 k of a unit lattice in a box of size 1.
  const std::string text = content(folder / "case/1/lagrangian/dust/positions");
  std::istringstream positions(text.substr(text.find("\n20\n(") + 6));
  char bracket = 0;
  double x = 0, y = 0, z = 0;
  int cell = 0, count = 0;
  while (positions >> bracket >> x >> y >> z >> bracket >> cell) {
    EXPECT_EQ(cell, int(x * 3) + 3 * int(y * 3) + 9 * int(z * 3));
    ++count;
  }
  EXPECT_EQ(count, 20);
  // The case is still one, and its times have no points.
  EXPECT_EQ(run("check case").status, 0);
  expect_failure("lagrangian out nothing", 1, "no folder of an OpenFOAM case");
  expect_failure("lagrangian case case", 1, "particles.pvd");
  expect_failure("lagrangian out case --cloud a/b", 1, "no name for a cloud");
}

const std::string slowed_scene = R"(
[environment]
mesh = 'case'
[[particles]]
count = 200
velocity = [0.0, 1e-6, 0.0]
diameter = 1e-3
density = 1000
[motion]
dt = 0.5
steps = 4
drag = 3.0
[output]
every = 2
)";

// Particles in still air, which slows them: their loss is in the fields, interval by interval.
TEST_F(SceneVerbs, SourcesAreFieldsOfAnOpenFoamCase) {
  BoxOptions options;
  options.cells = {3, 3, 3};
  options.size = {1.0, 1.0, 1.0};
  test::FoamWriter(folder / "case", {}).write(test::foam_mesh(generate_box(options), {{"xmin", "symmetry"}}));
  (void)write("plain.toml", slowed_scene);
  (void)write("s.toml", slowed_scene +
                            "[statistics]\ncells = { quantities = ['momentum_source', 'energy_source'], every = 2 }\n");
  ASSERT_EQ(run("run s.toml -o out").status, 0);
  ASSERT_EQ(run("run plain.toml -o plain").status, 0);
  const Result r = run("lagrangian out case --sources");
  ASSERT_EQ(r.status, 0) << r.error;
  EXPECT_EQ(r.out, "3 frames in case/*/*_source\n3 frames in case/*/lagrangian/particles\n");
  // An interval of 1 s takes the share 1 - exp(-3) of what there was before, in cells of 1/27 m^3.
  const double momentum = 200.0 * 1e-6 * 1000.0 * 3.14159265358979 / 6.0 * 1e-9;
  const double lost = 1.0 - std::exp(-3.0);
  for (const auto& [time, share] : {std::pair{"0", 0.0}, {"1", lost}, {"2", (1.0 - lost) * lost}}) {
    const std::string text = content(folder / "case" / time / "momentum_source");
    EXPECT_NE(text.find("class       volVectorField"), std::string::npos);
    EXPECT_NE(text.find("\"xmin\"\n    {\n        type            symmetry;"), std::string::npos) << text;
    EXPECT_NE(text.find("type            zeroGradient;"), std::string::npos);
    std::istringstream values(text.substr(text.find("\n27\n(") + 5));
    char bracket = 0;
    double x = 0, y = 0, z = 0, sum = 0;
    int count = 0;
    while (values >> bracket >> x >> y >> z >> bracket) {
      sum += y / 27.0;
      ++count;
    }
    EXPECT_EQ(count, 27);
    EXPECT_NEAR(sum, momentum * share, 1e-12 * momentum) << time;
  }
  // The case reads its new field, at its cells.
  EXPECT_NE(run("info case/1").out.find("momentum_source"), std::string::npos) << run("info case/1").out;
  expect_failure("lagrangian plain case --sources", 1, "momentum_source");
}

// The page has the scene, its files, the engine's bytes and the hash of a native run.
TEST_F(SceneVerbs, ALivePage) {
  (void)write("dartcast.mjs", "const program = 1;");
  (void)write("dartcast.wasm", std::string("\0asm</script>", 13));
  (void)write("part.off", test::off(test::cube_squares));
  const std::string text =
      "# </script>\n[environment]\ngenerator = 'box'\ncells = [2, 2, 2]\n[[particles]]\ncount = 20\nvelocity = [1, 2, "
      "3]\n"
      "[[body]]\nsurface = 'part.off'\nspacing = 0.5\nscale = 0.5\nat = [0.6, 0.6, 0.6]\n[motion]\ndt = 0.01\nsteps = "
      "500\n";
  (void)write("s.toml", text);
  const Result r = run("live s.toml " + scene("maze.toml") + " --engine .");
  ASSERT_EQ(r.status, 0) << r.error;
  const test::PageReader page(folder / "s.html");
  const auto block = [&](const nlohmann::json& number) {
    const std::vector<char> bytes = page.block<char>(number);
    return std::string(bytes.begin(), bytes.end());
  };
  EXPECT_EQ(block(page.meta["engine"]["program"]), "const program = 1;");
  EXPECT_EQ(block(page.meta["engine"]["wasm"]), content(folder / "dartcast.wasm"));
  const nlohmann::json& first = page.meta["scenes"][0];
  EXPECT_EQ(first["scene"], text);
  EXPECT_EQ(block(first["files"]["part.off"]), content(folder / "part.off"));
  EXPECT_EQ(first["native"]["steps"], 100);
  const auto summary = nlohmann::json::parse(run("run s.toml --steps 100 --json -o out").out);
  EXPECT_EQ(first["native"]["hash"], summary["state_hash"]);
  EXPECT_EQ(page.meta["scenes"][1]["name"], "maze");
  EXPECT_NE(page.text.find("wasm-unsafe-eval"), std::string::npos);
  expect_failure("live s.toml --engine nowhere", 1, "nowhere/dartcast.mjs: the file cannot be read");
  std::filesystem::create_directory(folder / "case");
  (void)write("case.toml", "[environment]\nmesh = 'case'\n[motion]\ndt = 0.01\n");
  expect_failure("live case.toml --engine .", 1, "a live page cannot hold a folder");
}

}  // namespace dartcast::scene_verbs_test
