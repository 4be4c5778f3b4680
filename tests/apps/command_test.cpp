// The command as its users see it: exit status, stdout, stderr, files.
#include "support/command.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "dartcast/generators.hpp"
#include "dartcast/mesh_files.hpp"
#include "support/expectations.hpp"
#include "support/foam_case.hpp"
#include "support/shared_data.hpp"

namespace dartcast::command_test {

namespace fs = std::filesystem;

using test::Result;

class Command : public test::CommandTest {};

TEST_F(Command, RunWritesItsFolderAndSaysSo) {
  const Result r = run("run " + scene("box.toml") + " --steps 5");
  EXPECT_EQ(r.status, 0) << r.error;
  EXPECT_EQ(r.error, "");
  EXPECT_NE(r.out.find("5 steps"), std::string::npos) << r.out;
  EXPECT_NE(r.out.find("box-out"), std::string::npos) << r.out;
  EXPECT_TRUE(fs::exists(folder / "box-out/particles.pvd"));
  EXPECT_EQ(content(folder / "box-out/scene.toml"), content(fs::path(scenes_folder) / "box.toml"));
}

TEST_F(Command, JsonIsOneObjectAndQuietIsNothing) {
  const Result r = run("run " + scene("box.toml") + " --steps 5 --json -o a");
  const auto json = nlohmann::json::parse(r.out);
  EXPECT_EQ(r.error, "");
  EXPECT_EQ(json["steps"], 5);
  EXPECT_EQ(json["particles"]["alive"], 200);
  EXPECT_EQ(json, nlohmann::json::parse(content(folder / "a/summary.json")));
  const Result quiet = run("run " + scene("box.toml") + " --steps 5 -q -o b");
  EXPECT_EQ(quiet.status, 0);
  EXPECT_EQ(quiet.out + quiet.error, "");
}

TEST_F(Command, TheHashDependsOnTheSeedButNotOnThreads) {
  const auto hash = [&](const std::string& options) {
    const Result r = run("run " + scene("bar_deforming.toml") + " --steps 60 --json --audit -o out " + options);
    EXPECT_EQ(r.status, 0) << r.error;
    const auto json = nlohmann::json::parse(r.out);
    EXPECT_EQ(json["audit"]["failed"], 0);
    EXPECT_EQ(json["audit"]["checked"], 60000);
    EXPECT_EQ(json["particles"]["lost"], 0);
    return json["state_hash"].get<std::string>();
  };
  const std::string one = hash("-j 1");
  EXPECT_EQ(hash("-j 2"), one);
  EXPECT_EQ(hash("-j 7"), one);
  EXPECT_NE(hash("-j 2 --seed 9"), one);
}

// The paper took 6.75 and 6.85 orientation tests; our bound is 6.
TEST_F(Command, BarsTakeAtMostSixOrientationTests) {
  for (const std::string name : {"bar_static.toml", "bar_deforming.toml"}) {
    const Result r = run("run " + scene(name) + " --json -o out");
    ASSERT_EQ(r.status, 0) << r.error;
    const auto json = nlohmann::json::parse(r.out);
    EXPECT_EQ(json["particle_steps"], 1000000);
    EXPECT_LE(json["orientation_tests"]["mean"], 6.0) << name;
    EXPECT_EQ(json["particles"]["held"], 0) << name;
    EXPECT_GT(json["contacts"]["total"], 1000) << name;
  }
}

TEST_F(Command, TheVesselsParticlesComeInAndLeave) {
  const Result r = run("run " + scene("vessel.toml") + " --steps 60 --json --audit -o out");
  ASSERT_EQ(r.status, 0) << r.error;
  const auto json = nlohmann::json::parse(r.out);
  EXPECT_GE(json["environment"]["cells"], 20000);
  const auto& p = json["particles"];
  EXPECT_EQ(p["start"], 10000);
  EXPECT_GT(p["injected"], 0);
  EXPECT_GT(p["escaped"], 0);
  EXPECT_EQ(p["lost"], 0);
  EXPECT_EQ(json["audit"]["failed"], 0);
  EXPECT_GT(json["contacts"]["by_patch"]["outlet_left"], 0);
  EXPECT_GT(json["contacts"]["by_patch"]["outlet_right"], 0);
}

TEST_F(Command, BenchIsAProgramOfItsOwn) {
  for (const std::string options : {"", " --quick", " --run box.toml -j 1"})
    expect_failure("bench" + options, 2, "dartcast-bench");
}

TEST_F(Command, WrongUsageIsTwo) {
  expect_failure("", 2, "run, report, view, live, check, info, convert");
  expect_failure("fly", 2, "fly");
  expect_failure("run", 2, "SCENE");
  expect_failure("run a.toml --fast", 2, "--fast");
  expect_failure("run a.toml -j 0", 2, "threads");
  expect_failure("run a.toml --steps many", 2, "steps");
  expect_failure("run a.toml -q -v", 2, "quiet");
  expect_failure("convert a", 2, "--output is required");
  EXPECT_EQ(run("--help").status, 0);
  EXPECT_EQ(run("run --help").status, 0);
  EXPECT_EQ(run("--version").out.find_first_not_of("0123456789.\n"), std::string::npos);
}

// An option has the limits of its scene key, or those that its help gives.
TEST_F(Command, NumbersHaveLimits) {
  const std::string start = "run " + scene("box.toml") + " -q ";
  const std::string many = "99999999999999999999999999";
  for (const std::string value :
       {"-1", "-0", "9007199254740993", "99999999999999999", "1e3", "3.5", "0x3", "+3", "' 3'", "nan"})
    expect_failure(start + "--steps " + value, 2, "is no whole number from 0 to 9007199254740992");
  for (const std::string& value : {std::string("-1"), std::string("9223372036854775808"), many})
    expect_failure(start + "--seed " + value, 2,
                   "--seed: '" + value + "' is no whole number from 0 to 9223372036854775807");
  for (const std::string& value :
       {std::string("-1"), std::string("0"), std::string("1025"), std::string("4294967297"), many})
    expect_failure(start + "-j " + value, 2, "--threads: '" + value + "' is no whole number from 1 to ");
  EXPECT_FALSE(fs::exists(folder / "box-out"));
  const Result r = run(start + "--steps 010 --seed 9223372036854775807 -j 1");  // ten, not eight
  EXPECT_EQ(r.status, 0) << r.error;
  EXPECT_EQ(nlohmann::json::parse(content(folder / "box-out/summary.json"))["steps"], 10);
}

TEST_F(Command, WhatCannotBePrintedIsAnError) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  (void)write("good.mesh", tetrahedron());
  for (const std::string& arguments :
       {"run " + scene("box.toml") + " --steps 2 --json", "run " + scene("box.toml") + " --steps 2",
        std::string("check good.mesh --json"), std::string("info good.mesh --json"), std::string("info good.mesh"),
        std::string("trace good.mesh --from 0.1,0.1,0.1 --to 0.2,0.1,0.1"), std::string("--help"),
        std::string("--version")})
    expect_failure(arguments + " > /dev/full", 1, "stdout");
  expect_failure("info no.mesh --json > /dev/full", 1, "no.mesh");
}

TEST_F(Command, ARunningRunKeepsItsFolderToItself) {
  const std::string box = "'" + binary + "' run " + scene("box.toml");
  // The first one runs until it is killed: what it leaves does not stand in the way of the next.
  const Result r = run("--version > version.txt; " + box + " --steps 1000000000 -q -o out & first=$!; " +
                       "for i in $(seq 400); do test -s out/checkpoint.bin && break; sleep 0.05; done; " + box +
                       " --steps 5 -q -o out 2> second.txt; echo $?; " + box +
                       " --steps 5 -q --resume -o out 2> third.txt; echo $?; kill -9 $first; wait $first; " + box +
                       " --steps 5 -q -o out; echo $?; echo $first");
  EXPECT_EQ(r.out.rfind("1\n1\n0\n", 0), 0U) << r.out << r.error;
  const std::string first = r.out.substr(6);
  for (const char* refused : {"second.txt", "third.txt"})
    EXPECT_NE(content(folder / refused).find("(process " + first.substr(0, first.size() - 1) + ")"), std::string::npos)
        << content(folder / refused);
  EXPECT_TRUE(fs::exists(folder / "out/summary.json"));
  EXPECT_FALSE(fs::exists(folder / "out/run.lock"));
}

TEST_F(Command, AnEmptySceneSaysWhatIsMissing) {
  (void)write("empty.toml", "");
  expect_failure("run empty.toml", 1, "empty.toml:1: environment is missing: say [environment] with mesh");
  (void)write("motion.toml", "[motion]\nsteps = 3\n");
  expect_failure("run motion.toml", 1, "motion.toml:1: environment is missing: say [environment] with mesh");
  (void)write("nothing.toml", "[environment]\n");
  expect_failure("run nothing.toml", 1, "nothing.toml:1: [environment] give either mesh = \"FILE\" or generator");
  expect_failure("info empty.toml", 1, "environment is missing");
  expect_failure("run .", 1, "the scene cannot be read");
}

TEST_F(Command, AMotionOutOfThePlaneIsNamed) {
  (void)write("flat.toml",
              "[environment]\ngenerator = 'rectangle'\ncells = [10, 4]\n[[deformation]]\nkind = 'twist'\n"
              "axis = [1.0, 0.0, 0.0]\namplitude = 1.0\nlength = 5.0\n[[particles]]\ncount = 3\n[motion]\nsteps = 5\n");
  expect_failure("run flat.toml", 1, "deformation 1 (twist) moves points out of the plane");
  EXPECT_FALSE(fs::exists(folder / "flat-out"));
}

// The last of four tetrahedra lies on the same side of a face as the first.
TEST_F(Command, BadCellsAreSkippedOnRequest) {
  std::string text = "MeshVersionFormatted 2\nDimension 3\nVertices\n8\n";
  for (const char* point : {"0 0 0", "4 0 0", "0 4 0", "0 0 4", "1 1 5", "4 4 4", "1 1 -1", "5 5 5"})
    text += std::string(point) + " 0\n";
  text += "Tetrahedra\n4\n1 2 3 4 5\n2 3 4 6 5\n1 3 2 7 5\n1 2 4 5 6\nEnd\n";
  (void)write("bad.mesh", text);
  ASSERT_EQ(run("check bad.mesh").status, 1);
  Result r = run("check bad.mesh --skip-bad-cells --json");
  EXPECT_EQ(r.status, 0) << r.out << r.error;
  const auto report = nlohmann::json::parse(r.out);
  EXPECT_EQ(report["warnings"][0]["kind"], "bad_cells");
  EXPECT_EQ(report["warnings"][0]["count"], 1);
  EXPECT_EQ(report["warnings"][0]["first"], nlohmann::json::array({3}));
  const std::string body = "[[particles]]\ncount = 50\nvelocity = [1, 2, 3]\n[motion]\ndt = 0.1\nsteps = 20\n";
  (void)write("bad.toml", "[environment]\nmesh = 'bad.mesh'\n" + body);
  (void)write("key.toml", "[environment]\nmesh = 'bad.mesh'\nskip_bad_cells = true\n" + body);
  expect_failure("run bad.toml", 1, "bad.mesh: ");
  r = run("run bad.toml --skip-bad-cells --audit");
  EXPECT_EQ(r.status, 0) << r.error;
  EXPECT_NE(r.out.find("1 bad cells"), std::string::npos) << r.out;
  EXPECT_NE(r.out.find("the first: 3"), std::string::npos) << r.out;
  r = run("run key.toml --audit --json");
  ASSERT_EQ(r.status, 0) << r.error;
  const auto json = nlohmann::json::parse(r.out);
  EXPECT_EQ(json["environment"]["cells"], 3);
  EXPECT_EQ(json["environment"]["bad_cells"]["count"], 1);
  EXPECT_EQ(json["environment"]["bad_cells"]["first"], nlohmann::json::array({3}));
  EXPECT_EQ(json["audit"]["checked"], 1000);
  EXPECT_EQ(json["audit"]["failed"], 0);
  EXPECT_EQ(json["state_hash"], nlohmann::json::parse(content(folder / "bad-out/summary.json"))["state_hash"]);
}

TEST_F(Command, FailuresAreOneWithOneLine) {
  expect_failure("run missing.toml", 1, "missing.toml");
  (void)write("a.toml", "[environment]\ngenerator = 'box'\nradius = 1\n");
  expect_failure("run a.toml", 1, "a.toml:3: [environment] the key 'radius' is unknown");
  (void)write("b.toml", "[environment]\nmesh = 'no.vtu'\n");
  expect_failure("run b.toml", 1, "no.vtu");
  expect_failure("info no.vtu", 1, "no.vtu");
  expect_failure("convert no.vtu b.vtu", 1, "no.vtu");
  (void)write("flat.mesh", tetrahedron("1 2 3 3"));
  expect_failure("convert flat.mesh b.vtu", 1, "flat.mesh");
  (void)write("good.mesh", tetrahedron());
  expect_failure("convert good.mesh b.stl", 1, ".stl");
  EXPECT_FALSE(fs::exists(folder / "b.vtu"));
  fs::create_directories(folder / "mine");
  (void)write("mine/thesis.txt", "years of work");
  expect_failure("run " + scene("box.toml") + " -o mine", 1, "mine");
}

TEST_F(Command, CheckGivesItsVerdict) {
  (void)write("good.mesh", tetrahedron());
  (void)write("turned.mesh", tetrahedron("1 3 2 4"));
  (void)write("bad.mesh", tetrahedron("1 2 3 9"));
  Result r = run("check good.mesh --json");
  EXPECT_EQ(r.status, 0);
  auto json = nlohmann::json::parse(r.out);
  EXPECT_EQ(json["valid"], true);
  EXPECT_EQ(json["cells"]["tetrahedron"], 1);
  EXPECT_TRUE(json["repairs"].empty() && json["warnings"].empty() && json["defects"].empty());
  r = run("check turned.mesh --json");
  EXPECT_EQ(r.status, 0);
  json = nlohmann::json::parse(r.out);
  EXPECT_EQ(json["repairs"][0]["kind"], "orientation");
  EXPECT_EQ(json["repairs"][0]["first"], nlohmann::json::array({0}));
  r = run("check bad.mesh --json");
  EXPECT_EQ(r.status, 1);
  json = nlohmann::json::parse(r.out);
  EXPECT_EQ(json["valid"], false);
  EXPECT_FALSE(json["defects"].empty());
  EXPECT_NE(run("check bad.mesh").out.find("verdict: refuse"), std::string::npos);
  EXPECT_EQ(run("check missing.mesh").status, 1);
}

// A cube whose top is turned by a quarter: no point sees all of its faces.
TEST_F(Command, CheckFindsCellsThatNoPointSees) {
  (void)write("twisted.mesh",
              "MeshVersionFormatted 2\nDimension 3\nVertices\n8\n0 0 0 0\n1 0 0 0\n1 1 0 0\n0 1 0 0\n"
              "1.3 0.1 1 0\n1.2 1.2 1 0\n0.2 1.1 1 0\n0.1 -0.2 1 0\nHexahedra\n1\n1 2 3 4 6 7 8 5 1\nEnd\n");
  const Result r = run("check twisted.mesh --json");
  EXPECT_EQ(r.status, 1) << r.out;
  EXPECT_EQ(nlohmann::json::parse(r.out)["defects"][0]["kind"], "not_star_shaped") << r.out;
}

TEST_F(Command, InfoDescribesMeshesAndScenes) {
  (void)write("good.mesh", tetrahedron());
  Result r = run("info good.mesh --json");
  ASSERT_EQ(r.status, 0) << r.error;
  auto json = nlohmann::json::parse(r.out);
  EXPECT_EQ(json["points"], 4);
  EXPECT_EQ(json["simplices"], 1);
  EXPECT_EQ(json["wall_faces"], 4);
  EXPECT_EQ(json["bounds"], nlohmann::json::parse("[[0.0,0.0,0.0],[1.0,1.0,1.0]]"));
  r = run("info " + scene("bar_static.toml") + " --json");
  ASSERT_EQ(r.status, 0) << r.error;
  json = nlohmann::json::parse(r.out);
  EXPECT_EQ(json["cells"]["hexahedron"], 700);
  EXPECT_EQ(json["free_cells"], 234);
  EXPECT_LE(json["bytes_per_cell"], 200.0);  // a small mesh: its outside and its shapes weigh more
  EXPECT_NE(run("info good.mesh").out.find("per cell"), std::string::npos);
}

TEST_F(Command, InfoListsPeriodicPairs) {
  (void)write("periodic.toml",
              "[environment]\ngenerator = 'box'\ncells = [2, 2, 1]\n"
              "[[periodic]]\na = 'zmax'\nb = 'zmin'\ntranslate = [0.0, 0.0, -1.0]\n"
              "[[periodic]]\na = 'ymin'\nb = 'xmin'\naxis = [0.0, 0.0, 1.0]\nangle = 90.0\n");
  const std::string text = run("info periodic.toml").out;
  EXPECT_NE(text.find("periodic: zmax leads to zmin, 4 faces, moved by (0, 0, -1)\n"), std::string::npos) << text;
  EXPECT_NE(text.find("periodic: ymin leads to xmin, 2 faces, turned by 90 degrees around (0, 0, 1) at (0, 0, 0)\n"),
            std::string::npos)
      << text;
  const auto json = nlohmann::json::parse(run("info periodic.toml --json").out)["periodic"];
  EXPECT_EQ(json[0]["faces"], 4);
  EXPECT_EQ(json[1]["angle"], 90.0);
}

// A case's cyclic patches are a pair unless the scene makes walls of them, or names another pair.
TEST_F(Command, PairsOfTheMeshsFile) {
  const MeshData box = generate_box({.cells = {2, 2, 1}, .size = Vec3{1.0, 1.0, 1.0}});
  test::FoamWriter(folder / "case", {}).write(test::foam_mesh(box, {{"xmin", "cyclic xmax"}, {"xmax", "cyclic xmin"}}));
  const std::string line = "periodic: xmin leads to xmax, 2 faces, moved by (2, 0, 0)\n";
  EXPECT_NE(run("check case").out.find("periodic: xmin leads to xmax, moved by (1, 0, 0)\n"), std::string::npos);
  const std::string mesh = "[environment]\nmesh = 'case'\nscale = 2.0\n";
  (void)write("pair.toml", mesh);
  EXPECT_NE(run("info pair.toml").out.find(line), std::string::npos);
  (void)write("pair.toml", mesh + "patches = ['ymin']\n");
  EXPECT_NE(run("info pair.toml").out.find(line), std::string::npos);
  (void)write("pair.toml", mesh + "walls = ['xmax']\n");
  EXPECT_EQ(run("info pair.toml").out.find("periodic"), std::string::npos);
  (void)write("pair.toml", mesh + "[[periodic]]\na = 'xmax'\nb = 'xmin'\ntranslate = [-2.0, 0.0, 0.0]\n");
  EXPECT_NE(run("info pair.toml").out.find("periodic: xmax leads to xmin, 2 faces"), std::string::npos);
}

TEST_F(Command, InfoListsArraysWithTheirRanges) {
  (void)write("a.vtk",
              "# vtk DataFile Version 3.0\na\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n"
              "0 0 0  1 0 0  0 1 0  0 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n"
              "POINT_DATA 4\nVECTORS u double\n1 2 3  -4 5 6  7 -8 9  0 0 0.5\n"
              "SCALARS p double 1\nLOOKUP_TABLE default\n2.5 3 0.25 1\n"
              "CELL_DATA 1\nSCALARS material int 1\nLOOKUP_TABLE default\n7\n");
  Result r = run("info a.vtk --json");
  ASSERT_EQ(r.status, 0) << r.error;
  const auto json = nlohmann::json::parse(r.out);
  EXPECT_EQ(json["point_arrays"], nlohmann::json::parse(R"([
    {"name": "u", "components": 3, "ranges": [[-4.0, 7.0], [-8.0, 5.0], [0.5, 9.0]]},
    {"name": "p", "components": 1, "ranges": [[0.25, 3.0]]}])"));
  EXPECT_EQ(json["cell_arrays"],
            nlohmann::json::parse(R"([{"name": "material", "components": 1, "ranges": [[7.0, 7.0]]}])"));
  r = run("info a.vtk");
  EXPECT_NE(r.out.find("point array u: 3 components, -4 to 7, -8 to 5, 0.5 to 9\n"), std::string::npos) << r.out;
  EXPECT_NE(r.out.find("point array p: 1 component, 0.25 to 3\n"), std::string::npos) << r.out;
  EXPECT_NE(r.out.find("cell array material: 1 component, 7 to 7\n"), std::string::npos) << r.out;
}

TEST_F(Command, TraceListsAndDrawsTheCellsPassed) {
  (void)write("plane.toml", "[environment]\ngenerator = 'rectangle'\ncells = [4, 4]\n[motion]\ndt = 0.1\nsteps = 1\n");
  Result r = run("trace plane.toml --from 0.5,0.5 --to 1.5,1.5 --to 1.5,2.5");
  ASSERT_EQ(r.status, 0) << r.error;
  EXPECT_EQ(r.out,
            "step,time,event,kind,x,y,z,cell,next\n"
            "1,0,start,face,0.5,0.5,0,0,\n"
            "1,0.5,crossing,vertex,1,1,0,0,5\n"
            "1,1,target,face,1.5,1.5,0,5,\n"
            "2,0.5,crossing,edge,1.5,2,0,5,9\n"
            "2,1,end,face,1.5,2.5,0,9,\n");
  const std::string table = r.out;
  r = run("trace plane.toml --from 0.5,0.5,0 --to 1.5,1.5 --to 1.5,2.5 -o a.csv");
  EXPECT_EQ(r.out, "a.csv: 2 crossings, arrived\n") << r.error;
  EXPECT_EQ(content(folder / "a.csv"), table);
  r = run("trace --to 1.5,-2.5 plane.toml -o a.svg --from 0.5,0.5");
  EXPECT_EQ(r.out, "a.svg: 0 crossings, stopped at a wall\n") << r.error;
  EXPECT_EQ(content(folder / "a.svg").rfind("<svg ", 0), 0U);
}

TEST_F(Command, TraceSaysWhatItCannotDo) {
  (void)write("good.mesh", tetrahedron());
  const Result r = run("trace good.mesh --from 0.1,0.1,0.1 --to 0.2,0.1,2e-1");
  EXPECT_EQ(r.out,
            "step,time,event,kind,x,y,z,cell,next\n1,0,start,volume,0.1,0.1,0.1,0,\n1,1,end,volume,0.2,0.1,0.2,0,\n")
      << r.error;
  const std::string ends = " --from 0.1,0.1,0.1 --to 0.2,0.1,0.2";
  expect_failure("trace good.mesh" + ends + " -o a.svg", 1, ".csv");
  expect_failure("trace good.mesh" + ends + " -o a.png", 2, "a.png");
  expect_failure("trace good.mesh --from 0.1,0.1 --to 0.2,0.1,0.2", 1, "x,y,z");
  expect_failure("trace good.mesh --from 1,1,1 --to 0.2,0.1,0.2", 1, "in no cell");
  for (const std::string x : {"nan", "inf", "-inf", "1e400", "1e-400", "1e120"})
    expect_failure("trace good.mesh --from 0.1,0.1,0.1 --to 0.2,0.1," + x, 2, "--to: '0.2,0.1," + x + "' is no point");
  expect_failure("trace good.mesh --from 0.1,0.1,nan --to 0,0,0", 2, "finite, and at most 2^300");
  expect_failure("trace good.mesh --from 0.1,0.1,0.1", 2, "--to");
  for (const std::string point : {"1", "1,", "1,2,3,4", "1;2", "1,2,x", "''"})
    expect_failure("trace good.mesh --from '" + point + "' --to 0,0,0", 2, "--from");
  expect_failure("trace no.vtu" + ends, 1, "no.vtu");
}

TEST_F(Command, ReplayTakesARecordedStepAgain) {
  (void)write("step.json", R"({"kind": "dartcast replay 1", "reason": "the position is outside its simplex",
    "motion": "carried", "particle": {"position": [0.125, 0.125, 0.25], "cell": 0, "simplex": 0, "touching": []},
    "target": [0.125, 0.125, -0.75], "options": {"max_contacts": 16, "tolerance": 0.05, "max_slices": 256},
    "end": [0.125, 0.125, -0.75], "answers": [{"displacement": [0.0, 0.0, 0.125], "along": false}],
    "points": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], "moved": [],
    "cells": [{"type": "tetrahedron", "free": true, "points": [0, 1, 2, 3]}], "faces": []})");
  const Result r = run("replay step.json");
  EXPECT_EQ(r.status, 0) << r.error;
  test::expect_parts(r.out, {"recorded: the position is outside its simplex", "it ended at (0.125, 0.125, -0.75)",
                             "contact at (0.125, 0.125, 0), at 0.25 of the step",
                             "now it ends at (0.125, 0.125, 0.125)", "nothing is wrong"});
  (void)write("good.mesh", tetrahedron());
  expect_failure("replay good.mesh", 1, "good.mesh: this is no replay");
  expect_failure("replay none.json", 1, "none.json");
}

TEST_F(Command, ConvertGoesRoundThroughAllFormats) {
  (void)write("a.mesh", tetrahedron());
  std::string from = "a.mesh";
  const std::vector<std::string> read = dartcast::mesh_endings();
  for (const std::string& ending : dartcast::writable_mesh_endings()) {
    if (std::find(read.begin(), read.end(), ending) == read.end()) continue;
    const std::string to = "b" + ending;
    const Result r = run("convert " + from + " " + to);
    ASSERT_EQ(r.status, 0) << to << ": " << r.error;
    EXPECT_EQ(r.out + r.error, "");
    const auto json = nlohmann::json::parse(run("check " + to + " --json").out);
    EXPECT_EQ(json["cells"]["tetrahedron"], 1) << to;
    EXPECT_EQ(json["regions"].begin().value(), 1) << to;
    EXPECT_TRUE(json["repairs"].empty()) << to;
    from = to;
  }
}

// A disk that is full at 1 KiB: what stood at the target stays, and nothing is left beside it.
TEST_F(Command, ConvertLeavesTheTargetWhereItFails) {
  (void)write("box.toml", "[environment]\ngenerator = 'box'\ncells = [6, 6, 6]\njitter = 0.5\n[motion]\nsteps = 0\n");
  ASSERT_EQ(run("run box.toml -q -o box").status, 0);
  const std::string limited =
      "sh -c 'trap \"\" XFSZ; ulimit -f 1; exec \"" + binary + "\" convert box/environment.vtu ";
  for (const std::string name : {"a.vtu", "a.vtk", "a.msh", "a.msh4", "a.mesh"}) {
    const fs::path target = write(name, "years of work");
    fs::permissions(target, fs::perms::owner_read | fs::perms::owner_write);
    const std::string line = "cd '" + folder.string() + "' && " + limited + name + "' 2> error.txt";
    const int status = std::system(line.c_str());
    EXPECT_EQ(WIFEXITED(status) ? WEXITSTATUS(status) : -1, 1) << name;
    EXPECT_NE(content(folder / "error.txt").find(name + ":"), std::string::npos) << content(folder / "error.txt");
    EXPECT_EQ(content(target), "years of work") << name;
    EXPECT_EQ(run("convert box/environment.vtu " + name).status, 0);
    EXPECT_NE(content(target), "years of work") << name;
    EXPECT_EQ(fs::status(target).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  }
  for (const auto& entry : fs::directory_iterator(folder))
    EXPECT_EQ(entry.path().string().find(".part"), std::string::npos) << entry.path();
  // A link stays one.
  fs::create_symlink("a.mesh", folder / "link.mesh");
  EXPECT_EQ(run("convert a.vtu link.mesh").status, 0);
  EXPECT_TRUE(fs::is_symlink(folder / "link.mesh"));
  fs::create_directories(folder / "folder.mesh");
  expect_failure("convert a.vtu folder.mesh", 1, "folder.mesh");
}

// A mesh of which a cell cannot be divided, and names that are not in it.
TEST_F(Command, RefusalsNameTheMeshFile) {
  (void)write("twisted.mesh",
              "MeshVersionFormatted 2\nDimension 3\nVertices\n8\n0 0 0 0\n1 0 0 0\n1 1 0 0\n0 1 0 0\n"
              "1.3 0.1 1 0\n1.2 1.2 1 0\n0.2 1.1 1 0\n0.1 -0.2 1 0\nHexahedra\n1\n1 2 3 4 6 7 8 5 1\nEnd\n");
  (void)write("a.toml", "[environment]\nmesh = 'twisted.mesh'\n[motion]\nsteps = 1\n");
  expect_failure("run a.toml", 1, "twisted.mesh: ");
  expect_failure("trace twisted.mesh --from 0.5,0.5,0.5 --to 0.6,0.5,0.5", 1, "twisted.mesh: ");
  (void)write("good.mesh", tetrahedron());
  (void)write("b.toml", "[environment]\nmesh = 'good.mesh'\nfree = { region = 'lumen' }\n[motion]\nsteps = 1\n");
  expect_failure("run b.toml", 1, "good.mesh: the mesh has no region");
  (void)write("c.toml", "[environment]\nmesh = 'good.mesh'\npatches = ['inlet']\n[motion]\nsteps = 1\n");
  expect_failure("info c.toml", 1, "good.mesh: the mesh has no patch");
}

TEST_F(Command, ReadingKeepsToItsMemory) {
  (void)write("good.mesh", tetrahedron());
  (void)write("a.toml", "[environment]\nmesh = 'good.mesh'\n[motion]\nsteps = 1\n");
  for (const std::string verb : {"check good.mesh", "info good.mesh", "convert good.mesh b.vtu", "run a.toml -q",
                                 "trace good.mesh --from 0.1,0.1,0.1 --to 0.2,0.1,0.1"}) {
    for (const std::string size : {"100M", "0.5G", "1t", "64MiB", "100000000", "1000000KB"})
      EXPECT_EQ(run(verb + " --max-memory " + size).status, 0) << verb << " " << size;
    const Result r = run(verb + " --max-memory 40M");
    EXPECT_EQ(r.status, 1) << verb;
    EXPECT_NE((r.out + r.error).find("--max-memory"), std::string::npos) << verb << r.out << r.error;
    for (const std::string size : {"many", "''", "-1", "0", "1X", "1GG", "nan", "inf", "1e30G", "99999999T", "G"})
      EXPECT_EQ(run(verb + " --max-memory=" + size).status, 2) << verb << " " << size;
  }
  EXPECT_FALSE(fs::exists(folder / "b.msh"));
}

// So one sees which patch is the inlet.
TEST_F(Command, InfoSaysWherePatchesLie) {
  (void)write("a.toml",
              "[environment]\ngenerator = 'box'\ncells = [2, 2, 3]\nsize = [2, 4, 6]\npatches = { angle = 30 }\n");
  const Result r = run("info a.toml --json");
  ASSERT_EQ(r.status, 0) << r.error;
  const auto json = nlohmann::json::parse(r.out);
  ASSERT_EQ(json["patch_places"].size(), 6U);
  bool found = false;
  for (const auto& [name, place] : json["patch_places"].items()) {
    if (place["centre"][2] != 6.0) continue;
    found = true;
    EXPECT_NEAR(place["centre"][0], 1.0, 1e-12);
    EXPECT_NEAR(place["centre"][1], 2.0, 1e-12);
    EXPECT_EQ(place["size"], 8.0);
    EXPECT_EQ(json["patches"][name], 4);
  }
  EXPECT_TRUE(found) << r.out;
  EXPECT_NE(run("info a.toml").out.find("area 8, centre (1, 2, 6)"), std::string::npos);
}

TEST_F(Command, CheckTakesSurfaces) {
  (void)write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2\n");
  const Result r = run("check a.obj --json");
  EXPECT_EQ(r.status, 1) << r.out;  // as a run refuses it
  const auto json = nlohmann::json::parse(r.out);
  EXPECT_EQ(json["verdict"], "refuse");
  EXPECT_EQ(json["warnings"][0]["kind"], "short_faces");
  EXPECT_EQ(json["defects"][0]["kind"], "open");
  EXPECT_NE(run("check a.obj").out.find("a surface in space"), std::string::npos);
}

// A sphere that bounces on a floor: contacts.csv, the counts and the hits of walls are those of a run without collisions.
class Bounces : public Command {
 public:
  void expect_same_contacts(const std::string& scene_text) {
    const auto results = [&](const std::string& name, const std::string& more) {
      (void)write(name + ".toml", scene_text + more + "[output]\ncontacts = true\nevery = 1000\nreport = false\n");
      const Result r = run("run " + name + ".toml --json -o " + name);
      EXPECT_EQ(r.status, 0) << r.error;
      return std::pair(content(folder / name / "contacts.csv"), nlohmann::json::parse(r.out));
    };
    const auto [rows, summary] = results("colliding", "[collisions]\n");
    const auto [expected, expected_summary] = results("alone", "");
    EXPECT_EQ(rows, expected);
    EXPECT_EQ(std::count(rows.begin(), rows.end(), '\n'), 3) << rows;  // the names, and two contacts
    EXPECT_EQ(summary["contacts"], expected_summary["contacts"]);
    EXPECT_EQ(summary["statistics"]["hits"]["total"], 2);
    EXPECT_EQ(summary["statistics"]["hits"], expected_summary["statistics"]["hits"]);
  }
};

constexpr const char* bouncing =
    "[motion]\ndt = 0.01\nsteps = 240\ngravity = [0.0, 0.0, -9.81]\n[contact]\nresponse = 'reflect'\nrestitution = "
    "0.5\n"
    "[statistics]\nhits = true\n";

TEST_F(Bounces, OfCollidingSpheresAreReported) {
  (void)write("seed.csv", "x,y,z,vx,vy,vz,radius\n2.5,1.5,6,0,0,0,0.5\n");
  expect_same_contacts(std::string("[environment]\ngenerator = 'box'\ncells = [4, 4, 8]\nsize = [4, 4, 8]\n"
                                   "[[particles]]\npositions = 'seed.csv'\n") +
                       bouncing);
}

TEST_F(Bounces, OnABoxOfOthersAreReported) {
  NEED_DATA("a sphere on a box");
  const std::string from = (dartcast::test::data_folder() / "regressions/turn3/sphere_on_box").string();
  expect_same_contacts("[environment]\nmesh = '" + from + "/hex.msh'\nfree = { region = ['air'] }\n" +
                       "[[particles]]\npositions = '" + from + "/seed.csv'\n" + bouncing);
}

// Real meshes: all that are well formed are accepted, divided into simplices, and can be run.
TEST_F(Command, SharedDataIsAccepted) {
  NEED_DATA("dartcast check over real meshes");
  int count = 0;
  for (const auto& entry : fs::recursive_directory_iterator(dartcast::test::data_folder() / "volumes")) {
    const std::string ending = entry.path().extension();
    const bool ours = ending == ".vtu" || ending == ".vtk" || ending == ".msh" ||
                      (ending == ".mesh" && entry.path().string().find("/mfem/") == std::string::npos);
    if (!ours) continue;
    const Result r = run("check '" + entry.path().string() + "'");
    EXPECT_EQ(r.status, 0) << r.out;
    ++count;
  }
  EXPECT_GE(count, 20);
  (void)write("liver.toml",
              "[environment]\nmesh = '" + (dartcast::test::data_folder() / "volumes/sofa/liver2.msh").string() +
                  "'\n[[particles]]\ncount = 500\nvelocity = [1, 2, 3]\n[motion]\ndt = 0.05\nsteps = 50\n");
  const Result r = run("run liver.toml --audit --json");
  ASSERT_EQ(r.status, 0) << r.error;
  EXPECT_EQ(nlohmann::json::parse(r.out)["audit"]["checked"], 25000);
}

}  // namespace dartcast::command_test
