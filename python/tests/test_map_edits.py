"""Edits of the topology, in transactions."""
from __future__ import annotations

import copy
import random

import dartcast
import numpy as np
import pytest

Dart, CellFace = dartcast.topology.Dart, dartcast.topology.CellFace


def box_map(**options):
    m = dartcast.topology.CombinatorialMap(dartcast.generate_box(cells=[2, 2, 2], size=[1.0, 1.0, 1.0], **options))
    dartcast.topology.Transaction(m)  # the first one on a map counts the cells of each vertex
    return m


def inner_face(m):
    return next(CellFace(int(c), f) for c in m.cells() for f in range(m.shape(int(c)).face_count)
                if m.opposite((int(c), f)) is not None)


def outer_face(m):
    return next(CellFace(int(c), f) for c in m.cells() for f in range(m.shape(int(c)).face_count)
                if m.opposite((int(c), f)) is None)


def test_leaving_without_commit_undoes_everything():
    m = box_map()
    before = copy.copy(m)
    with dartcast.topology.Transaction(m) as t:
        dartcast.topology.split_edge(t, (int(t.map.cells()[0]), 0))
        assert t.map.vertex_count == 28 and t.created_count == 1
    assert m == before
    with pytest.raises(ZeroDivisionError):
        with dartcast.topology.Transaction(m) as t:
            dartcast.topology.remove(t, int(t.map.cells()[0]))
            1 / 0
    assert m == before


def test_a_commit_makes_the_edits_final_and_reports_them():
    m = box_map()
    c = int(m.cells()[0])
    handle = m.handle(c)
    with dartcast.topology.Transaction(m) as t:
        split = dartcast.topology.split_edge(t, (c, 0))
        assert split.vertex == 27 and split.cells.tolist() == t.added().tolist()
        assert c in t.removed() and t.created(0).vertex == 27
        report = t.commit()
    assert handle in report.removed and report.added.tolist() == split.cells.tolist()
    assert [v.vertex for v in report.created] == [27]
    assert not m.contains(c) and m.vertex_count == 28 and dartcast.topology.check_integrity(m) == []


def test_splits_of_faces_and_cells():
    m = box_map()
    with dartcast.topology.Transaction(m) as t:
        f = inner_face(t.map)
        first = t.map.shape(f.cell).first_dart(f.face)
        a, b = dartcast.topology.split_face(t, (f.cell, first), (f.cell, first + 2))
        assert t.map.shape(int(a)).face_count == t.map.shape(int(b)).face_count == 7
        t.commit()
    assert dartcast.topology.check_integrity(m) == []


def test_a_cell_is_split_along_a_loop_and_merged_again():
    m = dartcast.topology.CombinatorialMap(dartcast.generate_box())
    before = m.vertex_count
    with dartcast.topology.Transaction(m) as t:
        for ends in ((0, 3), (4, 7)):
            darts = [d for d in cell_darts(t.map) if t.map.origin(d) in ends and face_has(t.map, d, ends)]
            dartcast.topology.split_face(t, darts[0], darts[1])
        path = loop(t.map, [0, 3, 7, 4])
        one, two = dartcast.topology.split_cell(t, path)
        assert t.map.type(np.array([one, two])).tolist() == [dartcast.formats.CellType.PRISM] * 2
        shared = next(f for f in range(5) if t.map.opposite((int(one), f)) is not None)
        whole = dartcast.topology.merge_cells(t, (int(one), shared))
        assert t.map.shape(whole).face_count == 8
        t.commit()
    assert m.vertex_count == before and dartcast.topology.check_integrity(m) == []


def cell_darts(m):
    c = int(m.cells()[0])
    return [Dart(c, d) for d in range(m.shape(c).dart_count)]


def face_has(m, d, ends):
    """Whether the dart's face has both ends, and they are no neighbours in it."""
    face = [d]
    while m.phi1(face[-1]) != d:
        face.append(m.phi1(face[-1]))
    return set(ends) <= {m.origin(x) for x in face} and m.origin(m.phi1(d)) not in ends and len(face) == 4


def loop(m, vertices):
    c = int(m.cells()[0])
    return [dartcast.topology.find_dart(m, c, a, b) for a, b in zip(vertices, vertices[1:] + vertices[:1])]


def test_sewing_and_opening():
    m = box_map()
    before = m.wall_face_count()
    with dartcast.topology.Transaction(m) as t:
        f = inner_face(t.map)
        other = t.map.opposite(f)
        dartcast.topology.unsew(t, f)
        assert t.map.wall_face_count() == before + 2
        t.roll_back()
        assert t.map.wall_face_count() == before and t.map.opposite(f) == other
        dartcast.topology.unsew(t, f)
        walls = [CellFace(int(c), k) for c in t.added() for k in range(6) if t.map.opposite((int(c), k)) is None]
        assert len(walls) > 1
        t.commit()
    assert dartcast.topology.check_integrity(m) == []


def test_merges_are_refused_with_a_reason():
    m = box_map()
    with dartcast.topology.Transaction(m) as t:
        f = outer_face(t.map)
        with pytest.raises(dartcast.EditRefused, match="on the boundary"):
            dartcast.topology.merge_cells(t, f)
        with pytest.raises(dartcast.EditRefused):
            dartcast.topology.unsew(t, f)
        with pytest.raises(dartcast.EditRefused):
            dartcast.topology.merge_edges(t, (f.cell, 0))
        with pytest.raises(dartcast.EditRefused):
            dartcast.topology.sew(t, (f.cell, 0), (f.cell, 1))
        assert t.added().size == 0 and t.removed().size == 0


def test_edges_are_merged_again():
    m = box_map()
    with dartcast.topology.Transaction(m) as t:
        split = dartcast.topology.split_edge(t, (int(t.map.cells()[0]), 0))
        d = next(Dart(int(c), k) for c in split.cells for k in range(t.map.shape(int(c)).dart_count)
                 if t.map.origin((int(c), k)) == split.vertex)
        assert len(dartcast.topology.merge_edges(t, d)) == len(split.cells)
        report = t.commit()
    assert report.created == [] and not m.is_vertex(split.vertex) and dartcast.topology.check_integrity(m) == []


def test_faces_are_merged_and_cells_are_removed():
    m = dartcast.topology.CombinatorialMap(dartcast.generate_box())
    with dartcast.topology.Transaction(m) as t:
        assert len(dartcast.topology.merge_faces(t, cell_darts(t.map)[0])) == 1
        t.roll_back()
        dartcast.topology.remove(t, int(t.map.cells()[0]))
        report = t.commit()
    assert m.cell_count() == 0 and len(report.deleted) == 8


def test_marks_are_undone():
    m = box_map()
    c = int(m.cells()[0])
    with dartcast.topology.Transaction(m) as t:
        t.set_free(c, False)
        assert t.marked().tolist() == [c] and not t.map.is_free(c)
    assert m.is_free(c)


def test_savepoints():
    m = box_map()
    with dartcast.topology.Transaction(m) as t:
        c = int(t.map.cells()[0])
        first = t.savepoint()
        dartcast.topology.remove(t, c)
        second = t.savepoint()
        dartcast.topology.remove(t, int(t.map.cells()[0]))
        t.roll_back(second)
        assert t.map.cell_count() == 7
        t.roll_back(first)
        assert t.map.cell_count() == 8
        with pytest.raises(dartcast.InvalidArgument, match="savepoint"):
            t.roll_back(second)
        dartcast.topology.remove(t, c)
        t.commit()
        with pytest.raises(dartcast.InvalidArgument, match="older than the last commit"):
            t.roll_back(first)
    other = box_map()
    with dartcast.topology.Transaction(other) as t:
        with pytest.raises(dartcast.InvalidArgument, match="another edit"):
            t.roll_back(first)


def test_an_ended_transaction_is_refused():
    m = box_map()
    with dartcast.topology.Transaction(m) as t:
        seen = t.map
    for call in (lambda: t.commit(), lambda: t.added(), lambda: dartcast.topology.split_edge(t, (0, 0)), lambda: seen.cells(),
                 lambda: t.__enter__(), lambda: t.savepoint(), lambda: t.map.cells()):
        with pytest.raises(dartcast.InvalidArgument, match="has ended"):
            call()
    assert m.cell_count() == 8


def test_a_map_has_one_transaction_at_a_time():
    m = box_map()
    with dartcast.topology.Transaction(m) as t:
        with pytest.raises(dartcast.InUse):
            dartcast.topology.Transaction(m)
        with pytest.raises(dartcast.InUse):
            m.cells()
        assert len(t.map.cells()) == 8
    del t
    abandoned = dartcast.topology.Transaction(m)
    dartcast.topology.remove(abandoned, int(abandoned.map.cells()[0]))
    del abandoned
    assert m.cell_count() == 8


def test_drafts_replace_cells():
    m = dartcast.topology.CombinatorialMap(dartcast.generate_box())
    c = int(m.cells()[0])
    draft = dartcast.topology.draft_of(m, c)
    assert len(draft.faces) == 6 and all(len(f.corners) == 4 for f in draft.faces)
    assert dartcast.topology.form_of(draft).defect == "" and dartcast.topology.form_of(draft).pool == 1
    assert dartcast.topology.forms_of([draft], 3)[0].pool == 1
    with dartcast.topology.Transaction(m) as t:
        v = t.add_vertex(0, 7)
        draft.point = v
        cells = t.replace([c], [draft])
        assert t.map.view(int(cells[0])).vertices[-1] == v
        t.commit()
    assert m.type(int(cells[0])) is dartcast.formats.CellType.POLYHEDRON and dartcast.topology.check_integrity(m) == []


def drafts_that_are_refused(m):
    c = int(m.cells()[0])

    def changed(change):
        draft = dartcast.topology.draft_of(m, c)
        faces = draft.faces
        change(draft, faces)
        draft.faces = faces
        return draft
    corner = dartcast.topology.DraftCorner
    yield changed(lambda d, f: f.pop())
    yield changed(lambda d, f: f.clear())
    yield changed(lambda d, f: setattr(f[0], "patch", 77))
    yield changed(lambda d, f: setattr(f[0], "point", 4000000000))
    yield changed(lambda d, f: setattr(d, "point", 4000000000))
    yield changed(lambda d, f: setattr(d, "point", 0))
    yield changed(lambda d, f: setattr(f[0], "corners", [corner(99), corner(98), corner(97), corner(96)]))
    yield changed(lambda d, f: setattr(f[0], "corners", []))
    yield changed(lambda d, f: setattr(f[0], "corners", [corner(None)] * 4))
    yield changed(lambda d, f: setattr(f[0], "across", dartcast.topology.DraftLink(draft=5, draft_face=1)))
    yield changed(lambda d, f: setattr(f[0], "across", dartcast.topology.DraftLink(draft=0, draft_face=60000)))
    yield changed(lambda d, f: setattr(f[0], "across", dartcast.topology.DraftLink((0xFFFFFFFE, 3))))
    yield changed(lambda d, f: setattr(f[0], "across", dartcast.topology.DraftLink((c, 77))))
    yield changed(lambda d, f: f.extend([f[0]] * 70000))
    yield dartcast.topology.CellDraft()


def test_drafts_that_are_no_cell_are_refused_and_change_nothing():
    m = box_map()
    before = copy.copy(m)
    for draft in drafts_that_are_refused(m):
        with dartcast.topology.Transaction(m) as t:
            with pytest.raises(dartcast.Error):
                t.replace([int(t.map.cells()[0])], [draft])
    assert m == before


def test_vertices_and_cells_that_are_not_there_are_refused():
    m = box_map()
    with dartcast.topology.Transaction(m) as t:
        for v in (27, None, 4000000000):
            with pytest.raises(dartcast.InvalidArgument, match="no vertex"):
                t.add_vertex(0, v)
            with pytest.raises(dartcast.InvalidArgument, match="no vertex"):
                t.note_merged(v, 0)
        for c in (0, None, 0xFFFFFFF0):
            with pytest.raises(dartcast.InvalidArgument):
                t.set_free(c, True)
            with pytest.raises(dartcast.InvalidArgument):
                dartcast.topology.remove(t, c)
            with pytest.raises(dartcast.InvalidArgument):
                dartcast.topology.split_edge(t, None if c is None else (c, 0))
        with pytest.raises(dartcast.InvalidArgument):
            t.replace([0], [])
        with pytest.raises(IndexError):
            t.created(0)
        c = int(t.map.cells()[0])
        for edit in (dartcast.topology.split_edge, dartcast.topology.merge_faces, dartcast.topology.merge_edges):
            with pytest.raises(dartcast.InvalidArgument, match="no such dart"):
                edit(t, (c, 24))
        for edit in (dartcast.topology.merge_cells, dartcast.topology.unsew):
            with pytest.raises(dartcast.InvalidArgument, match="no such face"):
                edit(t, (c, 6))
        for path in ([(c, 0), (c, 30), (c, 2)], [(c, 0), (c, 1), (c, 60000)],
                     [(c, 0), (c, 1), (0xFFFFFFF0, 0)], [None] * 3):
            with pytest.raises((dartcast.InvalidArgument, IndexError)):
                dartcast.topology.split_cell(t, path)
        with pytest.raises(dartcast.InvalidArgument):
            dartcast.topology.split_cell(t, [])


def test_stale_darts_are_refused():
    m = box_map()
    c = int(m.cells()[0])
    view = m.view(c)
    with dartcast.topology.Transaction(m) as t:
        dartcast.topology.split_edge(t, (c, 0))
        t.commit()
    for call in (lambda: m.phi1((c, 0)), lambda: view.vertices, lambda: view.neighbour(0),
                 lambda: dartcast.topology.draft_of(m, c), lambda: dartcast.topology.vertex_orbit(m, (c, 0)),
                 lambda: dartcast.topology.check_integrity(m, [c])):
        with pytest.raises(dartcast.InvalidArgument):
            call()
    assert dartcast.topology.find_dart(m, c, 0, 1) is None


def test_orbits():
    m = box_map()
    middle = next(Dart(int(c), d) for c in m.cells() for d in range(24) if m.origin((int(c), d)) == 13)
    around = dartcast.topology.vertex_orbit(m, middle)
    assert around[0] == middle and len(set(around)) == 24 and {m.origin(d) for d in around} == {13}
    assert len(dartcast.topology.edge_orbit(m, middle)) == 8
    assert len(dartcast.topology.face_orbit(m, middle)) == 8
    assert len(dartcast.topology.cell_orbit(m, middle)) == 24
    for orbit in (dartcast.topology.vertex_orbit, dartcast.topology.edge_orbit, dartcast.topology.face_orbit, dartcast.topology.cell_orbit):
        with pytest.raises(IndexError):
            orbit(m, (middle.cell, 24))


def test_polygons_are_split_and_merged():
    m = dartcast.topology.CombinatorialMap(dartcast.generate_rectangle(cells=[2, 2], size=[1.0, 1.0]))
    with dartcast.topology.Transaction(m) as t:
        c = int(t.map.cells()[0])
        one, two = dartcast.topology.split_face(t, (c, 0), (c, 2))
        assert t.map.type(np.array([one, two])).tolist() == [dartcast.formats.CellType.TRIANGLE] * 2
        with pytest.raises(dartcast.InvalidArgument, match="call split_face"):
            dartcast.topology.split_cell(t, [(int(one), 0)] * 3)
        t.commit()
    assert m.cell_count() == 5 and dartcast.topology.check_integrity(m) == []


def test_random_edits_leave_a_map_or_are_refused():
    rng = random.Random(1)
    m = box_map(mixed=True)
    edits = [dartcast.topology.split_edge, dartcast.topology.merge_faces, dartcast.topology.merge_edges]
    with dartcast.topology.Transaction(m) as t:
        for _ in range(400):
            cells = t.map.cells()
            if len(cells) < 3:
                break
            c, d = int(rng.choice(cells)), rng.randrange(30)
            try:
                choice = rng.randrange(6)
                if choice < 3:
                    edits[choice](t, (c, d))
                elif choice == 3:
                    dartcast.topology.split_face(t, (c, d), (c, rng.randrange(30)))
                elif choice == 4:
                    dartcast.topology.merge_cells(t, (c, rng.randrange(8)))
                else:
                    dartcast.topology.unsew(t, (c, rng.randrange(8)))
            except dartcast.Error:
                pass
        assert dartcast.topology.check_integrity(t.map) == []
        t.commit()
    assert dartcast.topology.check_integrity(m) == []
