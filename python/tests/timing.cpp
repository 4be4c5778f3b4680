// Times in C++ the calls that timing.py times in Python, on one thread: what Python adds is the difference.
#include <chrono>
#include <cstdio>
#include <random>

#include "dartcast/environment.hpp"
#include "dartcast/generators.hpp"
#include "dartcast/simulation.hpp"

namespace {

template <class Call>
double best(const Call& call, int repeats, int rounds) {
  double least = 1e300;
  for (int r = 0; r < rounds; ++r) {
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < repeats; ++i) call();
    const std::chrono::duration<double, std::micro> spent = std::chrono::steady_clock::now() - start;
    least = std::min(least, spent.count() / repeats);
  }
  return least;
}

}  // namespace

int main() {
  using namespace dartcast;
  BoxOptions options;
  options.cells = {16, 16, 16};
  Environment environment(generate_box(options), {1});
  Particles particles;
  add_random(environment, particles, 1000);
  std::vector<Vec3> targets;
  for (const ParticleState& s : particles.states()) targets.push_back(s.position);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform;
  std::vector<Vec3> points(1'000'000);
  for (Vec3& p : points) p = {uniform(random), uniform(random), uniform(random)};
  static_cast<void>(environment.locate(points[0]));
  std::printf("C++: advance 1,000 standing particles [us]: %.2f\n",
              best([&] { static_cast<void>(environment.advance(particles, targets)); }, 200, 7));
  std::printf("C++: locate 1,000,000 points [us]: %.2f\n",
              best([&] { static_cast<void>(environment.locate(points)); }, 1, 3));
}
