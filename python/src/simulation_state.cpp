// The state of a simulation in Python: copies of its arrays, its bodies and catheters, its sums.
#include <algorithm>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include "bodies_handle.hpp"
#include "dartcast/events.hpp"
#include "dartcast/statistics.hpp"
#include "simulation_handle.hpp"

namespace py = pybind11;

namespace dartcast::python::simulation_state {
namespace {

using Handle = SimulationHandle;
using Class = py::class_<Handle, std::shared_ptr<Handle>>;

void check_particle(const Simulation& s, std::size_t particle) {
  if (particle >= s.particles().size()) {
    throw InvalidArgument("there is no particle " + std::to_string(particle) + ": there are " +
                          std::to_string(s.particles().size()));
  }
}

py::array_t<double> user_data(const Handle& self, std::size_t particle) {
  const Use use = self.use();
  check_particle(self.get(), particle);
  return array_of(std::as_const(self.get()).user_data(particle));
}

py::array_t<double> unwrapped(const Handle& self) {
  const Use use = self.use();
  const std::vector<Vec3> places = self.get().unwrapped();
  return array_of(std::span<const Vec3>(places));
}

void set_user_data(Handle& self, std::size_t particle, const std::vector<double>& values) {
  const Use use = self.use();
  check_particle(self.get(), particle);
  const std::span<double> own = self.get().user_data(particle);
  if (values.size() != own.size()) {
    throw InvalidArgument("user_data: " + std::to_string(values.size()) + " numbers; the options name " +
                          std::to_string(own.size()));
  }
  std::copy(values.begin(), values.end(), own.begin());
}

std::optional<std::shared_ptr<BodiesHandle>> bodies(const Handle& self) {
  const Use use = self.use();
  Bodies* const found = self.get().bodies();
  if (found == nullptr) return {};
  return lent(self.environment, self.owner, found);
}

// Those of all ranks, by name.
py::dict cell_arrays(const Handle& self) {
  std::vector<DataArray> arrays;
  {
    const Use use = self.use();
    const std::optional<CellTally> tally = self.get().cell_tally();
    if (tally) arrays = self.get().cell_arrays(*tally);
  }
  py::dict found;
  for (DataArray& a : arrays) {
    const auto rows = static_cast<py::ssize_t>(a.values.size() / a.components);
    py::array values = array_of(std::move(a.values));
    found[py::str(a.name)] = a.components == 1 ? values : values.reshape({rows, py::ssize_t{3}});
  }
  return found;
}

void check_catheter(const Simulation& s, std::size_t i) {
  if (i >= s.catheter_count()) {
    throw InvalidArgument("there is no catheter " + std::to_string(i) + ": there are " +
                          std::to_string(s.catheter_count()));
  }
}

std::shared_ptr<CatheterHandle> catheter(const Handle& self, std::size_t i) {
  const Use use = self.use();
  check_catheter(self.get(), i);
  // Only its handle's reading functions reach a catheter of a simulation.
  return lent(self.environment, self.owner, const_cast<Catheter*>(&self.get().catheter(i)));
}

CatheterStep catheter_step(const Handle& self, std::size_t i) {
  const Use use = self.use();
  check_catheter(self.get(), i);
  return self.get().catheter_step(i);
}

std::vector<Vec3> positions(const Simulation& s) {
  std::vector<Vec3> points;
  for (const ParticleState& p : s.particles().states()) points.push_back(p.position);
  return points;
}

// Only its handle's reading functions reach the solids of a simulation.
Typed<"SolidSet | None"> solids(const Handle& self) {
  const Use use = self.use();
  auto* const found = const_cast<SolidSet*>(self.get().solids());
  return found == nullptr ? py::object(py::none()) : py::cast(lent(self.environment, self.owner, found));
}

py::array_t<bool> held(const Handle& self) {
  const Use use = self.use();
  const auto marks = self.get().held();
  py::array_t<bool> made(static_cast<py::ssize_t>(marks.size()));
  std::transform(marks.begin(), marks.end(), made.mutable_data(), [](std::uint8_t h) { return h != 0; });
  return read_only(made);
}

void bind_particles(Class& c) {
  property(c, "positions", &positions, "Of all particles, float64 (n, 3).");
  c.def_property_readonly("held", &held, about("Simulation::held", "bool (n,)."));
  c.def("unwrapped", &unwrapped, doc("Simulation::unwrapped"));
  c.def("user_data", &user_data, py::arg("particle"),
        about("Simulation::user_data", "A copy: set_user_data() changes them."));
  c.def("set_user_data", &set_user_data, py::arg("particle"), py::arg("values"),
        "Sets the particle's numbers, one for each name in SimulationOptions.user_data.");
}

void bind_solids(Class& c) {
  c.def_property_readonly(
      "bodies", &bodies,
      "The bodies; None where no body has been added. Set their velocities between steps; the simulation steps them.");
  c.def("cell_arrays", &cell_arrays,
        "The quantities of StatisticsOptions.cells by name: arrays with a value for each cell, in the order of "
        "map.cells(); vectors are rows. With classes, those of class k have the ending _NAME_k. Of all ranks: "
        "collective.");
  c.def("catheter", &catheter, py::arg("i"), "A catheter, which the simulation steps.");
  c.def("catheter_step", &catheter_step, py::arg("i"), doc("Simulation::catheter_step"));
  c.def_property_readonly("solids", &solids, "The solids, which the simulation moves; None where there are none.");
}

}  // namespace

void bind(Class& c) {
  c.def_property_readonly(
      "environment", [](const Handle& self) { return self.environment; },
      "The environment. It can be read; the simulation alone changes it.");
  bind_particles(c);
  bind_solids(c);
}

}  // namespace dartcast::python::simulation_state
