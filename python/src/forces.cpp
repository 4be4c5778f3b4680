// Binds dartcast/forces.hpp: the arrays of a law, and laws that are functions of Python.
#include "dartcast/forces.hpp"

#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bind.hpp"
#include "forces.hpp"
#include "simulation_handle.hpp"
#include "support/arrays.hpp"
#include "support/docs.hpp"
#include "support/python.hpp"
#include "support/typed.hpp"

namespace py = pybind11;

namespace dartcast::python {
namespace forces {
namespace {

// The arguments of a law: arrays that stand for the library's own memory during a call.
struct LawArrays {
  std::vector<std::pair<const char*, py::array>> all;

  [[nodiscard]] py::object get(const char* name) const {
    for (const auto& [key, array] : all) {
      if (std::string_view(key) == name) return array;
    }
    return py::none();
  }
};
struct PythonLawParticles : LawArrays {
  double time = 0.0;
};
struct PythonLawSamples : LawArrays {};
struct PythonLawResult : LawArrays {};

// With a base NumPy takes no copy.
template <class T>
py::array view(const T* data, std::vector<py::ssize_t> shape, bool writable) {
  py::array_t<T> made(std::move(shape), data, py::none());
  return writable ? py::array(made) : py::array(read_only(made));
}
py::array view(std::span<const Vec3> v, bool writable = false) {
  return view(reinterpret_cast<const double*>(v.data()), {static_cast<py::ssize_t>(v.size()), 3}, writable);
}
template <class T>
py::array view(std::span<const T> v, bool writable = false) {
  return view(v.data(), {static_cast<py::ssize_t>(v.size())}, writable);
}

std::shared_ptr<PythonLawParticles> arrays_of(const LawParticles& p) {
  auto made = std::make_shared<PythonLawParticles>();
  const auto rows = static_cast<py::ssize_t>(p.ids.size());
  const py::ssize_t width = rows == 0 ? 0 : static_cast<py::ssize_t>(p.user_data.size()) / rows;
  made->time = p.time;
  made->all = {{"ids", view(p.ids)},
               {"positions", view(p.positions)},
               {"velocities", view(p.velocities)},
               {"diameters", view(p.diameters)},
               {"densities", view(p.densities)},
               {"charges_per_mass", view(p.charges_per_mass)},
               {"user_data", view(p.user_data.data(), {rows, width}, false)}};
  return made;
}

std::shared_ptr<PythonLawSamples> arrays_of(const LawSamples& s) {
  auto made = std::make_shared<PythonLawSamples>();
  const auto rows = static_cast<py::ssize_t>(s.gradients.size());
  const auto* gradients = reinterpret_cast<const double*>(s.gradients.data());
  made->all = {{"velocities", view(s.velocities)},
               {"gradients", view(gradients, {rows, 3, 3}, false)},
               {"rates", view(s.rates)}};
  return made;
}

std::shared_ptr<PythonLawResult> arrays_of(const LawResult& r) {
  auto made = std::make_shared<PythonLawResult>();
  made->all = {{"accelerations", view(std::span<const Vec3>(r.accelerations), true)},
               {"rates", view(std::span<const double>(r.rates), true)},
               {"rotations", view(std::span<const Vec3>(r.rotations), true)}};
  return made;
}

// An array that outlives the call would stand for memory that is used for something else then.
void expect_none_kept(const LawArrays& arrays) {
  for (const auto& [name, array] : arrays.all) {
    if (array.ref_count() > 1)
      throw InvalidArgument(std::string("law: it has kept the array ") + name +
                            ", which is valid during the call alone: keep a copy of it, numpy.array(x)");
  }
}

// Takes the arrays from a law's arguments when its call ends.
struct Emptied {
  LawArrays& particles;
  LawArrays& samples;
  LawArrays& result;
  ~Emptied() {
    for (LawArrays* arrays : {&particles, &samples, &result}) arrays->all.clear();
  }
};

template <class T, class Array = Typed<"NDArray[float64]">>
void bind_arrays(py::class_<T, std::shared_ptr<T>>& c, std::initializer_list<const char*> names) {
  const auto of = c.attr("__name__").template cast<std::string>();
  for (const char* name : names)
    c.def_property_readonly(
        name, [name](const T& t) -> Array { return t.get(name); }, about(of + "::" + name));
}

}  // namespace

void bind(py::module_& m) {
  py::class_<PythonLawParticles, std::shared_ptr<PythonLawParticles>> particles(m, "LawParticles", doc("LawParticles"));
  bind_arrays<PythonLawParticles, Typed<"NDArray[uint64]">>(particles, {"ids"});
  bind_arrays(particles, {"positions", "velocities", "diameters", "densities", "charges_per_mass", "user_data"});
  particles.def_readonly("time", &PythonLawParticles::time, doc("LawParticles::time"));
  py::class_<PythonLawSamples, std::shared_ptr<PythonLawSamples>> samples(m, "LawSamples", doc("LawSamples"));
  bind_arrays(samples, {"velocities", "gradients", "rates"});
  py::class_<PythonLawResult, std::shared_ptr<PythonLawResult>> result(m, "LawResult", doc("LawResult"));
  bind_arrays(result, {"accelerations", "rates", "rotations"});
}

}  // namespace forces

ParticleLaw law_of(const py::object& function) {
  if (function.is_none()) return {};
  if (PyCallable_Check(function.ptr()) == 0)
    throw py::type_error("law: expected a function of particles, samples and result, or None");
  return [law = shared_object(function)](const LawParticles& particles, const LawSamples& samples,
                                         const LawResult& result) {
    const py::gil_scoped_acquire lock;
    const auto p = forces::arrays_of(particles);
    const auto s = forces::arrays_of(samples);
    const auto r = forces::arrays_of(result);
    const forces::Emptied after = {*p, *s, *r};
    (*law)(p, s, r);
    forces::expect_none_kept(*p);
    forces::expect_none_kept(*s);
    forces::expect_none_kept(*r);
  };
}

}  // namespace dartcast::python
