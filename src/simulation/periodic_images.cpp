// Counts the images of particles, and turns their vectors.
#include "simulation/periodic_images.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "complex/periodic_faces.hpp"

namespace dartcast {

namespace {

constexpr auto none = static_cast<std::size_t>(-1);

Vec3 turned(const PeriodicCrossing& c, const Vec3& v) {
  return {dot(c.turn[0], v), dot(c.turn[1], v), dot(c.turn[2], v)};
}

bool is_vector(const std::vector<std::string>& names, std::size_t i) {
  if (i + 2 >= names.size() || !names[i].ends_with("_x")) return false;
  const std::string stem = names[i].substr(0, names[i].size() - 1);
  return names[i + 1] == stem + "y" && names[i + 2] == stem + "z";
}

}  // namespace

std::vector<std::string> image_numbers(const CellComplex& complex) {
  std::vector<std::string> names;
  if (complex.periodic() == nullptr) return names;
  for (const PeriodicPair& pair : complex.periodic()->pairs()) names.push_back("image_" + pair.a);
  return names;
}

PeriodicImages::PeriodicImages(const CellComplex& complex, const std::vector<std::string>& user_data)
    : complex_(complex) {
  for (const std::string& name : image_numbers(complex)) {
    const auto found = std::find(user_data.begin(), user_data.end(), name);
    columns_.push_back(found == user_data.end() ? none : static_cast<std::size_t>(found - user_data.begin()));
  }
  for (std::size_t i = 0; i < user_data.size(); ++i) {
    if (is_vector(user_data, i)) vectors_.push_back(i);
  }
}

CrossingCallback PeriodicImages::callback(ParticleSet& set) const {
  return [this, &set](const PeriodicCrossing& crossing) { cross(crossing, set); };
}

// A translation has ones on the diagonal: then nothing changes but signs of zeros.
void PeriodicImages::cross(const PeriodicCrossing& crossing, ParticleSet& set) const {
  const std::span<double> numbers = set.user_data(crossing.particle);
  const std::size_t column = columns_[crossing.pair];
  if (column != none) numbers[column] += crossing.back ? -1.0 : 1.0;
  Vec3& velocity = set.velocities()[crossing.particle];
  velocity = turned(crossing, velocity);
  for (const std::size_t i : vectors_) {
    const Vec3 v = turned(crossing, {numbers[i], numbers[i + 1], numbers[i + 2]});
    numbers[i] = v.x;
    numbers[i + 1] = v.y;
    numbers[i + 2] = v.z;
  }
}

Vec3 PeriodicImages::unwrapped(const Vec3& position, std::span<const double> user_data) const {
  Vec3 x = position;
  for (std::size_t pair = columns_.size(); pair-- > 0;) {
    if (columns_[pair] == none) continue;
    const double count = user_data[columns_[pair]];
    const detail::PeriodicMotion& back = pairs()->motion({{}, static_cast<std::uint16_t>(pair), count > 0.0});
    x = back.power(std::abs(count)).point(x);
  }
  return x;
}

}  // namespace dartcast
