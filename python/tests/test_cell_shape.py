"""The combinatorial type of a cell."""
from __future__ import annotations

import dartcast
import numpy as np
import pytest

Face = dartcast.topology.ShapeKey.Face
TETRA = dartcast.topology.ShapeKey(4, 0, False, [Face([0, 2, 1]), Face([0, 1, 3]), Face([1, 2, 3]), Face([0, 3, 2])])


def test_a_tetrahedron():
    s = dartcast.topology.Shape(TETRA)
    assert (s.dimension, s.corner_count, s.point_count, s.face_count, s.dart_count) == (3, 4, 4, 4, 12)
    assert s.key == TETRA and s.bytes > 0
    assert len(s.simplices) == 1 and sorted(s.simplices["vertex"][0]) == [0, 1, 2, 3]
    assert not s.simplices.flags.writeable
    for dart in range(12):
        assert s.phi1(s.phi1(s.phi1(dart))) == dart and s.phi_1(s.phi1(dart)) == dart
        other = s.phi2(dart)
        assert s.phi2(other) == dart and s.origin(other) == s.origin(s.phi1(dart))
        assert s.first_dart(s.face_of(dart)) <= dart
    for face in range(4):
        assert s.degree(face) == 3 and s.triangle_count(face) == 1 and s.triangle_from_other_side(face, 0) == 0
        assert s.corners(face).tolist() == TETRA.faces[face].corners == s.triangle(face, 0)
        entry = s.entry(face, 0)
        assert not entry.outer and entry.index == 0
        across = s.simplices[0]["across"][entry.place]
        assert across["index"] == dartcast.topology.Across.OUTER_BIT + face


def test_features():
    s = dartcast.topology.Shape(TETRA)
    assert s.feature([2]).kind is dartcast.Kind.VERTEX
    assert s.feature([0, 1]).kind is dartcast.Kind.EDGE
    assert s.feature([0, 1, 3]).kind is dartcast.Kind.FACE
    assert s.feature([0, 1, 2, 3]).kind is dartcast.Kind.VOLUME
    assert s.face_of_point(0) == s.face_count


def test_a_polygon():
    s = dartcast.topology.Shape(dartcast.topology.ShapeKey(3, 0, False, [Face([0, 1]), Face([1, 2]), Face([2, 0])]))
    assert s.dimension == 2 and s.phi1(2) == 0 and len(s.simplices) == 1
    with pytest.raises(dartcast.InvalidArgument, match="ask the map"):
        s.phi2(0)


@pytest.mark.parametrize("key, error", [
    (dartcast.topology.ShapeKey(), dartcast.InvalidArgument),
    (dartcast.topology.ShapeKey(4, 9, False, TETRA.faces), dartcast.InvalidArgument),
    (dartcast.topology.ShapeKey(5, 0, False, TETRA.faces), dartcast.InvalidArgument),
    (dartcast.topology.ShapeKey(65535, 0, True, TETRA.faces), dartcast.InvalidArgument),
    (dartcast.topology.ShapeKey(4, 0, False, TETRA.faces[:3]), dartcast.InvalidMesh),
    (dartcast.topology.ShapeKey(4, 0, False, TETRA.faces[:3] + [Face([0, 2, 3])]), dartcast.InvalidMesh),
    (dartcast.topology.ShapeKey(4, 0, False, TETRA.faces[:3] + [Face([0, 3, 7])]), dartcast.InvalidMesh),
    (dartcast.topology.ShapeKey(4, 0, False, TETRA.faces[:3] + [Face([])]), dartcast.InvalidMesh),
    (dartcast.topology.ShapeKey(3, 0, False, [Face([0, 1], True), Face([1, 2]), Face([2, 0])]), dartcast.InvalidArgument),
    (dartcast.topology.ShapeKey(3, 0, False, [Face([0, 1]), Face([1, 2]), Face([2, 1])]), dartcast.InvalidMesh),
])
def test_keys_that_are_no_cell_are_refused(key, error):
    with pytest.raises(error):
        dartcast.topology.Shape(key)


@pytest.mark.parametrize("question, arguments", [
    ("origin", (12,)), ("face_of", (12,)), ("phi1", (12,)), ("phi_1", (12,)), ("phi2", (65535,)), ("first_dart", (4,)),
    ("degree", (4,)), ("corners", (4,)), ("triangle_count", (4,)), ("triangle", (0, 1)), ("triangle", (4, 0)),
    ("triangle_from_other_side", (0, 1)), ("entry", (0, 1)), ("feature", ([4],)),
])
def test_numbers_out_of_range_are_refused(question, arguments):
    with pytest.raises(IndexError, match="there is no"):
        getattr(dartcast.topology.Shape(TETRA), question)(*arguments)


def test_features_of_other_numbers_of_points_are_refused():
    s = dartcast.topology.Shape(TETRA)
    for points in ([], [0, 1, 2, 3, 0]):
        with pytest.raises(dartcast.InvalidArgument):
            s.feature(points)


def test_simplices_of_a_hexahedron_fill_it():
    mesh = dartcast.generate_box()
    s = dartcast.topology.CombinatorialMap(mesh).shape(0x20000000)
    view = dartcast.topology.CombinatorialMap(mesh).view(0x20000000)
    corners = mesh.points[view.vertices[s.simplices["vertex"]]]
    volumes = np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6
    assert (volumes > 0).all() and volumes.sum() == pytest.approx(1.0)
