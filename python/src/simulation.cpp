// Binds dartcast/simulation.hpp: the class Simulation, what makes it and what changes it. simulation_state.cpp: what it
// shows.
#include "dartcast/simulation.hpp"

#include <utility>

#include "bind.hpp"
#include "dartcast/deformation.hpp"
#include "dartcast/events.hpp"
#include "dartcast/statistics.hpp"
#include "forces.hpp"
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

std::shared_ptr<Handle> of_scene(const Scene& scene, Threads threads, const Typed<"Ranks | None">& ranks,
                                 Partition partition) {
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
                                      const Typed<"Callable[[Environment], object] | None">& after_edit,
                                      const Typed<"Ranks | None">& ranks, Partition partition) {
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

SimulationEdit edit(Handle& self, const Typed<"Callable[[ComplexEdit], object]">& make, OrphanPolicy orphaned) {
  const auto callback = edit_callback(make);
  return change(self, [&](Simulation& s) { return s.edit(callback, orphaned); });
}

std::vector<double> optional_numbers(const py::object& given, const char* name) {
  if (given.is_none()) return {};
  py::detail::make_caster<std::vector<double>> caster;
  if (!caster.load(given, true)) refuse_array(given, name, "numbers (n,)", "numpy.asarray(x, dtype=float)");
  return py::detail::cast_op<std::vector<double>&>(caster);
}

// One material for all particles, or one each, as rows of numbers.
std::span<const Material> materials(const py::object& given, Material& one) {
  static_assert(sizeof(Material) == sizeof(Vec3));
  if (given.is_none()) return {};
  if (py::isinstance<Material>(given)) {
    one = given.cast<Material>();
    return {&one, 1};
  }
  const auto rows = vectors(given, "material");
  return {reinterpret_cast<const Material*>(rows.data()), rows.size()};
}

// One velocity and radius for all particles, or one each.
Added add(Handle& self, const Typed<"Points">& positions, const Typed<"Vector | Points">& velocity,
          const Typed<"float | Floats">& radius, const Typed<"Numbers[float64] | None">& user_data,
          const Typed<"Material | Points | None">& material) {
  const auto x = vectors(positions, "positions");
  const std::vector<double> data = optional_numbers(user_data, "user_data");
  Material one;
  const std::span<const Material> of = materials(material, one);
  const bool single_radius =
      !py::isinstance<py::array>(radius) || py::reinterpret_borrow<py::array>(radius).ndim() == 0;
  if (!is_array(velocity, 2) && single_radius && of.size() < 2) {
    const Vec3 v = vector(velocity, "velocity");
    const auto r = radius.cast<double>();
    return added_of(change(self, [&](Simulation& s) { return s.add(x, v, r, data, of.empty() ? Material{} : of[0]); }));
  }
  const std::vector<Vec3> same(is_array(velocity, 2) ? 0 : x.size(),
                               is_array(velocity, 2) ? Vec3{} : vector(velocity, "velocity"));
  const std::vector<double> same_radius(single_radius ? x.size() : 0, single_radius ? radius.cast<double>() : 0.0);
  const std::span<const Vec3> v = is_array(velocity, 2) ? vectors(velocity, "velocity") : std::span<const Vec3>(same);
  const std::span<const double> r = single_radius ? std::span<const double>(same_radius) : numbers(radius, "radius");
  return added_of(change(self, [&](Simulation& s) { return s.add(x, v, r, data, of); }));
}

void add_random(Handle& self, std::size_t count, const Vec3& velocity, double radius,
                const Typed<"Numbers[float64] | None">& user_data, const Material& material) {
  const std::vector<double> data = optional_numbers(user_data, "user_data");
  change(self, [&, own = material](Simulation& s) { s.add_random(count, velocity, radius, data, own); });
}

void add_inlet(Handle& self, Patch patch, double rate, const Vec3& velocity, double radius,
               const Typed<"Numbers[float64] | None">& user_data, const Material& material) {
  const std::vector<double> data = optional_numbers(user_data, "user_data");
  change(self, [&, own = material](Simulation& s) { s.add_inlet(patch, rate, velocity, radius, data, own); });
}

template <class T>
void add_scene(Handle& self, const T& scene) {
  change(self, [own = scene](Simulation& s) { s.add(own); });
}

void bind_making(Class& simulation) {
  simulation
      .def(py::init(&of_environment), py::arg("environment").none(false), py::arg("options") = SimulationOptions{},
           about("Simulation::Simulation",
                 "As long as the simulation lives, the environment cannot be changed in another way."))
      .def(py::init(&of_scene), py::arg("scene"), py::arg("threads") = Threads{}, py::arg("ranks") = py::none(),
           py::arg("partition") = Partition::particles)
      .def(py::init(&of_checkpoint), py::arg("scene"), py::arg("saved"), py::arg("threads") = Threads{},
           py::arg("after_edit") = py::none(), py::arg("ranks") = py::none(),
           py::arg("partition") = Partition::particles);
  members_of_Simulation(simulation);
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

template <class F>
auto setting_field(F set) {
  return [set](Handle& self, const FieldHandle& field) {
    const Use use = self.use();
    VectorField own = field_for(self, field);
    const py::gil_scoped_release release;
    (self.get().*set)(std::move(own));
  };
}

void bind_motion(Class& simulation) {
  simulation.def("set_field", setting_field(&Simulation::set_field), py::arg("field"), "The velocities of the medium.")
      .def("set_force", setting_field(&Simulation::set_force), about("Simulation::set_force"))
      .def(
          "set_law",
          [](Handle& self, const Typed<"Callable[[LawParticles, LawSamples, LawResult], object] | None">& law) {
            ParticleLaw own = law_of(law);
            change(self, [&](Simulation& s) { s.set_law(std::move(own)); });
          },
          py::arg("law"),
          about(
              "Simulation::set_law",
              "A function of LawParticles, LawSamples and LawResult. It writes to the arrays of the result. All arrays "
              "are valid during the call alone. None: there is no law."))
      .def(
          "set_deformation",
          [](Handle& self, const DeformationHandle& deformation) {
            // The thread that reads frames for the former one may wait for Python's lock.
            const Use other(deformation.usage, "the deformation");
            change(self, [&](Simulation& s) { s.set_deformation(deformation.deformation); });
          },
          about("Simulation::set_deformation"))
      .def(
          "pull",
          [](Handle& self, const Typed<"Points">& displacement, double duration) {
            const auto x = vectors(displacement, "displacement");
            change(self, [&](Simulation& s) { s.pull(x, duration); });
          },
          about("Simulation::pull"))
      .def(
          "steer_solid",
          [](Handle& self, std::size_t solid, const Vec3& velocity, const Vec3& turn) {
            change(self, [&](Simulation& s) { s.steer_solid(solid, velocity, turn); });
          },
          py::arg("solid"), py::arg("velocity"), py::arg_v("turn", Vec3{}, "(0.0, 0.0, 0.0)"),
          doc("Simulation::steer_solid"));
}

void bind_adding(Class& simulation) {
  simulation
      .def("add", &add_scene<BodyScene>, py::arg("body"),
           about(
               "Simulation::add",
               "positions: float64 (n, 3). velocity: three numbers, or float64 (n, 3). radius: a number, or float64 "
               "(n,). user_data: a number for each name, the same for all of these particles. material: a Material, or "
               "float64 (n, 3): diameter, density and charge per mass of each. Returns as Environment.add(). Instead "
               "of positions, a ParticlesScene, a BodyScene, a CatheterScene or a SolidScene."))
      .def("add", &add_scene<ParticlesScene>, py::arg("group"))
      .def("add", &add_scene<CatheterScene>, py::arg("catheter"))
      .def("add", &add_scene<SolidScene>, py::arg("solid"))
      .def("add", &add, py::arg("positions"), py::arg("velocity"), py::arg("radius") = 0.0,
           py::arg("user_data") = py::none(), py::arg("material") = py::none())
      .def("add_random", &add_random, py::arg("count"), py::arg("velocity"), py::arg("radius") = 0.0,
           py::arg("user_data") = py::none(), py::arg("material") = Material{}, doc("Simulation::add_random"))
      .def("add_inlet", &add_inlet, py::arg("patch"), py::arg("rate"), py::arg("velocity"), py::arg("radius") = 0.0,
           py::arg("user_data") = py::none(), py::arg("material") = Material{}, doc("Simulation::add_inlet"));
}

void bind_changes(Class& simulation) {
  simulation
      .def(
          "set_after_edit",
          [](Handle& self, const Typed<"Callable[[Environment], object] | None">& after_edit) {
            Simulation::AfterEdit callback = after_edit_callback(after_edit);
            change(self, [&](Simulation& s) { s.set_after_edit(std::move(callback)); });
          },
          about("Simulation::set_after_edit",
                "The function gets the environment, and can read it until it returns. None: nothing is called."))
      .def("edit", &edit, about("Simulation::edit"));
}

}  // namespace

void bind(py::module_& m) {
  simulation_records::bind(m);
  Class simulation(m, "Simulation", doc("Simulation"));
  bind_making(simulation);
  bind_motion(simulation);
  bind_adding(simulation);
  bind_changes(simulation);
  simulation_state::bind(simulation);
}

}  // namespace dartcast::python::simulation
