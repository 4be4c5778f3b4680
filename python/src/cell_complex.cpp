// Binds dartcast/cell_complex.hpp.
#include "dartcast/cell_complex.hpp"

#include "bind.hpp"
#include "support/members.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::cell_complex {
namespace {

using Class = py::class_<ComplexHandle, std::shared_ptr<ComplexHandle>>;

std::shared_ptr<ComplexHandle> own_complex(CellComplex&& complex) {
  auto kept = std::make_shared<CellComplex>(std::move(complex));
  return std::make_shared<ComplexHandle>(ComplexHandle{kept, kept.get(), kept.get()});
}

std::shared_ptr<ComplexHandle> copy_of(const ComplexHandle& h) {
  return own_complex(read_long(h, [](const CellComplex& c) { return CellComplex(c); }));
}

// Takes the next positions, as Environment::move() does: those that a move gives.
void move(const ComplexHandle& h, const Typed<"Points">& given) {
  const auto points = vectors(given, "points");
  const Use use(*h.usage, "the complex (an edit of it may be open)");
  if (h.changeable == nullptr)
    throw InvalidArgument("this complex belongs to an environment: call move() of the environment");
  CellComplex& complex = *h.changeable;
  if (points.size() != complex.point_count()) {
    throw InvalidArgument("points: expected " + std::to_string(complex.point_count()) +
                          " positions, one for each point; got " + std::to_string(points.size()));
  }
  const py::gil_scoped_release release;
  std::copy(points.begin(), points.end(), complex.next_positions().begin());
  complex.commit_positions();
}

void bind_positions(Class& c) {
  members_of_CellComplex(c);
  c.def("move", &move, py::arg("points"),
        "Gives the points new positions: float64 (point_count, 3). Steiner points follow. No vertex is checked: see "
        "check_validity(). Raises InvalidArgument where the number is another, or the complex belongs to an "
        "environment.");
  c.def(
      "before_move",
      [](const ComplexHandle& h) {
        return own_complex(read_long(h, [](const CellComplex& x) { return x.before_move(); }));
      },
      "A copy with previous_positions as its positions: with all edits, but without the last move. Cost: linear.");
}

void bind_simplices(Class& c) {
  c.def("corners",
        calling<ComplexHandle>(static_cast<Corners (CellComplex::*)(SimplexId) const>(&CellComplex::corners)),
        py::arg("s"), "The positions of a simplex's corners: float64 (4, 3).");
}

Typed<"MeshData or tuple[MeshData, NDArray[uint32]]"> mesh_of(const ComplexHandle& h, bool with_vertices) {
  std::vector<Vertex> vertices;
  MeshData mesh = read_long(h, [&](const CellComplex& x) { return to_mesh(x, &vertices); });
  py::object made = py::cast(std::move(mesh));
  if (!with_vertices) return made;
  return py::make_tuple(made, vertices);
}

}  // namespace

void bind(py::module_& m) {
  m.def(
      "raised", [](const Corners& v) { return array_of(std::span<const Vec3>(raised(v))); },
      about("raised", "v: four points. Returns float64 (4, 3)."));
  Class c(m, "CellComplex", "The cell complex: a map with positions.");
  c.def(py::init([](const MeshData& mesh, Threads threads) {
          check_threads(threads);
          const MeshUse use(mesh);
          const py::gil_scoped_release release;
          return own_complex(CellComplex(checked_mesh(mesh), threads));
        }),
        about("CellComplex::CellComplex",
              "The mesh is taken as check_and_repair() repairs it, and is itself unchanged. Raises InvalidMesh where "
              "it is refused."));
  c.def_property_readonly(
      "map", [](const ComplexHandle& h) { return std::make_shared<MapHandle>(map_of(h)); },
      "The map. It can be read; ComplexEdit changes it.");
  bind_positions(c);
  bind_simplices(c);
  c.def("__copy__", &copy_of);
  c.def("__deepcopy__", [](const ComplexHandle& h, const py::dict& /*memo*/) { return copy_of(h); });
  m.def("to_mesh", &mesh_of, py::arg("complex"), py::arg("with_vertices") = false,
        "The current cells, pool by pool, with their free marks and their `source` as in the map. Points: the vertices "
        "that they use, at their positions, without Steiner points. There are no regions, patches or data. With "
        "with_vertices: (mesh, the vertex of each point). Cost: linear.");
}

}  // namespace dartcast::python::cell_complex
