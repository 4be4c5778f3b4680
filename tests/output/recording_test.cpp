#include "output/recording.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "dartcast/error.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/run.hpp"
#include "dartcast/scene_file.hpp"
#include "formats/point_file.hpp"
#include "output/run_files.hpp"
#include "support/data_arrays.hpp"
#include "support/sample_mesh.hpp"
#include "support/with_response.hpp"

namespace dartcast::recording_test {

using test::array;

namespace fs = std::filesystem;

const std::string scene_text = R"(
[environment]
generator = "box"
cells = [4, 4, 4]
blocked_share = 0.1
[[particles]]
count = 100
velocity = [3.0, 1.0, 0.5]
[motion]
dt = 0.02
steps = 25
gravity = [0.0, 0.0, -5.0]
[contact.patch.xmax]
response = "escape"
[output]
every = 10
contacts = true
)";
const std::string twist = "[[deformation]]\nkind = 'twist'\namplitude = 0.5\nlength = 4.0\n";

void add_step(Recording& recording, Simulation& simulation) {
  const SimulationStep& step = simulation.step();
  recording.add_step(simulation, step, {simulation.alive(), simulation.energy()});
}

void add_frame(Recording& recording, const Simulation& simulation) {
  const RecordingFrame frame{simulation.steps(), simulation.time()};
  recording.add_frame(simulation, {&frame, 1});
}

std::string content(const fs::path& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

std::vector<std::string> lines(const fs::path& path) {
  std::ifstream file(path);
  std::vector<std::string> result;
  for (std::string line; std::getline(file, line);) result.push_back(line);
  return result;
}

Summary run(const std::string& text, const fs::path& folder, bool audit = false) {
  RunOptions options;
  options.folder = folder;
  options.audit = audit;
  return run_scene(parse_scene(text, "test.toml"), options);
}

class RecordingTest : public testing::Test {
 protected:
  test::Folder temporary;
  fs::path folder = temporary / "run";
};

TEST_F(RecordingTest, AStaticRunLeavesItsFilesAndNoOthers) {
  const Summary summary = run(scene_text, folder);
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names, (std::vector<std::string>{"checkpoint.bin", "contacts.csv", "deposition.csv", "environment.pvd",
                                             "environment.vtu", "particles.pvd", "particles_000000.vtp",
                                             "particles_000010.vtp", "particles_000020.vtp", "particles_000025.vtp",
                                             "report.bin", "report.html", "scene.toml", "stats.csv", "summary.json"}));
  EXPECT_EQ(content(folder / "scene.toml"), scene_text);
  EXPECT_EQ(lines(folder / "stats.csv").size(), 26U);
  const auto& by_kind = summary.totals.counters.contacts;
  EXPECT_GT(by_kind[2], 0U);
  EXPECT_EQ(lines(folder / "contacts.csv").size(), 1 + by_kind[0] + by_kind[1] + by_kind[2]);
}

TEST_F(RecordingTest, FramesReadBackBitByBit) {
  const Scene scene = parse_scene(scene_text, "test.toml");
  BoxOptions box = std::get<BoxOptions>(scene.environment.mesh);
  const MeshData mesh = generate_box(box);
  Environment environment(mesh);
  SimulationOptions options;
  options.dt = 0.1;
  Simulation simulation(environment, options);
  simulation.add_random(50, {1.0, -2.0, 0.1});
  WritingThread writing;
  std::optional<EnvironmentRecord> record = EnvironmentRecord(mesh);
  Recording recording({writing, folder}, {false, false}, record, "");
  for (int i = 0; i < 5; ++i) add_step(recording, simulation);
  add_frame(recording, simulation);
  writing.finish();
  const PointFile file = read_points(folder / "particles_000005.vtp");
  ASSERT_EQ(file.points.size(), simulation.particles().size());
  ASSERT_EQ(array(file, "velocity").components, 3U);
  for (std::size_t i = 0; i < file.points.size(); ++i) {
    EXPECT_EQ(file.points[i], simulation.particles()[i].position);
    EXPECT_EQ(array(file, "velocity").values[3 * i + 1], simulation.velocities()[i].y);
    EXPECT_EQ(array(file, "id").values[i], static_cast<double>(simulation.ids()[i]));
    EXPECT_EQ(array(file, "cell").values[i], environment.map().source(simulation.particles()[i].cell));
    EXPECT_EQ(array(file, "contacts").values[i], simulation.contact_counts()[i]);
    EXPECT_EQ(array(file, "kind").values[i], 3.0);
  }
  const MeshFile back = read_mesh(folder / "environment.vtu");
  EXPECT_EQ(back.mesh.points, mesh.points);
  EXPECT_EQ(back.mesh.connectivity, mesh.connectivity);
  const auto free =
      std::find_if(back.mesh.cell_data.begin(), back.mesh.cell_data.end(), [](auto& a) { return a.name == "free"; });
  ASSERT_NE(free, back.mesh.cell_data.end());
  EXPECT_TRUE(std::equal(free->values.begin(), free->values.end(), mesh.free.begin(), mesh.free.end()));
}

TEST_F(RecordingTest, RunsInThePlaneLeaveTheSameFiles) {
  const std::string text =
      "[environment]\ngenerator = 'maze'\nrooms = [3, 2]\nsize = [26.0, 17.0]\ntype = 'mixed'\njitter = 0.2\n"
      "[[deformation]]\nkind = 'bend'\namplitude = 0.3\nlength = 20.0\naxis = [0.0, 1.0, 0.0]\n"
      "[[particles]]\ncount = 200\nvelocity = [3.0, 1.0, 0.0]\n"
      "[[particles]]\ninlet = 'border'\nrate = 50.0\nvelocity = [0.5, 0.25, 0.0]\n"
      "[motion]\ndt = 0.05\nsteps = 40\n[output]\nevery = 20\ncontacts = true\n";
  const Summary summary = run(text, folder, true);
  EXPECT_EQ(summary.lost, 0U);
  EXPECT_EQ(summary.audit->failed, 0U);
  EXPECT_GT(summary.audit->checked, 8000U);
  const MeshData frame = read_mesh(folder / "environment_000040.vtu").mesh;
  EXPECT_EQ(frame.dimension(), 2U);
  const auto count = [&](const char* kind) {
    std::size_t n = 0;
    for (const std::string& line : lines(folder / "contacts.csv")) n += line.find(kind) != std::string::npos ? 1 : 0;
    return n;
  };
  EXPECT_GT(count(",edge,"), 100U);
  EXPECT_EQ(count(",face,"), 0U);
}

TEST_F(RecordingTest, TheKindOfAParticleOnAWallIsSaid) {
  const MeshData mesh = generate_box({});
  Environment environment(mesh);
  SimulationOptions options;
  options.dt = 1.0;
  Simulation simulation(environment, test::with_response(options, Stick{}));
  simulation.add(std::vector<Vec3>{{0.5, 0.25, 0.75}}, {0.7, 0, 0});
  simulation.add(std::vector<Vec3>{{0.5, 0.25, 0.75}}, {0.0, 0, 0});
  simulation.step();
  WritingThread writing;
  std::optional<EnvironmentRecord> record = EnvironmentRecord(mesh);
  Recording recording({writing, folder}, {false, false}, record, "");
  add_frame(recording, simulation);
  writing.finish();
  const PointFile file = read_points(folder / "particles_000001.vtp");
  EXPECT_EQ(array(file, "kind").values[0], 2.0);
  EXPECT_EQ(array(file, "contacts").values, (std::vector<double>{1.0, 0.0}));
}

TEST_F(RecordingTest, ADeformingRunHasAnEnvironmentPerFrame) {
  run(scene_text + twist, folder);
  EXPECT_FALSE(fs::exists(folder / "environment.vtu"));
  const MeshFile first = read_mesh(folder / "environment_000000.vtu");
  const MeshFile middle = read_mesh(folder / "environment_000010.vtu");
  const MeshFile last = read_mesh(folder / "environment_000025.vtu");
  EXPECT_TRUE(last.report.valid());
  EXPECT_EQ(first.mesh.points.size(), last.mesh.points.size());
  EXPECT_NE(first.mesh.points, middle.mesh.points);
  EXPECT_EQ(first.mesh.points, last.mesh.points);  // half a period: at rest, to the last bit
  const std::string pvd = content(folder / "environment.pvd");
  EXPECT_NE(pvd.find("timestep=\"0.5\" part=\"0\" file=\"environment_000025.vtu\""), std::string::npos) << pvd;
}

TEST_F(RecordingTest, TheSummaryIsWhatTheInterfaceSays) {
  const Summary summary = run(scene_text + twist, folder, true);
  const auto json = nlohmann::json::parse(content(folder / "summary.json"));
  for (const char* key : {"version", "scene", "threads", "steps", "particle_steps", "environment", "particles",
                          "orientation_tests", "contacts", "seconds", "ns_per_particle_step", "audit", "state_hash"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  EXPECT_EQ(json["scene"], "test");
  EXPECT_EQ(json["steps"], 25);
  EXPECT_EQ(json["environment"]["cells"], 64);
  EXPECT_EQ(json["environment"]["free_cells"], 58);
  EXPECT_EQ(json["environment"]["vertices"], 125);
  const auto& p = json["particles"];
  EXPECT_EQ(p["start"], 100);
  EXPECT_GT(p["escaped"], 0);
  EXPECT_EQ(p["lost"], 0);
  EXPECT_EQ(p["alive"].get<int>() + p["escaped"].get<int>() + p["absorbed"].get<int>(), 100);
  EXPECT_EQ(json["audit"]["failed"], 0);
  EXPECT_EQ(json["audit"]["checked"], summary.audit->checked);
  const auto& tests = json["orientation_tests"];
  std::uint64_t steps = 0;
  double sum = 0.0;
  for (std::size_t i = 0; i < tests["histogram"].size(); ++i) {
    steps += tests["histogram"][i].get<std::uint64_t>();
    sum += static_cast<double>(i) * tests["histogram"][i].get<double>();
  }
  EXPECT_EQ(json["particle_steps"], steps);
  EXPECT_NEAR(tests["mean"], sum / static_cast<double>(steps), 1e-9);
  EXPECT_TRUE(tests.contains("updated_by_deformation_share"));
  EXPECT_GT(json["contacts"]["by_patch"]["xmax"], 0);
  EXPECT_EQ(json["state_hash"], summary.state_hash);
}

TEST_F(RecordingTest, WhatHasNoMeaningIsLeftOut) {
  run("[environment]\ngenerator = 'box'\n[motion]\nsteps = 3\n", folder);
  const auto json = nlohmann::json::parse(content(folder / "summary.json"));
  EXPECT_FALSE(json.contains("audit"));
  EXPECT_FALSE(json.contains("orientation_tests"));
  EXPECT_FALSE(json.contains("ns_per_particle_step"));
  EXPECT_FALSE(json["seconds"].contains("deform"));
  EXPECT_EQ(json["particles"]["start"], 0);
}

TEST_F(RecordingTest, AnEarlierRunIsReplacedWithoutRemains) {
  run(scene_text + twist, folder);
  write_bytes(folder / "notes.txt", "mine");
  write_bytes(folder / "particles_mine.vtp", "mine");
  run("[environment]\ngenerator = 'box'\n[motion]\nsteps = 1\n", folder);
  EXPECT_FALSE(fs::exists(folder / "environment_000025.vtu"));
  EXPECT_FALSE(fs::exists(folder / "particles_000025.vtp"));
  EXPECT_FALSE(fs::exists(folder / "contacts.csv"));
  EXPECT_TRUE(fs::exists(folder / "particles_000001.vtp"));
  EXPECT_EQ(content(folder / "notes.txt"), "mine");
  EXPECT_EQ(content(folder / "particles_mine.vtp"), "mine");
}

TEST_F(RecordingTest, FoldersOfOthersAreLeftAlone) {
  fs::create_directories(folder);
  write_bytes(folder / "scene.toml", "mine");
  EXPECT_THROW(run(scene_text, folder), Error);
  EXPECT_EQ(content(folder / "scene.toml"), "mine");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 1);
  write_bytes(temporary / "file", "mine");
  EXPECT_THROW(run(scene_text, temporary / "file"), Error);
  EXPECT_EQ(content(temporary / "file"), "mine");
}

TEST_F(RecordingTest, PositionsComeFromVtpAndCsv) {
  const fs::path csv = temporary / "seeds.csv";
  write_bytes(csv, "id,\"z\",y,x\n1, 0.5,0.25,0.125\n\n2,1e-1,0.1,0.1\r\n");
  const auto points = read_points(csv).points;
  EXPECT_EQ(points, (std::vector<Vec3>{{0.125, 0.25, 0.5}, {0.1, 0.1, 0.1}}));
  const std::string text =
      "[environment]\ngenerator = 'box'\n[[particles]]\npositions = '" + csv.string() + "'\n[motion]\nsteps = 1\n";
  run(text, folder);
  EXPECT_EQ(read_points(folder / "particles_000001.vtp").points, points);
  const auto expect_error = [&](const std::string& content_of_file, const std::string& part) {
    write_bytes(csv, content_of_file);
    try {
      run(text, folder);
      ADD_FAILURE() << content_of_file;
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
    }
  };
  expect_error("a,b\n1,2\n", ":1: there is no column 'x'");
  expect_error("x,y,z\n1,2\n", ":2: column 'z': '' is not a number");
  expect_error("x,y,z\n0,0,0\n1,2,3a\n", ":3: column 'z': '3a' is not a number");
  expect_error("x,y,z\n0.5,0.5,0.5\n1,2,3\n", "position 1 (counted from 0) is outside the mesh");
  expect_error("x,y,z\nnan,0.5,0.5\n", "finite");
  EXPECT_THROW(read_points("no.csv"), Error);
  EXPECT_THROW(read_points(temporary / "."), Error);
  write_bytes(temporary / "bad.vtp", "<VTKFile type=\"PolyData\"><PolyData>");
  EXPECT_THROW(read_points(temporary / "bad.vtp"), Error);
}

TEST_F(RecordingTest, PatchesAndRegionsThatAreNotThereAreRefused) {
  const std::string start = "[environment]\ngenerator = 'box'\n";
  for (const std::string& text :
       {start + "free = { region = 'lumen' }\n", start + "patches = ['inlet']\n",
        start + "[contact.patch.inlet]\nresponse = 'escape'\n", start + "[motion]\nfield = 'velocity'\n",
        start + "[[particles]]\ninlet = 'inlet'\nrate = 1\n",
        std::string("[environment]\nmesh = 'no-such-file.vtu'\n")}) {
    EXPECT_THROW(run(text, folder), Error) << text;
    EXPECT_FALSE(fs::exists(folder)) << text;
  }
}

// A run that is cut off at its very begin leaves a folder that the next may take over.
TEST(RunFiles, ATableIsKnownAtOnce) {
  const test::Folder folder;
  const RunTable table(folder / "table.csv", "step,time");
  EXPECT_EQ(content(folder / "table.csv"), "step,time\n");
}

TEST(RunFiles, FramesAreKnownByTheirNames) {
  EXPECT_EQ(frame_step("particles_000010.vtp"), 10U);
  EXPECT_EQ(frame_step("environment_1000000.vtu"), 1000000U);
  EXPECT_EQ(frame_step("surface_a_000002_000010.vtp"), 10U);
  EXPECT_EQ(frame_step("particles_000010.12.vtp"), 10U);  // a piece
  EXPECT_EQ(frame_step("particles_000010.pvtp"), 10U);
  for (const char* other : {"particles_000010.a.vtp", "particles_000010..vtp", "checkpoint_000010.2.bin",
                            "particles_10.vtp", "particles_000010.vtu", "body_000010.vtp", "body__000010.vtp",
                            "mine_000010.vtp", "particles_00001x.vtp", "environment.vtu"})
    EXPECT_FALSE(frame_step(other)) << other;
  EXPECT_TRUE(is_run_file(checkpoint_part_name(10, 2)));
  EXPECT_EQ(checkpoint_part_step("checkpoint_000010.2.bin"), 10U);
  EXPECT_FALSE(checkpoint_part_step("checkpoint.bin"));
}

}  // namespace dartcast::recording_test
