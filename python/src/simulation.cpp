// Binds dartcast/simulation.hpp: the class Simulation, what makes it and what changes it. simulation_state.cpp: what it
// shows.
#include "dartcast/simulation.hpp"

#include <string>
#include <utility>

#include "bind.hpp"
#include "dartcast/deformation.hpp"
#include "dartcast/events.hpp"
#include "dartcast/statistics.hpp"
#include "simulation_handle.hpp"
#include "support/edits.hpp"
#include "support/motions.hpp"
#include "support/rows.hpp"

namespace py = pybind11;

namespace dartcast::python::simulation {
namespace {

using Handle = SimulationHandle;
using Class = py::class_<Handle, std::shared_ptr<Handle>>;

std::shared_ptr<Handle> of_environment(const std::shared_ptr<EnvironmentHandle>& environment,
                                       const SimulationOptions& options) {
  return std::make_shared<Handle>(std::make_shared<SimulationOwner>(environment, options));
}

std::shared_ptr<Handle> of_scene(const Scene& scene, Threads threads, const py::object& ranks, Partition partition) {
  const Scene own = scene;
  std::unique_ptr<PythonRanks> all = python_ranks(ranks);
  std::shared_ptr<SimulationOwner> made;
  {
    const py::gil_scoped_release release;
    made = std::make_shared<SimulationOwner>(own, threads, std::move(all), partition);
  }
  return std::make_shared<Handle>(std::move(made));
}

std::shared_ptr<Handle> of_checkpoint(const Scene& scene, const SimulationCheckpoint& saved, Threads threads,
                                      const py::object& after_edit, const py::object& ranks, Partition partition) {
  const Scene own = scene;
  std::unique_ptr<PythonRanks> all = python_ranks(ranks);
  const SimulationCheckpoint own_saved = saved;
  Simulation::AfterEdit callback = after_edit_callback(after_edit);
  std::shared_ptr<SimulationOwner> made;
  {
    const py::gil_scoped_release release;
    made = std::make_shared<SimulationOwner>(own, own_saved, threads, std::move(callback), std::move(all), partition);
  }
  return std::make_shared<Handle>(std::move(made));
}

// Calls f(simulation) without Python's lock.
template <class F>
auto compute(const Handle& self, F&& f) {
  const Use use = self.use();
  const py::gil_scoped_release release;
  return f(self.get());
}

SimulationEdit edit(Handle& self, const py::object& make, OrphanPolicy orphaned) {
  const auto callback = edit_callback(make);
  return compute(self, [&](Simulation& s) { return s.edit(callback, orphaned); });
}

std::vector<double> optional_numbers(const py::object& given, const char* name) {
  if (given.is_none()) return {};
  py::detail::make_caster<std::vector<double>> caster;
  if (!caster.load(given, true)) refuse_array(given, name, "numbers (n,)", "numpy.asarray(x, dtype=float)");
  return py::detail::cast_op<std::vector<double>&>(caster);
}

bool is_matrix(const py::object& x) {
  return py::isinstance<py::array>(x) && py::reinterpret_borrow<py::array>(x).ndim() == 2;
}

// One velocity and radius for all particles, or one each.
py::array add(Handle& self, const py::object& positions, const py::object& velocity, const py::object& radius,
              const py::object& user_data) {
  const auto x = vectors(positions, "positions");
  const std::vector<double> data = optional_numbers(user_data, "user_data");
  const bool single_radius =
      !py::isinstance<py::array>(radius) || py::reinterpret_borrow<py::array>(radius).ndim() == 0;
  if (!is_matrix(velocity) && single_radius) {
    const Vec3 v = vector(velocity, "velocity");
    const auto r = radius.cast<double>();
    return rows_of(compute(self, [&](Simulation& s) { return s.add(x, v, r, data); }));
  }
  const std::vector<Vec3> same(is_matrix(velocity) ? 0 : x.size(),
                               is_matrix(velocity) ? Vec3{} : vector(velocity, "velocity"));
  const std::vector<double> same_radius(single_radius ? x.size() : 0, single_radius ? radius.cast<double>() : 0.0);
  const std::span<const Vec3> v = is_matrix(velocity) ? vectors(velocity, "velocity") : std::span<const Vec3>(same);
  const std::span<const double> r = single_radius ? std::span<const double>(same_radius) : numbers(radius, "radius");
  return rows_of(compute(self, [&](Simulation& s) { return s.add(x, v, r, data); }));
}

void add_random(Handle& self, std::size_t count, const Vec3& velocity, double radius, const py::object& user_data) {
  const std::vector<double> data = optional_numbers(user_data, "user_data");
  compute(self, [&](Simulation& s) { s.add_random(count, velocity, radius, data); });
}

void add_inlet(Handle& self, Patch patch, double rate, const Vec3& velocity, double radius,
               const py::object& user_data) {
  const std::vector<double> data = optional_numbers(user_data, "user_data");
  compute(self, [&](Simulation& s) { s.add_inlet(patch, rate, velocity, radius, data); });
}

AddBodyResult add_body(Handle& self, const py::object& points, const BodyOptions& options) {
  const auto x = vectors(points, "points");
  return compute(self, [&, own = options](Simulation& s) { return s.add_body(x, own); });
}

template <class T>
void add_scene(Handle& self, const T& scene) {
  compute(self, [own = scene](Simulation& s) { s.add(own); });
}

void bind_making(Class& simulation) {
  simulation
      .def(py::init(&of_environment), py::arg("environment").none(false), py::arg("options") = SimulationOptions{},
           (std::string(doc("Simulation::Simulation")) +
            "\n\nAs long as the simulation lives, the environment cannot be changed in another way.")
               .c_str())
      .def(py::init(&of_scene), py::arg("scene"), py::arg("threads") = Threads{}, py::arg("ranks") = py::none(),
           py::arg("partition") = Partition::particles)
      .def(py::init(&of_checkpoint), py::arg("scene"), py::arg("saved"), py::arg("threads") = Threads{},
           py::arg("after_edit") = py::none(), py::arg("ranks") = py::none(),
           py::arg("partition") = Partition::particles)
      .def(
          "totals_of_all", [](const Handle& h) { return compute(h, [](Simulation& s) { return s.totals_of_all(); }); },
          doc("Simulation::totals_of_all"))
      .def(
          "alive", [](const Handle& h) { return compute(h, [](Simulation& s) { return s.alive(); }); },
          doc("Simulation::alive"));
}

// A copy. Throws InvalidArgument where it was made for another complex, or has missed an edit.
VectorField field_for(const Handle& self, const FieldHandle& field) {
  const CellComplex& complex = self.get().environment().complex();
  if (field.complex->complex != &complex)
    throw InvalidArgument("the field was made for another complex: make it for that of the simulation's environment");
  if (field.vertices != complex.positions().size())
    throw InvalidArgument("the field has missed an edit: call its update_after_edit() after each");
  const Use use(field.usage, "the field");
  return field.field;
}

void bind_motion(Class& simulation) {
  simulation
      .def(
          "set_field",
          [](Handle& self, const FieldHandle& field) {
            const Use use = self.use();
            VectorField own = field_for(self, field);
            const py::gil_scoped_release release;
            self.get().set_field(std::move(own));
          },
          py::arg("field"), "The velocities of the medium.")
      .def(
          "set_force",
          [](Handle& self, const FieldHandle& force) {
            const Use use = self.use();
            VectorField own = field_for(self, force);
            const py::gil_scoped_release release;
            self.get().set_force(std::move(own));
          },
          py::arg("force"), doc("Simulation::set_force"))
      .def(
          "set_deformation",
          [](Handle& self, const DeformationHandle& deformation) {
            // The thread that reads frames for the former one may wait for Python's lock.
            const Use other(deformation.usage, "the deformation");
            compute(self, [&](Simulation& s) { s.set_deformation(deformation.deformation); });
          },
          py::arg("deformation"), doc("Simulation::set_deformation"))
      .def(
          "set_statistics",
          [](Handle& self, const StatisticsOptions& options) {
            compute(self, [own = options](Simulation& s) { s.set_statistics(own); });
          },
          py::arg("options"), doc("Simulation::set_statistics"))
      .def(
          "pull",
          [](Handle& self, const py::object& displacement, double duration) {
            const auto x = vectors(displacement, "displacement");
            compute(self, [&](Simulation& s) { s.pull(x, duration); });
          },
          py::arg("displacement"), py::arg("duration"), doc("Simulation::pull"));
}

void bind_adding(Class& simulation) {
  const std::string text =
      std::string(doc("Simulation::add")) +
      "\n\npositions: float64 (n, 3). velocity: three numbers, or float64 (n, 3). radius: a number, "
      "or float64 (n,). user_data: a number for each name, the same for all of these particles. "
      "Instead of positions, a BodyScene, a CatheterScene or a SolidScene.";
  simulation.def("add", &add_scene<BodyScene>, py::arg("body"), text.c_str())
      .def("add", &add_scene<CatheterScene>, py::arg("catheter"))
      .def("add", &add_scene<SolidScene>, py::arg("solid"))
      .def("add", &add, py::arg("positions"), py::arg("velocity"), py::arg("radius") = 0.0,
           py::arg("user_data") = py::none())
      .def("add_random", &add_random, py::arg("count"), py::arg("velocity"), py::arg("radius") = 0.0,
           py::arg("user_data") = py::none(), doc("Simulation::add_random"))
      .def("add_inlet", &add_inlet, py::arg("patch"), py::arg("rate"), py::arg("velocity"), py::arg("radius") = 0.0,
           py::arg("user_data") = py::none(), doc("Simulation::add_inlet"))
      .def("add_body", &add_body, py::arg("points"), py::arg("options"), doc("Simulation::add_body"));
}

void bind_changes(Class& simulation) {
  simulation
      .def(
          "set_events",
          [](Handle& self, const std::vector<Event>& events) {
            compute(self, [own = events](Simulation& s) { s.set_events(own); });
          },
          py::arg("events"), doc("Simulation::set_events"))
      .def(
          "set_remeshing",
          [](Handle& self, const RemeshScene& remeshing) {
            compute(self, [own = remeshing](Simulation& s) { s.set_remeshing(own); });
          },
          py::arg("remeshing"), doc("Simulation::set_remeshing"))
      .def(
          "set_adaptive_subdivision",
          [](Handle& self, const AdaptiveSubdivisionScene& subdivision) {
            compute(self, [own = subdivision](Simulation& s) { s.set_adaptive_subdivision(own); });
          },
          py::arg("subdivision"), doc("Simulation::set_adaptive_subdivision"))
      .def(
          "set_after_edit",
          [](Handle& self, const py::object& after_edit) {
            Simulation::AfterEdit callback = after_edit_callback(after_edit);
            compute(self, [&](Simulation& s) { s.set_after_edit(std::move(callback)); });
          },
          py::arg("after_edit"),
          (std::string(doc("Simulation::set_after_edit")) +
           "\n\nThe function gets the environment, and can read it until it returns. None: nothing is called.")
              .c_str())
      .def("edit", &edit, py::arg("make"), py::arg("orphaned") = OrphanPolicy::relocate, doc("Simulation::edit"))
      .def(
          "repair",
          [](Handle& self, const RepairOptions& options) {
            return compute(self, [own = options](Simulation& s) { return s.repair(own); });
          },
          py::arg("options") = RepairOptions{}, doc("Simulation::repair"))
      .def(
          "adapt", [](Handle& self) { return compute(self, [](Simulation& s) { return s.adapt(); }); },
          doc("Simulation::adapt"));
}

void bind_steps(Class& simulation) {
  simulation
      .def(
          "step", [](Handle& self) { return compute(self, [](Simulation& s) -> SimulationStep { return s.step(); }); },
          doc("Simulation::step"))
      .def(
          "checkpoint", [](Handle& self) { return compute(self, [](Simulation& s) { return s.checkpoint(); }); },
          "All that the simulation goes on from.")
      .def(
          "restore",
          [](Handle& self, const SimulationCheckpoint& saved) {
            compute(self, [own = saved](Simulation& s) { s.restore(own); });
          },
          py::arg("saved"), doc("Simulation::restore"))
      .def(
          "go_to", [](Handle& self, std::uint64_t steps) { compute(self, [steps](Simulation& s) { s.go_to(steps); }); },
          py::arg("steps"), doc("Simulation::go_to"));
}

}  // namespace

void bind(py::module_& m) {
  simulation_records::bind(m);
  Class simulation(m, "Simulation", doc("Simulation"));
  bind_making(simulation);
  bind_motion(simulation);
  bind_adding(simulation);
  bind_changes(simulation);
  bind_steps(simulation);
  simulation_state::bind(simulation);
}

}  // namespace dartcast::python::simulation
