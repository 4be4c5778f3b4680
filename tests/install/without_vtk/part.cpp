// Runs a scene from a mesh file, writes its frames compressed, and asks for a .vtu file.
#include <cstdio>

#include "dartcast/generators.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/run.hpp"
#include "dartcast/scene_file.hpp"

void run_without_vtk(const char* folder) {
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
  const dartcast::MeshFile frame = dartcast::read_mesh(path / "run" / "environment.vtu");
  std::printf("VTK %d: %s\n", dartcast::has_vtk() ? 1 : 0,
              frame.report.valid() ? "valid" : frame.report.defects.front().message.c_str());
}
