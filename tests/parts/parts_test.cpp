// Parts of meshes against the whole: cut, made, put together, and moved from rank to rank.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include "base/random.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_part.hpp"
#include "parts/bisected.hpp"
#include "parts/merged_parts.hpp"
#include "support/part_checks.hpp"
#include "support/stepped_scenes.hpp"
#include "support/thread_ranks.hpp"

namespace dartcast::parts_test {

MeshData checked(MeshData mesh) {
  EXPECT_TRUE(check_and_repair(mesh).valid());
  return mesh;
}

std::map<std::string, MeshData> meshes() {
  std::map<std::string, MeshData> all;
  for (const test::SteppedScene& scene : test::make_scenes()) {
    if (scene.mesh.dimension() == 3 && !scene.moved) all[scene.name] = checked(scene.mesh);
  }
  OctahedraOptions octahedra;
  octahedra.cells = {3, 3, 3};
  octahedra.size = {1.0, 1.0, 1.0};
  octahedra.blocked_share = 0.2;
  all["octahedra"] = checked(generate_octahedra(octahedra));
  return all;
}

std::vector<MeshPart> all_parts(const MeshData& mesh, const std::vector<std::uint32_t>& owners, std::uint32_t parts) {
  std::vector<MeshPart> result;
  for (std::uint32_t p = 0; p < parts; ++p) result.push_back(mesh_part(mesh, owners, parts, p));
  return result;
}

TEST(Parts, AreCutOutOfAnyMesh) {
  for (const auto& [name, mesh] : meshes()) {
    for (const std::uint32_t parts : {1U, 2U, 5U, 8U}) {
      const std::vector<std::uint32_t> owners = partition(mesh, parts);
      for (const MeshPart& part : all_parts(mesh, owners, parts)) {
        test::expect_is_part(mesh, owners, part, name + ", part " + std::to_string(part.part));
        if (HasFailure()) return;
      }
    }
  }
}

// Owners at random: parts of many pieces, which touch in points and edges.
TEST(Parts, AreCutAlongAnyBorder) {
  for (const auto& [name, mesh] : meshes()) {
    Random random(17);
    std::vector<std::uint32_t> owners(mesh.cell_count());
    for (std::uint32_t& o : owners) o = random.below(3) == 0 ? 1 : 0;
    for (const MeshPart& part : all_parts(mesh, owners, 2)) test::expect_is_part(mesh, owners, part, name);
  }
}

TEST(Parts, RefuseWhatCannotBe) {
  const MeshData mesh = generate_box({});
  EXPECT_THROW(partition(mesh, 2), InvalidArgument);
  EXPECT_THROW(partition(mesh, 0), InvalidArgument);
  EXPECT_THROW(mesh_part(mesh, std::vector<std::uint32_t>{}, 1, 0), InvalidArgument);
  EXPECT_THROW(mesh_part(mesh, std::vector<std::uint32_t>{1}, 1, 0), InvalidArgument);
  EXPECT_THROW(mesh_part(mesh, std::vector<std::uint32_t>{0}, 1, 1), InvalidArgument);
  BoxOptions mixed;
  mixed.mixed = true;
  EXPECT_FALSE(has_parts(mixed));
  EXPECT_THROW(box_part(mixed, 1, 0), InvalidArgument);
  EXPECT_THROW(box_part({}, 2, 0), InvalidArgument);
  EXPECT_THROW(box_part({}, 1, 1), InvalidArgument);
}

// A part of a box that is made alone is one of the whole box; owners are known from all parts together.
TEST(Parts, OfABoxAreMadeAlone) {
  for (const CellType type : {CellType::hexahedron, CellType::tetrahedron, CellType::prism, CellType::pyramid}) {
    for (const std::array<std::uint32_t, 3>& cells :
         {std::array{5U, 4U, 3U}, std::array{1U, 1U, 9U}, std::array{3U, 3U, 1U}}) {
      BoxOptions box;
      box.cells = cells;
      box.size = {1.0, 2.0, 0.7};
      box.type = type;
      box.jitter = 0.2;
      box.blocked_layer = cells[0] == 5;
      const MeshData whole = checked(generate_box(box));
      for (const std::uint32_t parts : {1U, 2U, 3U, 7U, 9U}) {
        std::vector<MeshPart> made;
        std::vector<std::uint32_t> owners(whole.cell_count(), parts);
        for (std::uint32_t p = 0; p < parts; ++p) {
          const MeshPart& part = made.emplace_back(box_part(box, parts, p));
          for (std::size_t c = 0; c < part.cells.size(); ++c) {
            if (part.owners[c] == p) owners[part.cells[c]] = p;
          }
        }
        EXPECT_EQ(std::set<std::uint32_t>(owners.begin(), owners.end()).size(), parts);
        EXPECT_EQ(std::count(owners.begin(), owners.end(), parts), 0);
        for (const MeshPart& part : made) test::expect_is_part(whole, owners, part, std::to_string(parts) + " parts");
        if (HasFailure()) return;
      }
    }
  }
}

// All parts together are the whole; some of them are the part with all of their cells.
TEST(Parts, ArePutTogether) {
  for (const auto& [name, mesh] : meshes()) {
    const std::vector<std::uint32_t> owners = partition(mesh, 6);
    std::vector<MeshPart> parts = all_parts(mesh, owners, 6);
    for (MeshPart& p : parts) p = unpacked_part(packed(p));
    std::vector<std::uint32_t> halves = owners;
    for (std::uint32_t& o : halves) o /= 3;
    for (MeshPart& p : parts) {
      for (std::uint32_t& o : p.owners) o /= 3;
    }
    for (std::uint32_t half = 0; half < 2; ++half) {
      const auto first = parts.begin() + 3 * half;
      test::expect_is_part(mesh, halves, merged_parts({first, first + 3}, 2, half), name);
    }
    const MeshPart all = merged_parts(parts, 1, 0);
    EXPECT_EQ(all.mesh.points, mesh.points);
    EXPECT_EQ(all.mesh.types, mesh.types);
    EXPECT_EQ(all.mesh.connectivity, mesh.connectivity);
    EXPECT_EQ(all.mesh.free, mesh.free);
    EXPECT_EQ(all.mesh.regions, mesh.regions);
    EXPECT_EQ(all.mesh.patch_tags.size(), mesh.patch_tags.size());
  }
}

TEST(Parts, OfOtherMeshesAreNotPutTogether) {
  BoxOptions box;
  box.cells = {4, 2, 2};
  box.size = {1.0, 1.0, 1.0};
  const MeshPart low = box_part(box, 2, 0);
  box.origin.x = 0.25;
  EXPECT_THROW(merged_parts({low, box_part(box, 2, 1)}, 1, 0), InvalidMesh);
  box.origin.x = 0.0;
  MeshPart high = box_part(box, 2, 1);
  high.mesh.connectivity[0] = high.mesh.connectivity[1];
  EXPECT_THROW(merged_parts({low, high}, 1, 0), InvalidMesh);
  const std::string bytes = packed(low);
  for (const std::size_t size : {std::size_t{0}, std::size_t{5}, bytes.size() / 2, bytes.size() - 1})
    EXPECT_THROW(unpacked_part(std::string_view(bytes).substr(0, size)), Error);
}

// The order of cells along a side, found by sorting: the truth for a search without it.
std::vector<std::uint32_t> sorted_halves(const std::vector<Vec3>& middles, const std::vector<std::uint64_t>& weights) {
  std::vector<std::uint32_t> order(middles.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return middles[a].x < middles[b].x; });
  const std::uint64_t all = std::accumulate(weights.begin(), weights.end(), std::uint64_t{0});
  std::vector<std::uint32_t> parts(middles.size(), 1);
  std::uint64_t sum = 0;
  for (const std::uint32_t c : order) {
    if (2 * sum + weights[c] >= all) break;
    parts[c] = 0;
    sum += weights[c];
  }
  return parts;
}

TEST(Bisection, HalvesTheWeight) {
  Random random(3);
  for (int round = 0; round < 200; ++round) {
    std::vector<Vec3> middles(2 + random.below(40));
    std::vector<std::uint64_t> weights(middles.size());
    for (Vec3& m : middles) m = {static_cast<double>(random.below(9)) - 4.0, 0.0, 0.0};
    middles[0].x = -4.0;
    middles[1].x = 4.0;
    for (std::uint64_t& w : weights) w = 1 + random.below(5);
    EXPECT_EQ(bisected(middles, {}, weights, 2), sorted_halves(middles, weights));
  }
}

// Each part has a cell, also where all middles are one, and one cell has all the weight.
TEST(Bisection, GivesEachPartACell) {
  for (const std::uint32_t parts : {1U, 2U, 3U, 7U, 8U}) {
    for (const std::uint64_t heavy : {1U, 1000U}) {
      std::vector<std::uint64_t> weights(8, 1);
      weights[2] = heavy;
      const auto found = bisected(std::vector<Vec3>(8, Vec3{1.0, -2.0, 0.5}), {}, weights, parts);
      EXPECT_EQ(std::set<std::uint32_t>(found.begin(), found.end()).size(), parts);
      EXPECT_LT(*std::max_element(found.begin(), found.end()), parts);
    }
  }
}

// Many parts of a real mesh: their weights differ by little.
TEST(Bisection, BalancesManyParts) {
  BoxOptions box;
  box.cells = {20, 10, 10};
  box.size = {1.0, 1.0, 1.0};
  box.type = CellType::tetrahedron;
  const MeshData mesh = generate_box(box);
  const std::vector<std::uint32_t> parts = partition(mesh, 24);
  std::vector<std::size_t> count(24);
  for (const std::uint32_t p : parts) ++count[p];
  const auto [low, high] = std::minmax_element(count.begin(), count.end());
  EXPECT_LE(*high, *low + 3);
}

// The parts of cells do not depend on which rank has them.
TEST(Bisection, IsTheSameOnAnyNumberOfRanks) {
  const std::vector<Vec3> middles = middles_of(generate_vessel({.core = 2, .rings = 1}));
  Random random(5);
  std::vector<std::uint64_t> weights(middles.size());
  for (std::uint64_t& w : weights) w = 1 + random.below(30);
  const std::vector<std::uint32_t> expected = bisected(middles, {}, weights, 7);
  for (const unsigned count : {2U, 5U}) {
    std::vector<std::uint32_t> owner(middles.size());
    for (std::uint32_t& o : owner) o = random.below(count);
    std::vector<std::uint32_t> found(middles.size());
    std::mutex mutex;
    test::on_ranks(count, [&](Ranks& ranks) {
      std::vector<Vec3> own;
      std::vector<std::uint32_t> numbers;
      std::vector<std::uint64_t> own_weights;
      for (std::uint32_t c = 0; c < owner.size(); ++c) {
        if (owner[c] != ranks.rank()) continue;
        own.push_back(middles[c]);
        numbers.push_back(c);
        own_weights.push_back(weights[c]);
      }
      const std::vector<std::uint32_t> parts = bisected(own, numbers, own_weights, 7, &ranks);
      const std::lock_guard lock(mutex);
      for (std::size_t i = 0; i < numbers.size(); ++i) found[numbers[i]] = parts[i];
    });
    EXPECT_EQ(found, expected);
  }
}

}  // namespace dartcast::parts_test
