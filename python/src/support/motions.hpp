// Deformations and fields as Python holds them.
#pragma once

#include <cstddef>
#include <memory>

#include "dartcast/deformation.hpp"
#include "dartcast/vector_field.hpp"
#include "support/handles.hpp"

namespace dartcast::python {

struct DeformationHandle {
  Deformation deformation;
  mutable Usage usage = {};

  /// Calls f(deformation) while it is in use, without Python's lock.
  template <class F>
  auto change(const F& f) {
    const Use use(usage, "the deformation");
    const pybind11::gil_scoped_release release;
    return f(deformation);
  }
};

using ComplexPointer = std::shared_ptr<ComplexHandle>;

struct FieldHandle {
  ComplexPointer complex;
  VectorField field;
  std::size_t moments = 1;   ///< times that are set
  std::size_t vertices = 0;  ///< of the complex, that the field has followed
  mutable Usage usage = {};

  template <class F>
  auto call(const F& f) const {
    const Use use(usage, "the field");
    return f(field);
  }
};
using FieldPointer = std::shared_ptr<FieldHandle>;

}  // namespace dartcast::python
