// Binds dartcast/environment.hpp: the class, and queries. Sets of particles, adding, moves and steps are in files of
// their own.
#include "dartcast/environment.hpp"

#include <limits>
#include <string>
#include <vector>

#include "bind.hpp"
#include "dartcast/mesh_files.hpp"
#include "dartcast/mesh_selection.hpp"
#include "dartcast/validity.hpp"
#include "support/environments.hpp"
#include "support/members.hpp"
#include "support/rows.hpp"

namespace py = pybind11;

namespace dartcast::python::environment {
namespace {

using FreeNames = std::optional<std::vector<std::string>>;

EnvironmentPointer of_mesh(const MeshData& mesh, Threads threads, const FreeNames& free) {
  const MeshUse use(mesh);
  const py::gil_scoped_release release;
  check_arrays(mesh);
  MeshData copy = mesh;
  if (free) select_free_regions(copy, *free);
  auto kept = std::make_shared<Environment>(std::move(copy), threads);
  auto handle = std::make_shared<EnvironmentHandle>();
  handle->environment = kept.get();
  handle->owner = std::move(kept);
  return handle;
}

EnvironmentPointer of_file(const MeshFile& file, Threads threads, const FreeNames& free) {
  if (!file.report.valid()) throw InvalidMesh(file.report.file + ": " + first_defect(file.report));
  return of_mesh(file.mesh, threads, free);
}

EnvironmentPointer make(const Typed<"MeshData | MeshFile | Path">& mesh, Threads threads, const FreeNames& free) {
  if (py::isinstance<MeshData>(mesh)) return of_mesh(mesh.cast<const MeshData&>(), threads, free);
  if (py::isinstance<MeshFile>(mesh)) return of_file(mesh.cast<const MeshFile&>(), threads, free);
  if (!py::isinstance<py::str>(mesh) && !py::hasattr(mesh, "__fspath__"))
    throw py::type_error("mesh: expected a MeshData, the result of read_mesh(), or the path of a mesh file; got a " +
                         py::type::of(mesh).attr("__name__").cast<std::string>());
  const auto path = mesh.cast<std::filesystem::path>();
  MeshFile file;
  {
    const py::gil_scoped_release release;
    file = read_mesh(path);
  }
  expect_mesh_file(path, file);
  return of_file(file, threads, free);
}

void bind_parts(EnvironmentClass& c) {
  c.def_property_readonly(
      "complex",
      [](const EnvironmentHandle& h) {
        const Use use(*h.usage, "the environment");
        return std::make_shared<ComplexHandle>(ComplexHandle{h.owner, &h.environment->complex(), nullptr, h.usage});
      },
      "The cell complex. It can be read; edit() changes it.");
  c.def_property_readonly(
      "map",
      [](const EnvironmentHandle& h) {
        const Use use(*h.usage, "the environment");
        auto map = std::make_shared<MapHandle>();
        map->owner = h.owner;
        map->map = &h.environment->map();
        map->usage = h.usage;
        return map;
      },
      "The combinatorial map. It can be read; edit() changes it.");
  members_of_Environment(c);
  c.def_property(
      "threads", calling<EnvironmentHandle>(&Environment::threads),
      [](const EnvironmentHandle& h, Threads threads) {
        const Use use(*h.usage, "the environment");
        Environment& e = h.changeable("set the threads of the simulation");
        const py::gil_scoped_release release;
        e.set_threads(threads);
      },
      "The number of threads that calls use; 0: all of the machine. Results never depend on it. Setting it raises "
      "Error, nothing changed, as check_threads().");
}

Typed<"Location or Records"> locate(const EnvironmentHandle& h, const Typed<"Vector or Points">& x) {
  const Use use(*h.usage, "the environment");
  if (py::isinstance<py::array>(x) && py::reinterpret_borrow<py::array>(x).ndim() != 1) {
    const auto points = vectors(x, "x");
    std::vector<Location> found;
    {
      const py::gil_scoped_release release;
      found = h.environment->locate(points);
    }
    return rows_of(found);
  }
  const Vec3 point = vector(x, "x");
  Location found;
  {
    const py::gil_scoped_release release;
    found = h.environment->locate(point);
  }
  return py::cast(found);
}

// Rays, and the cells that they pass if `passed` is given. The lock is held before and after.
py::array hits_of(const EnvironmentHandle& h, const Typed<"Points">& origins, const Typed<"Points">& directions,
                  double max_distance, RayCells* passed) {
  const Use use(*h.usage, "the environment");
  const auto starts = vectors(origins, "origins");
  const auto ways = vectors(directions, "directions");
  std::vector<RayHit> hits;
  {
    const py::gil_scoped_release release;
    hits = h.environment->cast_rays(starts, ways, max_distance, passed);
  }
  return rows_of(hits);
}

py::array numbers_of(const std::vector<Cell>& cells) {
  std::vector<std::uint32_t> numbers;
  numbers.reserve(cells.size());
  for (const Cell cell : cells) numbers.push_back(cell.value);
  return array_of(std::move(numbers));
}

Typed<"Records or tuple[Records, NDArray[uint32], NDArray[uint64]]"> cast_rays(const EnvironmentHandle& h,
                                                                               const Typed<"Points">& origins,
                                                                               const Typed<"Points">& directions,
                                                                               double max_distance, bool cells) {
  RayCells passed;
  const py::array hits = hits_of(h, origins, directions, max_distance, cells ? &passed : nullptr);
  if (!cells) return hits;
  return py::make_tuple(hits, numbers_of(passed.cells),
                        array_of(std::vector<std::uint64_t>(passed.first.begin(), passed.first.end())));
}

Typed<"tuple[Records, NDArray[uint32], NDArray[uint64], NDArray[float64]]"> cast_rays_with_lengths(
    const EnvironmentHandle& h, const Typed<"Points">& origins, const Typed<"Points">& directions, double max_distance,
    bool lengths) {
  if (!lengths) throw InvalidArgument("cast_rays: lengths is False: leave it out");
  RayCells passed;
  const py::array hits = hits_of(h, origins, directions, max_distance, &passed);
  return py::make_tuple(hits, numbers_of(passed.cells),
                        array_of(std::vector<std::uint64_t>(passed.first.begin(), passed.first.end())),
                        array_of(std::move(passed.lengths)));
}

void bind_queries(EnvironmentClass& c) {
  c.def(
      "cast_rays", &cast_rays, py::arg("origins"), py::arg("directions"),
      py::arg("max_distance") = std::numeric_limits<double>::infinity(), py::arg("cells") = false,
      about(
          "Environment::cast_rays",
          "origins, directions: float64 (n, 3). Returns a structured array, one row for each ray: origin (place), hit, "
          "kind, cell, face, triangle, patch, distance, point, normal, invalid_cell. With cells=True a tuple: these "
          "rows, the cells that all rays pass, and of each ray the first of its cells, with their number at the end."));
  c.def("cast_rays", &cast_rays_with_lengths, py::arg("origins"), py::arg("directions"),
        py::arg("max_distance") = std::numeric_limits<double>::infinity(), py::kw_only(), py::arg("lengths"),
        "With lengths=True the tuple of cells=True, and the length of the way in each of these cells.");
  c.def("locate", &locate, py::arg("x"),
        about("Environment::locate",
              "x: one point, or float64 (n, 3). Returns a Location; or a structured array: place, kind, simplex, dart, "
              "cell, dart_cell. NONE stands for no cell."));
  c.def(
      "check_advance",
      [](const EnvironmentHandle& h, const ParticlesHandle& p, const StepOptions& options, const std::string& caller) {
        const UseBoth use(h, p);
        h.environment->check_advance(p.particles, options, caller.c_str());
      },
      py::arg("particles"), py::arg("options") = StepOptions{}, py::arg("caller") = "advance",
      doc("Environment::check_advance"));
}

}  // namespace

void bind(py::module_& m) {
  particles::bind(m);
  EnvironmentClass c(m, "Environment",
                     about("Environment", "It serves one call at a time: a second thread gets InUse."));
  c.def(py::init(&make), py::arg("mesh"), py::arg("threads") = Threads{}, py::arg("free") = py::none(),
        about("Environment::Environment",
              "mesh: MeshData, or what read_mesh() returns, or the path of a mesh file. It is copied, and stays as it "
              "is. free: names of regions whose cells are free, all others are blocked (select_free_regions()); None: "
              "as the mesh says."));
  bind_parts(c);
  bind_queries(c);
  environment_adding::bind(c);
  environment_moves::bind(m, c);
  environment_steps::bind(c);
}

}  // namespace dartcast::python::environment
