// Cases of OpenFOAM that are damaged: each gets a verdict, soon, with little memory, and what is accepted is sound.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_files.hpp"
#include "output/mesh_report_text.hpp"
#include "support/foam_case.hpp"
#include "support/foam_layer.hpp"
#include "support/mutants.hpp"
#include "support/sample_mesh.hpp"
#include "support/tier.hpp"

namespace dartcast::test::openfoam_damage_test {

/// A case on disk, and the content of its files.
struct Case {
  std::filesystem::path folder;
  std::vector<std::pair<std::filesystem::path, std::string>> files;
};

Case case_at(const std::filesystem::path& folder) {
  Case made{folder, {}};
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) made.files.emplace_back(entry.path(), slurp(entry.path()));
  }
  std::sort(made.files.begin(), made.files.end());
  return made;
}

/// Every form of a case, whole and in parts; each has a field at a time.
std::vector<Case> cases(const Folder& folder) {
  std::vector<Case> all;
  FoamMesh mesh = foam_mesh(sample_mesh());
  mesh.face_zones = {{"between", {0, 2}}};
  const std::vector<Vec3> values(sample_mesh().cell_count(), {1, 2, 3});
  for (const FoamStyle& style : foam_styles()) {
    const std::string name = "case" + std::to_string(all.size());
    const FoamWriter writer(folder / name, style);
    writer.write(mesh);
    writer.points("0.5", mesh.points);
    writer.field("0.5", "U", values);
    all.push_back(case_at(folder / name));
  }
  write_foam_parts(folder / "parts", {.binary = true}, mesh, {0, 1, 0, 1});
  all.push_back(case_at(folder / "parts"));
  FoamWriter(folder / "layer", {}).write(foam_mesh(layer(planar_mesh(), 0.0, 1.0), {{"sides", "empty"}}));
  all.push_back(case_at(folder / "layer"));
  return all;
}

/// Reads the case with one file changed.
bool expect_verdict(const Case& made, std::size_t file, const std::string& content, const std::string& how) {
  const auto& [path, whole] = made.files[file];
  std::filesystem::remove(path);
  write_bytes(path, content);
  const bool timed = path.string().find("0.5") != std::string::npos;
  MeshFile read = read_mesh(timed ? made.folder / "0.5" : made.folder);
  std::filesystem::remove(path);
  write_bytes(path, whole);
  const std::string name = path.string() + ", " + how;
  if (!read.report.valid()) {
    EXPECT_FALSE(read.report.defects[0].message.empty()) << name;
    EXPECT_FALSE(report_json(read.report).empty());
    return false;
  }
  const MeshReport again = check_and_repair(read.mesh);
  EXPECT_TRUE(again.valid() && again.repairs.empty()) << name << "\n" << report_text(again);
  return true;
}

class OpenFoamDamage : public testing::Test {
 protected:
  void TearDown() override {
    if (sanitized()) return;
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    EXPECT_LT(usage.ru_maxrss, 600 * 1024) << "kilobytes";
  }

  Folder folder_;
  std::vector<Case> cases_ = cases(folder_);
};

TEST_F(OpenFoamDamage, Truncated) {
  for (const Case& made : cases_) {
    for (std::size_t f = 0; f < made.files.size(); ++f) {
      const std::string& content = made.files[f].second;
      for (std::size_t n = 0; n < content.size(); n += stride(5, 41)) {
        expect_verdict(made, f, content.substr(0, n), "cut at " + std::to_string(n));
      }
    }
  }
}

TEST_F(OpenFoamDamage, WholeCasesAreAccepted) {
  for (const Case& made : cases_) {
    for (std::size_t f = 0; f < made.files.size(); ++f)
      EXPECT_TRUE(expect_verdict(made, f, made.files[f].second, "whole")) << made.files[f].first;
  }
}

TEST_F(OpenFoamDamage, BytesAndNumbersChanged) {
  Mutants mutants(11);
  const int rounds = scaled(20000, 200000);
  int accepted = 0;
  for (int round = 0; round < rounds; ++round) {
    const Case& made = cases_[mutants.below(cases_.size())];
    const std::size_t f = mutants.below(made.files.size());
    const std::string content = mutants.damaged(made.files[f].second);
    accepted += expect_verdict(made, f, content, "round " + std::to_string(round)) ? 1 : 0;
  }
  EXPECT_GT(accepted, rounds / 100);  // banners, names and the like
}

TEST_F(OpenFoamDamage, WordsOfBinaryFilesReplaced) {
  const std::vector<std::uint64_t> words = {0, 1, 0xffffffffU, 0x7fffffffU, 0x80000000U, 0x7fffffffffffffffU};
  for (const Case& made : cases_) {
    for (std::size_t f = 0; f < made.files.size(); ++f) {
      const std::string& content = made.files[f].second;
      if (content.find("binary") == std::string::npos) continue;
      for (std::size_t at = content.find("}\n") + 1; at + 8 <= content.size(); at += stride(7, 61)) {
        for (const std::uint64_t word : words) {
          std::string changed = content;
          std::memcpy(changed.data() + at, &word, word > 0xffffffffU ? 8 : 4);
          expect_verdict(made, f, changed, "word at " + std::to_string(at));
        }
      }
    }
  }
}

}  // namespace dartcast::test::openfoam_damage_test
