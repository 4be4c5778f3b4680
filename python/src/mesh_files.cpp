// Binds dartcast/mesh_files.hpp. Paths are texts or os.PathLike.
#include "dartcast/mesh_files.hpp"

#include "bind.hpp"
#include "support/members.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::mesh_files {
namespace {

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
  bind_mesh_file(m);
  m.def(
      "read_mesh",
      [](const std::filesystem::path& path, const ReadOptions& options) {
        const ReadOptions own = options;
        MeshFile file;
        {
          const py::gil_scoped_release release;
          file = read_mesh(path, own);
        }
        expect_mesh_file(path, file);
        return file;
      },
      about("read_mesh",
            "Raises FileNotFoundError where there is no such file, and InvalidArgument for a surface. "
            "`Environment(path)` reads a mesh and takes it if it is valid."));
  function(m, "write_mesh", &write_mesh, "Raises InvalidArgument, too, where the mesh's arrays contradict each other.");
  m.def(
      "write_bytes",
      [](const std::filesystem::path& path, const py::bytes& bytes) {
        const auto content = std::string_view(bytes);
        const py::gil_scoped_release release;
        write_bytes(path, content);
      },
      about("write_bytes"));
}

}  // namespace dartcast::python::mesh_files
