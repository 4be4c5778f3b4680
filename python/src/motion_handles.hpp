// Deformations and fields as Python holds them.
#pragma once

#include <memory>

#include "dartcast/deformation.hpp"
#include "dartcast/vector_field.hpp"
#include "support/handles.hpp"

namespace dartcast::python {

struct DeformationHandle {
  Deformation deformation;
  std::shared_ptr<Usage> usage = std::make_shared<Usage>();
};

struct FieldHandle {
  VectorField field;
  const CellComplex* complex = nullptr;  ///< that it was made for
  std::size_t moments = 1;               ///< number of times that are set
  std::shared_ptr<Usage> usage = std::make_shared<Usage>();
};

/// Throws InvalidArgument where an edit places a vertex between ones that are not below `size`.
void require_edit(const ComplexEditReport& edit, std::size_t size);

}  // namespace dartcast::python
