// Files of surfaces that are damaged: cut, with other bytes and numbers, and with huge counts.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "dartcast/mesh_files.hpp"
#include "dartcast/surface.hpp"
#include "output/mesh_report_text.hpp"
#include "support/sample_mesh.hpp"
#include "support/surface_files.hpp"
#include "support/tier.hpp"
#include "surface/check_surface.hpp"

namespace dartcast::test::surface_damage_test {

/// Whatever is accepted is a surface, and stays one.
bool expect_surface_or_error(const Folder& folder, const std::string& name, const std::string& content,
                             const std::string& how) {
  MeshFile file = check_surface(folder.file(name, content));
  if (!file.report.valid()) {
    EXPECT_FALSE(file.report.defects[0].message.empty()) << name << ", " << how;
    return false;
  }
  const MeshReport again = check_and_repair_surface(file.mesh);
  EXPECT_TRUE(again.valid() && again.repairs.empty()) << name << ", " << how << "\n" << report_text(again);
  EXPECT_NO_THROW(Surface(file.mesh)) << name << ", " << how;
  return true;
}

TEST(SurfaceDamage, TruncatedAnywhere) {
  const Folder folder;
  for (const SurfaceSample& s : cube_files()) {
    const std::size_t whole = s.content.find_last_not_of(" \r\n");
    // Behind its last number a file may lack the rest of the line.
    const std::size_t needed = s.name == "r.off" ? s.content.rfind("  1.0") : whole;
    for (std::size_t n = 0; n < needed; ++n) {
      const bool accepted =
          expect_surface_or_error(folder, s.name, s.content.substr(0, n), "cut at " + std::to_string(n));
      EXPECT_FALSE(accepted && !s.name.ends_with(".obj")) << s.name << " cut at " << n;  // .obj has no end
    }
  }
}

TEST(SurfaceDamage, BytesChanged) {
  std::mt19937 random(7);
  const Folder folder;
  const std::vector<SurfaceSample> all = cube_files();
  const int rounds = scaled(20000, 400000);
  int accepted = 0;
  for (int round = 0; round < rounds; ++round) {
    const SurfaceSample& s = all[random() % all.size()];
    std::string content = s.content;
    for (auto k = 1 + random() % 3; k > 0; --k) content[random() % content.size()] = static_cast<char>(random());
    accepted += expect_surface_or_error(folder, s.name, content, "round " + std::to_string(round)) ? 1 : 0;
  }
  EXPECT_GT(accepted, rounds / 100);  // comments, normals and the like
  EXPECT_LT(accepted, rounds);
}

TEST(SurfaceDamage, NumbersReplaced) {
  const Folder folder;
  const std::vector<std::string> numbers = {
      "-1", "3", "1e400", "nan", "-inf", "4294967295", "1000000000", "9223372036854775807", "-9223372036854775808",
      "x"};
  for (const SurfaceSample& s : cube_files()) {
    for (std::size_t at = 1; at < s.content.size(); ++at) {
      const auto digit = [](char c) { return c >= '0' && c <= '9'; };
      if (!digit(s.content[at]) || digit(s.content[at - 1]) || (test::sanitized() && at % 8 != 0)) continue;
      const std::size_t end = std::min(s.content.find_first_not_of("0123456789.", at), s.content.size());
      for (const std::string& number : numbers)
        expect_surface_or_error(folder, s.name, s.content.substr(0, at) + number + s.content.substr(end), number);
    }
  }
}

TEST(SurfaceDamage, HugeCountsTakeNoMemory) {
  const Folder folder;
  const std::string big = "1000000000000000000";
  const std::string ply = "format ascii 1.0\nelement vertex 1\nproperty int x\nproperty int y\nproperty int z\n";
  const std::string list = "property list uint uint vertex_indices\nend_header\n";
  const std::vector<SurfaceSample> bombs = {
      {"a.stl", std::string(80, ' ') + std::string(4, '\xff')},
      {"a.off", "OFF\n" + big + " 1 0\n"},
      {"a.off", "OFF\n1 " + big + " 0\n0 0 0\n"},
      {"a.off", "OFF\n1 1 0\n0 0 0\n" + big + "\n"},
      {"a.ply", "ply\nformat ascii 1.0\nelement vertex " + big +
                    "\nproperty int x\nproperty int y\nproperty int z\n"
                    "element face 1\n" +
                    list + "0 0 0\n"},
      {"a.ply", "ply\n" + ply + "element face " + big + "\n" + list + "0 0 0\n"},
      {"a.ply", "ply\n" + ply + "element face 1\n" + list + "0 0 0\n" + big + "\n"},
      {"a.ply", "ply\n" + ply + "element x " + big + "\nelement face " + big + "\n" + list + "0 0 0\n"},
      {"a.ply", "ply\n" + ply + "property list uint double n\nelement face 1\n" + list + "0 0 0 4000000000\n"},
      {"a.ply",
       "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty list uint double n\nproperty char x\n"
       "property char y\nproperty char z\nelement face 1\n" +
           list + std::string(40, '\xff')},
      {"a.obj", "v 0 0 0\nf 1 2 " + big + "\n"}};
  for (const SurfaceSample& bomb : bombs)
    EXPECT_FALSE(expect_surface_or_error(folder, bomb.name, bomb.content, "bomb")) << bomb.content;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  if (!test::sanitized()) EXPECT_LT(usage.ru_maxrss, 600 * 1024) << "kilobytes";
}

}  // namespace dartcast::test::surface_damage_test
