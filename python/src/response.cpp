// Binds dartcast/response.hpp: the responses at walls, and their operators for own responses.
#include "dartcast/response.hpp"

#include <string>
#include <vector>

#include "bind.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python {
namespace {

/// A response as a value of its own: Slide(). It stands wherever a WallResponse does.
template <class T>
void bind_plain_response(py::module_& m, const char* name, const char* text) {
  py::class_<T>(m, name, text)
      .def(py::init<>())
      .def("__repr__", [name](const T&) { return std::string(name) + "()"; })
      .def("__eq__", [](const T&, const py::object& other) { return py::isinstance<T>(other); });
  py::implicitly_convertible<T, WallResponse>();
}

std::vector<WallHit> walls_with(const py::object& normals, const char* name) {
  std::vector<WallHit> walls;
  for (const Vec3& n : vectors(normals, name)) walls.push_back({{}, 0, {}, n});
  return walls;
}

void bind_operators(py::module_& m) {
  m.def(
      "reflected",
      [](const Vec3& v, const py::object& walls, double restitution, double friction) {
        return reflected(v, walls_with(walls, "walls"), restitution, friction);
      },
      py::arg("v"), py::arg("walls"), py::arg("restitution"), py::arg("friction"),
      (std::string(doc("reflected")) + "\n\nwalls: their normals, float64 (n, 3).").c_str());
  m.def(
      "slid",
      [](const Vec3& v, const py::object& walls, const py::object& earlier) {
        return slid(v, walls_with(walls, "walls"), walls_with(earlier, "earlier"));
      },
      py::arg("v"), py::arg("walls"), py::arg("earlier"),
      (std::string(doc("slid")) + "\n\nwalls, earlier: their normals, float64 (n, 3).").c_str());
}

}  // namespace

void bind_response(py::module_& m) {
  bind_enum<WallResponseKind>(m, "WallResponseKind",
                              {{"REFLECT", WallResponseKind::reflect},
                               {"SLIDE", WallResponseKind::slide},
                               {"STICK", WallResponseKind::stick},
                               {"ABSORB", WallResponseKind::absorb},
                               {"ESCAPE", WallResponseKind::escape}});
  bind_enum<ParticleStatus>(m, "ParticleStatus",
                            {{"ALIVE", ParticleStatus::alive},
                             {"STUCK", ParticleStatus::stuck},
                             {"ABSORBED", ParticleStatus::absorbed},
                             {"ESCAPED", ParticleStatus::escaped}});
  Record<WallResponse>(m, "WallResponse")
      .field("kind", &WallResponse::kind)
      .field("restitution", &WallResponse::restitution)
      .field("friction", &WallResponse::friction)
      .finish();
  Record<Reflect>(m, "Reflect")
      .field("restitution", &Reflect::restitution)
      .field("friction", &Reflect::friction)
      .finish();
  py::implicitly_convertible<Reflect, WallResponse>();
  bind_plain_response<Slide>(m, "Slide", "A particle loses the normal part of its motion.");
  bind_plain_response<Stick>(m, "Stick", "A particle stays on the wall from then on, and moves with it.");
  bind_plain_response<Absorb>(m, "Absorb", "A particle ends at the wall.");
  bind_plain_response<Escape>(m, "Escape", "A particle leaves the scene through the wall.");
  Record<Acceleration>(m, "Acceleration")
      .field("value", &Acceleration::value)
      .field("duration", &Acceleration::duration)
      .finish();
  bind_operators(m);
}

}  // namespace dartcast::python
