// Binds dartcast/solids.hpp.
#include "dartcast/solids.hpp"

#include <string>
#include <utility>

#include "bind.hpp"
#include "bodies_handle.hpp"
#include "support/meshes.hpp"
#include "support/rows.hpp"

namespace py = pybind11;

namespace dartcast::python::solids {
namespace {

using Handle = SolidHandle<SolidSet>;
using Class = py::class_<Handle, std::shared_ptr<Handle>>;

// Rows of N numbers of points: integers (n, N). None: no rows.
template <std::size_t N>
std::vector<std::array<std::uint32_t, N>> rows_of_numbers(const py::object& given, const char* name) {
  std::vector<std::array<std::uint32_t, N>> rows;
  if (given.is_none()) return rows;
  const std::string expected = "whole numbers (n, " + std::to_string(N) + ")";
  const auto a = py::array::ensure(given);
  if (!a) PyErr_Clear();
  if (a && a.size() == 0) return rows;
  if (!a || a.ndim() != 2 || a.shape(1) != static_cast<py::ssize_t>(N))
    refuse_array(given, name, expected.c_str(), "numpy.asarray(x, dtype=numpy.uint32)");
  const auto numbers_of_rows = indices(a.attr("reshape")(-1), name);
  rows.resize(numbers_of_rows.size() / N);
  for (std::size_t i = 0; i < numbers_of_rows.size(); ++i) rows[i / N][i % N] = numbers_of_rows[i];
  return rows;
}

template <std::size_t N>
py::array_t<std::uint32_t> array_of_rows(const std::vector<std::array<std::uint32_t, N>>& rows) {
  py::array_t<std::uint32_t> made({static_cast<py::ssize_t>(rows.size()), static_cast<py::ssize_t>(N)});
  for (std::size_t i = 0; i < rows.size(); ++i) std::copy(rows[i].begin(), rows[i].end(), made.mutable_data() + i * N);
  return made;
}

SolidMesh make_mesh(const py::object& points, const py::object& edges, const py::object& triangles) {
  const auto x = vectors(points, "points");
  return {{x.begin(), x.end()}, rows_of_numbers<2>(edges, "edges"), rows_of_numbers<3>(triangles, "triangles")};
}

void bind_mesh(py::module_& m) {
  py::class_<SolidMesh>(m, "SolidMesh", doc("SolidMesh"))
      .def(py::init(&make_mesh), py::arg("points"), py::arg("edges") = py::none(), py::arg("triangles") = py::none(),
           "points: float64 (n, 3). edges: whole numbers (n, 2). triangles: whole numbers (n, 3).")
      .def_property_readonly(
          "points", [](const SolidMesh& s) { return array_of(std::span<const Vec3>(s.points)); },
          "A copy: float64 (n, 3).")
      .def_property_readonly(
          "edges", [](const SolidMesh& s) { return array_of_rows(s.edges); }, "A copy: uint32 (n, 2).")
      .def_property_readonly(
          "triangles", [](const SolidMesh& s) { return array_of_rows(s.triangles); }, "A copy: uint32 (n, 3).");
  const auto from_mesh = [&](const char* name, SolidMesh (*make)(const MeshData&)) {
    m.def(
        name,
        [make](const MeshData& mesh) {
          const MeshData own = mesh;
          const py::gil_scoped_release release;
          return make(own);
        },
        py::arg("mesh"), doc(name));
  };
  from_mesh("solid_of_surface", &solid_of_surface);
  from_mesh("solid_of_cells", &solid_of_cells);
  m.def(
      "solid_of_polyline", [](const py::object& points) { return solid_of_polyline(vectors(points, "points")); },
      py::arg("points"), doc("solid_of_polyline"));
}

void bind_records(py::module_& m) {
  bind_enum<SolidRefusal>(m, "SolidRefusal",
                          {{"NONE", SolidRefusal::none},
                           {"VERTEX_NOT_FREE", SolidRefusal::vertex_not_free},
                           {"MEETS_WALL", SolidRefusal::meets_wall},
                           {"ENCLOSES_WALL", SolidRefusal::encloses_wall},
                           {"CELL_NOT_POSITIVE", SolidRefusal::cell_not_positive}});
  bind_enum<SolidContactKind>(m, "SolidContactKind",
                              {{"VERTEX_FACE", SolidContactKind::vertex_face},
                               {"EDGE_EDGE", SolidContactKind::edge_edge},
                               {"FACE_VERTEX", SolidContactKind::face_vertex}});
  py::class_<SolidPlacement>(m, "SolidPlacement", doc("SolidPlacement"))
      .def_readonly("refusal", &SolidPlacement::refusal, "Why the place is refused; NONE: it is not.")
      .def_property_readonly(
          "solid",
          [](const SolidPlacement& p) { return p.solid == 0xffffffffU ? py::object(py::none()) : py::cast(p.solid); },
          "Its index in the set; None where it is not added.")
      .def_property_readonly(
          "vertices",
          [](const SolidPlacement& p) {
            return std::vector<std::uint32_t>(p.vertices.begin(), p.vertices.begin() + p.count);
          },
          "The vertices of the place where it is refused: numbers in the solid.");
  Record<SolidStepOptions>(m, "SolidStepOptions")
      .field("rounds", &SolidStepOptions::rounds)
      .field("iterations", &SolidStepOptions::iterations)
      .field("separation", &SolidStepOptions::separation)
      .finish();
  py::class_<SolidAudit>(m, "SolidAudit", doc("SolidAudit"))
      .def_readonly("checked", &SolidAudit::checked, doc("SolidAudit::checked"))
      .def_readonly("failed", &SolidAudit::failed, doc("SolidAudit::failed"))
      .def_readonly("first", &SolidAudit::first, doc("SolidAudit::first"));
}

void bind_step_report(py::module_& m) {
  py::class_<SolidStep>(m, "SolidStep", doc("SolidStep"))
      .def_property_readonly(
          "contacts", [](const SolidStep& s) { return rows_of(s.contacts); },
          "Contacts that changed the motion, by solid, then by time, as a structured array: solid, kind "
          "(SolidContactKind), count (of the vertices), wall_kind (Kind), vertices (numbers in the solid), weights, "
          "cell, "
          "face, triangle and dart (of the wall, in the free cell), patch, time_of_impact, gap, point (of the solid, "
          "at "
          "the end of the step), wall_point, normal (unit, from the wall to the solid's side), displacement (of the "
          "place "
          "on the solid, to the targets), wall_displacement.")
      .def_property_readonly(
          "made", [](const SolidStep& s) { return array_of(std::span<const double>(s.made)); }, doc("SolidStep::made"))
      .def_readonly("walls_made", &SolidStep::walls_made, doc("SolidStep::walls_made"))
      .def_readonly("corrected", &SolidStep::corrected, doc("SolidStep::corrected"))
      .def_readonly("cut", &SolidStep::cut, doc("SolidStep::cut"))
      .def_property_readonly(
          "held", [](const SolidStep& s) { return array_of(std::span<const std::uint32_t>(s.held)); },
          doc("SolidStep::held"))
      .def_readonly("rounds", &SolidStep::rounds, doc("SolidStep::rounds"))
      .def_readonly("pairs", &SolidStep::pairs, doc("SolidStep::pairs"));
}

// A checkpoint cannot be made or changed in Python.
void bind_checkpoint(py::module_& m) {
  py::class_<SolidCheckpoint>(m, "SolidCheckpoint", doc("SolidCheckpoint"))
      .def_property_readonly(
          "states", [](const SolidCheckpoint& c) { return without_writing(py::cast(c.states)); }, "Of all vertices.")
      .def_property_readonly(
          "held_weights", [](const SolidCheckpoint& c) { return without_writing(py::cast(c.held_weights)); },
          "Of all vertices.");
}

std::shared_ptr<Handle> make_set(const std::shared_ptr<EnvironmentHandle>& environment) {
  const Use use(*environment->usage, "the Environment");
  auto made = std::make_shared<Handle>();
  made->environment = environment;
  made->own = std::make_shared<SolidSet>(environment->changeable("its solids are those of the scene"));
  made->solid = made->own.get();
  return made;
}

SolidPlacement add(Handle& self, const SolidMesh& mesh) {
  const SolidMesh own = mesh;
  const Use use = self.use();
  SolidSet& solids = self.changeable();
  const py::gil_scoped_release release;
  return solids.add(own);
}

SolidStep advance(Handle& self, const py::object& given, const SolidStepOptions& options) {
  const auto x = vectors(given, "targets");
  const std::vector<Vec3> targets(x.begin(), x.end());
  const SolidStepOptions chosen = options;
  const Use use = self.use();
  self.environment->expect_no_writing("advance");
  SolidSet& solids = self.changeable();
  const py::gil_scoped_release release;
  return solids.advance(targets, chosen);
}

SolidStep move_with(Handle& self, const py::object& given, const py::object& given_positions,
                    const SolidStepOptions& options) {
  const auto x = vectors(given, "targets");
  const std::vector<Vec3> targets(x.begin(), x.end());
  const auto y = vectors(given_positions, "positions");
  const std::vector<Vec3> positions(y.begin(), y.end());
  const SolidStepOptions chosen = options;
  const Use use = self.use();
  self.environment->expect_no_writing("move_with");
  SolidSet& solids = self.changeable();
  const py::gil_scoped_release release;
  SolidStep step = solids.move_with(targets, positions, chosen);
  self.environment->overwritten = false;
  return step;
}

// A function of the set, whose result is a copy.
template <class F>
auto of_set(F&& f) {
  return [f](const Handle& self) {
    const Use use = self.use();
    return f(std::as_const(*self.solid));
  };
}

void bind_changes(Class& solids) {
  const auto change = [](auto f) {
    return [f](Handle& self) {
      const Use use = self.use();
      SolidSet& set = self.changeable();
      const py::gil_scoped_release release;
      return f(set);
    };
  };
  solids.def(py::init(&make_set), py::arg("environment").none(false), doc("SolidSet::SolidSet"))
      .def("add", &add, py::arg("mesh"), doc("SolidSet::add"))
      .def(
          "remove",
          [](Handle& self, std::uint32_t solid) {
            const Use use = self.use();
            self.changeable().remove(solid);
          },
          py::arg("solid"), doc("SolidSet::remove"))
      .def("update_after_edit", change([](SolidSet& s) { return s.update_after_edit(); }),
           doc("SolidSet::update_after_edit"))
      .def(
          "set_inverse_masses",
          [](Handle& self, const py::object& given) {
            const auto values = numbers(given, "inverse_masses");
            const Use use = self.use();
            self.changeable().set_inverse_masses(values);
          },
          py::arg("inverse_masses"), (std::string(doc("SolidSet::set_inverse_masses")) + "\n\nfloat64 (n,).").c_str())
      .def("advance", &advance, py::arg("targets"), py::arg("options") = SolidStepOptions{},
           (std::string(doc("SolidSet::advance")) + "\n\ntargets: float64 (n, 3).").c_str())
      .def("move_with", &move_with, py::arg("targets"), py::arg("positions"), py::arg("options") = SolidStepOptions{},
           (std::string(doc("SolidSet::move_with")) + "\n\ntargets, positions: float64 (n, 3).").c_str());
}

void bind_state(Class& solids) {
  solids.def("__len__", of_set([](const SolidSet& s) { return s.size(); }), "The number of solids.")
      .def_property_readonly("size", of_set([](const SolidSet& s) { return s.size(); }), "The number of solids.")
      .def_property_readonly("positions", of_set([](const SolidSet& s) { return array_of(s.positions()); }),
                             (std::string(doc("SolidSet::positions")) + "\n\nA copy: float64 (n, 3).").c_str())
      .def_property_readonly("first_vertices", of_set([](const SolidSet& s) { return array_of(s.first_vertices()); }),
                             (std::string(doc("SolidSet::first_vertices")) + "\n\nA copy.").c_str())
      .def_property_readonly("particles", of_set([](const SolidSet& s) {
                               auto copy = std::make_shared<ParticlesHandle>();
                               copy->particles = s.particles();
                               return copy;
                             }),
                             (std::string(doc("SolidSet::particles")) + "\n\nA copy.").c_str())
      .def_property_readonly("stuck", of_set([](const SolidSet& s) {
                               return std::vector<SolidPlacement>(s.stuck().begin(), s.stuck().end());
                             }),
                             doc("SolidSet::stuck"))
      .def_property_readonly(
          "environment", [](const Handle& self) { return self.environment; }, "The environment.")
      .def("checkpoint", of_set([](const SolidSet& s) { return s.checkpoint(); }), "The state, for restore().")
      .def(
          "restore",
          [](Handle& self, const SolidCheckpoint& saved) {
            const SolidCheckpoint own = saved;
            const Use use = self.use();
            SolidSet& set = self.changeable();
            const py::gil_scoped_release release;
            set.restore(own);
          },
          py::arg("saved"), doc("SolidSet::restore"))
      .def(
          "audit",
          [](const Handle& self) {
            const Use use = self.use();
            const SolidSet& set = *self.solid;
            const py::gil_scoped_release release;
            return set.audit();
          },
          doc("SolidSet::audit"));
}

}  // namespace

void bind(py::module_& m) {
  bind_mesh(m);
  bind_records(m);
  bind_step_report(m);
  bind_checkpoint(m);
  Class solids(m, "SolidSet", doc("SolidSet"));
  bind_changes(solids);
  bind_state(solids);
}

}  // namespace dartcast::python::solids
