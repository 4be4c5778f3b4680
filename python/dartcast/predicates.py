"""Exact signs of determinants, and the bounds of numbers. Written by tools/make_stub.py."""
from ._core import (
    CachedImpulse as CachedImpulse, CellInversion as CellInversion, CollisionCounts as CollisionCounts,
    DETERMINANT_ERROR as DETERMINANT_ERROR, INVERSION_RESOLUTION as INVERSION_RESOLUTION,
    InversionKind as InversionKind, LARGEST_DECIDED_EXTENT as LARGEST_DECIDED_EXTENT,
    LARGEST_EXTENT as LARGEST_EXTENT, LARGEST_MAGNITUDE as LARGEST_MAGNITUDE, LARGEST_MASS as LARGEST_MASS,
    LARGEST_RADIUS as LARGEST_RADIUS, Mat3 as Mat3, PLANE_ERROR as PLANE_ERROR,
    PlanarSymbolicPerturbation as PlanarSymbolicPerturbation, Quaternion as Quaternion, RigidMover as RigidMover,
    SMALLEST_EXTENT as SMALLEST_EXTENT, SMALLEST_MAGNITUDE as SMALLEST_MAGNITUDE, SMALLEST_MASS as SMALLEST_MASS,
    SPHERE_TIME_BOUND as SPHERE_TIME_BOUND, Sign as Sign, SimplexInversion as SimplexInversion,
    SymbolicPerturbation as SymbolicPerturbation, TOUCHING_BOUND as TOUCHING_BOUND, Validity as Validity,
    are_extents as are_extents, are_plane_extents as are_plane_extents, bound_holds as bound_holds,
    check_cell as check_cell, check_validity as check_validity, extent_of as extent_of,
    filter_applies as filter_applies, find_inversion as find_inversion, first_inversion as first_inversion,
    flushed as flushed, in_exact_range as in_exact_range, is_mass as is_mass, is_radius as is_radius,
    move_towards as move_towards, orient2d as orient2d, orient2d_exact as orient2d_exact,
    orient2d_value as orient2d_value, orient3d as orient3d, orient3d_exact as orient3d_exact,
    orient3d_value as orient3d_value, plane_bound_holds as plane_bound_holds,
    plane_filter_applies as plane_filter_applies, rounds_nothing as rounds_nothing)
