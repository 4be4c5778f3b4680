#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include "dartcast/error.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/run.hpp"
#include "dartcast/scene_file.hpp"
#include "formats/file_text.hpp"
#include "support/run_scenes.hpp"
#include "support/sample_mesh.hpp"
#include "support/tier.hpp"

namespace dartcast::resume_test {

namespace fs = std::filesystem;
using test::edges_text;
using test::scene_text;
using test::solids_text;
using test::spheres_text;
using test::surgery_text;
using test::tools_text;

struct CutOff : std::exception {};

class Resume : public testing::Test {
 protected:
  static Summary run(const fs::path& to, bool resume, std::uint64_t steps, const std::string& text,
                     const Progress& progress) {
    RunOptions options;
    options.folder = to;
    options.resume = resume;
    options.steps = steps;
    options.audit = true;
    return run_scene(parse_scene(text, "test.toml"), options, progress);
  }
  // Runs the scene; cut off after `cut` steps where that is not 0.
  static Summary run(const fs::path& to, bool resume, std::uint64_t steps, std::uint64_t cut = 0,
                     const std::string& text = scene_text) {
    return run(to, resume, steps, text, [&](std::uint64_t done, std::uint64_t) {
      if (done == cut) throw CutOff();
      return true;
    });
  }

  // All files but those with times in them: timings, and the checkpoint that repeats them.
  static std::map<std::string, std::string> files(const fs::path& of) {
    std::map<std::string, std::string> result;
    for (const auto& entry : fs::directory_iterator(of)) {
      const std::string name = entry.path().filename();
      if (name != "summary.json" && name != "checkpoint.bin" && name != "report.html")
        result[name] = read_bytes(entry.path());
    }
    return result;
  }

  void expect_same(const Summary& whole, const Summary& resumed) const {
    EXPECT_EQ(resumed.state_hash, whole.state_hash);
    EXPECT_EQ(resumed.steps, whole.steps);
    EXPECT_EQ(resumed.held, whole.held);
    EXPECT_EQ(resumed.audit->checked, whole.audit->checked);
    EXPECT_EQ(resumed.audit->failed, 0U);
    EXPECT_EQ(resumed.totals.injected, whole.totals.injected);
    EXPECT_EQ(resumed.totals.contacts_by_patch, whole.totals.contacts_by_patch);
    EXPECT_EQ(resumed.totals.deposited_by_patch, whole.totals.deposited_by_patch);
    EXPECT_EQ(resumed.totals.escaped_by_patch, whole.totals.escaped_by_patch);
    EXPECT_EQ(resumed.totals.counters.histogram, whole.totals.counters.histogram);
    const auto expected = files(one);
    const auto found = files(two);
    for (const auto& [name, content] : expected) {
      ASSERT_TRUE(found.contains(name)) << name;
      EXPECT_TRUE(found.at(name) == content) << name;
    }
    EXPECT_EQ(found.size(), expected.size());
  }

  std::string failure(const std::string& text = scene_text) const {
    try {
      run(two, true, 47, 0, text);
    } catch (const Error& e) {
      return e.what();
    }
    return {};
  }

  test::Folder temporary;
  fs::path one = temporary / "one";
  fs::path two = temporary / "two";
};

// Without the key the interval follows from the steps of the run that began, and stays with --resume.
TEST_F(Resume, TheIntervalOfFramesIsKept) {
  std::string text = scene_text;
  text.erase(text.find("every = 10\n"), 11);
  RunOptions options;
  ExpectedOutput expected;
  const auto go = [&](const fs::path& to, std::uint64_t steps, bool resume) {
    options.folder = to;
    options.steps = steps;
    options.resume = resume;
    run_scene(parse_scene(text, "test.toml"), options, {}, [&](const ExpectedOutput& e) { expected = e; });
  };
  go(one, 47, false);
  EXPECT_EQ(expected.every, 10U);
  EXPECT_EQ(expected.frames, 6U);
  if (test::sanitized()) return;  // a thousand steps take a minute there
  go(two, 1001, false);
  EXPECT_EQ(expected.every, 11U);
  EXPECT_EQ(expected.frames, 92U);
  EXPECT_GT(expected.bytes, 92U * 5000);
  EXPECT_TRUE(fs::exists(two / "particles_000011.vtp"));
  EXPECT_FALSE(fs::exists(two / "particles_000010.vtp"));
  go(two, 1201, true);
  EXPECT_EQ(expected.every, 11U);
  EXPECT_EQ(expected.frames, 19U);
  EXPECT_TRUE(fs::exists(two / "particles_001199.vtp"));
}

TEST_F(Resume, ARunCutOffAnywhereEndsAsIfItWereNot) {
  const Summary whole = run(one, false, 47);
  EXPECT_GT(whole.totals.absorbed, 0U);
  EXPECT_GT(whole.totals.escaped, 0U);
  for (const std::uint64_t cut : test::all_or_first({10U, 1U, 9U, 23U, 46U})) {
    EXPECT_THROW(run(two, false, 47, cut), CutOff);
    expect_same(whole, run(two, true, 47));
  }
}

// Bodies that lie on each other and a catheter at walls go on from the impulses and walls that they had.
TEST_F(Resume, BodiesAndCathetersGoOnFromTheirContacts) {
  const std::string scene = R"(
[environment]
generator = "box"
cells = [5, 5, 5]
size = [0.5, 0.5, 0.5]
[[body]]
generator = "barrel"
radius = 0.05
bulge = 0.01
height = 0.12
spacing = 0.03
at = [0.25, 0.25, 0.08]
[[body]]
generator = "barrel"
radius = 0.05
bulge = 0.01
height = 0.12
spacing = 0.03
at = [0.26, 0.26, 0.2]
velocity = [0.0, 0.0, -1.0]
[[catheter]]
entry = [0.02, 0.1, 0.1]
direction = [1.0, 0.3, 0.2]
length = 0.7
spacing = 0.01
moves = [{ until = 2.0, push = 2.0, turn = 1.0 }]
[motion]
dt = 0.005
steps = 80
gravity = [0.0, 0.0, -9.81]
[collisions]
body_friction = 0.3
[output]
every = 10
)";
  const Summary whole = run(one, false, 80, 0, scene);
  EXPECT_GT(whole.catheters.at(0).inserted, 0.5);  // longer than the box
  for (const std::uint64_t cut : test::all_or_first({55U, 35U, 75U})) {
    EXPECT_THROW(run(two, false, 80, cut, scene), CutOff);
    expect_same(whole, run(two, true, 80, 0, scene));
  }
}

TEST_F(Resume, ARunCutOffAgainAndAgainComesToTheSameEnd) {
  const Summary whole = run(one, false, 47);
  for (const std::uint64_t cut : {12U, 13U, 25U, 46U}) EXPECT_THROW(run(two, true, 47, cut), CutOff);
  expect_same(whole, run(two, true, 47));
}

TEST_F(Resume, SolidsGoOnAtWalls) {
  const Summary whole = run(one, false, 47, 0, tools_text);
  ASSERT_EQ(whole.solids.size(), 2U);
  for (const SolidSummary& solid : whole.solids) EXPECT_GT(solid.stopped, 0U) << solid.name;
  EXPECT_EQ(whole.lost, 0U);
  for (const std::uint64_t cut : test::all_or_first({14U, 9U, 31U})) {
    EXPECT_THROW(run(two, false, 47, cut, tools_text), CutOff);
    const Summary resumed = run(two, true, 47, 0, tools_text);
    expect_same(whole, resumed);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(resumed.solids[i].contacts, whole.solids[i].contacts);
      EXPECT_EQ(resumed.solids[i].stopped, whole.solids[i].stopped);
    }
  }
  EXPECT_GT(fs::file_size(one / "solid_contacts.csv"), 500U);
  EXPECT_TRUE(fs::exists(one / "solid_needle_000040.vtp"));
  EXPECT_TRUE(fs::exists(one / "solid_solid1.pvd"));
}

TEST_F(Resume, EdgesGoOnAtWalls) {
  const Summary whole = run(one, false, 47, 0, edges_text);
  EXPECT_EQ(whole.lost, 0U);
  for (const std::uint64_t cut : test::all_or_first({14U, 9U, 31U})) {
    EXPECT_THROW(run(two, false, 47, cut, edges_text), CutOff);
    expect_same(whole, run(two, true, 47, 0, edges_text));
  }
  const std::string contacts = read_bytes(one / "solid_contacts.csv");
  EXPECT_NE(contacts.find(",solid1,"), std::string::npos);
  EXPECT_NE(contacts.find(",body1,"), std::string::npos);
}

TEST_F(Resume, ARunWithSurgeryIsOperatedOnAgain) {
  const Summary whole = run(one, false, 47, 0, surgery_text);
  ASSERT_EQ(whole.surgery->events.size(), 4U);
  EXPECT_GT(whole.surgery->in_opened, 0U);
  EXPECT_GT(whole.surgery->mended, 0U);
  EXPECT_GT(whole.totals.absorbed, 0U);
  EXPECT_EQ(whole.lost, 0U);
  for (const std::uint64_t cut : test::all_or_first({16U, 4U, 11U, 46U})) {
    EXPECT_THROW(run(two, false, 47, cut, surgery_text), CutOff);
    const Summary resumed = run(two, true, 47, 0, surgery_text);
    expect_same(whole, resumed);
    EXPECT_EQ(resumed.surgery->in_opened, whole.surgery->in_opened);
    EXPECT_EQ(resumed.surgery->mended, whole.surgery->mended);
    ASSERT_EQ(resumed.surgery->events.size(), 4U);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(resumed.surgery->events[i].particles_touched, whole.surgery->events[i].particles_touched);
      EXPECT_EQ(resumed.surgery->events[i].cells_added, whole.surgery->events[i].cells_added);
    }
  }
}

TEST_F(Resume, ARunWithSpheresAndCrowdedCellsGoesOn) {
  const Summary whole = run(one, false, 47, 0, spheres_text);
  EXPECT_GT(whole.totals.collisions.pairs_touching, 0U);
  EXPECT_GT(whole.surgery->subdivided, 0U);
  EXPECT_GT(whole.surgery->merged, 0U);
  EXPECT_EQ(whole.lost, 0U);
  for (const std::uint64_t cut : test::all_or_first({31U, 4U, 16U, 46U})) {
    EXPECT_THROW(run(two, false, 47, cut, spheres_text), CutOff);
    const Summary resumed = run(two, true, 47, 0, spheres_text);
    expect_same(whole, resumed);
    EXPECT_EQ(resumed.totals.collisions.pairs_touching, whole.totals.collisions.pairs_touching);
    EXPECT_EQ(resumed.surgery->subdivided, whole.surgery->subdivided);
    EXPECT_EQ(resumed.surgery->merged, whole.surgery->merged);
  }
}

TEST_F(Resume, ARunWithBodiesAndACatheterGoesOn) {
  const Summary whole = run(one, false, 47, 0, solids_text);
  EXPECT_EQ(whole.audit->failed, 0U);
  EXPECT_EQ(whole.lost, 0U);
  ASSERT_EQ(whole.bodies.size(), 2U);
  ASSERT_EQ(whole.catheters.size(), 1U);
  EXPECT_GT(whole.catheters[0].inserted, 0.1);
  EXPECT_LE(whole.catheters[0].totals.worst_segment, 0.01);
  for (const std::uint64_t cut : test::all_or_first({26U, 4U, 11U, 46U})) {
    EXPECT_THROW(run(two, false, 47, cut, solids_text), CutOff);
    const Summary resumed = run(two, true, 47, 0, solids_text);
    expect_same(whole, resumed);
    EXPECT_EQ(resumed.bodies[0].energy.kinetic, whole.bodies[0].energy.kinetic);
    EXPECT_EQ(resumed.catheters[0].totals.refused, whole.catheters[0].totals.refused);
  }
}

TEST_F(Resume, ARunWithSpheresThatMeetBodiesGoesOn) {
  const std::string text = solids_text + R"(
[[particles]]
count = 150
radius = 0.02
velocity = [0.0, 0.0, -1.0]
[collisions]
restitution = 0.3
friction = 0.3
body_restitution = 0.5
)";
  const Summary whole = run(one, false, 47, 0, text);
  EXPECT_GT(whole.totals.collisions.pairs_touching, 0U);
  EXPECT_EQ(whole.audit->failed, 0U);
  for (const std::uint64_t cut : test::all_or_first({26U, 4U, 46U})) {
    EXPECT_THROW(run(two, false, 47, cut, text), CutOff);
    const Summary resumed = run(two, true, 47, 0, text);
    expect_same(whole, resumed);
    EXPECT_EQ(resumed.bodies[0].energy.kinetic, whole.bodies[0].energy.kinetic);
    EXPECT_EQ(resumed.totals.collisions.pairs_touching, whole.totals.collisions.pairs_touching);
  }
}

// A signal stops it so: it writes a frame of that moment, which no run has that goes through. Cells are edited before
// step 16 and 31.
TEST_F(Resume, ARunStoppedAnywhereEndsAsIfItWereNot) {
  for (const std::string& text : {surgery_text, test::statistics_text, spheres_text}) {
    const Summary whole = run(one, false, 47, 0, text);
    for (const std::uint64_t stop : test::all_or_first({16U, 4U, 20U, 31U})) {
      const auto goes_on = [&](std::uint64_t done, std::uint64_t) { return done < stop; };
      EXPECT_TRUE(run(two, false, 47, text, goes_on).cancelled);
      expect_same(whole, run(two, true, 47, 0, text));
    }
  }
}

TEST_F(Resume, AFinishedRunGoesOnToMoreSteps) {
  const Summary whole = run(one, false, 47);
  run(two, false, 25);
  expect_same(whole, run(two, true, 47));
  expect_same(whole, run(two, true, 47));  // nothing left to do
  EXPECT_THROW(run(two, true, 46), Error);
}

TEST_F(Resume, WithoutACheckpointItStarts) { expect_same(run(one, false, 47), run(two, true, 47)); }

TEST_F(Resume, AnotherSceneMeshOrSeedIsRefused) {
  run(two, false, 10);
  const auto before = files(two);
  EXPECT_NE(failure(scene_text + "\n").find("the scene has changed"), std::string::npos);
  RunOptions options;
  options.folder = two;
  options.resume = true;
  options.seed = 6;
  EXPECT_THROW(run_scene(parse_scene(scene_text, "test.toml"), options), Error);
  EXPECT_EQ(files(two), before);
}

// Whatever byte of a checkpoint is damaged, or wherever it ends: an error, and nothing else.
TEST_F(Resume, ADamagedCheckpointIsRefused) {
  run(two, false, 10);
  const std::string good = read_bytes(two / "checkpoint.bin");
  const auto before = files(two);
  const auto expect_refused = [&](const std::string& bytes) {
    write_bytes(two / "checkpoint.bin", bytes);
    EXPECT_NE(failure().find("checkpoint.bin: the run cannot be resumed"), std::string::npos);
  };
  for (std::size_t i = 0; i < good.size(); i += good.size() / 50 + 1) {
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ 0x10);
    expect_refused(bad);
    expect_refused(good.substr(0, i));
  }
  expect_refused(good + "x");
  EXPECT_EQ(files(two), before);
  write_bytes(two / "checkpoint.bin", good);
  fs::resize_file(two / "stats.csv", fs::file_size(two / "stats.csv") - 1);
  EXPECT_NE(failure().find("stats.csv: the file is shorter"), std::string::npos);
}

}  // namespace dartcast::resume_test
