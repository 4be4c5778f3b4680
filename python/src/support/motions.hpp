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

  [[nodiscard]] Use use() const { return Use(usage, "the deformation"); }
  [[nodiscard]] Deformation& target() { return deformation; }
};

using ComplexPointer = std::shared_ptr<ComplexHandle>;

struct FieldHandle {
  ComplexPointer complex;
  VectorField field;
  std::size_t moments = 1;   ///< times that are set
  std::size_t vertices = 0;  ///< of the complex, that the field has followed
  mutable Usage usage = {};

  [[nodiscard]] Use use() const { return Use(usage, "the field"); }
  [[nodiscard]] const VectorField& object() const { return field; }
};
using FieldPointer = std::shared_ptr<FieldHandle>;

}  // namespace dartcast::python
