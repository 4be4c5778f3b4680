"""Maps with positions, and their validity."""
from __future__ import annotations

import copy

import dartcast
import numpy as np
import pytest


def box(**options):
    return dartcast.topology.CellComplex(dartcast.generate_box(cells=[2, 2, 2], size=[1.0, 1.0, 1.0], **options))


def first(complex):
    return int(complex.map.cells()[0])


def test_sizes_and_positions():
    mesh = dartcast.generate_box(cells=[2, 2, 2], size=[1.0, 1.0, 1.0])
    c = dartcast.topology.CellComplex(mesh, threads=1)
    assert c.point_count == 27 and c.simplex_count == 8 * 6 and c.steiner_point_count == 0
    assert c.invalid_cells == [] and c.bytes > 0
    assert np.array_equal(c.positions, mesh.points) and not c.positions.flags.writeable
    assert not np.shares_memory(c.positions, c.positions)
    assert np.array_equal(c.previous_positions, c.positions)


def test_moves():
    c = box()
    before = c.positions
    c.move(before * 2.0)
    assert np.array_equal(c.positions, before * 2) and np.array_equal(c.previous_positions, before)
    assert np.array_equal(c.before_move().positions, before)
    corners = c.corners((first(c), 0))
    assert corners.shape == (4, 3) and np.array_equal(corners, 2 * c.previous_corners((first(c), 0)))
    assert np.array_equal(c.positions[c.vertices((first(c), 0))], corners)
    with pytest.raises(dartcast.InvalidArgument, match="expected 27 positions"):
        c.move(np.zeros((26, 3)))
    with pytest.raises(TypeError, match="points: expected float64"):
        c.move(np.zeros((27, 3), dtype=np.complex64))


def test_simplices_that_are_not_there_are_refused():
    c = box()
    for question in (c.vertices, c.corners, c.previous_corners):
        with pytest.raises(IndexError, match="no simplex"):
            question((first(c), 6))
        with pytest.raises(dartcast.InvalidArgument):
            question((3, 0))
        with pytest.raises(dartcast.InvalidArgument):
            question(None)


def test_copies_are_independent():
    c = box()
    other = copy.deepcopy(c)
    other.move(other.positions + 1.0)
    assert c.positions.max() == 1.0 and copy.copy(c).map == c.map


def test_maps_outlive_their_complex():
    m = box().map
    assert m.cell_count() == 8


def test_a_complex_becomes_a_mesh_again():
    c = box(mixed=True)
    mesh, vertices = dartcast.topology.to_mesh(c, with_vertices=True)
    assert mesh.cell_count == c.map.cell_count() == dartcast.topology.to_mesh(c).cell_count
    assert np.array_equal(mesh.points, c.positions[vertices])
    assert dartcast.check_and_repair(mesh).verdict is dartcast.formats.Verdict.ACCEPT


def test_a_triangle_is_raised():
    raised = dartcast.topology.raised([[1, 2, 9], [3, 4, 9], [5, 7, 9], [0, 0, 0]])
    assert raised.tolist() == [[1, 2, 0], [3, 4, 0], [5, 7, 0], [1, 2, 1]]


def test_validity_finds_the_inverted_cells():
    c = box()
    assert dartcast.predicates.check_validity(c).valid and dartcast.predicates.check_validity(c).cells_checked == 8
    points = np.array(c.positions)
    points[0] = [0.9, 0.9, 0.9]
    assert dartcast.predicates.check_cell(c.map, points, first(c)).cell == first(c)
    c.move(points)
    v = dartcast.predicates.check_validity(c, threads=1, max_count=1)
    assert not v.valid and v.invalid_count == 1 and v.first[0].cell == first(c) and "inverted" in v.first[0].message
    assert dartcast.predicates.check_validity(c.map, points, max_count=0).first == []
    with pytest.raises(dartcast.InvalidArgument, match="positions: expected 27"):
        dartcast.predicates.check_validity(c.map, points[:5].copy())
    with pytest.raises(dartcast.InvalidArgument):
        dartcast.predicates.check_cell(c.map, points, 12)
    with pytest.raises(dartcast.InvalidArgument):
        dartcast.predicates.check_validity(c, threads=10**6)


def test_a_simplex_is_inverted_when_its_volume_is_zero():
    before = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.25, 0.25, 1]], dtype=float)
    after = before.copy()
    after[3, 2] = -3.0
    how = dartcast.predicates.find_inversion(before, after)
    assert how.kind is dartcast.predicates.InversionKind.VERTEX_FACE
    assert how.safe_time <= 0.25 <= how.safe_time + dartcast.predicates.INVERSION_RESOLUTION
    assert {how.one, how.other} == {8, 7}
    assert dartcast.predicates.find_inversion(before, after, 0.2) is None and dartcast.predicates.find_inversion(before, before) is None
    for until in (-0.1, 1.1, np.nan):
        with pytest.raises(dartcast.InvalidArgument, match="until"):
            dartcast.predicates.find_inversion(before, after, until)


def test_the_first_inversion_of_a_motion():
    c = box()
    before, after = np.array(c.positions), np.array(c.positions)
    after[13] = [0.5, 0.5, 2.0]
    found = dartcast.predicates.first_inversion(c.map, before, after)
    assert 13 in found.vertices and found.simplex.cell in c.map.cells() and "inverts at" in found.message
    one = dartcast.predicates.first_inversion(c.map, before, after, found.simplex.cell)
    assert one == found
    assert dartcast.predicates.first_inversion(c.map, before, after, found.simplex.cell, found.how.safe_time) is None
    c.move(after)
    assert dartcast.predicates.first_inversion(c) == found
    with pytest.raises(dartcast.InvalidArgument, match="after: expected 27"):
        dartcast.predicates.first_inversion(c.map, before, after[:3].copy())
    with pytest.raises(dartcast.InvalidArgument, match="name a cell"):
        dartcast.predicates.first_inversion(c.map, before, after, until=0.5)


def test_a_motion_is_followed_as_far_as_possible():
    c = box()
    before, after = np.array(c.positions), np.array(c.positions)
    after[13] = [0.5, 0.5, 2.0]
    safe = dartcast.predicates.first_inversion(c.map, before, after).how.safe_time
    time, positions = dartcast.predicates.move_towards(c, before, after, safe)
    assert safe - 1e-6 < time <= safe and dartcast.predicates.first_inversion(c.map, before, positions) is None
    assert np.array_equal(positions[:13], before[:13])
    with pytest.raises(dartcast.InvalidArgument):
        dartcast.predicates.move_towards(c, before, after, 2.0)
    with pytest.raises(dartcast.InvalidArgument):
        dartcast.predicates.move_towards(c, before, after[:2].copy(), 0.5)


def test_cells_with_steiner_points():
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float)
    points[6] += 0.3
    mesh = dartcast.MeshData(points, {"hexahedron": [list(range(8))]})
    c = dartcast.topology.CellComplex(mesh)
    assert c.invalid_cells == [] and len(c.positions) == 8 + c.steiner_point_count == c.map.vertex_count
    c.move(points * 2)
    assert dartcast.predicates.check_validity(c).valid
