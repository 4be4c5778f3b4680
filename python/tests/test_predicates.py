"""Exact signs, of single points and of arrays."""
from __future__ import annotations

from fractions import Fraction

import dartcast
import numpy as np
import pytest

Sign = dartcast.predicates.Sign


def exact_sign(points):
    a, b, c, d = ([Fraction(x) for x in p] for p in points)
    u, v, w = ([x - y for x, y in zip(p, a)] for p in (b, c, d))
    det = (u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) + u[2] * (v[0] * w[1] - v[1] * w[0]))
    return (det > 0) - (det < 0)


def test_signs_of_arrays_are_those_of_rational_arithmetic():
    rng = np.random.default_rng(1)
    points = rng.integers(-3, 4, (4, 500, 3)) * 0.1 + rng.integers(0, 2, (4, 500, 3)) * 1e-17
    signs = dartcast.predicates.orient3d(*points)
    assert signs.dtype == np.int8 and signs.shape == (500,)
    assert signs.tolist() == [exact_sign(points[:, i]) for i in range(500)]
    assert np.array_equal(signs, dartcast.predicates.orient3d_exact(*points))
    assert np.array_equal(signs, np.sign(dartcast.predicates.orient3d_value(*points)))
    assert {-1, 0, 1} == set(signs.tolist())


def test_single_points_give_a_sign():
    sign = dartcast.predicates.orient3d([0, 0, 0], (1, 0, 0), np.array([0.0, 1, 0]), [0, 0, 1])
    assert sign is Sign.POSITIVE
    assert dartcast.predicates.orient2d([0, 0, 9], [1, 0, 0], [0, -1, 5]) is Sign.NEGATIVE
    assert dartcast.predicates.orient2d_exact([0, 0, 0], [1, 1, 0], [2, 2, 0]) is Sign.ZERO
    assert dartcast.predicates.orient2d_value([0, 0, 0], [2, 0, 0], [0, 3, 0]) == 6.0
    assert dartcast.predicates.orient3d([np.nan, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]) is Sign.UNDECIDABLE


def test_a_single_point_counts_for_all_rows():
    d = np.array([[0.0, 0, 1], [0, 0, -1], [1, 1, 0]])
    assert dartcast.predicates.orient3d([0, 0, 0], [1, 0, 0], [0, 1, 0], d).tolist() == [1, -1, 0]


def test_other_arrays_are_refused():
    one = np.zeros((2, 3))
    with pytest.raises(dartcast.InvalidArgument, match="c: expected 2 points"):
        dartcast.predicates.orient3d(one, one, np.zeros((3, 3)), one)
    with pytest.raises(TypeError, match="b: expected float64"):
        dartcast.predicates.orient2d(one, one.astype(np.complex64), one)
    with pytest.raises(TypeError, match="a: expected three numbers"):
        dartcast.predicates.orient2d([0, 0], one, one)


def test_ranges_and_flushing():
    points = np.array([[1e-301, 0, 1], [1e91, 0, 0], [np.inf, 0, 0]])
    assert dartcast.predicates.in_exact_range(points).tolist() == [True, False, False]
    assert dartcast.predicates.in_exact_range([0, 0, 0]) is True
    assert dartcast.predicates.flushed(points)[0].tolist() == [0, 0, 1] and dartcast.predicates.flushed([1e-301, 0, 0]).tolist() == [0, 0, 0]
    assert dartcast.predicates.LARGEST_MAGNITUDE == 2.0**300 and dartcast.predicates.SMALLEST_MAGNITUDE == 2.0**-300


def test_bounds_of_the_filters():
    assert dartcast.predicates.extent_of(np.array([[1.0, -5, 2], [-3, 1, 1]])).tolist() == [3, 5, 2]
    with pytest.raises(dartcast.InvalidArgument):
        dartcast.predicates.extent_of(np.zeros((0, 3)))
    assert dartcast.predicates.rounds_nothing([4, 4, 4], np.array([[1.0, 2, 3], [4, 0, 1]]))
    assert not dartcast.predicates.rounds_nothing([4, 4, 4], np.array([[0.1, 2, 3]]))
    assert dartcast.predicates.bound_holds([1, 1, 1]) and not dartcast.predicates.bound_holds([0, 1, 1])
    assert dartcast.predicates.filter_applies([1, 1, 1]) and not dartcast.predicates.filter_applies([1, 1, 1e80])
    assert dartcast.predicates.are_extents([1, 1, 1], 2.0) and dartcast.predicates.are_plane_extents(1, 1, 2)
    assert dartcast.predicates.plane_bound_holds(1, 1) and not dartcast.predicates.plane_filter_applies(1, 1e80)
    assert 0 < dartcast.predicates.PLANE_ERROR < dartcast.predicates.DETERMINANT_ERROR < 1e-14


def test_perturbations_leave_no_tie():
    p = dartcast.predicates.SymbolicPerturbation([0, 0, 0], np.array([[1.0, 2, 3]]))
    assert p.of_line([1, 0, 0], [2, 0, 0], [3, 1, 0]) in (Sign.POSITIVE, Sign.NEGATIVE)
    plane = dartcast.predicates.PlanarSymbolicPerturbation([0, 0, 0], np.zeros((0, 3)))
    assert plane.of_line([1, 0, 0]) in (Sign.POSITIVE, Sign.NEGATIVE)
    with pytest.raises(dartcast.InvalidArgument, match="at most 3"):
        dartcast.predicates.SymbolicPerturbation([0, 0, 0], np.zeros((4, 3)))
    with pytest.raises(dartcast.InvalidArgument, match="not finite"):
        p.of_line([1, 0, np.nan], [2, 0, 0], [3, 1, 0])
