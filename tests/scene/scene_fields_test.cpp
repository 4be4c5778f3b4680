// Fields of a scene: from arrays of the mesh file, numbered files, lists of files and collections.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/run.hpp"
#include "dartcast/scene_file.hpp"
#include "dartcast/simulation.hpp"
#include "formats/file_series.hpp"
#include "simulation/series.hpp"
#include "support/expectations.hpp"
#include "support/thread_ranks.hpp"

namespace dartcast::scene_fields_test {

namespace fs = std::filesystem;
using test::expect_near;
using test::expect_parts;

MeshData box() {
  BoxOptions o;
  o.cells = {3, 3, 3};
  o.size = {3, 3, 3};
  return generate_box(o);
}

// Linear in space, and in time between the samples at 0, 1, 2, ...
Vec3 velocity(const Vec3& p, double t) { return {0.02 * p.y + 0.01 * t, 0.03 * p.z, -0.02 * p.x - 0.005 * t}; }
Vec3 at_cell(std::size_t c, double t) { return {0.001 * static_cast<double>(c), 0.002 * t, 0}; }

DataArray array(const std::string& name, std::size_t count, const std::function<Vec3(std::size_t)>& value) {
  DataArray a{name, 3, {}};
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 v = value(i);
    a.values.insert(a.values.end(), {v.x, v.y, v.z});
  }
  return a;
}

void add_arrays(MeshData& mesh, const std::string& points, const std::string& cells, double t) {
  mesh.point_data.push_back(
      array(points, mesh.points.size(), [&](std::size_t i) { return velocity(mesh.points[i], t); }));
  mesh.cell_data.push_back(array(cells, mesh.cell_count(), [&](std::size_t c) { return at_cell(c, t); }));
}

// A folder with mesh.vtu, whose arrays are U_8, U_9, U_10 and C_8, ..., and U_8.vtu, ... with the arrays U and C, each
// for the times 0, 1 and 2.
class SceneFields : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              fmt::format("scene_fields_{}", ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    MeshData mesh = box();
    for (int k = 0; k < 3; ++k) {
      add_arrays(mesh, fmt::format("U_{}", k + 8), fmt::format("C_{}", k + 8), k);
      MeshData one = box();
      add_arrays(one, "U", "C", k);
      write_mesh(one, folder_ / fmt::format("U_{}.vtu", k + 8));
    }
    write_mesh(mesh, folder_ / "mesh.vtu");
    pvd("flow.pvd", {{"0", "U_8.vtu"}, {"1.0", "U_9.vtu"}, {"2e0", "U_10.vtu"}});
  }
  void TearDown() override { fs::remove_all(folder_); }

  void pvd(const std::string& name, const std::vector<std::pair<std::string, std::string>>& entries) const {
    std::ofstream out(folder_ / name);
    out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n";
    for (const auto& [time, file] : entries)
      out << "<DataSet timestep=\"" << time << "\" group=\"\" part=\"0\" file=\"" << file << "\"/>\n";
    out << "</Collection>\n</VTKFile>\n";
  }

  [[nodiscard]] Scene parse(const std::string& motion) const {
    return parse_scene("[environment]\nmesh = 'mesh.vtu'\n[motion]\ndt = 0.25\n" + motion, folder_ / "scene.toml");
  }

  [[nodiscard]] Scene load(const std::string& motion) const { return load_scene_files(parse(motion)).scene; }

  // Runs 10 steps, and compares the velocities with those of the array U or C.
  void expect_flow(const std::string& motion, bool cells = false, double period = 0.0) const {
    SCOPED_TRACE(motion);
    Simulation simulation(load(motion));
    simulation.add({{1.5, 1.4, 1.3}, {0.4, 2.2, 1.7}}, {});
    for (int i = 0; i < 10; ++i) {
      double t = 0.25 * i;
      if (period > 0.0 && t >= period) t -= period;
      t = std::min(t, 2.0);
      std::vector<Vec3> expected;
      for (const ParticleState& s : simulation.particles().states())
        expected.push_back(cells ? at_cell(simulation.environment().map().source(s.cell), t) : velocity(s.position, t));
      simulation.step();
      for (std::size_t k = 0; k < expected.size(); ++k) expect_near(simulation.velocities()[k], expected[k], 1e-15);
    }
  }

  [[nodiscard]] std::string error_of(const std::string& motion) const {
    try {
      Simulation simulation(load(motion));
      simulation.add({{1.5, 1.4, 1.3}}, {});
      for (int i = 0; i < 10; ++i) simulation.step();
      return "done";
    } catch (const Error& e) {
      return e.what();
    }
  }

  fs::path folder_;
};

// As SimVascular writes its results: all times as arrays of one file, which is not that of the mesh.
TEST_F(SceneFields, ArraysOfAnotherFile) {
  fs::rename(folder_ / "mesh.vtu", folder_ / "all_results.vtu");
  write_mesh(box(), folder_ / "mesh.vtu");
  expect_flow("field = { array = 'U_*', files = 'all_results.vtu', times = [0, 1, 2] }");
  expect_flow("field = { array = 'C_*', files = ['all_results.vtu'], spacing = 1 }", true);
  EXPECT_NE(test::error_text([&] {
              (void)load("field = { array = 'X_*', files = 'all_results.vtu', spacing = 1 }");
            }).find("'X_*'"),
            std::string::npos);
  EXPECT_NE(test::error_text([&] {
              (void)load("field = { array = 'U_*', files = ['all_results.vtu', 'U_8.vtu'], spacing = 1 }");
            }).find("just one"),
            std::string::npos);
}

TEST_F(SceneFields, FromWhereverTheyAre) {
  expect_flow("field = { array = 'U_*', spacing = 1.0 }");
  expect_flow("field = { array = 'U_*', times = [0.0, 1.0, 2.0], period = 2.0 }", false, 2.0);
  expect_flow("field = { array = 'C_*', spacing = 1.0 }", true);
  expect_flow("field = { array = 'U', files = 'U_*.vtu', spacing = 1.0 }");
  expect_flow("field = { array = 'U', files = 'U_*.vtu', times = [0.0, 1.0, 2.0], period = 2.0 }", false, 2.0);
  expect_flow("field = { array = 'C', files = 'U_*.vtu', spacing = 1.0 }", true);
  expect_flow("field = { array = 'C', at = 'cells', files = ['U_8.vtu', 'U_9.vtu', 'U_10.vtu'], spacing = 1.0 }", true);
  expect_flow("field = { array = 'U', files = 'flow.pvd' }");
  expect_flow("field = { array = 'U', files = 'flow.pvd', period = 2.0 }", false, 2.0);
}

TEST_F(SceneFields, ANameAloneIsASteadyArrayAsBefore) {
  for (const char* text :
       {"field = 'U_8'", "field = { array = 'U_8' }", "field = { array = 'U', files = 'U_8.vtu' }"}) {
    Simulation simulation(load(text));
    simulation.add({{1.5, 1.4, 1.3}}, {});
    simulation.step();
    const Vec3 before = simulation.particles()[0].position;
    simulation.step();
    expect_near(simulation.velocities()[0], velocity(before, 0), 1e-15);
  }
}

TEST_F(SceneFields, ForcesAreReadInTheSameWay) {
  Simulation simulation(load("gravity = [0, 0, 0.1]\nforce = { array = 'C', files = 'flow.pvd' }"));
  simulation.add({{1.5, 1.4, 1.3}}, {});
  simulation.step();
  simulation.step();
  const double c = 0.001 * simulation.environment().map().source(simulation.particles()[0].cell);
  expect_near(simulation.velocities()[0], {2 * c * 0.25, 0.002 * 0.25 * 0.25, 2 * 0.1 * 0.25}, 1e-15);
  Simulation both(load("drag = 1.0\nfield = 'U_8'\nforce = 'U_9'"));
  both.add({{1.5, 1.4, 1.3}}, {});
  both.step();
  const Vec3 u = velocity({1.5, 1.4, 1.3}, 0) + velocity({1.5, 1.4, 1.3}, 1);
  expect_near(both.velocities()[0], u * (1 - std::exp(-0.25)), 1e-15);
}

TEST_F(SceneFields, KeysAreRead) {
  const Scene s = parse(
      "integrator = 'rk4'\nfield = { array = 'U', at = 'cells', frame = 'mesh', files = ['a.vtu', 'b.vtu'], times = "
      "[1, "
      "2], period = 3 }");
  const FieldScene& f = s.motion.field;
  EXPECT_EQ(s.motion.integrator, Integrator::rk4);
  EXPECT_EQ(f.array, "U");
  EXPECT_EQ(f.at, FieldPlace::cells);
  EXPECT_EQ(f.frame, FieldFrame::mesh);
  EXPECT_EQ(f.files, (std::vector<fs::path>{folder_ / "a.vtu", folder_ / "b.vtu"}));
  EXPECT_EQ(f.times, (std::vector<double>{1, 2}));
  EXPECT_EQ(f.period, 3.0);
  EXPECT_FALSE(s.motion.force.given());
}

TEST_F(SceneFields, RefusalsSayWhatAndWhere) {
  const auto expect_error = [&](const std::string& motion, std::initializer_list<const char*> parts) {
    SCOPED_TRACE(motion);
    expect_parts(error_of(motion), parts);
  };
  expect_error("field = 'U_*'", {"scene.toml:5", "spacing"});
  expect_error("field = {}", {"scene.toml:5", "array"});
  expect_error("field = { array = 'U_8', file = 'a' }", {"'file' is unknown", "files"});
  expect_error("field = { array = 'U_8', at = 'faces' }", {"points, cells"});
  expect_error("field = { array = 'U_*', times = [0, 1, 2], spacing = 1 }", {"times or spacing, not both"});
  expect_error("field = { array = 'U_8' }\nfield_frame = 'mesh'", {"scene.toml:6", "frame in the field's table"});
  expect_error("integrator = 'rk4'", {"scene.toml:5", "needs a field"});
  expect_error("integrator = 'rk4'\nfield = 'U_8'\ndrag = 1", {"scene.toml:5", "leave drag out"});
  expect_error("integrator = 'rk4'\nfield = 'U_8'\nsubsteps = 2", {"scene.toml:5", "leave substeps out"});
  expect_error("integrator = 'rk45'", {"euler, rk4"});
  expect_error("field = 'U_8'\nforce = 'U_9'", {"scene.toml:6", "give drag"});
  expect_error("field = { array = 'U_*' }", {"'U_*'", "3 arrays", "times or spacing"});
  expect_error("field = { array = 'U_*', times = [0, 1] }", {"2 times for 3 arrays"});
  expect_error("field = { array = 'U_*', times = [0, 2, 1] }", {"velocity field", "must increase"});
  expect_error("field = { array = 'U_*', spacing = 1, period = 1 }", {"velocity field", "period is 1 s"});
  expect_error("field = { array = 'V_*', spacing = 1 }", {"point or cell array 'V_*'", "U_8 (3)", "C_8 (3)"});
  expect_error("field = { array = 'V_8', at = 'points' }", {"no point array 'V_8'", "U_8 (3)"});
  expect_error("field = { array = 'U_8', at = 'cells' }", {"no cell array 'U_8'", "C_8 (3)"});
  expect_error("field = { array = 'U', files = 'V_*.vtu', spacing = 1 }", {"V_*.vtu", "no file"});
  expect_error("field = { array = 'U', files = '*_*.vtu', spacing = 1 }", {"*_*.vtu", "one star"});
  expect_error("field = { array = 'U', files = ['U_8.vtu', 'U_7.vtu'], spacing = 1 }", {"U_7.vtu", "no such file"});
  expect_error("field = { array = 'U', files = 'U_*.vtu' }", {"3 files", "times or spacing"});
  expect_error("field = { array = 'U', files = 'flow.pvd', spacing = 1 }", {"flow.pvd", "leave out times"});
  expect_error("field = { array = 'V', files = 'U_*.vtu', spacing = 1 }", {"U_8.vtu", "'V'", "U (3)"});
  EXPECT_EQ(error_of("force = { array = 'U', files = 'U_*.vtu', spacing = 1 }"), "done");
}

TEST_F(SceneFields, CollectionsAreChecked) {
  const auto expect_error = [&](const std::vector<std::pair<std::string, std::string>>& entries,
                                std::initializer_list<const char*> parts) {
    pvd("bad.pvd", entries);
    expect_parts(error_of("field = { array = 'U', files = 'bad.pvd' }"), parts);
  };
  expect_error({}, {"bad.pvd", "no DataSet"});
  expect_error({{"1", "U_8.vtu"}, {"1", "U_9.vtu"}}, {"bad.pvd: ", "line 5", "several parts"});
  expect_error({{"1", "U_8.vtu"}, {"0.5", "U_9.vtu"}}, {"line 5", "0.5 stands after 1"});
  expect_error({{"late", "U_8.vtu"}}, {"line 4", "\"late\""});
  expect_error({{"nan", "U_8.vtu"}}, {"line 4", "finite"});
  expect_error({{"0", ""}}, {"line 4", "no file"});
  expect_error({{"0", "U_7.vtu"}}, {"U_7.vtu", "no such file"});
  std::ofstream(folder_ / "bad.pvd") << "<VTKFile><Collection><DataSet";
  expect_parts(error_of("field = { array = 'U', files = 'bad.pvd' }"), {"bad.pvd", "truncated"});
  expect_parts(error_of("field = { array = 'U', files = 'none.pvd' }"), {"none.pvd"});
}

// A file that is bad only later: the run stops before the step that needs it, and names it.
TEST_F(SceneFields, LaterFilesAreCheckedWhenTheyAreNeeded) {
  const std::string motion = "field = { array = 'U', files = 'U_*.vtu', spacing = 1.0 }";
  const auto error_at_five = [&] {
    Simulation simulation(load(motion));
    simulation.add({{1.5, 1.4, 1.3}}, {});
    for (int i = 0; i < 3; ++i) simulation.step();  // up to 0.75 s
    std::string text = "done";
    try {
      for (int i = 3; i < 10; ++i) simulation.step();
    } catch (const Error& e) {
      text = e.what();
    }
    EXPECT_EQ(simulation.steps(), 3U);  // the fourth ends at 1 s, where the last sample starts to count
    return text;
  };
  MeshData other = box();
  add_arrays(other, "U", "C", 2);
  other.point_data[0].values[7] = std::numeric_limits<double>::quiet_NaN();
  write_mesh(other, folder_ / "U_10.vtu");
  expect_parts(error_at_five(), {"U_10.vtu", "'U'", "not finite", "item 2"});
  BoxOptions o;
  o.cells = {2, 2, 2};
  o.size = {1.0, 1.0, 1.0};
  other = generate_box(o);
  add_arrays(other, "U", "C", 2);
  write_mesh(other, folder_ / "U_10.vtu");
  expect_parts(error_at_five(), {"U_10.vtu", "27 points and 8 cells", "64 and 27", "same mesh"});
  other = box();
  write_mesh(other, folder_ / "U_10.vtu");
  expect_parts(error_at_five(), {"U_10.vtu", "no point array 'U'"});
  std::ofstream(folder_ / "U_10.vtu") << "no mesh";
  expect_parts(error_at_five(), {"U_10.vtu"});
}

// The time follows from the steps, and the files are read again.
TEST_F(SceneFields, AResumedRunIsThatOfARunThatWasNeverCutOff) {
  for (const char* integrator : {"euler", "rk4"}) {
    const std::string motion = fmt::format(
        "integrator = '{}'\nfield = {{ array = 'U', files = 'flow.pvd', period = 2.5 }}\n[[particles]]\ncount = "
        "100\n[output]\n"
        "every = 2",
        integrator);
    const auto hash = [&](const fs::path& folder, std::uint64_t steps, bool resume) {
      RunOptions options;
      options.folder = folder_ / folder;
      options.steps = steps;
      options.resume = resume;
      return run_scene(parse(motion), options).state_hash;
    };
    const std::string whole = hash("whole", 30, false);
    hash("cut", 14, false);
    EXPECT_EQ(hash("cut", 30, true), whole);
    EXPECT_NE(hash("other", 29, false), whole);
    for (const char* folder : {"whole", "cut", "other"}) fs::remove_all(folder_ / folder);
  }
}

TEST_F(SceneFields, ASceneWhoseFilesAreNotReadIsRefused) {
  EXPECT_THROW(Simulation(parse("field = { array = 'U', files = 'flow.pvd' }")), InvalidArgument);
}

// Cells that the scene leaves out have no values; those of the others stay with their cells.
TEST_F(SceneFields, BadCellsAreLeftOutOfFieldsToo) {
  MeshData mesh = box();
  const std::size_t inverted = 13;
  const auto corners = mesh.connectivity.begin() + static_cast<std::ptrdiff_t>(mesh.offsets[inverted]);
  mesh.points[*corners] = {2.9, 2.9, 2.9};
  for (int k = 0; k < 3; ++k) {
    MeshData one = mesh;
    add_arrays(one, "U", "C", k);
    write_mesh(one, folder_ / fmt::format("U_{}.vtu", k + 8));
  }
  write_mesh(mesh, folder_ / "mesh.vtu");
  const Scene scene =
      load_scene_files(parse_scene("[environment]\nmesh = 'mesh.vtu'\nskip_bad_cells = true\n[motion]\ndt "
                                   "= 0.01\nfield = { array = 'C', files = 'flow.pvd' }",
                                   folder_ / "scene.toml"))
          .scene;
  Simulation simulation(scene);
  ASSERT_LT(simulation.environment().map().cell_count(), 27U);
  simulation.add_random(50, {});
  std::vector<std::uint32_t> sources;
  for (const ParticleState& s : simulation.particles().states())
    sources.push_back(simulation.environment().map().source(s.cell));
  simulation.step();
  for (std::size_t k = 0; k < sources.size(); ++k)
    expect_near(simulation.velocities()[k], at_cell(sources[k], 0), 1e-15);
}

// The places, by id, after 14 steps; the parts of the cells change after 10.
std::map<std::uint64_t, std::pair<Vec3, std::vector<double>>> ends(Simulation& simulation) {
  for (int i = 0; i < 14; ++i) simulation.step();
  std::map<std::uint64_t, std::pair<Vec3, std::vector<double>>> all;
  for (std::size_t i = 0; i < simulation.particles().size(); ++i) {
    const std::span<const double> data = simulation.user_data(i);
    all[simulation.ids()[i]] = {simulation.particles()[i].position, {data.begin(), data.end()}};
  }
  return all;
}

TEST_F(SceneFields, RanksThatShareTheCellsReadTheSameFiles) {
  for (const char* motion : {"field = { array = 'U', files = 'flow.pvd' }\nsample = ['C']",
                             "field = { array = 'C', files = 'flow.pvd' }\nsample = ['U']",
                             "field = { array = 'C', at = 'points', files = 'flow.pvd' }",
                             "field = { array = 'U_*', files = ['mesh.vtu'], spacing = 1.0 }\ndrag = 2.0\n"
                             "force = { array = 'U', files = 'flow.pvd' }"}) {
    SCOPED_TRACE(motion);
    Scene scene = parse(std::string(motion) + "\n[[particles]]\ncount = 200");
    Simulation alone(load_scene_files(scene).scene);
    const auto truth = ends(alone);
    ASSERT_EQ(truth.size(), 200U);
    std::size_t count = 0;
    std::mutex mutex;
    test::on_ranks(3, [&](Ranks& ranks) {
      Simulation shared(load_scene_part(scene, ranks).scene, Threads{1}, &ranks, Partition::cells);
      const auto some = ends(shared);
      const std::lock_guard lock(mutex);
      count += some.size();
      for (const auto& [id, end] : some) EXPECT_EQ(end, truth.at(id)) << id;
    });
    EXPECT_EQ(count, truth.size());
  }
}

// The file of the second time has a cell fewer.
TEST_F(SceneFields, RanksThatShareTheCellsRefuseFilesOfAnotherMesh) {
  BoxOptions o;
  o.cells = {3, 3, 2};
  MeshData other = generate_box(o);
  add_arrays(other, "U", "C", 1.0);
  write_mesh(other, folder_ / "U_9.vtu");
  const Scene scene = parse("field = { array = 'U', files = 'flow.pvd' }");
  EXPECT_THROW(test::on_ranks(2,
                              [&](Ranks& ranks) {
                                Simulation shared(load_scene_part(scene, ranks).scene, Threads{1}, &ranks,
                                                  Partition::cells);
                                for (int i = 0; i < 10; ++i) shared.step();
                              }),
               InvalidMesh);
}

TEST(FieldSeries, NumbersAreInOrder) {
  EXPECT_EQ(numbered("U_*.vtu", {"U_10.vtu", "U_9.vtu", "U_007.vtu", "U_.vtu", "U_1a.vtu", "U_2.vtk", "V_3.vtu", "_1",
                                 "U_100000000000000000000.vtu", "U_0.vtu"}),
            (std::vector<std::string>{"U_0.vtu", "U_007.vtu", "U_9.vtu", "U_10.vtu", "U_100000000000000000000.vtu"}));
  EXPECT_EQ(numbered("*", {"3", "a", "12"}), (std::vector<std::string>{"3", "12"}));
}

// Cells' values at points are a field without jumps: on both sides of a face between two cells it is the same.
TEST_F(SceneFields, CellsBroughtToPointsAreContinuous) {
  for (const char* keys : {"field = { array = 'C_8', at = 'points' }",
                           "field = { array = 'C', at = 'points', files = ['U_8.vtu'], spacing = 1.0 }"}) {
    const Scene scene = load(keys);
    EXPECT_EQ(scene.motion.field.samples.read ? scene.motion.field.samples.place : FieldPlace::points,
              FieldPlace::points);
    Simulation simulation(scene);
    constexpr double near = 0x1p-40;
    simulation.add({{1.0 - near, 1.4, 1.3}, {1.0 + near, 1.4, 1.3}, {1.5, 1.5, 2.0 - near}, {1.5, 1.5, 2.0 + near}},
                   {});
    simulation.step();
    expect_near(simulation.velocities()[0], simulation.velocities()[1], 1e-12);
    expect_near(simulation.velocities()[2], simulation.velocities()[3], 1e-12);
    EXPECT_GT(simulation.velocities()[3].x, 0.01);
  }
}

// The mesh's values are linear in space, so particles take them exactly; in time those of the files are, too.
TEST_F(SceneFields, ParticlesTakeSamples) {
  const auto check = [](Simulation& simulation, bool moves) {
    const std::vector<std::string> names = simulation.options().user_data;
    ASSERT_EQ(names.size(), 6U);
    EXPECT_EQ(names[0].substr(names[0].size() - 2), "_x");
    for (std::size_t i = 0; i < simulation.particles().size(); ++i) {
      const std::span<const double> numbers = simulation.user_data(i);
      const ParticleState& s = simulation.particles()[i];
      const double t = moves ? std::min(simulation.time(), 2.0) : 0.0;
      expect_near({numbers[0], numbers[1], numbers[2]}, velocity(s.position, t), 1e-14);
      expect_near({numbers[3], numbers[4], numbers[5]}, at_cell(simulation.environment().map().source(s.cell), t),
                  1e-14);
    }
  };
  for (const bool moves : {false, true}) {
    Scene scene = load(moves ? "field = { array = 'U', files = 'U_*.vtu', spacing = 1.0 }\nsample = ['U', 'C']"
                             : "field = 'U_8'\nsample = ['U_8', 'C_8']");
    EXPECT_EQ(scene.motion.sample.empty(), moves);
    ParticlesScene group;
    group.source = RandomParticles{40};
    scene.particles.push_back(group);
    Simulation simulation(scene);
    ASSERT_EQ(simulation.particles().size(), 40U);
    check(simulation, moves);  // at the start, too
    for (int i = 0; i < 10; ++i) simulation.step();
    check(simulation, moves);
    Simulation other(scene, simulation.checkpoint());
    other.step();
    simulation.step();
    check(other, moves);
    for (std::size_t i = 0; i < 40; ++i) EXPECT_EQ(other.user_data(i)[0], simulation.user_data(i)[0]);
  }
}

// The numbers of a scene's user come first; those of a scalar and of a tensor have its name and its axes.
TEST_F(SceneFields, SamplesStandBehindUserData) {
  MeshData mesh = box();
  mesh.cell_data.push_back({"p", 1, std::vector<double>(mesh.cell_count(), 7.0)});
  DataArray stress{"stress", 6, {}};
  for (std::size_t c = 0; c < mesh.cell_count(); ++c)
    for (int k = 0; k < 6; ++k) stress.values.push_back(k + 0.5);
  mesh.cell_data.push_back(stress);
  Scene scene;
  scene.environment.mesh = mesh;
  scene.user_data = {"age"};
  scene.motion.sample = {"p", "stress"};
  scene.motion.field.at = FieldPlace::points;
  ParticlesScene group;
  group.source = RandomParticles{5};
  group.user_data = {3.0};
  scene.particles.push_back(group);
  const Simulation simulation(scene);
  EXPECT_EQ(simulation.options().user_data, (std::vector<std::string>{"age", "p", "stress_xx", "stress_xy", "stress_xz",
                                                                      "stress_yy", "stress_yz", "stress_zz"}));
  const std::span<const double> numbers = simulation.user_data(4);
  EXPECT_EQ(std::vector<double>(numbers.begin(), numbers.end()),
            (std::vector<double>{3.0, 7.0, 0.5, 1.5, 2.5, 3.5, 4.5, 5.5}));
  scene.motion.sample = {"none"};
  expect_parts(test::error_text([&] { Simulation{scene}; }), {"no array 'none'", "p (1)", "stress (6)"});
}

}  // namespace dartcast::scene_fields_test
