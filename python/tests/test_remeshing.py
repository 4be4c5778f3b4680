"""Subdivision, coarsening, repair."""
from __future__ import annotations

import copy

import dartcast
import numpy as np
import pytest


def box(n=2):
    c = dartcast.topology.CellComplex(dartcast.generate_box(cells=[n, n, n], size=[1.0, 1.0, 1.0]))
    dartcast.topology.ComplexEdit(c)  # the first edit of a map counts the cells of each vertex
    return c


def first(m):
    return int(m.cells()[0])


def subdivided(c):
    with dartcast.topology.ComplexEdit(c) as edit:
        made = dartcast.topology.subdivide(edit, first(edit.map))
        report = edit.commit()
    s = made.subdivision
    dartcast.topology.update_after_edit(c.map, report.map.added, s)
    return made, s


def test_a_cell_is_subdivided_and_made_again():
    c = box()
    made, s = subdivided(c)
    assert c.map.cell_count() == 7 + 8 and dartcast.predicates.check_validity(c).valid
    assert s.corners.shape == (8,) and s.edge_middles.shape == (12,) and s.face_middles.shape == (6,)
    assert np.allclose(c.positions[s.middle], c.positions[s.corners].mean(axis=0))
    assert c.map.contains(s.part) and len(made.cells) >= 8
    with dartcast.topology.ComplexEdit(c) as edit:
        assert len(dartcast.topology.coarsen(edit, s)) >= 1
        edit.commit()
    assert c.map.cell_count() == 8 and dartcast.topology.check_integrity(c.map) == []


def test_a_subdivision_is_of_its_complex_and_cannot_be_invented():
    c, other = box(), box()
    _, s = subdivided(c)
    with dartcast.topology.ComplexEdit(other) as edit:
        with pytest.raises(dartcast.InvalidArgument, match="another complex"):
            dartcast.topology.coarsen(edit, s)
    with pytest.raises(dartcast.InvalidArgument, match="another complex"):
        dartcast.topology.update_after_edit(other.map, [], s)
    with pytest.raises(TypeError):
        dartcast.topology.Subdivision()
    with pytest.raises(AttributeError):
        s.middle = 3


def test_a_stale_subdivision_is_refused():
    c = box()
    with dartcast.topology.ComplexEdit(c) as edit:
        s = dartcast.topology.subdivide(edit, first(edit.map)).subdivision
    with dartcast.topology.ComplexEdit(c) as edit:
        with pytest.raises(dartcast.InvalidArgument, match="update_after_edit"):
            dartcast.topology.coarsen(edit, s)
        with pytest.raises(dartcast.InvalidArgument):
            dartcast.topology.subdivide(edit, 3)


def test_a_cell_becomes_its_simplices():
    c = dartcast.topology.CellComplex(dartcast.generate_box(dartcast.formats.BoxOptions(cells=[2, 2, 2], size=[2, 2, 2])))
    before = c.simplex_count
    with dartcast.topology.ComplexEdit(c) as edit:
        parts = dartcast.topology.divide_into_simplices(edit, [first(edit.map)])
        assert len(parts) == 6
        assert len(edit.refused_cells(parts, keep_faces=True)) == 0
        report = edit.commit()
    assert report.boundary_shift == 0.0
    assert c.simplex_count > before
    assert dartcast.predicates.check_validity(c).invalid_count == 0


def test_an_inverted_cell_is_repaired():
    c = box(3)
    points = np.array(c.positions)
    points[21] = points[21] + [0.6, 0.6, 0.6]
    c.move(points)
    bad = dartcast.predicates.check_validity(c, max_count=100).first
    assert bad
    with dartcast.topology.ComplexEdit(c) as edit:
        report = dartcast.topology.repair(edit, [b.cell for b in bad], dartcast.topology.RepairOptions(max_cells=64))
        edit.commit() if not report.left else None
    assert report.mended and all(m.how in dartcast.topology.Mending and len(m.sources) and len(m.cells) for m in report.mended)
    assert report.left == [] and dartcast.predicates.check_validity(c).valid


def test_sound_cells_are_left_alone():
    c = box()
    before = copy.copy(c.map)
    with dartcast.topology.ComplexEdit(c) as edit:
        report = dartcast.topology.repair(edit, edit.map.cells())
        with pytest.raises(dartcast.InvalidArgument):
            dartcast.topology.repair(edit, [5])
        edit.commit()
    assert report.mended == [] and report.left == [] and c.map == before
