// The files that a run reads besides the scene and writes besides frames: seeds, scales, energies, the lock.
#include "output/run_files.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/run.hpp"
#include "dartcast/scene_file.hpp"
#include "formats/file_text.hpp"
#include "formats/point_file.hpp"
#include "formats/scene_files.hpp"
#include "output/info.hpp"
#include "support/data_arrays.hpp"
#include "support/sample_mesh.hpp"

namespace dartcast::run_files_test {

using test::array;

namespace fs = std::filesystem;

// A row of a table of numbers, by the names in its header.
class Table {
 public:
  explicit Table(const fs::path& path) {
    std::ifstream file(path);
    std::string line;
    std::getline(file, line);
    names_ = split(line);
    while (std::getline(file, line)) rows_.push_back(split(line));
  }
  [[nodiscard]] std::size_t size() const { return rows_.size(); }
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  [[nodiscard]] double at(std::size_t row, const std::string& name) const {
    const auto column = static_cast<std::size_t>(std::find(names_.begin(), names_.end(), name) - names_.begin());
    return std::stod(rows_.at(row).at(column));
  }

 private:
  static std::vector<std::string> split(const std::string& line) {
    std::vector<std::string> fields(1);
    for (const char c : line) {
      if (c == ',')
        fields.emplace_back();
      else
        fields.back() += c;
    }
    return fields;
  }
  std::vector<std::string> names_;
  std::vector<std::vector<std::string>> rows_;
};

// (1, 2, 3) and (2, 2, 2), with these arrays.
std::string two_points(const std::string& arrays) {
  return "<VTKFile type='PolyData' version='0.1' byte_order='LittleEndian'><PolyData><Piece NumberOfPoints='2' "
         "NumberOfVerts='0' NumberOfLines='0' NumberOfStrips='0' NumberOfPolys='0'><PointData>" +
         arrays +
         "</PointData><Points><DataArray type='Float64' NumberOfComponents='3' format='ascii'>1 2 3 2 2 2</DataArray>"
         "</Points></Piece></PolyData></VTKFile>";
}

class RunFilesTest : public testing::Test {
 protected:
  [[nodiscard]] Summary run(const std::string& text) const {
    RunOptions options;
    options.folder = folder;
    options.audit = true;
    return run_scene(parse_scene(text, "test.toml"), options);
  }
  [[nodiscard]] std::string failure(const std::string& text) const {
    try {
      (void)run(text);
      return "";
    } catch (const Error& e) {
      return e.what();
    }
  }
  // A scene of a box of 4 x 4 x 4 m with these seeds.
  [[nodiscard]] std::string seeded(const std::string& file, const std::string& keys = "") const {
    return "[environment]\ngenerator = 'box'\ncells = [4, 4, 4]\n[[particles]]\npositions = '" +
           (temporary / file).string() + "'\n" + keys + "[motion]\ndt = 0.125\nsteps = 1\n";
  }

  test::Folder temporary;
  fs::path folder = temporary / "run";
};

TEST_F(RunFilesTest, SeedsInACsvFileHaveVelocitiesAndRadii) {
  (void)temporary.file("a.csv", "radius, vx,vy,vz,x,y,z\n0.25,1,0,0,1,2,3\n0,0,-1,0.5,2,2,2\n");
  EXPECT_EQ(run(seeded("a.csv", "velocity = [9, 9, 9]\nradius = 0.1\n")).audit->failed, 0U);
  const PointFile after = read_points(folder / "particles_000001.vtp");
  EXPECT_EQ(after.points, (std::vector<Vec3>{{1.125, 2, 3}, {2, 1.875, 2.0625}}));
  EXPECT_EQ(array(after, "radius").values, (std::vector<double>{0.25, 0}));
  EXPECT_EQ(array(after, "velocity").values, (std::vector<double>{1, 0, 0, 0, -1, 0.5}));
  (void)temporary.file("b.csv", "x,y,z\n1,2,3\n");
  (void)run(seeded("b.csv", "velocity = [1, 0, 0]\nradius = 0.1\n"));
  EXPECT_EQ(array(read_points(folder / "particles_000001.vtp"), "radius").values, (std::vector<double>{0.1}));
}

// Tables of spreadsheets, of ParaView, of Fortran.
TEST_F(RunFilesTest, SeedsInTablesOfOtherPrograms) {
  const std::vector<Vec3> expected = {{1.125, 2, 3}, {2, 1.875, 2.0625}};
  for (const std::string& text :
       {std::string("\xef\xbb\xbfx,y,z,vx,vy,vz\r\n1,2,3,1,0,0\r\n2,2,2,0,-1,0.5\r\n\r\n"),
        std::string("\"Points:0\",\"Points:1\",\"Points:2\",\"velocity:0\",\"velocity:1\",\"velocity:2\",\"velocity:"
                    "Magnitude\","
                    "\"id\"\n1,2,3,1,0,0,1,0\n2,2,2,0,-1,0.5,1.1,1\n"),
        std::string(
            "Point ID,Points_0,Points_1,Points_2,velocity_0,velocity_1,velocity_2\n0,1,2,3,1,0,0\n1,2,2,2,0,-1,0.5\n"),
        std::string("x;y;z;vx;vy;vz\n1;2;3;1;0;0\n2;2;2;0;-1;0.5\n"),
        std::string("x\ty\tz\tvx\tvy\tvz\n1\t2\t3\t1\t0\t0\n2\t2\t2\t0\t-1\t0.5\n"),
        std::string("x,y,z,vx,vy,vz\n+1.0D+00, 2d0,3E0,1.,0,0\n2,2,2,0,-1.0d+00,5.0D-01\n")}) {
    SCOPED_TRACE(text);
    (void)temporary.file("a.csv", text);
    (void)run(seeded("a.csv"));
    EXPECT_EQ(read_points(folder / "particles_000001.vtp").points, expected);
  }
}

TEST_F(RunFilesTest, SeedsInAVtpFileHaveVelocitiesAndRadii) {
  const std::string radius = "<DataArray type='Float64' Name='radius' format='ascii'>0 0.25</DataArray>";
  const std::string velocity =
      "<DataArray type='Float64' Name='velocity' NumberOfComponents='3' format='ascii'>1 0 0 1 0 1</DataArray>";
  (void)temporary.file("a.vtp", two_points(radius + velocity));
  (void)run(seeded("a.vtp"));
  const PointFile after = read_points(folder / "particles_000001.vtp");
  EXPECT_EQ(after.points, (std::vector<Vec3>{{1.125, 2, 3}, {2.125, 2, 2.125}}));
  EXPECT_EQ(array(after, "radius").values, (std::vector<double>{0, 0.25}));
  // A frame of a run starts another one.
  fs::copy(folder / "particles_000001.vtp", temporary / "frame.vtp");
  (void)run(seeded("frame.vtp"));
  EXPECT_EQ(read_points(folder / "particles_000001.vtp").points, (std::vector<Vec3>{{1.25, 2, 3}, {2.25, 2, 2.25}}));
  fs::remove_all(folder);
  (void)temporary.file("b.vtp",
                       two_points(radius + "<DataArray type='Int32' Name='mass' format='ascii'>1 1</DataArray>"));
  EXPECT_NE(failure(seeded("b.vtp")).find("b.vtp: the point array 'mass' is unknown"), std::string::npos);
  (void)temporary.file("c.vtp", two_points("<DataArray type='Float64' Name='velocity' format='ascii'>1 1</DataArray>"));
  EXPECT_NE(failure(seeded("c.vtp")).find("'velocity' has 1 components; it must have 3"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder));
}

TEST_F(RunFilesTest, ColumnsOfSeedsThatHaveNoMeaningAreRefused) {
  const auto expect_error = [&](const std::string& content, const std::string& part) {
    (void)temporary.file("a.csv", content);
    const std::string error = failure(seeded("a.csv"));
    EXPECT_NE(error.find("a.csv"), std::string::npos) << error;
    EXPECT_NE(error.find(part), std::string::npos) << error;
    EXPECT_FALSE(fs::exists(folder));
  };
  expect_error(
      "x,y,z,mass\n1,1,1,1\n",
      ":1: the column 'mass' is unknown; there are x, y, z, vx, vy, vz, radius, diameter, density and charge_per_mass");
  expect_error("x,y,z,\n1,1,1,\n", ":1: the column '' is unknown");
  expect_error("x,y,z,vx,vy\n1,1,1,1,1\n", ":1: there is no column 'vz'");
  expect_error("x,y,z,x\n1,1,1,1\n", ":1: there are two columns 'x'");
  expect_error("1,1,1\n2,2,2\n", ":1: there are two columns '1'; the first line must name each once");
  expect_error("\xff\xfex,y,z\n1,1,1\n", ".csv: the file cannot be read: byte 0: the text is in UTF-16");
  expect_error("x,y,z,radius\n1,1,1,-0.5\n", "the radius of position 0 (counted from 0) is -0.5");
  expect_error("x,y,z,radius\n1,1,1,0\n1,1,1,inf\n", ":3: column 'radius': 'inf' is not finite");
  expect_error("x,y,z,vx,vy,vz\n1,1,1,0,0,nan\n", ":2: column 'vz': 'nan' is not finite");
  expect_error("x,y,z,vx,vy,vz\n1,1,1,0,0\n", ":2: column 'vz': '' is not a number");
  expect_error("x;y;z\n0,5;1;1\n", ":2: column 'x': '0,5' is not a number");
  expect_error("x,y,z\n1,1.0D+,1\n", ":2: column 'y': '1.0D+' is not a number");
  expect_error("x,Points:0,y,z\n1,1,1,1\n", "the columns 'Points:0' and 'x' say the same");
}

// Free fall: each row's energies are those of the frame's particles.
TEST_F(RunFilesTest, EnergiesStandInTheTable) {
  (void)run(
      "[environment]\ngenerator = 'box'\ncells = [4, 4, 4]\n[[particles]]\ncount = 50\nvelocity = [1.0, 2.0, 0.5]\n"
      "[motion]\ndt = 0.02\nsteps = 20\ngravity = [0.0, -1.0, -9.5]\n[output]\nevery = 1\n");
  const Table stats(folder / "stats.csv");
  ASSERT_EQ(stats.size(), 20U);
  const auto& names = stats.names();
  EXPECT_EQ(std::vector<std::string>(names.end() - 2, names.end()),
            (std::vector<std::string>{"kinetic_energy", "potential_energy"}));
  for (std::size_t row = 0; row < stats.size(); ++row) {
    const PointFile frame = read_points(folder / frame_name("particles", row + 1, ".vtp"));
    const std::vector<double>& v = array(frame, "velocity").values;
    double kinetic = 0.0;
    double potential = 0.0;
    for (std::size_t i = 0; i < frame.points.size(); ++i) {
      kinetic += 0.5 * (v[3 * i] * v[3 * i] + v[3 * i + 1] * v[3 * i + 1] + v[3 * i + 2] * v[3 * i + 2]);
      potential += 1.0 * frame.points[i].y + 9.5 * frame.points[i].z;
    }
    EXPECT_NEAR(stats.at(row, "kinetic_energy"), kinetic, 1e-12 * kinetic);
    EXPECT_NEAR(stats.at(row, "potential_energy"), potential, 1e-12 * potential);
  }
}

// With collisions spheres have a mass, and points none.
TEST_F(RunFilesTest, EnergiesAreThoseOfTheMasses) {
  (void)temporary.file("a.csv", "x,y,z,vx,vy,vz,radius\n1,2,3,0,0,2,0.1\n3,2,1,3,0,0,0.2\n2,2,2,9,9,9,0\n");
  const std::string scene = seeded("a.csv") + "gravity = [0.0, 0.0, -0.0625]\n[collisions]\ndensity = 500.0\n";
  (void)run(scene);
  const Table stats(folder / "stats.csv");
  const auto mass = [](double r) { return 500.0 * 4.0 / 3.0 * std::numbers::pi * r * r * r; };
  const double vz = -0.125 * 0.0625;
  const double kinetic = 0.5 * mass(0.1) * (2.0 + vz) * (2.0 + vz) + 0.5 * mass(0.2) * (9.0 + vz * vz);
  const double potential = 0.0625 * (mass(0.1) * (3.0 + 0.125 * (2.0 + vz)) + mass(0.2) * (1.0 + 0.125 * vz));
  EXPECT_NEAR(stats.at(0, "kinetic_energy"), kinetic, 1e-12 * kinetic);
  EXPECT_NEAR(stats.at(0, "potential_energy"), potential, 1e-12 * potential);
}

TEST_F(RunFilesTest, ParticlesThatAreHeldSaySo) {
  // The whole box is turned inside out along z: everybody is held.
  const MeshData mesh = generate_box({});
  write_mesh(mesh, temporary / "a.vtu");
  MeshData turned = mesh;
  for (Vec3& x : turned.points) x.z = x.z * 0.5;
  write_mesh(turned, temporary / "b.vtu");
  const std::string start = "[environment]\nmesh = '" + (temporary / "a.vtu").string() + "'\n";
  const std::string end = "[[particles]]\ncount = 20\n[motion]\ndt = 0.5\nsteps = 2\n[output]\nevery = 1\n";
  const std::string bump =
      "[[deformation]]\nkind = 'bump'\namplitude = 40.0\nlength = 1.2\nperiod = 2.0\ncentre = [0.0, 0.0, 0.0]\n";
  const Summary summary = run(start + bump + end);
  ASSERT_GT(summary.held + summary.alive, 0U);
  double held = 0.0;
  const PointFile first = read_points(folder / "particles_000001.vtp");
  for (const double h : array(first, "held").values) {
    EXPECT_TRUE(h == 0.0 || h == 1.0);
    held += h;
  }
  EXPECT_EQ(held, Table(folder / "stats.csv").at(0, "held"));
  EXPECT_GT(held, 0.0);
  const std::string bytes = read_bytes(folder / "particles_000001.vtp");
  EXPECT_NE(bytes.find("type=\"UInt8\" Name=\"held\""), std::string::npos);
}

// A mesh in millimetres is the one in metres.
TEST_F(RunFilesTest, MeshesAreScaled) {
  BoxOptions o;
  o.cells = {3, 4, 5};
  o.size = {3.1, 4.3, 5.7};
  o.jitter = 0.5;
  MeshData mesh = generate_box(o);
  write_mesh(mesh, temporary / "mm.msh");
  for (Vec3& x : mesh.points) x *= 1e-3;
  write_mesh(mesh, temporary / "m.msh");
  const std::string rest = "[[particles]]\ncount = 40\nvelocity = [3e-3, 1e-3, 2e-3]\n[motion]\ndt = 0.1\nsteps = 30\n";
  const std::string in_m = "[environment]\nmesh = '" + (temporary / "m.msh").string() + "'\n";
  const std::string in_mm = "[environment]\nmesh = '" + (temporary / "mm.msh").string() + "'\nscale = 1e-3\n";
  const Summary metres = run(in_m + rest);
  const Summary scaled = run(in_mm + rest);
  EXPECT_EQ(metres.state_hash, scaled.state_hash);
  EXPECT_GT(scaled.totals.counters.contacts[2], 10U);
  const auto frames = [&](const char* file) {
    return "[[deformation]]\nkind = 'frames'\nfiles = ['" + (temporary / file).string() + "']\ntimes = [0.0]\n";
  };
  EXPECT_EQ(run(in_mm + frames("mm.msh") + rest).state_hash, run(in_m + frames("m.msh") + rest).state_hash);
  EXPECT_NE(failure(in_m + "scale = 1e300\n" + rest).find("m.msh: points with a coordinate too large"),
            std::string::npos);
}

TEST_F(RunFilesTest, ARunLocksItsFolder) {
  const std::string scene = "[environment]\ngenerator = 'box'\n[motion]\nsteps = 2\n";
  fs::create_directories(folder);
  const std::string lock = (folder / "run.lock").string();
  const int descriptor = ::open(lock.c_str(), O_RDWR | O_CREAT, 0666);
  ASSERT_EQ(::flock(descriptor, LOCK_EX | LOCK_NB), 0);
  ASSERT_EQ(::write(descriptor, "4711\n", 5), 5);
  const std::string error = failure(scene);
  EXPECT_NE(error.find("another run writes to this folder (process 4711)"), std::string::npos) << error;
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 1);
  ::close(descriptor);  // as when the process dies: the file stays behind, without a lock
  EXPECT_EQ(failure(scene), "");
  EXPECT_FALSE(fs::exists(folder / "run.lock"));
  EXPECT_TRUE(fs::exists(folder / "summary.json"));
}

// From the inside: while one run is under way another into its folder is refused, and to go on from it is, too.
TEST_F(RunFilesTest, ASecondRunInTheFolderIsRefused) {
  const std::string scene = "[environment]\ngenerator = 'box'\n[[particles]]\ncount = 5\n[motion]\nsteps = 4\n";
  RunOptions options;
  options.folder = folder;
  int refused = 0;
  const Scene parsed = parse_scene(scene, "test.toml");
  run_scene(parsed, options, [&](std::uint64_t step, std::uint64_t) {
    RunOptions second = options;
    second.resume = step % 2 == 0;
    try {
      run_scene(parsed, second);
    } catch (const Error& e) {
      const std::string process = "(process " + std::to_string(::getpid()) + ")";
      if (std::string(e.what()).find(process) != std::string::npos) ++refused;
    }
    return true;
  });
  EXPECT_EQ(refused, 4);
  EXPECT_EQ(Table(folder / "stats.csv").size(), 4U);
  options.resume = true;
  EXPECT_EQ(run_scene(parsed, options).steps, 4U);
}

TEST_F(RunFilesTest, RunsThatFailEarlyLeaveNothing) {
  (void)temporary.file("a.csv", "x,y,z\n9,9,9\n");
  EXPECT_NE(failure(seeded("a.csv")).find("outside the mesh"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder));
  fs::create_directories(folder);
  EXPECT_NE(failure(seeded("a.csv")).find("outside the mesh"), std::string::npos);
  EXPECT_TRUE(fs::is_empty(folder));
}

TEST_F(RunFilesTest, PlanarScenesRefuseWhatLeavesThePlaneBeforeTheyWrite) {
  const std::string start = "[environment]\ngenerator = 'rectangle'\ncells = [10, 4]\n[[particles]]\ncount = 5\n";
  const std::string rotate = "[[deformation]]\nkind = 'rotate'\n";
  const std::string twist = "[[deformation]]\nkind = 'twist'\naxis = [1.0, 0.0, 0.0]\namplitude = 1.0\nlength = 5.0\n";
  (void)temporary.file("a.csv", "x,y,z,vx,vy,vz\n1,1,0,0,0,1\n");
  const std::vector<std::pair<std::string, std::string>> bad = {
      {start + twist, "deformation 1 (twist)"},
      {start + rotate + twist, "deformation 2 (twist)"},
      {start + "velocity = [0.0, 0.0, 1.0]\n", "velocity"},
      {start + "[motion]\ngravity = [0.0, 0.0, -9.81]\n", "gravity"},
      {start + "[[particles]]\npositions = '" + (temporary / "a.csv").string() + "'\n", "velocity"},
      {start + "[[particles]]\ninlet = 'xmin'\nrate = 1.0\nvelocity = [1.0, 0.0, 1.0]\n", "velocity"}};
  for (const auto& [text, part] : bad) {
    const std::string error = failure(text);
    EXPECT_NE(error.find(part), std::string::npos) << text << error;
    EXPECT_NE(error.find("plane"), std::string::npos) << text << error;
    EXPECT_FALSE(fs::exists(folder)) << text;
  }
  EXPECT_EQ(failure(start + rotate + "[motion]\nsteps = 3\n"), "");
}

// Counts that no 64-bit number holds.
TEST_F(RunFilesTest, CountsThatOverflowAreRefused) {
  const std::string start = "[environment]\ngenerator = 'box'\n";
  const std::string rate = failure(start + "[[particles]]\ninlet = 'xmin'\nrate = 1e300\n[motion]\nsteps = 2\n");
  EXPECT_NE(rate.find("1e+300"), std::string::npos) << rate;
  EXPECT_NE(rate.find("rate"), std::string::npos) << rate;
  const std::string late = "[[event]]\nkind = 'carve'\nat = 1e300\ntool = 'ball'\npoint = [0, 0, 0]\nradius = 1.0\n";
  EXPECT_NE(failure(start + late + "[motion]\nsteps = 2\n").find("its time is 1e+300 s"), std::string::npos);
  RunOptions options;
  options.steps = ~std::uint64_t{0};
  EXPECT_THROW(run_scene(parse_scene(start, "test.toml"), options), InvalidArgument);
}

TEST(MeshInfoArrays, RangesAreThoseOfFiniteValues) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  MeshData mesh = generate_box({});
  mesh.point_data = {{"u", 2, {1, nan, 2, -1, 3, 4, -5, 6, 7, -8, 9, 0, 1, 1, 1, 1}},
                     {"none", 1, std::vector<double>(8, nan)}};
  mesh.cell_data = {{"c", 1, {0.25}}};
  const MeshInfo info = mesh_info(mesh, "box");
  ASSERT_EQ(info.point_arrays.size(), 2U);
  EXPECT_EQ(info.point_arrays[0].ranges, (std::vector<std::array<double, 2>>{{-5, 9}, {-8, 6}}));
  EXPECT_EQ(info.point_arrays[0].not_finite, 1U);
  EXPECT_TRUE(info.point_arrays[1].ranges.empty());
  EXPECT_EQ(info.point_arrays[1].not_finite, 8U);
  EXPECT_NE(info_text(info).find("cell array c: 1 component, 0.25 to 0.25\n"), std::string::npos);
  EXPECT_NE(info_text(info).find("point array none: 1 component, 8 values not finite\n"), std::string::npos);
}

}  // namespace dartcast::run_files_test
