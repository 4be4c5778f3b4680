// The closed surface of a barrel.
#include <array>
#include <cmath>

#include "base/elementary.hpp"
#include "dartcast/error.hpp"
#include "dartcast/generators.hpp"

namespace dartcast {

namespace {

constexpr std::int32_t stave_region = 1;
constexpr std::int32_t head_region = 2;

void check_barrel(const BarrelOptions& o) {
  const auto positive = [](double x) { return x > 0.0 && std::isfinite(x); };
  if (!positive(o.height) || !positive(o.radius)) throw InvalidArgument("barrel: height and radius must be positive");
  if (!(o.bulge >= 0.0) || !std::isfinite(o.bulge))
    throw InvalidArgument("barrel: the bulge must be finite and not negative");
  if (!is_finite(o.centre)) throw InvalidArgument("barrel: the centre must be finite");
  constexpr std::uint32_t limit = 1U << 14U;
  if (o.staves < 3 || o.staves > limit) throw InvalidArgument("barrel: the staves must be between 3 and 2^14");
  if (o.rows < 1 || o.rows > limit || o.rings < 1 || o.rings > limit)
    throw InvalidArgument("barrel: rows and rings must be between 1 and 2^14");
}

class BarrelMaker {
 public:
  explicit BarrelMaker(const BarrelOptions& options) : o_(options) {}

  MeshData make() {
    for (std::uint32_t row = 0; row <= o_.rows; ++row) {
      const double s = (static_cast<double>(row) / o_.rows - 0.5) * 2.0;
      add_circle(o_.radius + o_.bulge * (1.0 - s * s), 0.5 * o_.height * s);
    }
    for (std::uint32_t row = 0; row < o_.rows; ++row) add_band(row * o_.staves, (row + 1) * o_.staves, stave_region);
    add_head(0, -0.5 * o_.height, false);
    add_head(o_.rows * o_.staves, 0.5 * o_.height, true);
    mesh_.region_names = {{stave_region, "staves"}, {head_region, "heads"}};
    return std::move(mesh_);
  }

 private:
  std::uint32_t add_circle(double radius, double z) {
    const auto first = static_cast<std::uint32_t>(mesh_.points.size());
    for (std::uint32_t i = 0; i < o_.staves; ++i) {
      const SineCosine turned = sine_cosine_of_turns(static_cast<double>(i) / o_.staves);
      mesh_.points.push_back(o_.centre + Vec3{radius * turned.cosine, radius * turned.sine, z});
    }
    return first;
  }

  void add_face(std::span<const std::uint32_t> corners, std::int32_t region) {
    mesh_.add_cell(corners.size() == 3 ? CellType::triangle : CellType::quadrilateral, corners);
    mesh_.regions.push_back(region);
  }

  // Quadrilaterals between two circles, seen from where the second is above the first as the staves are.
  void add_band(std::uint32_t lower, std::uint32_t upper, std::int32_t region) {
    for (std::uint32_t i = 0; i < o_.staves; ++i) {
      const std::uint32_t j = (i + 1) % o_.staves;
      add_face(std::array{lower + i, lower + j, upper + j, upper + i}, region);
    }
  }

  // From the circle around it inwards.
  void add_head(std::uint32_t outer, double z, bool top) {
    for (std::uint32_t ring = 1; ring < o_.rings; ++ring) {
      const std::uint32_t inner = add_circle(o_.radius * (o_.rings - ring) / o_.rings, z);
      add_band(top ? outer : inner, top ? inner : outer, head_region);
      outer = inner;
    }
    const auto middle = static_cast<std::uint32_t>(mesh_.points.size());
    mesh_.points.push_back(o_.centre + Vec3{0.0, 0.0, z});
    for (std::uint32_t i = 0; i < o_.staves; ++i) {
      const std::uint32_t j = (i + 1) % o_.staves;
      add_face(top ? std::array{middle, outer + i, outer + j} : std::array{middle, outer + j, outer + i}, head_region);
    }
  }

  BarrelOptions o_;
  MeshData mesh_;
};

}  // namespace

MeshData generate_barrel(const BarrelOptions& options) {
  check_barrel(options);
  return BarrelMaker(options).make();
}

}  // namespace dartcast
