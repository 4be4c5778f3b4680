// Cases of OpenFOAM in scenes: times as frames and as fields, whole and in parts; the cases made by others.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/scene_file.hpp"
#include "dartcast/simulation.hpp"
#include "mesh/point_weights.hpp"
#include "support/expectations.hpp"
#include "support/foam_case.hpp"
#include "support/shared_data.hpp"

namespace dartcast::openfoam_scene_test {

namespace fs = std::filesystem;
using test::FoamStyle;
using test::FoamWriter;

MeshData box() {
  BoxOptions o;
  o.cells = {4, 3, 3};
  o.size = {1.0, 1.0, 1.0};
  return generate_box(o);
}

std::vector<Vec3> swayed(std::vector<Vec3> points, double t) {
  for (Vec3& x : points) x.x += 0.1 * t * x.y;
  return points;
}

std::vector<Vec3> velocities(std::size_t count, double t) {
  std::vector<Vec3> values;
  for (std::size_t c = 0; c < count; ++c) values.push_back({0.01 * static_cast<double>(c), 1.0 / 3.0, t});
  return values;
}

const std::map<std::string, double> times = {{"0.25", 0.25}, {"1", 1.0}, {"10", 10.0}, {"2e1", 20.0}};

class OpenFoamScene : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              fmt::format("openfoam_{}", ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// A case with points and U at all times, and what OpenFOAM leaves beside them.
  void write_case(const std::string& name, const FoamStyle& style) const {
    const MeshData mesh = box();
    const FoamWriter writer(folder_ / name, style);
    writer.write(test::foam_mesh(mesh));
    for (const auto& [time, t] : times) {
      writer.points(time, swayed(mesh.points, t));
      writer.field(time, "U", velocities(mesh.cell_count(), t));
      writer.file(time + "/p", "volScalarField", "dimensions [0 0 0 0 0 0 0];\ninternalField uniform 7;\n");
      writer.file(time + "/phi", "surfaceScalarField", "internalField uniform 0;");
      write_bytes(folder_ / name / time / "notes.txt", "nothing");
    }
    fs::create_directories(folder_ / name / "system");
    write_bytes(folder_ / name / "any.foam", "");
  }

  [[nodiscard]] Scene load(const std::string& text) const {
    return load_scene_files(parse_scene("[environment]\nmesh = 'case'\n" + text, folder_ / "scene.toml")).scene;
  }

  void expect_error(const std::string& text, std::initializer_list<const char*> words) const {
    SCOPED_TRACE(text);
    test::expect_parts(test::error_text([&] { static_cast<void>(load(text)); }), words);
  }

  fs::path folder_;
};

TEST_F(OpenFoamScene, TimesAreFramesFromConstantOn) {
  for (const FoamStyle& style : test::foam_styles()) {
    fs::remove_all(folder_ / "case");
    write_case("case", style);
    for (const char* name : {"case", "case/", "case/any.foam"}) {
      const Scene scene = load(fmt::format("[[deformation]]\nkind = 'frames'\nfiles = '{}'\n", name));
      const DeformationStep& step = scene.deformation.front().step;
      EXPECT_EQ(step.times, (std::vector<double>{0.0, 0.25, 1.0, 10.0, 20.0}));
      for (std::size_t k = 0; k < step.times.size(); ++k)
        EXPECT_EQ(step.reader(k), swayed(box().points, step.times[k])) << k;
    }
  }
}

// The times of a steady case are iterations: the last one counts.
TEST_F(OpenFoamScene, TheLastTimeOfASteadyCaseIsItsField) {
  write_case("case", {});
  const auto samples = [&](const std::string& keys) {
    return load("[motion]\nfield = { array = 'U', files = ['case'], at = 'cells'" + keys + " }\n").motion.field.samples;
  };
  const auto write_schemes = [&](const std::string& text) {
    write_bytes(folder_ / "case/system/fvSchemes",
                "FoamFile { version 2.0; format ascii; class dictionary; object fvSchemes; }\n" + text);
  };
  EXPECT_EQ(samples("").times.size(), 4U);
  EXPECT_EQ(samples(", steady = true").times, std::vector<double>{0.0});
  EXPECT_EQ(samples(", steady = true").read(0), velocities(box().cell_count(), 20.0));
  for (const char* text :
       {"ddtSchemes { default steadyState; }\n",
        "// ddtSchemes { default Euler; }\ngradSchemes { default Gauss linear; }\nddtSchemes\n{\n  ddt(U) "
        "Euler;\n  default  steadyState;\n}\n"}) {
    write_schemes(text);
    EXPECT_EQ(samples("").times, std::vector<double>{0.0}) << text;
    EXPECT_EQ(samples("").read(0), velocities(box().cell_count(), 20.0));
    EXPECT_EQ(samples(", steady = false").times.size(), 4U);
  }
  for (const char* text :
       {"ddtSchemes { default Euler; }\n", "gradSchemes { default steadyState; }\n", "ddtSchemes {", "}"}) {
    write_schemes(text);
    EXPECT_EQ(samples("").times.size(), 4U) << text;
  }
  expect_error("[motion]\nfield = { array = 'U', steady = true }\n", {"steady belongs to files"});
}

TEST_F(OpenFoamScene, APlaceAtZeroIsTheFirstFrame) {
  write_case("case", {});
  FoamWriter(folder_ / "case", {}).points("0", swayed(box().points, 3.0));
  const Scene scene = load("scale = 2\n[[deformation]]\nkind = 'frames'\nfiles = 'case'\n");
  const DeformationStep& step = scene.deformation.front().step;
  EXPECT_EQ(step.times.size(), 5U);
  std::vector<Vec3> expected = swayed(box().points, 3.0);
  for (Vec3& x : expected) x *= 2.0;
  EXPECT_EQ(step.reader(0), expected);
}

TEST_F(OpenFoamScene, FramesRepeatAndAreInterpolated) {
  write_case("case", {});
  const Scene scene =
      load("[[deformation]]\nkind = 'frames'\nfiles = 'case'\ninterpolation = 'cubic'\nperiod = 25.0\n");
  EXPECT_EQ(scene.deformation.front().step.interpolation, Interpolation::cubic);
  EXPECT_EQ(scene.deformation.front().step.cycle, 25.0);
  expect_error("[[deformation]]\nkind = 'frames'\nfiles = 'case'\ninterpolation = 'square'\n",
               {"square", "linear, cubic"});
}

TEST_F(OpenFoamScene, OtherSeriesOfFrames) {
  write_case("case", {});
  MeshData mesh = box();
  std::string pvd = "<VTKFile type=\"Collection\"><Collection>";
  for (const int k : {8, 9, 10}) {
    mesh.points = swayed(box().points, k);
    write_mesh(mesh, folder_ / fmt::format("beat_{}.msh", k));
    pvd += fmt::format("<DataSet timestep=\"{}\" file=\"beat_{}.msh\"/>", 0.5 * k, k);
  }
  write_bytes(folder_ / "beat.pvd", pvd + "</Collection></VTKFile>");
  const auto step = [&](const std::string& keys) {
    return load("[[deformation]]\nkind = 'frames'\n" + keys).deformation.front().step;
  };
  const DeformationStep numbered = step("files = 'beat_*.msh'\nspacing = 0.1\n");
  EXPECT_EQ(numbered.times, (std::vector<double>{0.0, 0.1, 0.2}));
  EXPECT_EQ(numbered.reader(2), swayed(box().points, 10));
  const DeformationStep collection = step("files = 'beat.pvd'\n");
  EXPECT_EQ(collection.times, (std::vector<double>{4.0, 4.5, 5.0}));
  EXPECT_EQ(collection.reader(1), swayed(box().points, 9));
  EXPECT_EQ(step("files = 'beat_*.msh'\ntimes = [1, 2, 4]\n").times, (std::vector<double>{1.0, 2.0, 4.0}));
  const std::string kind = "[[deformation]]\nkind = 'frames'\n";
  expect_error(kind + "files = 'beat_*.msh'\n", {"deformation", "no times"});
  expect_error(kind + "files = 'beat_*.msh'\ntimes = [0, 1]\n", {"2 times for 3 files"});
  expect_error(kind + "files = 'beat_*.msh'\ntimes = [0, 2, 2]\n", {"beat_10.msh", "its time 2", "after"});
  expect_error(kind + "files = 'beat_*.msh'\ntimes = [nan, 1, 2]\n", {"times must be finite"});
  expect_error(kind + "files = 'beat.pvd'\nspacing = 1\n", {"times of its own"});
  expect_error(kind + "files = 'none_*.msh'\nspacing = 1\n", {"none_*.msh"});
  expect_error(kind + "files = ['beat_8.msh', 'beat_9.msh']\n", {"0 times for 2 files"});
}

TEST_F(OpenFoamScene, FieldsAreSamplesAtTheirTimes) {
  for (const FoamStyle& style : test::foam_styles()) {
    fs::remove_all(folder_ / "case");
    write_case("case", style);
    const Scene scene = load("[motion]\nfield = { array = 'U', files = 'case', at = 'cells' }\n");
    const FieldSamples& samples = scene.motion.field.samples;
    EXPECT_EQ(samples.times, (std::vector<double>{0.25, 1.0, 10.0, 20.0}));
    EXPECT_EQ(samples.place, FieldPlace::cells);
    for (std::size_t k = 0; k < samples.times.size(); ++k)
      EXPECT_EQ(samples.read(k), velocities(box().cell_count(), samples.times[k])) << k;
  }
}

TEST_F(OpenFoamScene, UniformAndPointFields) {
  write_case("case", {});
  const FoamWriter writer(folder_ / "case", {});
  writer.file("1/V", "volVectorField", "internalField uniform (1 2 3);");
  writer.field("1", "W", swayed(box().points, 2.0), "pointVectorField");
  const auto samples = [&](const std::string& array) {
    return load(fmt::format("[motion]\nfield = {{ array = '{}', files = ['case'] }}\n", array)).motion.field.samples;
  };
  EXPECT_EQ(samples("V").place, FieldPlace::points);
  EXPECT_EQ(samples("V").read(0), std::vector<Vec3>(box().points.size(), Vec3{1, 2, 3}));
  EXPECT_EQ(samples("W").place, FieldPlace::points);
  EXPECT_EQ(samples("W").read(0), swayed(box().points, 2.0));
}

TEST_F(OpenFoamScene, FieldsWithMacrosAndIncludedFiles) {
  write_case("case", {});
  const FoamWriter writer(folder_ / "case", {});
  const auto field = [&](const std::string& name, const std::string& text) {
    writer.file("1/" + name, "volVectorField", text);
  };
  fs::create_directories(folder_ / "case/1/include");
  write_bytes(folder_ / "case/1/include/values", "x 0.5; // m/s\nall (1 $x 3);\n#include \"more\"\nnever { x 1; }\n");
  write_bytes(folder_ / "case/1/include/more", "y $x;");
  const std::string include = "#include \"include/values\"\n#inputMode merge\n";
  const std::string rest =
      "boundaryField\n{\n  #includeEtc \"caseDicts/setConstraintTypes\"\n  a { value $internalField; }\n}\n";
  field("V", include + "internalField uniform ($x ${y} 2);\n" + rest);
  field("W", include + "whole uniform $all;\ninternalField $whole;\n" + rest);
  field("unknown", "#includeEtc \"values\"\ninternalField uniform\n  $all;\n");
  field("round", "a $b;\nb $a;\ninternalField uniform $a;\n");
  const auto read = [&](const std::string& array) {
    const std::string text = fmt::format("[motion]\nfield = {{ array = '{}', files = ['case'] }}\n", array);
    return load(text).motion.field.samples.read(0).front();
  };
  EXPECT_EQ(read("V"), (Vec3{0.5, 0.5, 2}));
  EXPECT_EQ(read("W"), (Vec3{1, 0.5, 3}));
  expect_error("[motion]\nfield = { array = 'unknown', files = ['case'] }\n", {"1/unknown", "line 14", "'$all'"});
  expect_error("[motion]\nfield = { array = 'round', files = ['case'] }\n", {"1/round", "'$"});
  // Nobody asks for the others: what is wrong there is a warning.
  const MeshFile file = read_mesh(folder_ / "case/1");
  ASSERT_TRUE(file.report.valid());
  EXPECT_EQ(file.report.warnings.size(), 2U);
}

TEST_F(OpenFoamScene, ATimeIsAMeshWithItsArrays) {
  write_case("case", {});
  const MeshFile file = read_mesh(folder_ / "case/10");
  ASSERT_TRUE(file.report.valid());
  EXPECT_EQ(file.mesh.points, swayed(box().points, 10.0));
  ASSERT_EQ(file.mesh.cell_data.size(), 2U);
  EXPECT_EQ(file.mesh.cell_data[0].name, "U");
  EXPECT_EQ(file.mesh.cell_data[1].values, std::vector<double>(box().cell_count(), 7.0));
  // A time without points has those of the last one before it.
  fs::remove_all(folder_ / "case/10/polyMesh");
  EXPECT_EQ(read_mesh(folder_ / "case/10").mesh.points, swayed(box().points, 1.0));
}

TEST_F(OpenFoamScene, PartsOfSeveralProcessors) {
  const MeshData mesh = box();
  std::vector<std::size_t> part;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) part.push_back(c % 3);
  const FoamStyle style = {.binary = true};
  test::write_foam_parts(folder_ / "case", style, test::foam_mesh(mesh), part);
  for (const auto& [time, t] : times) {
    for (std::size_t k = 0; k < 3; ++k) {
      const fs::path processor = folder_ / fmt::format("case/processor{}", k);
      std::vector<Vec3> values;
      for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
        if (part[c] == k) values.push_back(velocities(mesh.cell_count(), t)[c]);
      }
      FoamWriter(processor, style).field(time, "U", values);
    }
  }
  const Scene scene = load("[motion]\nfield = { array = 'U', files = 'case', at = 'cells' }\n");
  const FieldSamples& samples = scene.motion.field.samples;
  ASSERT_EQ(samples.times.size(), times.size());
  for (std::size_t k = 0; k < samples.times.size(); ++k)
    EXPECT_EQ(samples.read(k), velocities(mesh.cell_count(), samples.times[k])) << k;
  // With a mesh of the whole the parts still have the fields.
  FoamWriter(folder_ / "case", {}).write(test::foam_mesh(mesh));
  EXPECT_EQ(load("[motion]\nfield = { array = 'U', files = 'case', at = 'cells' }\n").motion.field.samples.read(1),
            velocities(mesh.cell_count(), samples.times[1]));
}

// Fields at cells, brought to points.

std::string vector_list(const std::vector<Vec3>& values) {
  std::string text = fmt::format("nonuniform List<vector> {} (", values.size());
  for (const Vec3& v : values) text += fmt::format("({} {} {})", v.x, v.y, v.z);
  return text + ")";
}

Vec3 shear(const Vec3& x, double t) { return {1.0 + x.y + t, 0.5 * x.z, 0.25 * x.x}; }

// The middles of the faces of a patch, as the case lists them.
std::vector<Vec3> middles_of_patch(const test::FoamMesh& mesh, const std::string& name) {
  std::vector<Vec3> middles;
  std::size_t first = mesh.neighbour.size();
  for (const auto& patch : mesh.patches) {
    for (std::size_t f = first; f < first + patch.size && patch.name == name; ++f) {
      Vec3 sum;
      for (const std::int64_t p : mesh.faces[f]) sum += mesh.points[static_cast<std::size_t>(p)];
      middles.push_back(sum * (1.0 / static_cast<double>(mesh.faces[f].size())));
    }
    first += patch.size;
  }
  return middles;
}

// The inlet has values of its own, the walls are without slip, and the outlet takes the cells' values.
std::string shear_file(const MeshData& mesh, double t) {
  std::vector<Vec3> cells;
  for (const Vec3& x : cell_centres(mesh)) cells.push_back(shear(x, t));
  std::vector<Vec3> inlet;
  for (const Vec3& x : middles_of_patch(test::foam_mesh(mesh), "xmin")) inlet.push_back(shear(x, t));
  return "internalField " + vector_list(cells) + ";\nboundaryField\n{\n  xmin { type fixedValue; value " +
         vector_list(inlet) +
         "; }\n  \"y.*\" { type noSlip; }\n  zmin { type slip; $default; }\n  zmax { type symmetry; }\n" +
         "  xmax { type zeroGradient; value uniform (7 7 7); }\n}\n";
}

TEST_F(OpenFoamScene, PointsTakeTheValuesOfPatches) {
  const MeshData mesh = box();
  const FoamWriter writer(folder_ / "case", {});
  writer.write(test::foam_mesh(mesh));
  writer.file("1/U", "volVectorField", shear_file(mesh, 0.0));
  const Scene scene = load("[motion]\nfield = { array = 'U', files = 'case' }\n");
  const FieldSamples& samples = scene.motion.field.samples;
  EXPECT_EQ(samples.place, FieldPlace::points);
  const std::vector<Vec3> values = samples.read(0);
  ASSERT_EQ(values.size(), mesh.points.size());
  std::size_t walls = 0;
  std::size_t exact = 0;
  for (std::size_t p = 0; p < values.size(); ++p) {
    const Vec3& x = mesh.points[p];
    if (x.y == 0.0 || x.y == 1.0) {
      EXPECT_EQ(values[p], Vec3());
      ++walls;
    } else if (x.z > 0.0 && x.z < 1.0 && x.x < 1.0) {  // inside, and inside the inlet
      test::expect_near(values[p], shear(x, 0.0), 1e-14);
      ++exact;
    } else if (x.x == 1.0 && x.z > 0.0 && x.z < 1.0) {  // in the outlet: of the last cells, half a cell upstream
      test::expect_near(values[p], shear({1.0 - 0.125, x.y, x.z}, 0.0), 1e-14);
    }
  }
  EXPECT_EQ(walls, 2U * 5U * 4U);
  EXPECT_EQ(exact, 4U * 2U * 2U);
  // The same arrays of the scene's mesh, and at the cells if they are wanted there.
  const auto in_mesh = [&](const std::string& keys) {
    const std::string text = "[environment]\nmesh = 'case/1'\n[motion]\nfield = { array = 'U'" + keys + " }\n";
    const Scene loaded = load_scene_files(parse_scene(text, folder_ / "scene.toml")).scene;
    const MeshData& read = std::get<MeshData>(loaded.environment.mesh);
    return std::pair{read.point_data, read.cell_data.front().values.size()};
  };
  const auto [point_data, size] = in_mesh("");
  ASSERT_EQ(point_data.size(), 1U);
  for (std::size_t p = 0; p < values.size(); ++p)
    EXPECT_EQ((Vec3{point_data[0].values[3 * p], point_data[0].values[3 * p + 1], point_data[0].values[3 * p + 2]}),
              values[p]);
  EXPECT_EQ(size, 3 * mesh.cell_count());
  EXPECT_TRUE(in_mesh(", at = 'cells'").first.empty());
}

// At each time by the points of that time; in parts, and with a mesh in binary, to the same bits.
TEST_F(OpenFoamScene, PointsOfMovingCasesAndOfParts) {
  const MeshData rest = box();
  std::vector<std::size_t> part;
  for (std::size_t c = 0; c < rest.cell_count(); ++c) part.push_back(c % 2);
  const FoamWriter writer(folder_ / "case", {});
  writer.write(test::foam_mesh(rest));
  MeshData moved = rest;
  for (const auto& [time, t] : times) {
    if (t != 10.0) moved.points = swayed(rest.points, t);  // at 10 it stands where it stood at 1
    if (t != 10.0) writer.points(time, moved.points);
    if (t == 10.0) moved.points = swayed(rest.points, 1.0);
    writer.file(time + "/U", "volVectorField", shear_file(moved, t));
  }
  const Scene scene = load("[motion]\nfield = { array = 'U', files = 'case' }\n");
  const FieldSamples samples = scene.motion.field.samples;
  for (const std::size_t k : {2U, 0U, 1U, 3U}) {
    const double t = samples.times[k];
    const std::vector<Vec3> values = samples.read(k);
    for (std::size_t p = 0; p < values.size(); ++p) {
      const Vec3& x = rest.points[p];
      if (x.x > 0.0 && x.x < 1.0 && x.y > 0.0 && x.y < 1.0 && x.z > 0.0 && x.z < 1.0)
        test::expect_near(values[p], shear(swayed({x}, t == 10.0 ? 1.0 : t).front(), t), 1e-13);
    }
  }
}

TEST_F(OpenFoamScene, PatchValuesOfProcessors) {
  const MeshData mesh = box();
  const test::FoamMesh whole = test::foam_mesh(mesh);
  FoamWriter(folder_ / "case", {}).write(whole);
  FoamWriter(folder_ / "case", {}).file("1/U", "volVectorField", shear_file(mesh, 0.0));
  const std::string text = "[motion]\nfield = { array = 'U', files = 'case' }\n";
  const std::vector<Vec3> expected = load(text).motion.field.samples.read(0);
  fs::remove_all(folder_ / "case");
  std::vector<std::size_t> part;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) part.push_back(c % 2);
  test::write_foam_parts(folder_ / "case", {}, whole, part);
  const std::vector<Vec3> centres = cell_centres(mesh);
  for (std::size_t k = 0; k < 2; ++k) {
    const fs::path processor = folder_ / fmt::format("case/processor{}", k);
    std::vector<Vec3> cells;
    for (std::size_t c = 0; c < centres.size(); ++c) {
      if (part[c] == k) cells.push_back(shear(centres[c], 0.0));
    }
    std::string inlet = "fixedValue; value nonuniform List<vector> 0()";
    const std::vector<Vec3> middles = middles_of_patch(test::FoamPart(whole, part, k).mesh(), "xmin");
    std::vector<Vec3> values;
    for (const Vec3& x : middles) values.push_back(shear(x, 0.0));
    if (!values.empty()) inlet = "fixedValue; value " + vector_list(values);
    FoamWriter(processor, {})
        .file("1/U", "volVectorField",
              "internalField " + vector_list(cells) + ";\nboundaryField { xmin { type " + inlet +
                  "; } \".*\" { type zeroGradient; } \"y.*\" { type noSlip; } "
                  "\"proc.*\" { type processor; value uniform (5 5 5); } }\n");
  }
  EXPECT_EQ(load(text).motion.field.samples.read(0), expected);
}

// Patterns come from files of others: none may take the stack, or a time that grows faster than the name.
TEST_F(OpenFoamScene, HostilePatternsOfPatches) {
  const MeshData mesh = box();
  auto whole = test::foam_mesh(mesh);
  whole.patches.back().name = std::string(100000, 'a');
  FoamWriter(folder_ / "case", {}).write(whole);
  std::vector<Vec3> cells(mesh.cell_count(), {1, 2, 3});
  const auto values = [&](const std::string& pattern) {
    FoamWriter(folder_ / "case", {})
        .file("1/U", "volVectorField",
              "internalField " + vector_list(cells) + ";\nboundaryField { \"" + pattern + "\" { type noSlip; } }\n");
    return load("[motion]\nfield = { array = 'U', files = 'case' }\n").motion.field.samples.read(0);
  };
  const std::vector<Vec3> without = values("none");
  EXPECT_NE(values("(a*)*"), without);
  for (const std::string& pattern : {std::string("(a*)*b"), std::string("(a|a)*b"), std::string("(a*)\\1"),
                                     std::string("((a{99}){99}){99}"), std::string("(a"), std::string(300, 'a')})
    EXPECT_EQ(values(pattern), without) << pattern;
}

TEST_F(OpenFoamScene, PointsOfPartsAtATime) {
  const MeshData mesh = box();
  std::vector<std::size_t> part(mesh.cell_count(), 0);
  test::write_foam_parts(folder_ / "case", {}, test::foam_mesh(mesh), part);
  const fs::path own = folder_ / "case/processor0";
  const MeshFile rest = read_mesh(folder_ / "case");
  ASSERT_TRUE(rest.report.valid());
  // The part has the points of the whole in another order: its addressing says which.
  std::ifstream file(own / "constant/polyMesh/pointProcAddressing");
  std::string text((std::istreambuf_iterator<char>(file)), {});
  std::istringstream list(text.substr(text.find('(') + 1));
  std::vector<Vec3> points;
  for (std::size_t label = 0; list >> label;) points.push_back(swayed(mesh.points, 2.0)[label]);
  ASSERT_EQ(points.size(), mesh.points.size());
  FoamWriter(own, {}).points("2", points);
  EXPECT_EQ(read_mesh(folder_ / "case/2").mesh.points, swayed(mesh.points, 2.0));
  const DeformationStep step = load("[[deformation]]\nkind = 'frames'\nfiles = 'case'\n").deformation.front().step;
  EXPECT_EQ(step.reader(1), swayed(mesh.points, 2.0));
  // A label far beyond all points takes no memory.
  std::vector<std::int64_t> labels(points.size(), 4000000000);
  FoamWriter(own, {}).labels_file("pointProcAddressing", labels);
  FoamWriter(folder_ / "case", {}).write(test::foam_mesh(mesh));
  const MeshFile far = read_mesh(folder_ / "case/2");
  ASSERT_FALSE(far.report.valid());
  test::expect_parts(far.report.defects[0].message, {"pointProcAddressing", "4000000000"});
}

TEST_F(OpenFoamScene, WhatIsRefused) {
  write_case("case", {});
  const std::string frames = "[[deformation]]\nkind = 'frames'\nfiles = 'case'\n";
  expect_error(frames + "times = [0, 1]\n", {"case", "times of its own"});
  expect_error("[motion]\nfield = { array = 'V', files = 'case' }\n", {"no time of the case has a field V"});
  expect_error("[motion]\nfield = { array = 'p', files = 'case' }\n", {"0.25", "'p'"});
  FoamWriter(folder_ / "case", {}).field("1", "U", velocities(3, 0.0));
  const Scene scene = load("[motion]\nfield = { array = 'U', files = 'case' }\n");
  test::expect_parts(test::error_text([&] { scene.motion.field.samples.read(1); }), {"1/U", "3 values for 36 cells"});
  fs::copy(folder_ / "case/constant/polyMesh/faces", folder_ / "case/10/polyMesh/faces");
  expect_error(frames, {"case/10/polyMesh", "other faces from the time 10 on"});
  FoamWriter(folder_ / "none", {}).write(test::foam_mesh(box()));
  expect_error("[[deformation]]\nkind = 'frames'\nfiles = 'none'\n", {"no time of the case has points"});
}

TEST_F(OpenFoamScene, AFrameOfOtherPointsIsNamed) {
  write_case("case", {});
  FoamWriter(folder_ / "case", {}).points("10", std::vector<Vec3>(7));
  const Scene scene = load("[[deformation]]\nkind = 'frames'\nfiles = 'case'\n");
  test::expect_parts(test::error_text([&] { scene.deformation.front().step.reader(3); }),
                     {"frame 3", "case/10", "7 points"});
}

// Cases made by others.

struct Made {
  std::string name;
  std::size_t cells;
  bool moves;
  std::string free;
  std::map<std::string, std::size_t> patches, regions;
};

std::vector<Made> made_by_others() {
  const std::map<std::string, std::size_t> vessel = {
      {"inlet", 33}, {"outlet", 33}, {"tissue_ends", 24}, {"outer", 120}, {"wall", 120}};
  const std::map<std::string, std::size_t> zones = {{"lumen", 330}, {"tissue", 120}};
  return {{"pipe", 1024, true, "", {{"inlet", 64}, {"outlet", 64}, {"wall", 256}}, {{"lumen", 1024}}},
          {"vessel", 450, true, "free = { region = ['lumen'] }\n", vessel, zones},
          {"vessel_gz", 450, true, "free = { region = ['lumen'] }\n", vessel, zones},
          {"vessel_decomposed", 450, false, "free = { region = ['lumen'] }\n", vessel, zones},
          {"poly", 1241, false, "", {{"inlet", 89}, {"outlet", 89}, {"wall", 304}}, {}},
          {"dual", 93, true, "", {{"wall", 79}}, {}},
          {"refined", 120, false, "", {{"floor", 16}, {"lid", 16}, {"sides", 64}}, {}}};
}

TEST(OpenFoamCases, CountsZonesAndPatches) {
  NEED_DATA("seven cases of OpenFOAM");
  for (const Made& made : made_by_others()) {
    SCOPED_TRACE(made.name);
    const MeshFile file = read_mesh(test::data_folder() / "openfoam" / made.name);
    ASSERT_TRUE(file.report.valid());
    EXPECT_EQ(file.mesh.cell_count(), made.cells);
    std::map<std::string, std::size_t> patches, regions;
    for (const std::int32_t tag : file.mesh.patch_tags) ++patches[file.mesh.patch_names.at(tag)];
    for (const std::int32_t tag : file.mesh.regions) ++regions[file.mesh.region_names.at(tag)];
    EXPECT_EQ(patches, made.patches);
    EXPECT_EQ(regions, made.regions);
  }
  EXPECT_EQ(read_mesh(test::data_folder() / "openfoam/vessel_decomposed").mesh.points,
            read_mesh(test::data_folder() / "openfoam/vessel").mesh.points);
}

TEST(OpenFoamCases, PartsGiveTheMeshOfTheWhole) {
  NEED_DATA("a decomposed case of OpenFOAM");
  const fs::path from = test::data_folder() / "openfoam/vessel_decomposed";
  const fs::path parts = fs::path(::testing::TempDir()) / "openfoam_parts";
  fs::remove_all(parts);
  fs::create_directories(parts);
  for (const char* k : {"processor0", "processor1"}) fs::copy(from / k, parts / k, fs::copy_options::recursive);
  const MeshFile whole = read_mesh(from);
  const MeshFile merged = read_mesh(parts);
  EXPECT_EQ(merged.report.format, "OpenFOAM polyMesh, of 2 processors");
  EXPECT_EQ(merged.mesh.points, whole.mesh.points);
  EXPECT_EQ(merged.mesh.connectivity, whole.mesh.connectivity);
  EXPECT_EQ(merged.mesh.regions, whole.mesh.regions);
  EXPECT_EQ(merged.mesh.patch_tags, whole.mesh.patch_tags);
  EXPECT_EQ(merged.mesh.patch_faces, whole.mesh.patch_faces);
  fs::remove_all(parts);
}

TEST(OpenFoamCases, RunAuditedWhileTheyDeform) {
  NEED_DATA("seven cases of OpenFOAM");
  for (const Made& made : made_by_others()) {
    SCOPED_TRACE(made.name);
    const fs::path folder = test::data_folder() / "openfoam" / made.name;
    std::string text = fmt::format("[environment]\nmesh = '{}'\n{}", folder.string(), made.free);
    if (made.moves) text += fmt::format("[[deformation]]\nkind = 'frames'\nfiles = '{}'\n", folder.string());
    text +=
        "[[particles]]\ncount = 300\n[motion]\ndt = 0.02\ngravity = [0.05, 0.1, -0.3]\n[contact]\nrestitution = 0.9\n";
    Simulation simulation(load_scene_files(parse_scene(text, "scene.toml")).scene);
    for (int step = 0; step < 60; ++step) {
      simulation.step();
      EXPECT_EQ(simulation.audit().failed, 0U);
    }
    EXPECT_EQ(simulation.particles().size(), 300U);
  }
}

}  // namespace dartcast::openfoam_scene_test
