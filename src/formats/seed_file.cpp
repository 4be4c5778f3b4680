// Reads where particles start.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include "dartcast/error.hpp"
#include "formats/csv_table.hpp"
#include "formats/point_file.hpp"
#include "formats/scene_files.hpp"

namespace dartcast {

namespace {

constexpr std::array<std::string_view, 6> csv_columns = {"x", "y", "z", "vx", "vy", "vz"};
// Numbers that a file may have of each particle.
struct SeedNumber {
  const char* name;
  std::vector<double> ParticleSeeds::*values;
};
constexpr std::array<SeedNumber, 4> seed_numbers = {{{"radius", &ParticleSeeds::radii},
                                                     {"diameter", &ParticleSeeds::diameters},
                                                     {"density", &ParticleSeeds::densities},
                                                     {"charge_per_mass", &ParticleSeeds::charges_per_mass}}};
const SeedNumber* seed_number(std::string_view name) {
  const auto* const at =
      std::find_if(seed_numbers.begin(), seed_numbers.end(), [&](const SeedNumber& n) { return n.name == name; });
  return at == seed_numbers.end() ? nullptr : at;
}
// A run computes these itself.
constexpr std::array<std::string_view, 5> passed_over = {"id", "cell", "kind", "contacts", "held"};
// ParaView computes these.
constexpr std::array<std::string_view, 5> of_paraview = {"Point ID", "Points:Magnitude", "Points_Magnitude",
                                                         "velocity:Magnitude", "velocity_Magnitude"};

// ParaView's names of the columns in tables that it saves.
void rename_columns_of_paraview(CsvTable& table) {
  static constexpr std::array<std::string_view, 3> points = {"x", "y", "z"};
  static constexpr std::array<std::string_view, 3> velocity = {"vx", "vy", "vz"};
  for (std::size_t k = 0; k < 3; ++k) {
    for (const char between : {':', '_'}) {
      table.rename(fmt::format("Points{}{}", between, k), points[k]);
      table.rename(fmt::format("velocity{}{}", between, k), velocity[k]);
    }
  }
}

template <std::size_t n>
bool is_one_of(const std::array<std::string_view, n>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

ParticleSeeds read_csv_seeds(const std::filesystem::path& path, const ReadOptions& options) {
  CsvTable table(path, options.max_memory);
  rename_columns_of_paraview(table);
  std::vector<std::size_t> columns;
  for (const char* name : {"x", "y", "z"}) columns.push_back(table.column(name, "x, y and z"));
  for (const std::string& name : table.names()) {
    if (!is_one_of(csv_columns, name) && seed_number(name) == nullptr && !is_one_of(passed_over, name) &&
        !is_one_of(of_paraview, name))
      table.fail(fmt::format(
          "the column '{}' is unknown; there are x, y, z, vx, vy, vz, radius, diameter, density and charge_per_mass",
          name));
  }
  const bool moving = table.has("vx") || table.has("vy") || table.has("vz");
  for (const char* name : {"vx", "vy", "vz"}) {
    if (moving) columns.push_back(table.column(name, "vx, vy and vz, or none of them"));
  }
  const std::size_t first_number = columns.size();
  std::vector<const SeedNumber*> numbers;
  for (const SeedNumber& n : seed_numbers) {
    if (!table.has(n.name)) continue;
    columns.push_back(table.column(n.name, n.name));
    numbers.push_back(&n);
  }
  const std::vector<double> values = table.rows(columns);
  ParticleSeeds seeds;
  for (std::size_t at = 0; at < values.size(); at += columns.size()) {
    const double* row = &values[at];
    seeds.points.push_back({row[0], row[1], row[2]});
    if (moving) seeds.velocities.push_back({row[3], row[4], row[5]});
    for (std::size_t k = 0; k < numbers.size(); ++k) (seeds.*numbers[k]->values).push_back(row[first_number + k]);
  }
  return seeds;
}

void check_components(const std::filesystem::path& path, const DataArray& array, std::size_t components) {
  if (array.components != components)
    throw Error(fmt::format("{}: the array '{}' has {} components; it must have {}", path.string(), array.name,
                            array.components, components));
}

ParticleSeeds read_vtp_seeds(const std::filesystem::path& path, const ReadOptions& options) {
  PointFile file = read_points(path, options);
  ParticleSeeds seeds;
  seeds.points = std::move(file.points);
  for (DataArray& array : file.arrays) {
    if (array.name == "velocity") {
      check_components(path, array, 3);
      for (std::size_t i = 0; i < array.values.size(); i += 3)
        seeds.velocities.push_back({array.values[i], array.values[i + 1], array.values[i + 2]});
    } else if (const SeedNumber* const number = seed_number(array.name)) {
      check_components(path, array, 1);
      seeds.*number->values = std::move(array.values);
    } else if (!is_one_of(passed_over, array.name)) {
      throw Error(
          fmt::format("{}: the point array '{}' is unknown; there are velocity, radius, diameter, density and "
                      "charge_per_mass",
                      path.string(), array.name));
    }
  }
  return seeds;
}

void check_values(const std::filesystem::path& path, const ParticleSeeds& seeds) {
  for (std::size_t i = 0; i < seeds.velocities.size(); ++i) {
    const Vec3& v = seeds.velocities[i];
    if (!is_finite(v))
      throw Error(fmt::format("{}: the velocity of position {} (counted from 0) is ({}, {}, {}): it must be finite",
                              path.string(), i, v.x, v.y, v.z));
  }
  for (const SeedNumber& n : seed_numbers) {
    const bool may_be_negative = n.values == &ParticleSeeds::charges_per_mass;
    const std::vector<double>& values = seeds.*n.values;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if ((may_be_negative || values[i] >= 0.0) && std::isfinite(values[i])) continue;
      throw Error(fmt::format("{}: the {} of position {} (counted from 0) is {}: it must be {}finite", path.string(),
                              n.name, i, values[i], may_be_negative ? "" : "0 or more, and "));
    }
  }
}

}  // namespace

ParticleSeeds read_seeds(const std::filesystem::path& path, const ReadOptions& options) {
  const bool csv = path.extension() == ".csv" && std::filesystem::is_regular_file(path);
  ParticleSeeds seeds = csv ? read_csv_seeds(path, options) : read_vtp_seeds(path, options);
  check_values(path, seeds);
  seeds.name = path.string();
  return seeds;
}

}  // namespace dartcast
