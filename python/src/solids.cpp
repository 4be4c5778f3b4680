// Binds dartcast/solids.hpp.
#include "dartcast/solids.hpp"

#include <string>

#include "bind.hpp"
#include "bodies_handle.hpp"
#include "support/pickles.hpp"
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

SolidMesh make_mesh(const Typed<"Points">& points, const Typed<"Integers | Sequence[Sequence[int]] | None">& edges,
                    const Typed<"Integers | Sequence[Sequence[int]] | None">& triangles) {
  const auto x = vectors(points, "points");
  return {{x.begin(), x.end()}, rows_of_numbers<2>(edges, "edges"), rows_of_numbers<3>(triangles, "triangles")};
}

void bind_mesh(py::module_& m) {
  py::class_<SolidMesh> c(m, "SolidMesh", doc("SolidMesh"));
  pickle_by_bytes(c, [](SolidMesh& s) { return std::tie(s.points, s.edges, s.triangles); });
  c.def(py::init(&make_mesh), py::arg("points"), py::arg("edges") = py::none(), py::arg("triangles") = py::none(),
        "points: float64 (n, 3). edges: whole numbers (n, 2). triangles: whole numbers (n, 3).")
      .def_property_readonly(
          "points", [](const SolidMesh& s) { return array_of(std::span<const Vec3>(s.points)); },
          "A copy: float64 (n, 3).")
      .def_property_readonly(
          "edges", [](const SolidMesh& s) { return array_of_rows(s.edges); }, "A copy: uint32 (n, 2).")
      .def_property_readonly(
          "triangles", [](const SolidMesh& s) { return array_of_rows(s.triangles); }, "A copy: uint32 (n, 3).");
  static constexpr std::array<Argument, 1> mesh = {{{"mesh"}}};
  function(m, "solid_of_surface", &solid_of_surface, {doc("solid_of_surface"), mesh});
}

void bind_records(py::module_& m) {
  py::class_<SolidPlacement> c(m, "SolidPlacement", doc("SolidPlacement"));
  pickle_by_bytes(c, [](SolidPlacement& p) { return std::tie(p); });
  c.def_readonly("refusal", &SolidPlacement::refusal, "Why the place is refused; NONE: it is not.")
      .def_property_readonly(
          "solid",
          [](const SolidPlacement& p) { return p.solid == 0xffffffffU ? std::nullopt : std::optional(p.solid); },
          "Its index in the set; None where it is not added.")
      .def_property_readonly(
          "other",
          [](const SolidPlacement& p) { return p.other == 0xffffffffU ? std::nullopt : std::optional(p.other); },
          "The solid that it meets; None where it meets none.")
      .def_property_readonly(
          "vertices",
          [](const SolidPlacement& p) {
            return std::vector<std::uint32_t>(p.vertices.begin(), p.vertices.begin() + p.count);
          },
          "The vertices of the place where it is refused: numbers in the solid.");
}

std::shared_ptr<Handle> make_set(const std::shared_ptr<EnvironmentHandle>& environment) {
  const Use use(*environment->usage, "the Environment");
  auto made = std::make_shared<Handle>();
  made->environment = environment;
  made->own = std::make_shared<SolidSet>(environment->changeable("its solids are those of the scene"));
  made->solid = made->own.get();
  return made;
}

SolidStep advance(Handle& self, const Typed<"Points">& given, const SolidStepOptions& options) {
  const auto x = vectors(given, "targets");
  const std::vector<Vec3> targets(x.begin(), x.end());
  const SolidStepOptions chosen = options;
  const Use use = self.use();
  self.environment->expect_no_writing("advance");
  SolidSet& solids = self.changeable();
  const py::gil_scoped_release release;
  return solids.advance(targets, chosen);
}

SolidStep move_with(Handle& self, const Typed<"Points">& given, const Typed<"Points">& given_positions,
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

void bind_changes(Class& c) {
  c.def(py::init(&make_set), py::arg("environment").none(false), doc("SolidSet::SolidSet"))
      .def("advance", &advance, about("SolidSet::advance", "targets: float64 (n, 3)."))
      .def("move_with", &move_with, about("SolidSet::move_with", "targets, positions: float64 (n, 3)."));
  members_of_SolidSet(c);
}

void bind_state(Class& c) {
  c.def("__len__", calling<Handle>(&SolidSet::size), "The number of solids.");
  c.def_property_readonly(
      "environment", [](const Handle& self) { return self.environment; }, "The environment.");
}

}  // namespace

void bind(py::module_& m) {
  bind_mesh(m);
  bind_records(m);
  Class solids(m, "SolidSet", doc("SolidSet"));
  bind_changes(solids);
  bind_state(solids);
}

}  // namespace dartcast::python::solids
