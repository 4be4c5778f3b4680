// Checks of a surface in space before anything is built from it.
#pragma once

#include "dartcast/mesh_check.hpp"
#include "dartcast/mesh_data.hpp"

namespace dartcast {

/// As check_and_repair(), for a mesh whose cells are triangles, quadrilaterals and polygons anywhere in space. A
/// polygon is a fan around its lowest-numbered corner, and need not be planar: the triangles of the fan are the
/// surface.
///
/// Repairs in place:
///
///  - collapsed: faces that named a point twice in a row;
///  - not_convex: faces whose fan overlaps itself, as seen along the axis nearest to their normal, or has a triangle
///    without area. Triangles take their place (ears()), with the face's index as their source.
///  - orientation: faces that ran against their neighbours are turned; in each part the first face decides.
///
/// Warns about findings with which the surface can be used with care:
///
///  - repeated_points: that faces use;
///  - open_border: edges of one face;
///  - pinched_points: several fans of faces at one point.
///
/// Refuses a surface for:
///
///  - empty;
///  - structure: array sizes, cells of space;
///  - id_out_of_range, repeated_corner;
///  - not_finite, out_of_range: coordinates;
///  - face_shared: edges of more than two faces;
///  - not_orientable;
///  - flat: a triangle of a fan without area, exactly;
///  - too_large.
///
/// Surfaces that cross themselves are accepted, because particles do not notice it. It never throws, whatever the
/// arrays contain. Cost: n log n.
MeshReport check_and_repair_surface(MeshData& mesh);

}  // namespace dartcast
