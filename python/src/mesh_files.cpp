// Binds dartcast/mesh_files.hpp. Paths are texts or os.PathLike.
#include "dartcast/mesh_files.hpp"

#include "bind.hpp"
#include "support/meshes.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::mesh_files {
namespace {

namespace fs = std::filesystem;

void bind_reading(py::module_& m, const char* name, MeshFile (*read)(const fs::path&, const ReadOptions&)) {
  m.def(
      name,
      [read](const fs::path& path, const ReadOptions& options) {
        const ReadOptions own = options;
        const py::gil_scoped_release release;
        return read(path, own);
      },
      py::arg("path"), py::arg("options") = ReadOptions{}, doc(name));
}

void bind_mesh_file(py::module_& m) {
  py::class_<MeshFile, std::shared_ptr<MeshFile>>(m, "MeshFile",
                                                  "A mesh and the report on it: `mesh, report = read_mesh(path)`.")
      .def(py::init([](const MeshData& mesh, const MeshReport& report) {
             return MeshFile{mesh, report};
           }),
           py::arg("mesh") = MeshData{}, py::arg("report") = MeshReport{})
      .def_property(
          "mesh", [](MeshFile& f) -> MeshData& { return f.mesh; },
          [](MeshFile& f, const MeshData& mesh) {
            const MeshUse use(f.mesh, true);
            f.mesh = mesh;
          },
          py::return_value_policy::reference_internal, doc("MeshFile::mesh"))
      .def_property(
          "report", [](const MeshFile& f) { return f.report; },
          [](MeshFile& f, const MeshReport& report) { f.report = report; }, "The report: a copy.")
      .def("__iter__", [](const py::object& f) { return py::iter(py::make_tuple(f.attr("mesh"), f.attr("report"))); })
      .def("__repr__", [](const MeshFile& f) { return "<dartcast.MeshFile: '" + f.report.file + "'>"; });
}

}  // namespace

void bind(py::module_& m) {
  Record<ReadOptions>(m, "ReadOptions")
      .field("patch_array", &ReadOptions::patch_array)
      .field("max_memory", &ReadOptions::max_memory)
      .field("linearise", &ReadOptions::linearise)
      .field("kept_mesh", &ReadOptions::kept_mesh)
      .finish();
  bind_mesh_file(m);
  m.def("writable_mesh_endings", &writable_mesh_endings, doc("writable_mesh_endings"));
  m.def("mesh_endings", &mesh_endings, doc("mesh_endings"));
  m.def("surface_endings", &surface_endings, doc("surface_endings"));
  m.def("is_surface_file", &is_surface_file, py::arg("path"), doc("is_surface_file"));
  bind_reading(m, "read_mesh", &read_mesh);
  bind_reading(m, "read_valid_mesh", &read_valid_mesh);
  bind_reading(m, "check_surface", &check_surface);
  bind_reading(m, "read_surface", &read_surface);
  m.def(
      "check_mesh",
      [](const fs::path& path, Threads threads, const ReadOptions& options, bool without_bad_cells) {
        check_threads(threads);
        const ReadOptions own = options;
        const py::gil_scoped_release release;
        return check_mesh(path, threads, own, without_bad_cells);
      },
      py::arg("path"), py::arg("threads") = Threads{}, py::arg("options") = ReadOptions{},
      py::arg("without_bad_cells") = false, doc("check_mesh"));
  m.def(
      "write_mesh",
      [](const MeshData& mesh, const fs::path& path) {
        check_arrays(mesh);
        const MeshUse use(mesh);
        const py::gil_scoped_release release;
        write_mesh(mesh, path);
      },
      py::arg("mesh"), py::arg("path"),
      (std::string(doc("write_mesh")) +
       "\n\nRaises InvalidArgument, too, where the mesh's arrays contradict each other.")
          .c_str());
  m.def(
      "write_bytes",
      [](const fs::path& path, const py::bytes& bytes) {
        const auto content = std::string_view(bytes);
        const py::gil_scoped_release release;
        write_bytes(path, content);
      },
      py::arg("path"), py::arg("bytes"), doc("write_bytes"));
}

}  // namespace dartcast::python::mesh_files
