// Binds dartcast/combinatorial_map.hpp. A view of a cell looks the cell up at each question, so that an edit makes it
// stale, never dangling.
#include "dartcast/combinatorial_map.hpp"

#include "bind.hpp"
#include "support/map_checks.hpp"
#include "support/meshes.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::combinatorial_map {
namespace {

using Map = CombinatorialMap;
using Class = py::class_<MapHandle, std::shared_ptr<MapHandle>>;

std::shared_ptr<MapHandle> own_map(Map&& map) {
  auto kept = std::make_shared<Map>(std::move(map));
  return std::make_shared<MapHandle>(MapHandle{kept, kept.get(), kept.get()});
}

std::shared_ptr<MapHandle> copy_of(const MapHandle& h) {
  return own_map(read_long(h, [](const Map& map) { return Map(map); }));
}

Map& changeable(const MapHandle& h) {
  if (h.changeable == nullptr)
    throw InvalidArgument("this map belongs to a complex, an environment or an edit: change it there");
  return *h.changeable;
}

/// A cell of a map, looked up at each question.
struct ViewHandle {
  std::shared_ptr<MapHandle> map;
  CellHandle cell;

  template <class Function>
  auto look(const Function& f) const {
    return read(*map, [&](const Map& m) {
      if (!m.contains(cell)) throw InvalidArgument("an edit replaced the cell of this view: look it up anew");
      return f(m.view(cell.cell));
    });
  }
};

std::shared_ptr<Shape> shape_copy(const Shape& shape) { return std::make_shared<Shape>(shape.key()); }

void bind_view(py::module_& m) {
  using Number = std::uint16_t;
  const auto at_face = [](const CellView& v, Number face) { expect_number(face, v.shape().face_count(), "face"); };
  py::class_<ViewHandle>(m, "CellView", "A cell of a map. Raises InvalidArgument once an edit has replaced the cell.")
      .def_property_readonly(
          "shape", [](const ViewHandle& h) { return h.look([](const CellView& v) { return shape_copy(v.shape()); }); },
          "The cell's Shape: a copy.")
      .def(
          "vertex",
          [](const ViewHandle& h, Number local) {
            return h.look([&](const CellView& v) {
              expect_number(local, v.shape().point_count(), "point");
              return v.vertex(local);
            });
          },
          py::arg("local"), "The vertex with a local number.")
      .def_property_readonly(
          "vertices",
          [](const ViewHandle& h) { return h.look([](const CellView& v) { return array_of(v.vertices()); }); },
          "The vertices by their local numbers: uint32 (n,).")
      .def_property_readonly(
          "is_free", [](const ViewHandle& h) { return h.look([](const CellView& v) { return v.is_free(); }); },
          "Whether particles may enter the cell.")
      .def_property_readonly(
          "version", [](const ViewHandle& h) { return h.cell.version; }, "That of the cell's handle.")
      .def(
          "neighbour",
          [at_face](const ViewHandle& h, Number face) {
            return h.look([&](const CellView& v) {
              at_face(v, face);
              return v.neighbour(face);
            });
          },
          py::arg("face"), doc("CellView::neighbour"))
      .def(
          "neighbour_face",
          [at_face](const ViewHandle& h, Number face) {
            return h.look([&](const CellView& v) {
              at_face(v, face);
              if (!v.neighbour(face).valid()) throw InvalidArgument("the face has no neighbour");
              return v.neighbour_face(face);
            });
          },
          py::arg("face"), doc("CellView::neighbour_face"))
      .def(
          "is_wall",
          [at_face](const ViewHandle& h, Number face) {
            return h.look([&](const CellView& v) {
              at_face(v, face);
              return v.is_wall(face);
            });
          },
          py::arg("face"), doc("CellView::is_wall"));
}

void bind_darts(Class& c) {
  const auto def = [&c](const char* name, const char* text, auto f) {
    c.def(
        name,
        [f](const MapHandle& h, Dart d) {
          return read(h, [&](const Map& map) {
            expect_dart(map, d);
            return f(map, d);
          });
        },
        py::arg("d"), text);
  };
  def("phi1", "The next dart of the face.", [](const Map& map, Dart d) { return map.phi1(d); });
  def("phi_1", "The dart before it in the face.", [](const Map& map, Dart d) { return map.phi_1(d); });
  def("phi2", doc("CombinatorialMap::phi2"), [](const Map& map, Dart d) { return map.phi2(d); });
  def("phi3", doc("CombinatorialMap::phi3"), [](const Map& map, Dart d) { return map.phi3(d); });
  def("alpha1", doc("CombinatorialMap::alpha1"), [](const Map& map, Dart d) { return map.alpha1(d); });
  def("origin", "The vertex that the dart starts from.", [](const Map& map, Dart d) { return map.origin(d); });
  def("face", "The face of the dart.", [](const Map& map, Dart d) { return map.face(d); });
  def("flat", "Marks that edits left at the dart.", [](const Map& map, Dart d) { return map.flat(d); });
}

void bind_faces(Class& c) {
  const auto def = [&c](const char* name, auto f) {
    c.def(
        name,
        [f](const MapHandle& h, CellFace face) {
          return read(h, [&](const Map& map) {
            expect_face(map, face);
            return f(map, face);
          });
        },
        py::arg("f"), doc(std::string("CombinatorialMap::") + name));
  };
  def("opposite", [](const Map& map, CellFace f) { return map.opposite(f); });
  def("point", [](const Map& map, CellFace f) { return map.point(f); });
  def("patch", [](const Map& map, CellFace f) { return map.patch(f); });
  c.def(
      "patch",
      [](const MapHandle& h, const std::string& name) {
        return read(h, [&](const Map& map) { return map.patch(name); });
      },
      py::arg("name"), doc("CombinatorialMap::patch"));
  c.def_property_readonly(
      "patch_names", [](const MapHandle& h) { return read(h, [](const Map& map) { return map.patch_names(); }); },
      doc("CombinatorialMap::patch_names"));
  c.def(
      "wall_face_count",
      [](const MapHandle& h) { return read_long(h, [](const Map& map) { return map.wall_face_count(); }); },
      doc("CombinatorialMap::wall_face_count"));
}

// One question about one cell, or about an array of cells.
template <class Number, class Function>
void def_of_cells(Class& c, const char* name, const std::string& text, const Function& f) {
  c.def(
      name,
      [f](const MapHandle& h, const py::object& given) -> py::object {
        if (!py::isinstance<py::array>(given)) {
          const auto cell = given.cast<Cell>();
          return read(h, [&](const Map& map) {
            expect_cell(map, cell);
            return py::cast(f(map, cell));
          });
        }
        const auto cells = given.cast<std::vector<Cell>>();
        py::array_t<Number> values(static_cast<py::ssize_t>(cells.size()));
        Number* value = values.mutable_data();
        read_long(h, [&](const Map& map) {
          for (std::size_t i = 0; i < cells.size(); ++i) {
            expect_cell(map, cells[i]);
            value[i] = static_cast<Number>(f(map, cells[i]));
          }
        });
        return values;
      },
      py::arg("c"), (text + "\n\nOf an array of cells: an array (n,).").c_str());
}

void bind_cells(Class& c) {
  c.def(
      "view",
      [](const std::shared_ptr<MapHandle>& h, Cell cell) {
        return ViewHandle{h, read(*h, [&](const Map& map) {
                            expect_cell(map, cell);
                            return map.handle(cell);
                          })};
      },
      py::arg("c"), "A view of a cell.");
  c.def(
      "shape",
      [](const MapHandle& h, Cell cell) {
        return read(h, [&](const Map& map) {
          expect_cell(map, cell);
          return shape_copy(map.shape(cell));
        });
      },
      py::arg("c"), "The Shape of a cell: a copy.");
  c.def(
      "contains",
      [](const MapHandle& h, const CellHandle& cell) {
        return read(h, [&](const Map& map) { return map.contains(cell); });
      },
      py::arg("h"));
  c.def(
      "contains",
      [](const MapHandle& h, Cell cell) { return read(h, [&](const Map& map) { return map.contains(cell); }); },
      py::arg("c"), "Whether there is such a cell. Of a CellHandle: whether it is still the same cell.");
  c.def(
      "handle",
      [](const MapHandle& h, Cell cell) {
        return read(h, [&](const Map& map) {
          expect_cell(map, cell);
          return map.handle(cell);
        });
      },
      py::arg("c"), "The handle of a cell. Raises InvalidArgument where there is no such cell.");
  def_of_cells<std::uint8_t>(c, "type", "The CellType of a cell.",
                             [](const Map& map, Cell cell) { return map.type(cell); });
  def_of_cells<std::uint32_t>(c, "source", doc("CombinatorialMap::source"),
                              [](const Map& map, Cell cell) { return map.source(cell); });
  def_of_cells<bool>(c, "is_free", "Whether particles may enter a cell.",
                     [](const Map& map, Cell cell) { return map.is_free(cell); });
  def_of_cells<bool>(c, "has_flat", doc("CombinatorialMap::has_flat"),
                     [](const Map& map, Cell cell) { return map.has_flat(cell); });
  c.def(
      "cells", [](const MapHandle& h) { return read_long(h, [](const Map& map) { return map.cells(); }); },
      "All cells, pool by pool: uint32 (n,).");
  c.def(
      "set_free",
      [](const MapHandle& h, Cell cell, bool free) {
        const Use use(*h.usage, "the map");
        Map& map = changeable(h);
        expect_cell(map, cell);
        map.set_free(cell, free);
      },
      py::arg("c"), py::arg("free"), doc("CombinatorialMap::set_free"));
}

void bind_sizes(Class& c) {
  c.def_property_readonly(
      "dimension", [](const MapHandle& h) { return read(h, [](const Map& map) { return map.dimension(); }); },
      doc("CombinatorialMap::dimension"));
  c.def(
      "cell_count",
      [](const MapHandle& h, std::optional<std::uint32_t> pool) {
        if (pool) expect_pool(*pool);
        return read(h, [&](const Map& map) { return pool ? map.cell_count(*pool) : map.cell_count(); });
      },
      py::arg("pool") = py::none(), "The number of cells, of all or of one pool.");
  c.def(
      "slot_count",
      [](const MapHandle& h, std::uint32_t pool) {
        expect_pool(pool);
        return read(h, [&](const Map& map) { return map.slot_count(pool); });
      },
      py::arg("pool"), doc("CombinatorialMap::slot_count"));
  c.def(
      "type_of",
      [](const MapHandle& h, std::uint32_t pool) {
        expect_pool(pool);
        return read(h, [&](const Map& map) { return map.type_of(pool); });
      },
      py::arg("pool"), doc("CombinatorialMap::type_of"));
  c.def_property_readonly(
      "vertex_count", [](const MapHandle& h) { return read(h, [](const Map& map) { return map.vertex_count(); }); },
      doc("CombinatorialMap::vertex_count"));
  c.def(
      "is_vertex",
      [](const MapHandle& h, Vertex v) { return read(h, [&](const Map& map) { return map.is_vertex(v); }); },
      py::arg("v"), doc("CombinatorialMap::is_vertex"));
  c.def(
      "may_touch_wall",
      [](const MapHandle& h, Vertex v) {
        return read(h, [&](const Map& map) {
          expect_vertex(map, v);
          return map.may_touch_wall(v);
        });
      },
      py::arg("v"), doc("CombinatorialMap::may_touch_wall"));
  c.def_property_readonly(
      "bytes", [](const MapHandle& h) { return read_long(h, [](const Map& map) { return map.bytes(); }); },
      "Size in memory.");
}

// Two maps, or one map twice.
bool are_equal(const MapHandle& a, const MapHandle& b) {
  if (a.usage == b.usage) return read_long(a, [&](const Map& map) { return map == b.read(); });
  const Use use(*b.usage, "the map");
  const Map& other = b.read();
  return read_long(a, [&](const Map& map) { return map == other; });
}

}  // namespace

void bind(py::module_& m) {
  bind_view(m);
  Class c(
      m, "CombinatorialMap",
      "The combinatorial map: darts with phi1, phi2, phi3 over convex cells, free or blocked. It has no coordinates.");
  c.attr("GENERAL_POOL") = Map::general_pool;
  c.def_static("pool_of", &Map::pool_of, py::arg("type"), doc("CombinatorialMap::pool_of"));
  Record<Map::Flat>(c, "Flat", "CombinatorialMap::Flat")
      .field("straight", &Map::Flat::straight)
      .field("coplanar", &Map::Flat::coplanar)
      .finish();
  c.def(py::init([](const MeshData& mesh) {
          const MeshUse use(mesh);
          const py::gil_scoped_release release;
          return own_map(Map(checked_mesh(mesh)));
        }),
        py::arg("mesh"),
        "Builds the map of a mesh, as check_and_repair() repairs it; the mesh itself is unchanged. Raises InvalidMesh "
        "where "
        "it is refused. Cost: linear, except for sorting.");
  bind_darts(c);
  bind_faces(c);
  bind_cells(c);
  bind_sizes(c);
  c.def(
      "__eq__",
      [](const MapHandle& a, const py::object& b) {
        return py::isinstance<MapHandle>(b) && are_equal(a, b.cast<const MapHandle&>());
      },
      doc("CombinatorialMap::operator=="));
  c.def("__copy__", &copy_of);
  c.def("__deepcopy__", [](const MapHandle& h, const py::dict& /*memo*/) { return copy_of(h); });
}

}  // namespace dartcast::python::combinatorial_map
