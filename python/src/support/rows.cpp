// Rows of contacts, which need their walls, and states back from rows.
#include "support/rows.hpp"

#include <algorithm>
#include <cstring>

namespace py = pybind11;

namespace dartcast::python {
namespace {

bool same_fields(const py::dtype& a, const py::dtype& b) {
  const auto names = b.attr("names");
  if (!a.attr("names").equal(names)) return false;
  return std::all_of(names.begin(), names.end(), [&](const py::handle field) {
    return a.attr("fields")[field][py::int_(0)].equal(b.attr("fields")[field][py::int_(0)]);
  });
}

Vec3 vec(const Row3& r) { return {r[0], r[1], r[2]}; }

}  // namespace

py::array rows_of(const std::vector<Contact>& contacts, std::span<const WallHit> walls) {
  std::vector<ContactAtWallRow> rows(contacts.size());
  {
    const py::gil_scoped_release release;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const WallHit& wall = walls[contacts[i].first_wall];
      fill(ContactAtWall{contacts[i], wall.patch, wall.normal}, rows[i]);
    }
  }
  return array_of(std::move(rows));
}

py::array structured(const py::object& x, const py::dtype& wanted, const char* name, const char* expected,
                     const char* remedy) {
  const bool right = is_array(x, 1) && same_fields(py::reinterpret_borrow<py::array>(x).dtype(), wanted);
  if (!right) refuse_array(x, name, expected, remedy);
  return py::module_::import("numpy").attr("ascontiguousarray")(x, wanted);
}

std::vector<ParticleState> states_of(const py::object& x, const char* name) {
  const py::array_t<ParticleStateRow> rows = structured(x, py::dtype::of<ParticleStateRow>(), name,
                                                        "an array as Particles.states gives it", "Particles.states");
  std::vector<ParticleState> states;
  for (py::ssize_t i = 0; i < rows.size(); ++i) {
    const ParticleStateRow& r = rows.data()[i];
    ParticleState& s = states.emplace_back();
    s = {vec(r.position), Cell{r.cell}, r.simplex, r.touching_count, r.held, s.touching};
    for (std::size_t k = 0; k < 3; ++k) s.touching[k] = {Cell{r.touching_cell[k]}, r.touching_face[k]};
  }
  return states;
}

std::vector<Weights> weights_of(const py::object& given, std::size_t count) {
  std::vector<Weights> weights(count);
  if (given.is_none()) return weights;
  const bool right = py::isinstance<py::array_t<double, py::array::c_style>>(given) &&
                     py::reinterpret_borrow<py::array>(given).ndim() == 2 &&
                     py::reinterpret_borrow<py::array>(given).shape(1) == 4 &&
                     py::reinterpret_borrow<py::array>(given).shape(0) == static_cast<py::ssize_t>(count);
  if (!right) refuse_array(given, "weights", "float64 (n, 4), one row for each state", "Particles.held_weights()");
  if (count > 0) std::memcpy(weights.data(), py::reinterpret_borrow<py::array>(given).data(), count * sizeof(Weights));
  return weights;
}

}  // namespace dartcast::python
