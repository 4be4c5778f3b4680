// Readers of a scene's tables, but those that are short. Each throws Error, with file, line and key.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

#include "dartcast/scene.hpp"
#include "scene/toml_table.hpp"

namespace dartcast {

/// [environment]: a mesh file or a generator with its parameters, free cells, patches.
EnvironmentScene read_environment(TomlTable table, const std::filesystem::path& folder);

/// One [[particles]].
ParticlesScene read_particles(TomlTable& t, const std::filesystem::path& folder);

/// The keys `field`, `force` and `integrator`, and those that belong to them, after all others of [motion].
void read_fields(TomlTable& motion, const std::filesystem::path& folder, MotionScene& scene);

/// One [[event]].
EventScene read_event(TomlTable& t);

/// One [[body]], [[catheter]] or [[solid]]. `number`: its place among its kind, from 1, for a name if none is given.
BodyScene read_body(TomlTable& t, const std::filesystem::path& folder, std::size_t number, std::uint64_t seed);
CatheterScene read_catheter(TomlTable& t, std::size_t number);
SolidScene read_solid(TomlTable& t, const std::filesystem::path& folder, std::size_t number);

/// [statistics].
StatisticsScene read_statistics(TomlTable t);

}  // namespace dartcast
