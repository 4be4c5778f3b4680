// Runs a scene from a mesh file, writes its frames compressed, and reads one again.
#include <cstdio>

#include "dartcast/generators.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/run.hpp"
#include "dartcast/scene_file.hpp"

void run_part(const char* folder) {
  const std::filesystem::path path(folder);
  write_mesh(dartcast::generate_bar(), path / "bar.msh");
  const char* text = R"(
[environment]
mesh = "bar.msh"
[[particles]]
count = 10
velocity = [1.0, 0.0, 0.0]
[motion]
dt = 0.1
steps = 5
[output]
every = 5
compression = "fast"
)";
  dartcast::RunOptions options;
  options.folder = path / "run";
  const dartcast::Summary summary = dartcast::run_scene(dartcast::parse_scene(text, path / "scene.toml"), options);
  std::printf("%llu particles\n", static_cast<unsigned long long>(summary.alive));
  std::printf("%zu cells\n", dartcast::read_mesh(path / "run" / "environment.vtu").mesh.cell_count());
}
