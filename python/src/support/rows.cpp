// Records of C++ as rows of structured arrays, and states back from rows.
#include "support/rows.hpp"

#include <algorithm>

#include "support/arrays.hpp"
#include "support/ids.hpp"

namespace py = pybind11;

namespace dartcast::python {
namespace {

Row3 row(const Vec3& v) { return {v.x, v.y, v.z}; }

template <class Row, class Items, class Function>
py::array made_rows(const Items& items, const Function& fill) {
  std::vector<Row> rows(items.size());
  {
    const py::gil_scoped_release release;
    for (std::size_t i = 0; i < items.size(); ++i) fill(items[i], rows[i]);
  }
  return array_of(std::move(rows));
}

// The dart's number is used where its cell is valid.
template <class Row>
void fill_location(const Location& l, Row& r) {
  r.place = static_cast<std::uint8_t>(l.place);
  r.kind = static_cast<std::uint8_t>(l.kind);
  r.simplex = l.simplex.simplex;
  r.cell = l.simplex.cell.value;
  r.dart_cell = l.dart.cell.value;
  r.dart = l.dart.number;
}

bool same_fields(const py::dtype& a, const py::dtype& b) {
  const auto names = b.attr("names");
  if (!a.attr("names").equal(names)) return false;
  return std::all_of(names.begin(), names.end(), [&](const py::handle field) {
    return a.attr("fields")[field][py::int_(0)].equal(b.attr("fields")[field][py::int_(0)]);
  });
}

}  // namespace

void register_rows() {
  PYBIND11_NUMPY_DTYPE(ContactRow, particle, kind, last, patch, time_of_impact, point, normal, wall_displacement,
                       displacement, unused, first_wall, wall_count, earlier, together, cell, dart);
  PYBIND11_NUMPY_DTYPE(WallRow, cell, face, triangle, patch, normal);
  PYBIND11_NUMPY_DTYPE(StateRow, position, cell, simplex, touching_count, held, touching_cell, touching_face);
  PYBIND11_NUMPY_DTYPE(LocationRow, place, kind, simplex, dart, cell, dart_cell);
  PYBIND11_NUMPY_DTYPE(AddRow, particle, place, kind, simplex, dart, cell, dart_cell);
  PYBIND11_NUMPY_DTYPE(RayRow, origin, hit, kind, cell, face, triangle, patch, distance, point, normal, invalid_cell);
  PYBIND11_NUMPY_DTYPE(HeldRow, particle, cell);
  PYBIND11_NUMPY_DTYPE(StoppedRow, particle, unused);
  PYBIND11_NUMPY_DTYPE(OverlapRow, particle, cell, face, depth, left, point, normal);
  PYBIND11_NUMPY_DTYPE(SolidContactRow, solid, kind, count, wall_kind, vertices, weights, cell, face, triangle, dart,
                       patch, time_of_impact, gap, point, wall_point, normal, displacement, wall_displacement);
  PYBIND11_NUMPY_DTYPE(OrphanRow, particle, place, outcome, position, distance);
}

py::array rows_of(const std::vector<Contact>& contacts, std::span<const WallHit> walls) {
  return made_rows<ContactRow>(contacts, [&](const Contact& c, ContactRow& r) {
    const WallHit& wall = walls[c.first_wall];
    r = {c.particle,
         static_cast<std::uint8_t>(c.kind),
         c.last,
         wall.patch.value,
         c.time_of_impact,
         row(c.point),
         row(wall.normal),
         row(c.wall_displacement),
         row(c.displacement),
         row(c.unused),
         c.first_wall,
         c.wall_count,
         c.earlier,
         c.together,
         c.dart.cell.value,
         c.dart.number};
  });
}

py::array rows_of(std::span<const WallHit> walls) {
  return made_rows<WallRow>(walls, [](const WallHit& w, WallRow& r) {
    r = {w.face.cell.value, w.face.face, w.triangle, w.patch.value, row(w.normal)};
  });
}

py::array rows_of(std::span<const ParticleState> states) {
  return made_rows<StateRow>(states, [](const ParticleState& s, StateRow& r) {
    r.position = row(s.position);
    r.cell = s.cell.value;
    r.simplex = s.simplex;
    r.touching_count = s.touching_count;
    r.held = s.held;
    for (std::size_t k = 0; k < 3; ++k) {
      r.touching_cell[k] = s.touching[k].cell.value;
      r.touching_face[k] = s.touching[k].face;
    }
  });
}

py::array rows_of(const std::vector<Location>& locations) {
  return made_rows<LocationRow>(locations, fill_location<LocationRow>);
}

py::array rows_of(const std::vector<AddResult>& added) {
  return made_rows<AddRow>(added, [](const AddResult& a, AddRow& r) {
    r.particle = a.particle;
    fill_location(a.location, r);
  });
}

py::array rows_of(const std::vector<RayHit>& hits) {
  return made_rows<RayRow>(hits, [](const RayHit& h, RayRow& r) {
    r = {static_cast<std::uint8_t>(h.origin),
         h.hit,
         static_cast<std::uint8_t>(h.kind),
         h.face.cell.value,
         h.face.face,
         h.triangle,
         h.patch.value,
         h.distance,
         row(h.point),
         row(h.normal),
         h.invalid_cell.value};
  });
}

py::array rows_of(const std::vector<HeldParticle>& held) {
  return made_rows<HeldRow>(held, [](const HeldParticle& h, HeldRow& r) { r = {h.particle, h.cell.value}; });
}

py::array rows_of(const std::vector<StoppedParticle>& stopped) {
  return made_rows<StoppedRow>(stopped, [](const StoppedParticle& s, StoppedRow& r) {
    r = {s.particle, row(s.unused)};
  });
}

py::array rows_of(const std::vector<SphereOverlap>& overlaps) {
  return made_rows<OverlapRow>(overlaps, [](const SphereOverlap& o, OverlapRow& r) {
    r = {o.particle, o.face.cell.value, o.face.face, o.depth, o.left, row(o.point), row(o.normal)};
  });
}

py::array rows_of(const std::vector<SolidContact>& contacts) {
  return made_rows<SolidContactRow>(contacts, [](const SolidContact& c, SolidContactRow& r) {
    r = {c.solid,
         static_cast<std::uint8_t>(c.kind),
         c.count,
         static_cast<std::uint8_t>(c.wall_kind),
         c.vertices,
         c.weights,
         c.face.cell.value,
         c.face.face,
         c.triangle,
         c.dart.number,
         c.patch.value,
         c.time_of_impact,
         c.gap,
         row(c.point),
         row(c.wall_point),
         row(c.normal),
         row(c.displacement),
         row(c.wall_displacement)};
  });
}

py::array rows_of(const std::vector<OrphanedParticle>& orphaned) {
  return made_rows<OrphanRow>(orphaned, [](const OrphanedParticle& o, OrphanRow& r) {
    r = {o.particle, static_cast<std::uint8_t>(o.place), static_cast<std::uint8_t>(o.outcome), row(o.position),
         o.distance};
  });
}

py::array structured(const py::object& x, const py::dtype& wanted, const char* name, const char* expected,
                     const char* remedy) {
  const bool right = py::isinstance<py::array>(x) && py::reinterpret_borrow<py::array>(x).ndim() == 1 &&
                     same_fields(py::reinterpret_borrow<py::array>(x).dtype(), wanted);
  if (!right) refuse_array(x, name, expected, remedy);
  return py::module_::import("numpy").attr("ascontiguousarray")(x, wanted);
}

std::vector<ParticleState> states_of(const py::object& x, const char* name) {
  const py::array_t<StateRow> rows =
      structured(x, py::dtype::of<StateRow>(), name, "an array as Particles.states gives it", "Particles.states");
  std::vector<ParticleState> states(static_cast<std::size_t>(rows.size()));
  for (std::size_t i = 0; i < states.size(); ++i) {
    const StateRow& r = rows.data()[i];
    ParticleState& s = states[i];
    s.position = {r.position[0], r.position[1], r.position[2]};
    s.cell = Cell{r.cell};
    s.simplex = r.simplex;
    s.touching_count = r.touching_count;
    s.held = r.held;
    for (std::size_t k = 0; k < 3; ++k) s.touching[k] = {Cell{r.touching_cell[k]}, r.touching_face[k]};
  }
  return states;
}

}  // namespace dartcast::python
