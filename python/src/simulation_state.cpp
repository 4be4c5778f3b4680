// The state of a simulation in Python: copies of its arrays, its bodies and catheters, its sums.
#include <algorithm>
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

// A property: f(simulation) is a copy.
template <class F>
auto property(F&& f) {
  return [f](const Handle& self) {
    const Use use = self.use();
    auto value = f(std::as_const(self.get()));
    if constexpr (std::is_base_of_v<py::object, decltype(value)>) {
      return without_writing(std::move(value));
    } else {
      return without_writing(py::cast(std::move(value)));
    }
  };
}
// The same without Python's lock: for what takes long, and for fresh results.
template <class F>
auto computed(F&& f) {
  return [f](const Handle& self) {
    const Use use = self.use();
    const py::gil_scoped_release release;
    return f(std::as_const(self.get()));
  };
}

py::array statuses(std::span<const ParticleStatus> fates) {
  std::vector<std::uint8_t> numbers(fates.size());
  std::transform(fates.begin(), fates.end(), numbers.begin(), [](auto s) { return static_cast<std::uint8_t>(s); });
  return array_of(std::move(numbers));
}

py::array positions(const Simulation& s) {
  const auto states = s.particles().states();
  std::vector<Vec3> points(states.size());
  std::transform(states.begin(), states.end(), points.begin(), [](const ParticleState& p) { return p.position; });
  return array_of(std::span<const Vec3>(points));
}

py::array marks_of(std::span<const std::uint8_t> held) {
  py::array_t<bool> made(static_cast<py::ssize_t>(held.size()));
  std::transform(held.begin(), held.end(), made.mutable_data(), [](std::uint8_t h) { return h != 0; });
  return made;
}

void check_particle(const Simulation& s, std::size_t particle) {
  if (particle >= s.particles().size()) {
    throw InvalidArgument("there is no particle " + std::to_string(particle) + ": there are " +
                          std::to_string(s.particles().size()));
  }
}

py::array user_data(const Handle& self, std::size_t particle) {
  const Use use = self.use();
  check_particle(self.get(), particle);
  return array_of(std::as_const(self.get()).user_data(particle));
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

std::shared_ptr<BodiesHandle> bodies(const Handle& self) {
  const Use use = self.use();
  Bodies* const found = self.get().bodies();
  return found != nullptr ? lent(self.environment, self.owner, found) : nullptr;
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

void bind_particles(Class& simulation) {
  simulation
      .def_property_readonly(
          "particles", property([](const Simulation& s) {
            auto copy = std::make_shared<ParticlesHandle>();
            copy->particles = s.particles();
            return copy;
          }),
          "A copy of the particles: a set of its own. For their positions alone: Simulation.positions.")
      .def_property_readonly("positions", property([](const Simulation& s) { return positions(s); }),
                             "Of all particles, float64 (n, 3).")
      .def_property_readonly("ids", property([](const Simulation& s) { return array_of(s.ids()); }), "uint64 (n,).")
      .def_property_readonly("velocities", property([](const Simulation& s) { return array_of(s.velocities()); }),
                             "float64 (n, 3).")
      .def_property_readonly("fates", property([](const Simulation& s) { return statuses(s.fates()); }),
                             "uint8 (n,): values of ParticleStatus.")
      .def_property_readonly("contact_counts",
                             property([](const Simulation& s) { return array_of(s.contact_counts()); }), "uint32 (n,).")
      .def_property_readonly("radii", property([](const Simulation& s) { return array_of(s.radii()); }),
                             "float64 (n,).")
      .def_property_readonly("held", property([](const Simulation& s) { return marks_of(s.held()); }),
                             (std::string(doc("Simulation::held")) + "\n\nbool (n,).").c_str());
  simulation
      .def("user_data", &user_data, py::arg("particle"),
           (std::string(doc("Simulation::user_data")) + "\n\nA copy: set_user_data() changes them.").c_str())
      .def("set_user_data", &set_user_data, py::arg("particle"), py::arg("values"),
           "Sets the particle's numbers, one for each name in SimulationOptions.user_data.");
}

void bind_solids(Class& simulation) {
  simulation
      .def_property_readonly("bodies", &bodies,
                             "The bodies; None where no body has been added. Set their velocities between steps; the "
                             "simulation steps them.")
      .def_property_readonly("bodies_step", property([](const Simulation& s) { return BodiesStep(s.bodies_step()); }),
                             "The last one.")
      .def_property_readonly("catheter_count", property([](const Simulation& s) { return s.catheter_count(); }),
                             "The number of catheters.")
      .def("catheter", &catheter, py::arg("i"), "A catheter, which the simulation steps.")
      .def("catheter_step", &catheter_step, py::arg("i"), doc("Simulation::catheter_step"))
      .def("body_summaries", computed([](const Simulation& s) { return s.body_summaries(); }),
           doc("Simulation::body_summaries"))
      .def_property_readonly(
          "solids",
          [](const Handle& self) -> py::object {
            const Use use = self.use();
            const SolidSet* solids = self.get().solids();
            // Only its handle's reading functions reach the solids of a simulation.
            return solids == nullptr ? py::object(py::none())
                                     : py::cast(lent(self.environment, self.owner, const_cast<SolidSet*>(solids)));
          },
          "The solids, which the simulation moves; None where there are none.")
      .def_property_readonly("solids_step", property([](const Simulation& s) { return SolidStep(s.solids_step()); }),
                             "A copy of the last step of the solids.")
      .def("solid_summaries", computed([](const Simulation& s) { return s.solid_summaries(); }),
           "The solids, by number.")
      .def("catheter_summaries", computed([](const Simulation& s) { return s.catheter_summaries(); }),
           "By the order of adding.");
}

void bind_sums(Class& simulation) {
  simulation
      .def_property_readonly("statistics", property([](const Simulation& s) { return Statistics(s.statistics()); }),
                             "A copy of the statistics so far; empty where none are kept.")
      .def_property_readonly("statistics_options",
                             property([](const Simulation& s) { return StatisticsOptions(s.statistics_options()); }),
                             "A copy.")
      .def_property_readonly("totals", property([](const Simulation& s) { return SimulationTotals(s.totals()); }),
                             "Sums over all steps so far: a copy.")
      .def_property_readonly("seconds_solids", property([](const Simulation& s) { return s.seconds_solids(); }),
                             doc("Simulation::seconds_solids"))
      .def_property_readonly("event_log", property([](const Simulation& s) { return EventLog(s.event_log()); }),
                             "A copy.")
      .def("energy", computed([](const Simulation& s) { return s.energy(); }), doc("Simulation::energy"))
      .def("audit", computed([](const Simulation& s) { return s.audit(); }), doc("Simulation::audit"))
      .def("state_hash", computed([](const Simulation& s) { return s.state_hash(); }), doc("Simulation::state_hash"));
}

}  // namespace

void bind(Class& simulation) {
  simulation
      .def_property_readonly("options", property([](const Simulation& s) { return SimulationOptions(s.options()); }),
                             "A copy.")
      .def_property_readonly("time", property([](const Simulation& s) { return s.time(); }), "s: steps times dt.")
      .def_property_readonly("steps", property([](const Simulation& s) { return s.steps(); }), "Steps done.")
      .def_property_readonly(
          "environment", [](const Handle& self) { return self.environment; },
          "The environment. It can be read; the simulation alone changes it.")
      .def_property_readonly("deforms", property([](const Simulation& s) { return s.deforms(); }),
                             "Whether it has a deformation.");
  bind_particles(simulation);
  bind_solids(simulation);
  bind_sums(simulation);
}

}  // namespace dartcast::python::simulation_state
