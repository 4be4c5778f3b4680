// Binds dartcast/scene.hpp and dartcast/scene_file.hpp: scenes as plain records, and their files.
#include "dartcast/scene.hpp"

#include <utility>

#include "bind.hpp"
#include "dartcast/scene_file.hpp"
#include "support/members.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::scene {
namespace {

void bind_environment_scene(py::module_& m) { function(m, "mesh_surfaces", &mesh_surfaces); }

}  // namespace

void bind(py::module_& m) {
  bind_environment_scene(m);
  m.def(
      "load_scene_files",
      [](const Scene& scene, const ReadOptions& options, Threads threads) {
        Scene copy = scene;
        const ReadOptions own_options = options;
        const py::gil_scoped_release release;
        return load_scene_files(std::move(copy), own_options, threads);
      },
      about("load_scene_files"));
}

}  // namespace dartcast::python::scene
