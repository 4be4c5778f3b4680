"""The map: darts, faces, cells, marks, patches, views."""
from __future__ import annotations

import copy

import dartcast
import numpy as np
import pytest

CellFace, Dart = dartcast.topology.CellFace, dartcast.topology.Dart


def box_map(**options):
    return dartcast.topology.CombinatorialMap(dartcast.generate_box(cells=[2, 2, 2], size=[1.0, 1.0, 1.0], **options))


def all_darts(m):
    return [Dart(int(c), d) for c in m.cells() for d in range(m.shape(int(c)).dart_count)]


@pytest.mark.parametrize("options", [{}, {"mixed": True}])
def test_the_constraints_of_a_map_hold(options):
    m = box_map(**options)
    for d in all_darts(m):
        assert m.phi_1(m.phi1(d)) == d
        assert m.phi2(m.phi2(d)) == d and m.origin(m.phi2(d)) == m.origin(m.phi1(d))
        assert m.alpha1(d) == m.phi1(m.phi2(d))
        other = m.phi3(d)
        assert (other is None) == (m.opposite(m.face(d)) is None)
        if other is not None:
            assert m.phi3(other) == d and m.origin(m.phi1(other)) == m.origin(d)
    assert dartcast.topology.check_integrity(m) == []


def test_sizes():
    m = box_map()
    assert m.dimension == 3 and m.cell_count() == 8 and m.vertex_count == 27
    assert m.cell_count(1) == m.slot_count(1) == 8 and m.cell_count(0) == 0
    assert m.type_of(1) is dartcast.formats.CellType.HEXAHEDRON and m.bytes > 0
    assert m.pool_of("prism") == 2 and m.GENERAL_POOL == 4
    assert m.is_vertex(26) and not m.is_vertex(27) and not m.is_vertex(None)
    with pytest.raises(IndexError):
        m.cell_count(5)
    with pytest.raises(IndexError):
        m.slot_count(2**32 - 1)
    with pytest.raises(IndexError):
        m.type_of(5)


def test_cells_are_an_array_and_arrays_of_cells_are_answered_at_once():
    m = box_map(mixed=True)
    cells = m.cells()
    assert cells.dtype == np.uint32 and len(cells) == m.cell_count()
    assert np.array_equal(m.type(cells), [m.type(int(c)) for c in cells])
    assert np.array_equal(np.sort(m.source(cells)), np.arange(len(cells)))
    assert m.is_free(cells).dtype == bool and m.is_free(cells).all() and not m.has_flat(cells).any()
    assert m.is_free(int(cells[0])) is True and isinstance(m.type(int(cells[0])), dartcast.formats.CellType)
    with pytest.raises(dartcast.InvalidArgument, match="there is no cell"):
        m.source(np.append(cells, np.uint32(0xFFFFFFFF)))
    for wrong in (cells.astype(float), 1.5, "cell"):
        with pytest.raises(TypeError):
            m.source(wrong)


def test_free_marks_make_walls():
    m = box_map()
    assert m.wall_face_count() == 24 and m.may_touch_wall(0) and not m.may_touch_wall(13)
    c = int(m.cells()[0])
    face = next(f for f in range(6) if m.view(c).neighbour(f) is not None)
    assert not m.view(c).is_wall(face)
    m.set_free(c, False)
    assert m.view(c).is_wall(face) and not m.is_free(c) and m.wall_face_count() == 24 - 3 + 3
    m.set_free(c, True)
    assert not m.view(c).is_wall(face)
    assert m.may_touch_wall(13)


def test_patches():
    m = box_map()
    assert m.patch_names[0] == "" and sorted(m.patch_names[1:]) == ["xmax", "xmin", "ymax", "ymin", "zmax", "zmin"]
    assert m.patch_names[m.patch("ymin")] == "ymin"
    with pytest.raises(dartcast.InvalidArgument, match="no patch is named"):
        m.patch("inlet")
    patches = [m.patch(CellFace(int(c), f)) for c in m.cells() for f in range(6)]
    assert [patches.count(p) for p in range(7)] == [24] + [4] * 6


def test_views_and_handles():
    m = box_map()
    c = int(m.cells()[3])
    view, handle = m.view(c), m.handle(c)
    assert handle.cell == c and m.contains(handle) and m.contains(c)
    assert view.version == handle.version and view.is_free and view.vertices.shape == (8,)
    assert view.vertex(2) == view.vertices[2] and view.shape.face_count == 6
    for f in range(6):
        other = m.opposite((c, f))
        assert view.neighbour(f) == (None if other is None else other.cell)
        if other is None:
            with pytest.raises(dartcast.InvalidArgument, match="no neighbour"):
                view.neighbour_face(f)
        else:
            assert view.neighbour_face(f) == other.face
        assert m.point((c, f)) is None
    for question in (view.neighbour, view.neighbour_face, view.is_wall, view.vertex):
        with pytest.raises(IndexError):
            question(60000)
    flat = m.flat((c, 0))
    assert not flat.straight and not flat.coplanar


@pytest.mark.parametrize("cell", [None, 0, 7, 0x20000008, 0xFFFFFFFE, 0x80000000, 0xA0000000, 0xE0000001])
def test_cells_that_are_not_there_are_refused(cell):
    m = box_map()
    assert not m.contains(cell)
    for question in (m.view, m.shape, m.handle, m.type, m.source, m.is_free, m.has_flat):
        with pytest.raises(dartcast.InvalidArgument, match="there is no cell"):
            question(cell)
    with pytest.raises(dartcast.InvalidArgument):
        m.set_free(cell, False)
    pair = None if cell is None else (cell, 0)
    for question in (m.phi1, m.phi_1, m.phi2, m.phi3, m.alpha1, m.origin, m.face, m.flat, m.opposite, m.point, m.patch):
        with pytest.raises(dartcast.InvalidArgument):
            question(pair)


def test_darts_and_faces_that_are_not_there_are_refused():
    m = box_map()
    c = int(m.cells()[0])
    for question in (m.phi1, m.phi_1, m.phi2, m.phi3, m.alpha1, m.origin, m.face, m.flat):
        with pytest.raises(IndexError, match="no dart 24: there are 24"):
            question((c, 24))
    for question in (m.opposite, m.point, m.patch):
        with pytest.raises(IndexError, match="no face 6: there are 6"):
            question((c, 6))
    for wrong in (-1, 2**32, 2**64):
        with pytest.raises(ValueError):
            m.view(wrong)
    with pytest.raises(TypeError):
        m.view(1.0)
    with pytest.raises(dartcast.InvalidArgument):
        m.may_touch_wall(27)


def test_maps_are_equal_until_one_changes():
    a = box_map()
    b = copy.copy(a)
    assert a == b and copy.deepcopy(a) == a and a == a
    b.set_free(int(b.cells()[0]), False)
    assert a != b and a != 3


def test_the_mesh_is_checked_and_repaired_but_unchanged():
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    mesh = dartcast.MeshData(points, {"tetra": [[0, 2, 1, 3]]})
    assert dartcast.topology.CombinatorialMap(mesh).cell_count() == 1
    assert mesh.connectivity.tolist() == [0, 2, 1, 3]
    with pytest.raises(dartcast.InvalidMesh, match="without volume"):
        dartcast.topology.CombinatorialMap(dartcast.MeshData(points * [1, 1, 0], {"tetra": [[0, 1, 2, 3]]}))


def test_the_map_of_a_complex_is_only_read():
    m = dartcast.topology.CellComplex(dartcast.generate_box()).map
    with pytest.raises(dartcast.InvalidArgument, match="belongs to"):
        m.set_free(int(m.cells()[0]), False)
    with pytest.raises(dartcast.InvalidArgument, match="belongs to"):
        dartcast.topology.Transaction(m)


def test_planar_maps():
    m = dartcast.topology.CombinatorialMap(dartcast.generate_rectangle(cells=[3, 2], size=[1.0, 1.0], mixed=True))
    assert m.dimension == 2
    for d in all_darts(m):
        assert m.phi3(d) is None
        other = m.phi2(d)
        assert other is None or m.phi2(other) == d
        assert (m.alpha1(d) is None) == (other is None)
