"""Edits of a complex: positions, savepoints, commits."""
from __future__ import annotations

import copy

import dartcast
import numpy as np
import pytest

Dart = dartcast.topology.Dart


def box(n=2):
    c = dartcast.topology.CellComplex(dartcast.generate_box(cells=[n, n, n], size=[1.0, 1.0, 1.0]))
    dartcast.topology.ComplexEdit(c)  # the first edit of a map counts the cells of each vertex
    return c


def first(m):
    return int(m.cells()[0])


def test_leaving_without_commit_undoes_the_edit():
    c = box()
    before = copy.copy(c)
    with dartcast.topology.ComplexEdit(c) as edit:
        dartcast.topology.split_edge(edit.topology, (first(edit.map), 0))
        assert edit.map.vertex_count == 28
    assert c.map == before.map and np.array_equal(c.positions, before.positions)
    abandoned = dartcast.topology.ComplexEdit(c)
    dartcast.topology.remove(abandoned.topology, first(abandoned.map))
    del abandoned
    assert c.map == before.map


def test_new_vertices_are_placed():
    c = box()
    with dartcast.topology.ComplexEdit(c) as edit:
        split = dartcast.topology.split_edge(edit.topology, (first(edit.map), 0))
        a, b = (edit.topology.created(0).from_, edit.topology.created(0).other)
        ends = edit.position(np.array([a, b]))
        assert np.array_equal(edit.position(split.vertex), ends.mean(axis=0))
        edit.place(split.vertex, [a, b], [0.25, 0.75])
        x = 0.25 * ends[0] + 0.75 * ends[1]
        assert np.allclose(edit.position(split.vertex), x)
        report = edit.commit()
    assert np.allclose(c.positions[split.vertex], x) and dartcast.predicates.check_validity(c).valid
    assert report.map.created[0].vertex == split.vertex and report.boundary_shift < 1e-12
    placed = report.placed[0]
    assert placed.vertex == split.vertex and placed.of.tolist() == [a, b] and placed.weights.tolist() == [0.25, 0.75]
    for cell in split.cells:
        assert c.map.contains(report.now(int(cell)))
    values = np.arange(27.0)
    new = dartcast.topology.update_after_edit(report, c.map.vertex_count, values)
    assert new[split.vertex] == 0.25 * a + 0.75 * b and np.array_equal(new[:27], values)
    both = dartcast.topology.update_after_edit(report, c.map.vertex_count, np.column_stack([values, -values]))
    assert np.array_equal(both[:len(new)], np.column_stack([new, -new]))


def test_data_that_do_not_fit_an_edit_are_refused():
    c = box()
    with dartcast.topology.ComplexEdit(c) as edit:
        dartcast.topology.split_edge(edit.topology, (first(edit.map), 0))
        report = edit.commit()
    with pytest.raises(TypeError, match="values: expected float64"):
        dartcast.topology.update_after_edit(report, 28, np.zeros(27, dtype=complex))
    report.placed = [dartcast.topology.PlacedVertex(3, [4000000000], [1.0])]
    with pytest.raises(dartcast.InvalidArgument, match="not below 28"):
        dartcast.topology.update_after_edit(report, 28, np.arange(27.0))
    report.placed = [dartcast.topology.PlacedVertex(3, [1, 2], [1.0])]
    with pytest.raises(dartcast.InvalidArgument):
        dartcast.topology.update_after_edit(report, 28, np.arange(27.0))
    report.placed = [dartcast.topology.PlacedVertex(3, [], [])]
    with pytest.raises(dartcast.InvalidArgument):
        dartcast.topology.update_after_edit(report, 28, np.arange(27.0))


def test_places_are_refused():
    c = box()
    with dartcast.topology.ComplexEdit(c) as edit:
        v = dartcast.topology.split_edge(edit.topology, (first(edit.map), 0)).vertex
        for bad in ([np.nan, 0, 0], [1e100, 0, 0]):
            with pytest.raises(dartcast.InvalidArgument, match="place"):
                edit.place(v, bad)
        with pytest.raises(dartcast.InvalidArgument, match="not made by this edit"):
            edit.place(0, [0, 0, 0])
        with pytest.raises(dartcast.InvalidArgument, match="one weight per vertex"):
            edit.place(v, [0, 1], [1.0])
        with pytest.raises(dartcast.InvalidArgument, match="no vertex"):
            edit.place(v, [0, 4000000000], [0.5, 0.5])
        for w in (99, None, 4000000000):
            with pytest.raises(dartcast.InvalidArgument, match="no vertex"):
                edit.position(w)


def test_a_commit_that_is_refused_undoes_all():
    c = box()
    before = copy.copy(c)
    with dartcast.topology.ComplexEdit(c) as edit:
        point = edit.savepoint()
        v = dartcast.topology.split_edge(edit.topology, (first(edit.map), 0)).vertex
        edit.place(v, [5.0, 5.0, 5.0])
        with pytest.raises(dartcast.EditRefused):
            edit.commit()
        with pytest.raises(dartcast.InvalidArgument, match="savepoint"):
            edit.roll_back(point)
    assert c.map == before.map and np.array_equal(c.positions, before.positions)


def test_savepoints():
    c = box()
    with dartcast.topology.ComplexEdit(c) as edit:
        cell = first(edit.map)
        start = edit.savepoint()
        dartcast.topology.split_edge(edit.topology, (cell, 0))
        later = edit.topology.savepoint()
        dartcast.topology.remove(edit.topology, first(edit.map))
        edit.roll_back(later)
        assert edit.map.vertex_count == 28
        edit.roll_back(start)
        assert edit.map.vertex_count == 27 and edit.map.contains(cell)
        with pytest.raises(dartcast.InvalidArgument, match="undone"):
            edit.roll_back(later)


def test_the_topology_of_an_edit_is_ended_by_the_edit():
    c = box()
    with dartcast.topology.ComplexEdit(c) as edit:
        t = edit.topology
        for call in (t.commit, t.roll_back, lambda: t.__exit__(None, None, None)):
            with pytest.raises(dartcast.InvalidArgument, match="belongs to an edit"):
                call()
        with pytest.raises(dartcast.InvalidArgument, match="belongs to"):
            dartcast.topology.Transaction(edit.map)
        draft = dartcast.topology.draft_of(edit.map, first(edit.map))
        draft.point = t.add_vertex(0, 1)
        with pytest.raises(dartcast.InvalidArgument, match="no Steiner point of a cell"):
            t.replace([first(edit.map)], [draft])
        draft.point, faces = None, draft.faces
        faces[0].point = 0
        draft.faces = faces
        with pytest.raises(dartcast.InvalidArgument, match="may only keep"):
            t.replace([first(edit.map)], [draft])


def test_an_ended_edit_is_refused():
    c = box()
    with dartcast.topology.ComplexEdit(c) as edit:
        t, m = edit.topology, edit.map
    plane = dartcast.topology.Plane()
    for call in (lambda: edit.topology, lambda: edit.position(0), lambda: edit.commit(), lambda: m.cells(),
                 lambda: t.added(), lambda: dartcast.topology.remove(t, 0), lambda: edit.__enter__(), lambda: edit.savepoint(),
                 lambda: dartcast.topology.subdivide(edit, 0), lambda: dartcast.topology.split_by_plane(edit, [], plane)):
        with pytest.raises(dartcast.InvalidArgument, match="has ended"):
            call()


def test_a_complex_is_in_use_while_an_edit_is_open():
    c = box()
    m = c.map
    with dartcast.topology.ComplexEdit(c):
        for call in (lambda: c.positions, lambda: c.move(np.zeros((27, 3))), lambda: m.cells(),
                     lambda: dartcast.topology.ComplexEdit(c), lambda: copy.copy(c), lambda: dartcast.predicates.check_validity(c),
                     lambda: dartcast.topology.to_mesh(c)):
            with pytest.raises(dartcast.InUse):
                call()
    assert len(m.cells()) == 8


def test_an_edit_continues_after_a_commit():
    c = box()
    with dartcast.topology.ComplexEdit(c) as edit:
        dartcast.topology.remove(edit.topology, first(edit.map))
        edit.commit()
        dartcast.topology.remove(edit.topology, first(edit.map))
    assert c.map.cell_count() == 7
