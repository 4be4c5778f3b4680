// Runs that ranks share, against the run of one process: the same files, numbers and hash. Here ranks are threads; with
// processes under MPI: tests/mpi.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/run.hpp"
#include "dartcast/scene_file.hpp"
#include "formats/file_text.hpp"
#include "formats/point_file.hpp"
#include "output/run_files.hpp"
#include "simulation/simulation_view.hpp"
#include "support/run_scenes.hpp"
#include "support/sample_mesh.hpp"
#include "support/thread_ranks.hpp"
#include "support/tier.hpp"
#include "support/uncounted.hpp"

namespace dartcast::ranks_run_test {

namespace fs = std::filesystem;
using Json = nlohmann::json;

struct CutOff : std::exception {
  [[nodiscard]] const char* what() const noexcept override { return "cut off"; }
};

// Runs the scene on so many ranks, with data of a user on each particle; `cut`: after so many steps rank 1, or the only one, fails.
Summary run(const std::string& text, const fs::path& to, unsigned ranks, bool resume = false,
            std::optional<std::uint64_t> steps = {}, std::uint64_t cut = 0,
            Partition partition = Partition::particles) {
  Scene scene = parse_scene(text, "test.toml");
  scene.user_data = {"age", "load"};
  for (std::size_t i = 0; i < scene.particles.size(); ++i) scene.particles[i].user_data = {static_cast<double>(i), 0.5};
  RunOptions options;
  options.folder = to;
  options.resume = resume;
  options.steps = steps;
  options.threads = Threads{1};
  options.audit = true;
  options.partition = partition;
  Summary summary;
  test::on_ranks(ranks, [&](Ranks& r) {
    RunOptions own = options;
    own.ranks = &r;
    const Summary s = run_scene(scene, own, [&](std::uint64_t done, std::uint64_t) {
      if (done == cut && r.rank() == std::min(1U, ranks - 1)) throw CutOff();
      return true;
    });
    if (r.rank() == 0) summary = s;
  });
  return summary;
}

// The particles of a frame, by id: each array's values of a particle one after another.
std::vector<std::vector<double>> particles_of(const fs::path& folder, std::uint64_t step) {
  std::vector<std::vector<double>> rows;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename();
    if (!name.starts_with("particles_") || !name.ends_with(".vtp") || frame_step(name) != step) continue;
    const PointFile frame = read_points(entry.path());
    for (std::size_t i = 0; i < frame.points.size(); ++i) {
      const Vec3& x = frame.points[i];
      std::vector<double>& row = rows.emplace_back(std::vector{x.x, x.y, x.z});
      for (const DataArray& a : frame.arrays) {
        const auto first = a.values.begin() + static_cast<std::ptrdiff_t>(i * a.components);
        row.insert(a.name == "id" ? row.begin() : row.end(), first, first + static_cast<std::ptrdiff_t>(a.components));
      }
    }
  }
  std::sort(rows.begin(), rows.end());
  return rows;
}

// Particles of all frames, whatever the number of pieces; all other files as they are, but those that hold times.
struct Outcome {
  std::map<std::uint64_t, std::vector<std::vector<double>>> frames;
  std::map<std::string, std::string> files;
  Json summary;
};

void erase_times(Json& json) {
  for (const char* key : {"seconds", "ns_per_particle_step", "ranks"}) {
    if (json.is_object()) json.erase(key);
  }
  if (!json.is_structured()) return;
  for (Json& part : json) erase_times(part);
}

Outcome outcome_of(const fs::path& folder) {
  Outcome outcome;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename();
    if (name == "summary.json" || name == "report.html" || name.starts_with("checkpoint")) continue;
    if (const auto step = frame_step(name); step && name.starts_with("particles_")) {
      outcome.frames[*step] = particles_of(folder, *step);
    } else if (name != "particles.pvd") {
      outcome.files[name] = read_bytes(entry.path());
    }
  }
  outcome.summary = Json::parse(read_bytes(folder / "summary.json"));
  erase_times(outcome.summary);
  return outcome;
}

void expect_same(const Outcome& one, const Outcome& many, const std::string& name) {
  EXPECT_EQ(one.summary, many.summary) << name;
  EXPECT_TRUE(one.frames == many.frames) << name;
  for (const auto& [file, content] : one.files) {
    ASSERT_TRUE(many.files.contains(file)) << name << ": " << file;
    EXPECT_TRUE(many.files.at(file) == content) << name << ": " << file;
  }
  EXPECT_EQ(one.files.size(), many.files.size()) << name;
}

const std::map<std::string, std::string>& scenes() {
  static const std::map<std::string, std::string> all = {
      {"scene", test::scene_text}, {"surgery", test::surgery_text},     {"solids", test::solids_text},
      {"tools", test::tools_text}, {"plug flow", test::plug_flow_text}, {"statistics", test::statistics_text}};
  return all;
}

class RanksRun : public testing::Test {
 protected:
  test::Folder folder;
  [[nodiscard]] fs::path at(const std::string& name) const { return folder / name; }
};

TEST_F(RanksRun, OfAnyNumberAreThatOfOneProcess) {
  for (const auto& [name, text] : scenes()) {
    const std::uint64_t steps = name == "plug flow" ? 150 : 47;
    run(text, at(name + "1"), 1, false, steps);
    const Outcome one = outcome_of(at(name + "1"));
    for (const unsigned ranks : test::all_or_first({3U, 2U, 4U})) {
      const fs::path to = at(name + std::to_string(ranks));
      const Summary summary = run(text, to, ranks, false, steps);
      EXPECT_EQ(summary.ranks, ranks);
      expect_same(one, outcome_of(to), name + " on " + std::to_string(ranks) + " ranks");
    }
  }
}

// Every rank has something to do in these tests.
TEST_F(RanksRun, ShareTheParticles) {
  run(test::scene_text, at("shared"), 3);
  for (const char* piece : {"particles_000040.0.vtp", "particles_000040.1.vtp", "particles_000040.2.vtp"}) {
    ASSERT_TRUE(fs::exists(at("shared") / piece)) << piece;
    EXPECT_GT(read_points(at("shared") / piece).points.size(), 20U) << piece;
  }
  EXPECT_NE(read_bytes(at("shared") / "particles_000040.pvtp").find("Source=\"particles_000040.2.vtp\""),
            std::string::npos);
  EXPECT_NE(read_bytes(at("shared") / "particles.pvd").find("particles_000040.pvtp"), std::string::npos);
}

// Readers of frames take the index for the whole, also where a rank has no particles.
TEST_F(RanksRun, AnIndexIsReadAsTheWholeFrame) {
  run(test::scene_text, at("one"), 1);
  run(test::scene_text, at("three"), 3);
  const PointFile one = read_points(at("one") / "particles_000040.vtp");
  const PointFile all = read_points(at("three") / "particles_000040.pvtp");
  EXPECT_EQ(all.points.size(), one.points.size());
  ASSERT_EQ(all.arrays.size(), one.arrays.size());
  for (std::size_t k = 0; k < one.arrays.size(); ++k) {
    EXPECT_EQ(all.arrays[k].name, one.arrays[k].name);
    std::vector<double> expected = one.arrays[k].values;
    std::vector<double> found = all.arrays[k].values;
    std::sort(expected.begin(), expected.end());
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, expected) << one.arrays[k].name;
  }
  run("[environment]\ngenerator = 'box'\n[[particles]]\ncount = 3\n[output]\nevery = 1\n", at("few"), 3, false, 1);
  EXPECT_EQ(read_points(at("few") / "particles_000001.pvtp").points.size(), 3U);
  std::ofstream(at("few") / "outside.pvtp") << "<VTKFile><PPolyData><Piece Source=\"../one/particles_000040.vtp\"/>"
                                               "</PPolyData></VTKFile>";
  EXPECT_THROW(read_points(at("few") / "outside.pvtp"), Error);
}

TEST_F(RanksRun, GoOnWithAnyOtherNumber) {
  for (const char* name : {"scene", "statistics", "solids"}) {
    const std::string& text = scenes().at(name);
    run(text, at("whole"), 1, false, 47);
    const Outcome whole = outcome_of(at("whole"));
    for (const auto [first, second, third] :
         test::all_or_first({std::array{2U, 4U, 1U}, std::array{1U, 3U, 2U}, std::array{4U, 1U, 3U}})) {
      const fs::path to = at(std::string(name) + std::to_string(first));
      EXPECT_THROW(run(text, to, first, false, 47, 13), std::exception);
      EXPECT_THROW(run(text, to, second, true, 47, 34), std::exception);
      run(text, to, third, true, 47);
      expect_same(whole, outcome_of(to), name);
    }
    fs::remove_all(at("whole"));
  }
}

// A failure of one rank ends the run on all.
TEST_F(RanksRun, FailTogether) {
  try {
    run(test::scene_text, at("failed"), 3, false, 47, 20);
    FAIL();
  } catch (const RankFailed& e) {
    EXPECT_STREQ(e.what(), "rank 1: cut off");
  }
}

TEST_F(RanksRun, RefuseTornAndMissingParts) {
  const fs::path to = at("torn");
  EXPECT_THROW(run(test::scene_text, to, 3, false, 47, 25), std::exception);
  const fs::path part = to / "checkpoint_000020.2.bin";
  ASSERT_TRUE(fs::exists(part));
  EXPECT_FALSE(fs::exists(to / "checkpoint_000010.2.bin"));
  const std::string whole = read_bytes(part);
  const auto refusal = [&] {
    try {
      run(test::scene_text, to, 2, true, 47);
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  for (const std::size_t at : {std::size_t{20}, whole.size() / 2, whole.size() - 1}) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] + 1);
    std::ofstream(part, std::ios::binary) << damaged;
    EXPECT_NE(refusal().find("checkpoint_000020.2.bin: the run cannot be resumed: it is damaged"), std::string::npos)
        << at;
  }
  std::ofstream(part, std::ios::binary) << whole.substr(0, whole.size() / 3);
  EXPECT_NE(refusal().find("cannot be resumed"), std::string::npos);
  fs::copy_file(to / "checkpoint_000020.1.bin", part, fs::copy_options::overwrite_existing);
  EXPECT_NE(refusal().find("it is of another checkpoint"), std::string::npos);
  fs::remove(part);
  EXPECT_NE(refusal().find("a part of the checkpoint is missing"), std::string::npos);
  std::ofstream(part, std::ios::binary) << whole;
  EXPECT_EQ(refusal(), "");
}

TEST_F(RanksRun, RefuseSpheresThatCollide) {
  try {
    run(test::spheres_text, at("spheres"), 2);
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("run this scene with one process"), std::string::npos) << e.what();
  }
}

// --- by cells

// In one segment a step, and without a report; run() adds seeds.
std::string spread_scene() {
  std::string text = "# with seeds\n" + test::scene_text + "report = false\n";
  const std::string substeps = "substeps = 2\n";
  return text.erase(text.find(substeps), substeps.size());
}
const std::string spread_text = spread_scene();

// A vessel that beats, with an inlet and two outlets.
const std::string spread_vessel = R"(
[environment]
generator = "vessel"
core = 3
rings = 2
[[deformation]]
kind = "pulse"
amplitude = 0.1
period = 0.1
[[particles]]
count = 500
[[particles]]
inlet = "inlet"
rate = 2000.0
velocity = [0.0, 0.0, 0.2]
[motion]
dt = 0.001
steps = 47
gravity = [0.0, 0.0, 2.0]
[contact]
restitution = 0.8
[contact.patch.outlet_left]
response = "escape"
[contact.patch.outlet_right]
response = "escape"
[output]
every = 10
contacts = true
report = false
)";

Outcome without_environment(Outcome outcome) {
  std::erase_if(outcome.files, [](const auto& file) { return file.first.starts_with("environment"); });
  outcome.summary["environment"].erase("bytes");
  return outcome;
}

// The outcome of one process, as runs by cells have it.
Outcome spread(Outcome one) {
  one = without_environment(std::move(one));
  one.files["stats.csv"] = test::uncounted(one.files["stats.csv"]);
  for (Json& value : one.summary["orientation_tests"]) value = nullptr;
  return one;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  return text.replace(text.find(what), what.size(), by);
}

TEST_F(RanksRun, ByCellsAreThatOfOneProcess) {
  const std::string without = replaced(spread_vessel, "contacts = true\n", "");
  for (const auto& [name, text] : {std::pair{"box", spread_text}, std::pair{"vessel", spread_vessel},
                                   std::pair{"vessel without contacts", without}}) {
    run(text, at(std::string(name) + "1"), 1);
    const Outcome one = spread(outcome_of(at(std::string(name) + "1")));
    if (text != without) EXPECT_GT(one.files.at("contacts.csv").size(), 10'000U);
    for (const unsigned ranks : test::all_or_first({3U, 2U, 4U, 7U})) {
      const fs::path to = at(name + std::to_string(ranks));
      run(text, to, ranks, false, {}, 0, Partition::cells);
      expect_same(one, without_environment(outcome_of(to)), std::string(name) + " on " + std::to_string(ranks));
    }
  }
}

// All particles start in one corner of a box that twists, and spread: the cells must move again and again.
std::string crowd(const fs::path& file, unsigned count) {
  std::ofstream out(file);
  out << "x,y,z\n";
  for (unsigned i = 0; i < count; ++i)
    out << fmt::format("{},{},{}\n", 0.1 + 0.1 * (i % 7), 0.1 + 0.1 * (i % 5), 0.1 + 0.05 * (i % 11));
  std::string fine = replaced(spread_text, "cells = [5, 5, 5]", "cells = [16, 16, 16]\nsize = [5.0, 5.0, 5.0]");
  fine = replaced(fine, "blocked_share", "jitter");
  return replaced(replaced(fine, "count = 200", "positions = \"" + file.string() + "\""), "steps = 47", "steps = 120");
}

TEST_F(RanksRun, ByCellsAreBalanced) {
  const std::string text = crowd(at("crowd.csv"), 500);
  run(text, at("one"), 1);
  const Outcome one = spread(outcome_of(at("one")));
  for (const unsigned ranks : test::all_or_first({3U, 2U, 5U})) {
    const fs::path to = at(std::to_string(ranks));
    run(text, to, ranks, false, {}, 0, Partition::cells);
    expect_same(one, without_environment(outcome_of(to)), std::to_string(ranks));
    for (const char* frame : {"environment_000000", "environment_000050", "environment_000120"}) {
      std::size_t cells = 0;
      for (unsigned r = 0; r < ranks; ++r)
        cells += read_mesh(to / fmt::format("{}.{}.vtu", frame, r)).mesh.cell_count();
      EXPECT_EQ(cells, 4096U) << frame;
    }
  }
  Scene scene = parse_scene(text, "test.toml");
  test::on_ranks(4, [&](Ranks& ranks) {
    Simulation simulation(load_scene_part(scene, ranks).scene, Threads{1}, &ranks, Partition::cells);
    double excess = 0.0;  // of the largest rank over the mean
    for (int step = 0; step < 120; ++step) {
      simulation.step();
      std::vector<std::uint64_t> count(ranks.size());
      count[ranks.rank()] = simulation.particles().size();
      ranks.sum(count);
      const auto all = static_cast<double>(std::accumulate(count.begin(), count.end(), std::uint64_t{0}));
      excess += static_cast<double>(ranks.size() * *std::max_element(count.begin(), count.end())) / all / 120.0;
    }
    EXPECT_LE(excess, 1.7);  // 3.4 where the cells stay
    EXPECT_GE(view_of(simulation).balanced, 3U);
  });
}

// The mesh of the vessel from pieces, with its patches, and from one file: no difference but in its name.
TEST_F(RanksRun, ByCellsReadPieces) {
  MeshData mesh = generate_vessel({.core = 3, .rings = 2});
  check_and_repair(mesh);
  write_mesh(mesh, at("vessel.vtu"));
  write_mesh_parts(mesh, 6, at("vessel.pvtu"));
  const std::string generated = "generator = \"vessel\"\ncore = 3\nrings = 2\n";
  std::string text = replaced(spread_vessel, "kind = \"pulse\"", "kind = \"pulse\"\nfield = \"pulse_direction\"");
  const auto with_mesh = [&](const char* name) {
    std::string file = "mesh = \"" + at(name).string() + "\"\nscale = 0.5\n";
    file += "patches = [\"inlet\", \"outlet_left\", \"outlet_right\"]\n[environment.free]\nregion = [\"lumen\"]\n";
    return replaced(text, generated, file);
  };
  run(with_mesh("vessel.vtu"), at("whole"), 1);
  const Outcome counted = without_environment(outcome_of(at("whole")));
  Outcome whole = spread(counted);
  whole.files.erase("scene.toml");
  run(with_mesh("vessel.pvtu"), at("one"), 1);
  for (const unsigned ranks : test::all_or_first({4U, 2U, 6U})) {
    run(with_mesh("vessel.pvtu"), at("pieces"), ranks, false, {}, 0, Partition::cells);
    Outcome pieces = without_environment(outcome_of(at("pieces")));
    pieces.files.erase("scene.toml");
    expect_same(whole, pieces, std::to_string(ranks));
    fs::remove_all(at("pieces"));
  }
  Outcome one = without_environment(outcome_of(at("one")));
  one.files.erase("scene.toml");
  one.files["scene.toml"] = counted.files.at("scene.toml");
  expect_same(counted, one, "one process");
  EXPECT_THROW(run(with_mesh("vessel.pvtu"), at("too many"), 7, false, {}, 0, Partition::cells), Error);
}

// A part of one is the whole mesh, with its patches alone.
TEST_F(RanksRun, OneMayHaveTheOnlyPart) {
  Scene scene = parse_scene(spread_text, "test.toml");
  const auto hash_of = [&] {
    Simulation simulation(scene, Threads{1});
    for (int step = 0; step < 20; ++step) simulation.step();
    EXPECT_EQ(simulation.totals().contacts_by_patch.size(), 7U);
    return simulation.state_hash();
  };
  BoxOptions box = std::get<BoxOptions>(scene.environment.mesh);
  box.blocked_share = 0.0;
  scene.environment.mesh = box;
  const StateHash whole = hash_of();
  scene.environment.mesh = box_part(box, 1, 0);
  EXPECT_EQ(hash_of(), whole);
  scene.environment.mesh = box_part(box, 2, 0);
  EXPECT_THROW(Simulation(scene, Threads{1}), InvalidArgument);
}

// A checkpoint does not depend on how the ranks shared the run.
TEST_F(RanksRun, ByCellsGoOnWithAnyOtherNumber) {
  run(spread_text, at("whole"), 1);
  const Outcome whole = spread(outcome_of(at("whole")));
  const fs::path to = at("in turn");
  EXPECT_THROW(run(spread_text, to, 3, false, 47, 13, Partition::cells), std::exception);
  EXPECT_THROW(run(spread_text, to, 2, true, 47, 24), std::exception);
  EXPECT_THROW(run(spread_text, to, 4, true, 47, 34, Partition::cells), std::exception);
  run(spread_text, to, 1, true, 47);
  expect_same(whole, without_environment(outcome_of(to)), "in turn");
  // From a checkpoint of one process: the rows before it have counts.
  const fs::path later = at("later");
  EXPECT_THROW(run(spread_text, later, 1, false, 47, 24), std::exception);
  run(spread_text, later, 2, true, 47, 0, Partition::cells);
  const Outcome mixed = without_environment(outcome_of(later));
  const std::string counted = read_bytes(at("whole") / "stats.csv");
  EXPECT_EQ(test::uncounted(mixed.files.at("stats.csv")), test::uncounted(counted));
  EXPECT_EQ(mixed.files.at("stats.csv").substr(0, 400), counted.substr(0, 400));
  EXPECT_EQ(mixed.summary, whole.summary);
}

// Each cell is in one piece, at the places of its rank's vertices.
TEST_F(RanksRun, ByCellsHaveFramesOfEachPart) {
  run(spread_text, at("one"), 1);
  run(spread_text, at("parts"), 3, false, {}, 0, Partition::cells);
  const MeshData whole = read_mesh(at("one") / "environment_000040.vtu").mesh;
  std::size_t cells = 0;
  for (int piece = 0; piece < 3; ++piece) {
    const MeshData part = read_mesh(at("parts") / ("environment_000040." + std::to_string(piece) + ".vtu")).mesh;
    const auto source = std::find_if(part.cell_data.begin(), part.cell_data.end(),
                                     [](const DataArray& a) { return a.name == "source"; });
    ASSERT_NE(source, part.cell_data.end());
    for (std::size_t c = 0; c < part.cell_count(); ++c) {
      const auto corners = part.cell(c);
      const auto expected = whole.cell(static_cast<std::size_t>(source->values[c]));
      for (std::size_t k = 0; k < corners.size(); ++k) EXPECT_EQ(part.points[corners[k]], whole.points[expected[k]]);
    }
    cells += part.cell_count();
  }
  EXPECT_EQ(cells, whole.cell_count());
  EXPECT_NE(read_bytes(at("parts") / "environment_000040.pvtu").find("environment_000040.2.vtu"), std::string::npos);
  EXPECT_NE(read_bytes(at("parts") / "environment.pvd").find("environment_000040.pvtu"), std::string::npos);
}

TEST_F(RanksRun, ByCellsSayWhatCannotBeSpread) {
  const auto refusal = [&](const std::string& text) {
    try {
      run(text, at("refused"), 2, false, 1, 0, Partition::cells);
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  for (const auto& [text, part] : {std::pair{test::surgery_text, "edits"}, std::pair{test::solids_text, "bodies"},
                                   std::pair{test::tools_text, "solids"}, std::pair{test::plug_flow_text, "statistics"},
                                   std::pair{test::scene_text, "substeps"}}) {
    const std::string error = refusal(text);
    EXPECT_NE(error.find(std::string("a scene with ") + part), std::string::npos) << error;
    EXPECT_NE(error.find("leave --partition cells out"), std::string::npos) << error;
  }
  write_mesh(generate_box({}), at("box.vtu"));
  const std::string file = "'" + at("box.vtu").string() + "'";
  const std::string frames = refusal("[environment]\nmesh = " + file + "\nskip_bad_cells = true\n[[deformation]]\n" +
                                     "kind = 'frames'\nfiles = [" + file + "]\ntimes = [0]\n");
  EXPECT_NE(frames.find("cells to leave out, with frames,"), std::string::npos) << frames;
  EXPECT_NE(refusal("[environment]\ngenerator = 'maze'\n").find("meshes of the plane"), std::string::npos);
  EXPECT_NE(refusal("[environment]\ngenerator = 'box'\ncells = [1, 1, 1]\n").find("2 parts of 1 cubes"),
            std::string::npos);
}

}  // namespace dartcast::ranks_run_test
