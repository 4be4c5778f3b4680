// Bodies and catheters as Python holds them: objects of their own, or those of a simulation.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "dartcast/bodies.hpp"
#include "dartcast/catheter.hpp"
#include "support/handles.hpp"
#include "support/members.hpp"
#include "support/python.hpp"

namespace dartcast::python {

/// `T`: Bodies or Catheter. An environment shares its mark of use with what moves in it.
template <class T>
struct SolidHandle {
  std::shared_ptr<EnvironmentHandle> environment;
  std::shared_ptr<void> owner;  ///< of a simulation; null: it has `own`
  std::shared_ptr<T> own;       ///< after `environment`, which it needs until its end
  T* solid = nullptr;

  [[nodiscard]] Use use() const { return Use(*environment->usage, "the Environment of this object"); }
  [[nodiscard]] const T& object() const { return *solid; }
  [[nodiscard]] T& target() const { return changeable(); }
  /// Throws InvalidArgument if it belongs to a simulation, which alone changes it.
  [[nodiscard]] T& changeable() const {
    if (!own) throw InvalidArgument("this object belongs to a simulation, which alone steps and changes it");
    return *own;
  }
};
using BodiesHandle = SolidHandle<Bodies>;
using CatheterHandle = SolidHandle<Catheter>;

/// The object and its environment move together, to positions of all points: T::move_with().
template <class T>
double move_with(SolidHandle<T>& self, const Typed<"Points">& given) {
  const auto x = vectors(given, "positions");
  const std::vector<Vec3> positions(x.begin(), x.end());
  const Use use = self.use();
  self.environment->expect_no_writing("move_with");
  T& object = self.changeable();
  const pybind11::gil_scoped_release release;
  const double made = object.move_with(positions);
  self.environment->overwritten = false;
  return made;
}

/// Bodies of a simulation.
template <class T>
std::shared_ptr<SolidHandle<T>> lent(std::shared_ptr<EnvironmentHandle> environment, std::shared_ptr<void> owner,
                                     T* solid) {
  auto handle = std::make_shared<SolidHandle<T>>();
  handle->environment = std::move(environment);
  handle->owner = std::move(owner);
  handle->solid = solid;
  return handle;
}

/// A part of bodies::bind().
namespace bodies_records {
void bind(pybind11::module_& m);
}

}  // namespace dartcast::python
