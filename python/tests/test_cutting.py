"""Cuts, tools, carving, ligatures, reconnections."""
from __future__ import annotations

import dartcast
import numpy as np
import pytest

Plane = dartcast.topology.Plane


def volume(mesh):
    """Of all cells, from their faces: a sixth of the sum of determinants of fan triangles seen from the outside."""
    total = 0.0
    complex = dartcast.topology.CellComplex(mesh)
    for c in complex.map.cells():
        simplices = complex.map.shape(int(c)).simplices["vertex"]
        x = complex.positions[complex.map.view(int(c)).vertices[simplices]]
        total += np.linalg.det(x[:, 1:] - x[:, :1]).sum() / 6
    return total


def box(n=3, **options):
    return dartcast.topology.CellComplex(dartcast.generate_box(cells=[n, n, n], size=[n, n, n], **options))


def cells_of(c):
    return c.map.cells()


def test_planes():
    plane = dartcast.topology.plane_through([0, 0, 2], [0, 0, 4])
    assert plane.normal.tolist() == [0, 0, 1] and plane.offset == 2
    assert plane.height([5, 5, 3.5]) == 1.5 and plane.turned().height([5, 5, 3.5]) == -1.5
    assert plane.height(np.array([[0.0, 0, 0], [0, 0, 2]])).tolist() == [-2, 0]
    with pytest.raises(dartcast.InvalidArgument):
        dartcast.topology.plane_through([0, 0, 0], [0, 0, 0])


def test_a_plane_splits_cells_in_two():
    c = box()
    with dartcast.topology.ComplexEdit(c) as edit:
        plane = dartcast.topology.plane_through([0, 0, 1.5], [0, 0, 1])
        section = dartcast.topology.split_by_plane(edit, edit.map.cells(), plane)
        assert len(section.below) == len(section.above) == 18 and section.whole.size == 0
        edit.commit()
    assert c.map.cell_count() == 36 and dartcast.predicates.check_validity(c).valid
    assert volume(dartcast.topology.to_mesh(c)) == pytest.approx(27.0)


@pytest.mark.parametrize("plane", [Plane([np.nan, 0, 1], 0), Plane([0, 0, 0], 0), Plane([0, 0, 1], np.inf)])
def test_planes_that_are_not_finite_are_refused(plane):
    c = box(1)
    tools = [dartcast.topology.ConvexTool([plane])]
    with pytest.raises(dartcast.InvalidArgument, match="plane"):
        dartcast.cells_near(c, tools)
    with pytest.raises(dartcast.InvalidArgument, match="plane"):
        dartcast.topology.draw_together(c, cells_of(c), plane, dartcast.topology.TyingOptions(), np.zeros((8, 3)))
    with dartcast.topology.ComplexEdit(c) as edit:
        cells = edit.map.cells()
        for call in (lambda: dartcast.topology.split_by_plane(edit, cells, plane),
                     lambda: dartcast.carve(edit, cells, tools, "open"), lambda: dartcast.cut(edit, cells, plane, 0.1),
                     lambda: dartcast.topology.open_faces(edit, cells, plane, 0.1),
                     lambda: dartcast.ligature(edit, plane, int(cells[0]))):
            with pytest.raises(dartcast.InvalidArgument, match="plane"):
                call()


def test_tools():
    tool = dartcast.topology.box_tool([0, 0, 0], [1, 2, 3])
    assert len(tool.planes) == 6 and tool.finest == 1.0
    assert len(dartcast.topology.capsule_tool([0, 0, 0], [1, 0, 0], 0.5).planes) == 26
    assert len(dartcast.thicken(Plane(), 0.1)) == 1
    assert len(dartcast.thicken(dartcast.Disc(radius=2.0, sides=8), 0.1)[0].planes) == 10
    blade = dartcast.topology.BladePath([[[0, 0, 0], [0, 0, 1]], [[1, 0, 0], [1, 0, 1]], [[2, 1, 0], [2, 1, 1]]])
    assert np.array_equal(blade.places[1][0], [1, 0, 0]) and len(dartcast.thicken(blade, 0.1)) >= 2
    for bad in (lambda: dartcast.topology.box_tool([0, 0, 0], [0, 1, 1]),
                lambda: dartcast.topology.capsule_tool([0, 0, 0], [1, 0, 0], -1),
                lambda: dartcast.thicken(Plane(), 0), lambda: dartcast.thicken(dartcast.Disc(sides=2), 0.1),
                lambda: dartcast.thicken(dartcast.topology.BladePath([]), 0.1)):
        with pytest.raises(dartcast.InvalidArgument):
            bad()
    with pytest.raises(TypeError):
        dartcast.thicken(3, 0.1)


def test_cells_near_a_tool():
    c = box()
    tool = dartcast.topology.box_tool([0.2, 0.2, 0.2], [0.8, 0.8, 0.8])
    near = dartcast.cells_near(c, [tool])
    assert near.tolist() == [int(cells_of(c)[0])]
    assert dartcast.cells_near(c, [tool], int(near[0])).tolist() == near.tolist()
    assert dartcast.cells_near(c, [tool], int(cells_of(c)[-1])).size == 0
    with pytest.raises(dartcast.InvalidArgument):
        dartcast.cells_near(c, [tool], 5)


def test_carving_opens_and_removes():
    c = box(blocked_share=1.0)
    tool = dartcast.topology.box_tool([0.5, 0.5, 0.5], [1.5, 1.5, 1.5])
    near = dartcast.cells_near(c, [tool])
    with dartcast.topology.ComplexEdit(c) as edit:
        carved = dartcast.carve(edit, near, [tool], dartcast.topology.Carving.OPEN)
        assert carved.removed == 0 and len(carved.opened) == 8
        report = edit.commit()
    assert all(c.map.is_free(report.now(int(x))) for x in carved.opened) and dartcast.predicates.check_validity(c).valid
    c = box()
    with dartcast.topology.ComplexEdit(c) as edit:
        carved = dartcast.carve(edit, near, [tool], "remove", dartcast.topology.CarveOptions(whole_cells=False))
        edit.commit()
    assert carved.removed == 8 and volume(dartcast.topology.to_mesh(c)) == pytest.approx(26.0)


def test_cuts_open_a_layer():
    c = box(blocked_share=1.0)
    with dartcast.topology.ComplexEdit(c) as edit:
        carved = dartcast.cut(edit, edit.map.cells(), dartcast.topology.plane_through([0, 0, 1.5], [0, 0, 1]), 0.2)
        edit.commit()
    assert len(carved.opened) == 9
    c = box(blocked_share=1.0)
    with dartcast.topology.ComplexEdit(c) as edit:
        disc = dartcast.Disc(centre=[1.5, 1.5, 1.5], radius=0.7, sides=6)
        assert len(dartcast.cut(edit, edit.map.cells(), disc, 0.2).opened) > 0
        edit.commit()
    assert dartcast.predicates.check_validity(c).valid


def test_cells_of_a_cut_are_refused():
    c = box()
    with dartcast.topology.ComplexEdit(c) as edit:
        one = int(edit.map.cells()[0])
        for cells in ([one, one], [7], [0xFFFFFFF0]):
            with pytest.raises(dartcast.InvalidArgument):
                dartcast.topology.split_by_plane(edit, cells, Plane(offset=0.5))
            with pytest.raises(dartcast.InvalidArgument):
                dartcast.cut(edit, cells, Plane(offset=0.5), 0.1)
        with pytest.raises(dartcast.InvalidArgument, match="snap"):
            dartcast.topology.split_by_plane(edit, [one], Plane(), dartcast.topology.SectionOptions(snap=1.0))
        with pytest.raises(dartcast.InvalidArgument):
            dartcast.topology.open_faces(edit, [7], Plane(), 0.1)
        with pytest.raises(TypeError):
            dartcast.topology.split_by_plane(edit, [0.5], Plane())


def test_a_ligature_blocks_a_section():
    c = box()
    plane = dartcast.topology.plane_through([0, 0, 1.5], [0, 0, 1])
    with dartcast.topology.ComplexEdit(c) as edit:
        middle = next(int(x) for x in edit.map.cells() if edit.map.source(int(x)) == 13)
        tied = dartcast.ligature(edit, plane, middle)
        edit.commit()
    assert len(tied) == 9 and not c.map.is_free(tied).any()
    points = np.array(c.positions)
    moved = dartcast.topology.draw_together(c, tied, plane, dartcast.topology.TyingOptions(0.5, 1.0), points)
    assert np.array_equal(points, c.positions) and not np.array_equal(moved, points)
    with dartcast.topology.ComplexEdit(c) as edit:
        with pytest.raises(dartcast.InvalidArgument):
            dartcast.ligature(edit, plane, [1.5, 1.5, 1.5])
        with pytest.raises(dartcast.InvalidArgument):
            dartcast.ligature(edit, plane, 7)
        with pytest.raises(TypeError, match="place"):
            dartcast.ligature(edit, plane, "middle")
    with pytest.raises(dartcast.InvalidArgument):
        dartcast.topology.draw_together(c, [], plane, dartcast.topology.TyingOptions(), points)
    with pytest.raises(dartcast.InvalidArgument):
        dartcast.topology.draw_together(c, tied, plane, dartcast.topology.TyingOptions(share=1.0), points)


def test_a_place_chooses_the_ligature():
    c = box()
    with dartcast.topology.ComplexEdit(c) as edit:
        plane = dartcast.topology.plane_through([0, 0, 1.5], [0, 0, 1])
        assert len(dartcast.ligature(edit, plane, np.array([1.5, 1.5, 1.5]))) == 9


def test_ends_are_sewn_again():
    c = dartcast.topology.CellComplex(dartcast.generate_box(cells=[1, 1, 2], size=[1, 1, 2]))
    with dartcast.topology.ComplexEdit(c) as edit:
        lower = int(edit.map.cells()[0])
        face = next(f for f in range(6) if edit.map.opposite((lower, f)) is not None)
        dartcast.topology.unsew(edit.topology, (lower, face))
        report = edit.commit()
    assert [v.from_ == v.other for v in report.map.created] == [True] * 4
    plane = Plane(offset=1.0)
    with dartcast.topology.ComplexEdit(c) as edit:
        faces = dartcast.topology.open_faces(edit, edit.map.cells(), plane, 1e-9)
        assert len(faces) == 2
        joined = dartcast.reconnect(edit, faces[:1], faces[1:])
        assert joined.how is dartcast.topology.Reconnection.SEWN and joined.shift == 0.0
        edit.commit()
    assert dartcast.topology.check_integrity(c.map) == [] and c.map.wall_face_count() == 10


def test_ends_are_refused():
    c = box(2)
    with dartcast.topology.ComplexEdit(c) as edit:
        faces = dartcast.topology.open_faces(edit, edit.map.cells(), Plane(offset=0.0), 1e-9)
        assert len(faces) == 4
        for a, b, options in ((faces[:1], [], {}), (faces[:1], faces[:1], {}), (faces[:1], [(7, 0)], {}),
                              (faces[:1], [(faces[1].cell, 99)], {}), (faces[:1], faces[1:2], {"tolerance": -1.0}),
                              (faces[:1], faces[1:2], {"side": 60000})):
            with pytest.raises(dartcast.InvalidArgument):
                dartcast.reconnect(edit, a, b, dartcast.topology.ReconnectOptions(**options))


def test_planar_complexes_are_not_cut():
    c = dartcast.topology.CellComplex(dartcast.generate_rectangle(cells=[2, 2], size=[1.0, 1.0]))
    with dartcast.topology.ComplexEdit(c) as edit:
        with pytest.raises(dartcast.InvalidArgument, match="cells of space"):
            dartcast.topology.split_by_plane(edit, edit.map.cells(), dartcast.topology.plane_through([0.3, 0, 0], [1, 0, 0]))
        with pytest.raises(dartcast.InvalidArgument, match="cells of space"):
            dartcast.topology.subdivide(edit, int(edit.map.cells()[0]))
