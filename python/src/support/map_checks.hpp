// Checks of cells, darts, faces and vertices before C++ functions with preconditions get them. All throw
// InvalidArgument.
#pragma once

#include <pybind11/pybind11.h>

#include "dartcast/cell_complex.hpp"
#include "dartcast/cutting.hpp"
#include "dartcast/error.hpp"
#include "support/handles.hpp"

namespace dartcast::python {

void expect_cell(const CombinatorialMap& map, Cell c);
void expect_dart(const CombinatorialMap& map, Dart d);
void expect_face(const CombinatorialMap& map, CellFace f);
void expect_simplex(const CombinatorialMap& map, SimplexId s);
void expect_vertex(const CombinatorialMap& map, Vertex v);
void expect_pool(std::uint32_t pool);
/// If there are not as many positions as vertices.
void expect_positions(const CombinatorialMap& map, std::size_t count, const char* name);
/// If a number is not below its end. `what`: "dart", "face".
void expect_number(std::size_t number, std::size_t end, const char* what);

/// If a number is not finite, or the normal is zero.
void expect_plane(const Plane& plane);

/// The map of a complex, to be read.
MapHandle map_of(const ComplexHandle& complex);

}  // namespace dartcast::python
