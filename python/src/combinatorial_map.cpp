// Binds dartcast/combinatorial_map.hpp. A view of a cell looks the cell up at each question, so that an edit makes it
// stale, never dangling.
#include "dartcast/combinatorial_map.hpp"

#include "bind.hpp"
#include "support/members.hpp"
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
  py::class_<ViewHandle> c(m, "CellView",
                           "A cell of a map. Raises InvalidArgument once an edit has replaced the cell.");
  const auto read_only_of = [&c](const char* name, const char* text, auto f) {
    c.def_property_readonly(
        name, [f](const ViewHandle& h) { return h.look(f); }, text);
  };
  read_only_of("shape", "The cell's Shape: a copy.", [](const CellView& v) { return shape_copy(v.shape()); });
  read_only_of("vertices", "The vertices by their local numbers: uint32 (n,).",
               [](const CellView& v) { return array_of(v.vertices()); });
  read_only_of("is_free", "Whether particles may enter the cell.", [](const CellView& v) { return v.is_free(); });
  c.def_property_readonly(
      "version", [](const ViewHandle& h) { return h.cell.version; }, "That of the cell's handle.");
  c.def(
      "vertex",
      [](const ViewHandle& h, Number local) {
        return h.look([&](const CellView& v) {
          expect_number(local, v.shape().point_count(), "point");
          return v.vertex(local);
        });
      },
      py::arg("local"), "The vertex with a local number.");
  const auto of_face = [&c](const char* name, auto f) {
    c.def(
        name,
        [f](const ViewHandle& h, Number face) {
          return h.look([&](const CellView& v) {
            expect_number(face, v.shape().face_count(), "face");
            return f(v, face);
          });
        },
        about(std::string("CellView::") + name));
  };
  of_face("neighbour", [](const CellView& v, Number face) { return or_none(v.neighbour(face)); });
  of_face("neighbour_face", [](const CellView& v, Number face) {
    if (!v.neighbour(face).valid()) throw InvalidArgument("the face has no neighbour");
    return v.neighbour_face(face);
  });
  of_face("is_wall", [](const CellView& v, Number face) { return v.is_wall(face); });
}

void bind_darts(Class& c) {
  members_of_CombinatorialMap(c);
  method(
      c, "phi2", +[](const Map& map, Dart d) { return or_none(map.phi2(d)); });
  method(
      c, "phi3", +[](const Map& map, Dart d) { return or_none(map.phi3(d)); });
  method(
      c, "alpha1", +[](const Map& map, Dart d) { return or_none(map.alpha1(d)); });
}

void bind_faces(Class& c) {
  method(
      c, "opposite", +[](const Map& map, CellFace f) { return or_none(map.opposite(f)); });
  method(
      c, "point", +[](const Map& map, CellFace f) { return or_none(map.point(f)); });
  c.def("patch", calling<MapHandle>(static_cast<Patch (Map::*)(CellFace) const>(&Map::patch)), py::arg("f"),
        doc("CombinatorialMap::patch"));
  c.def("patch", calling<MapHandle>(+[](const Map& map, std::string name) { return map.patch(name); }),
        py::arg("name"));
}

// One question about one cell, or about an array of cells.
template <class Number, class Function>
void def_of_cells(Class& c, const char* name, const std::string& text, const Function& f) {
  c.def(
      name,
      [f](const MapHandle& h, const Typed<"Cell or Integers">& given)
          -> Either<decltype(f(std::declval<const Map&>(), Cell{})), py::array_t<Number>> {
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
  c.def("contains", calling<MapHandle>(static_cast<bool (Map::*)(CellHandle) const>(&Map::contains)), py::arg("h"));
  c.def(
      "contains",
      [](const MapHandle& h, Cell cell) { return read(h, [&](const Map& map) { return map.contains(cell); }); },
      py::arg("c"), "Whether there is such a cell. Of a CellHandle: whether it is still the same cell.");
  def_of_cells<std::uint8_t>(c, "type", "The CellType of a cell.",
                             [](const Map& map, Cell cell) { return map.type(cell); });
  def_of_cells<std::uint32_t>(c, "source", doc("CombinatorialMap::source"),
                              [](const Map& map, Cell cell) { return map.source(cell); });
  def_of_cells<bool>(c, "is_free", "Whether particles may enter a cell.",
                     [](const Map& map, Cell cell) { return map.is_free(cell); });
  def_of_cells<bool>(c, "has_flat", doc("CombinatorialMap::has_flat"),
                     [](const Map& map, Cell cell) { return map.has_flat(cell); });
  c.def(
      "set_free",
      [](const MapHandle& h, Cell cell, bool free) {
        const Use use(*h.usage, "the map");
        Map& map = changeable(h);
        expect_cell(map, cell);
        map.set_free(cell, free);
      },
      about("CombinatorialMap::set_free"));
}

void bind_sizes(Class& c) {
  c.def(
      "cell_count",
      [](const MapHandle& h, std::optional<std::uint32_t> pool) {
        if (pool) expect_pool(*pool);
        return read(h, [&](const Map& map) { return pool ? map.cell_count(*pool) : map.cell_count(); });
      },
      py::arg("pool") = py::none(), "The number of cells, of all or of one pool.");
  const auto of_pool = [&c](const char* name, auto f) {
    c.def(
        name,
        [f](const MapHandle& h, std::uint32_t pool) {
          expect_pool(pool);
          return read(h, [&](const Map& map) { return (map.*f)(pool); });
        },
        about(std::string("CombinatorialMap::") + name));
  };
  of_pool("slot_count", &Map::slot_count);
  of_pool("type_of", &Map::type_of);
  c.def(
      "is_vertex",
      [](const MapHandle& h, Vertex v) { return read(h, [&](const Map& map) { return map.is_vertex(v); }); },
      about("CombinatorialMap::is_vertex"));
}

// Two maps, or one map twice.
bool are_equal(const MapHandle& a, const MapHandle& b) {
  if (a.usage == b.usage) return read_long(a, [&](const Map& map) { return map == b.object(); });
  const Use use(*b.usage, "the map");
  const Map& other = b.object();
  return read_long(a, [&](const Map& map) { return map == other; });
}

}  // namespace

void bind(py::module_& m) {
  bind_view(m);
  Class c(
      m, "CombinatorialMap",
      "The combinatorial map: darts with phi1, phi2, phi3 over convex cells, free or blocked. It has no coordinates.");
  c.attr("GENERAL_POOL") = Map::general_pool;
  c.def_static("pool_of", &Map::pool_of, about("CombinatorialMap::pool_of"));
  c.def(py::init([](const MeshData& mesh) {
          const MeshUse use(mesh);
          const py::gil_scoped_release release;
          return own_map(Map(checked_mesh(mesh)));
        }),
        py::arg("mesh"),
        "Builds the map of a mesh, as check_and_repair() repairs it; the mesh itself is unchanged. Raises InvalidMesh "
        "where it is refused. Cost: linear, except for sorting.");
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
