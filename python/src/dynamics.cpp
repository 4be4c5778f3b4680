// Binds dartcast/dynamics.hpp.
#include "dartcast/dynamics.hpp"

#include "bind.hpp"
#include "support/python.hpp"

namespace py = pybind11;

namespace dartcast::python::dynamics {

void bind(py::module_& m) {
  m.attr("LARGEST_RADIUS") = largest_radius;
  m.attr("SMALLEST_MASS") = smallest_mass;
  m.attr("LARGEST_MASS") = largest_mass;
  m.attr("SPHERE_TIME_BOUND") = sphere_time_bound;
  m.attr("TOUCHING_BOUND") = touching_bound;
  m.def("is_radius", &is_radius, py::arg("r"), doc("is_radius"));
  m.def("is_mass", &is_mass, py::arg("m"), doc("is_mass"));

  Record<CollisionCounts>(m, "CollisionCounts")
      .field("pairs_tested", &CollisionCounts::pairs_tested)
      .field("pairs_near", &CollisionCounts::pairs_near)
      .field("pairs_touching", &CollisionCounts::pairs_touching)
      .field("walls_touching", &CollisionCounts::walls_touching)
      .field("overlaps", &CollisionCounts::overlaps)
      .field("deepest", &CollisionCounts::deepest)
      .finish()
      .def("__iadd__", &CollisionCounts::operator+=, py::arg("other"));
  Record<CachedImpulse> impulse(m, "CachedImpulse");
  impulse.field("a", &CachedImpulse::a)
      .field("b", &CachedImpulse::b)
      .field("normal", &CachedImpulse::normal)
      .field("normal_impulse", &CachedImpulse::normal_impulse)
      .field("tangent_impulse", &CachedImpulse::tangent_impulse)
      .finish()
      .attr("WALL") = CachedImpulse::wall;
  Record<Mat3>(m, "Mat3").field("x", &Mat3::x).field("y", &Mat3::y).field("z", &Mat3::z).finish();
  Record<Quaternion>(m, "Quaternion").field("w", &Quaternion::w).field("v", &Quaternion::v).finish();
  Record<RigidMover>(m, "RigidMover")
      .field("inverse_mass", &RigidMover::inverse_mass)
      .field("turns", &RigidMover::turns)
      .field("inverse_inertia", &RigidMover::inverse_inertia)
      .field("centre", &RigidMover::centre)
      .field("velocity", &RigidMover::velocity)
      .field("angular_velocity", &RigidMover::angular_velocity)
      .field("position_delta", &RigidMover::position_delta)
      .field("rotation_delta", &RigidMover::rotation_delta)
      .finish()
      .def("velocity_at", &RigidMover::velocity_at, py::arg("x"), doc("RigidMover::velocity_at"));
}

}  // namespace dartcast::python::dynamics
