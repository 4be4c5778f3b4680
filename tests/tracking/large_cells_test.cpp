// Walks through a cell of more faces than three bits number, and of more simplices than a table of exits has.
#include <gtest/gtest.h>

#include "base/elementary.hpp"
#include "base/random.hpp"
#include "support/random_vectors.hpp"
#include "topology/exit_table.hpp"
#include "tracking/batch/batch_stepper.hpp"
#include "tracking/locate.hpp"
#include "tracking/step.hpp"

namespace dartcast::test::large_cells_test {

using Numbers = std::vector<std::uint32_t>;

// A prism over a polygon, in a ring of hexahedra.
MeshData prism_in_ring(std::uint32_t n) {
  MeshData mesh;
  for (const double radius : {1.0, 1.2}) {
    for (const double z : {0.0, 1.0}) {
      for (std::uint32_t i = 0; i < n; ++i) {
        const SineCosine at = sine_cosine_of_turns(double(i) / n);
        mesh.points.push_back({radius * at.cosine, radius * at.sine, z});
      }
    }
  }
  Numbers prism = {n + 2, n};
  for (std::uint32_t i = n; i-- > 0;) prism.push_back(i);
  prism.push_back(n);
  for (std::uint32_t i = 0; i < n; ++i) prism.push_back(n + i);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    prism.insert(prism.end(), {4, i, j, n + j, n + i});
    mesh.add_cell(CellType::hexahedron, Numbers{i, 2 * n + i, 2 * n + j, j, n + i, 3 * n + i, 3 * n + j, n + j});
  }
  mesh.add_cell(CellType::polyhedron, prism);
  return mesh;
}

struct Crowd {
  std::vector<ParticleState> states;
  std::vector<Weights> weights;
  detail::ParticleCache cache;
};

Crowd crowd_in(const CellComplex& complex, std::size_t count, Random& random) {
  const Locator locator(complex);
  Crowd crowd;
  while (crowd.states.size() < count) {
    const Vec3 x = {2.4 * random.uniform() - 1.2, 2.4 * random.uniform() - 1.2, random.uniform()};
    const SimplexId at = locator.find(complex, x);
    if (!at.valid()) continue;
    crowd.states.emplace_back().put(at, x);
    crowd.weights.emplace_back();
    crowd.cache.add(complex, at, x);
  }
  return crowd;
}

void expect_same_steps(std::uint32_t corners, bool has_table) {
  CellComplex complex(prism_in_ring(corners));
  ASSERT_TRUE(complex.invalid_cells().empty());
  ASSERT_EQ(complex.map().shape(Cell(CombinatorialMap::general_pool, 0)).exits().empty(), !has_table);
  Random random(corners);
  Crowd crowd = crowd_in(complex, 60, random);
  const ContactCallback stop;
  const StepOptions options;
  for (int round = 0; round < 12; ++round) {
    const bool moved = round % 3 == 2;
    if (moved) {
      const auto next = complex.next_positions();
      for (std::size_t v = 0; v < next.size(); ++v) next[v] = complex.positions()[v] * 1.01;
      complex.commit_positions();
    }
    std::vector<Vec3> targets;
    for (const ParticleState& s : crowd.states) {
      const double length = std::ldexp(1.0, -static_cast<int>(random.below(10)));
      targets.push_back(flushed(s.position + length * Vec3{random.uniform() - 0.5, random.uniform() - 0.5, 0.1}));
    }
    const Stepper stepper(complex, moved, options, stop);
    std::vector<ParticleState> expected = crowd.states;
    for (std::uint32_t i = 0; i < expected.size(); ++i) {
      ContactList contacts;
      Counters counters;
      Weights weights = crowd.weights[i];
      stepper.step(i, expected[i], weights, targets[i], contacts, counters);
    }
    detail::BatchStepper(complex, moved, {}, options, stop, false)
        .advance({crowd.states, crowd.weights, crowd.cache}, targets);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      ASSERT_EQ(crowd.states[i].at(), expected[i].at()) << "round " << round << ", particle " << i;
      ASSERT_EQ(crowd.states[i].position, expected[i].position) << "round " << round << ", particle " << i;
    }
  }
}

TEST(LargeCells, BatchesWalkAsSingleSteps) {
  expect_same_steps(60, true);
  expect_same_steps(1367, true);   // 4095 simplices
  expect_same_steps(1368, false);  // 4098
  expect_same_steps(2730, false);  // 16380 darts
}

}  // namespace dartcast::test::large_cells_test
