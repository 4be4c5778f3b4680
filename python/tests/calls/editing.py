"""Edits of complexes: placed vertices, cuts, tools, ligatures, reconnections, subdivision and repair."""
from __future__ import annotations

import copy
from collections.abc import Callable

import numpy as np

import dartcast as dc

from . import Calls, refused
from .scenes import box, complex_of, first, inner_face, undone

PLANE = dc.topology.plane_through([0.0, 0.0, 0.3], [0.0, 0.0, 1.0])


def split_and_place(edit: dc.topology.ComplexEdit) -> None:
    v = dc.topology.split_edge(edit.topology, (first(edit.map), 0)).vertex
    made = edit.topology.created(0)
    edit.place(v, [made.from_, made.other], [0.25, 0.75])
    edit.place(v, edit.position(v))


def to_savepoint(edit: dc.topology.ComplexEdit) -> None:
    point = edit.savepoint()
    dc.topology.split_edge(edit.topology, (first(edit.map), 0))
    edit.roll_back(point)


def committed() -> dc.topology.ComplexEditReport:
    c = complex_of()
    with dc.topology.ComplexEdit(c) as edit:
        split_and_place(edit)
        return edit.commit()


def of_edits() -> Calls:
    c = complex_of()
    report = committed()
    values = np.arange(27.0)
    edit = dc.topology.ComplexEdit(complex_of())

    def commit_refused(edit: dc.topology.ComplexEdit) -> None:
        v = dc.topology.split_edge(edit.topology, (first(edit.map), 0)).vertex
        edit.place(v, [5.0, 5.0, 5.0])
        refused(edit.commit)()

    return {
        "ComplexEdit": lambda: dc.topology.ComplexEdit(c),
        "ComplexEdit: refused": undone(c, lambda e: refused(lambda: dc.topology.ComplexEdit(c))()),
        "ComplexEdit.position": lambda: edit.position(3),
        "ComplexEdit.position: many": lambda: edit.position(np.arange(27)),
        "ComplexEdit.position: refused": refused(lambda: edit.position(99)),
        "ComplexEdit.place": undone(c, split_and_place),
        "ComplexEdit.place: refused": refused(lambda: edit.place(0, [0.0, 0.0, 0.0])),
        "ComplexEdit.savepoint": undone(c, to_savepoint), "ComplexEdit.roll_back": undone(c, to_savepoint),
        "ComplexEdit.commit": committed, "ComplexEdit.commit: refused": undone(c, commit_refused),
        "ComplexEdit.__enter__": undone(c, lambda e: None),
        "ComplexEdit.__exit__": undone(c, lambda e: dc.topology.remove(e.topology, first(e.map))),
        "ComplexEdit.__exit__: raised": refused(undone(c, lambda e: {}["no key"])),
        "ComplexEdit: ended": lambda: refused(ended(c).commit)(),
        "ComplexEditReport.now": lambda: report.now(first(c.map)),
        "update_after_edit": lambda: dc.topology.update_after_edit(report, 28, values),
        "update_after_edit: vectors": lambda: dc.topology.update_after_edit(report, 28, np.ones((27, 3))),
        "update_after_edit: refused": refused(lambda: dc.topology.update_after_edit(report, 28, 1j * np.arange(27))),
    }


def ended(c: dc.topology.CellComplex) -> dc.topology.ComplexEdit:
    with dc.topology.ComplexEdit(c) as edit:
        return edit


def of_planes() -> Calls:
    blade = dc.topology.BladePath([[[0, 0, 0], [0, 0, 1]], [[1, 0, 0], [1, 0, 1]], [[2, 1, 0], [2, 1, 1]]])
    disc = dc.Disc(radius=2.0, sides=8)
    return {
        "plane_through": lambda: dc.topology.plane_through([0, 0, 2], [0, 0, 4]),
        "plane_through: refused": refused(lambda: dc.topology.plane_through([0, 0, 0], [0, 0, 0])),
        "Plane.height": lambda: PLANE.height([5, 5, 3.5]), "Plane.height: many": lambda: PLANE.height(np.ones((5, 3))),
        "Plane.turned": PLANE.turned, "thicken": lambda: dc.thicken(PLANE, 0.1),
        "thicken: disc": lambda: dc.thicken(disc, 0.1), "thicken: blade": lambda: dc.thicken(blade, 0.1),
        "thicken: refused": refused(lambda: dc.thicken(PLANE, 0.0)),
        "thicken: type refused": refused(lambda: dc.thicken(3, 0.1)),
        "box_tool": lambda: dc.topology.box_tool([0, 0, 0], [1, 2, 3]),
        "box_tool: refused": refused(lambda: dc.topology.box_tool([0, 0, 0], [0, 1, 1])),
        "capsule_tool": lambda: dc.topology.capsule_tool([0, 0, 0], [1, 0, 0], 0.5),
        "capsule_tool: refused": refused(lambda: dc.topology.capsule_tool([0, 0, 0], [1, 0, 0], -1.0)),
    }


def of_cuts() -> Calls:
    c, blocked = complex_of(), complex_of(blocked_share=1.0)
    tool = dc.topology.box_tool([0.1, 0.1, 0.1], [0.4, 0.4, 0.4])
    disc = dc.Disc(centre=[0.3, 0.3, 0.3], radius=0.2, sides=6)
    tied = complex_of()
    with dc.topology.ComplexEdit(tied) as edit:
        section = dc.ligature(edit, PLANE, first(edit.map))
        edit.commit()
    cells, points = c.map.cells(), tied.positions.copy()

    def refused_in(edit: Callable[[dc.topology.ComplexEdit], object]) -> Callable[[], None]:
        return undone(c, lambda e: refused(lambda: edit(e))())

    return {
        "cells_near": lambda: dc.cells_near(c, [tool]),
        "cells_near: start": lambda: dc.cells_near(c, [tool], int(cells[0])),
        "cells_near: refused": refused(lambda: dc.cells_near(c, [tool], 5)),
        "split_by_plane": undone(c, lambda e: dc.topology.split_by_plane(e, cells, PLANE)),
        "split_by_plane: refused": refused_in(lambda e: dc.topology.split_by_plane(e, [7], PLANE)),
        "carve": undone(blocked, lambda e: dc.carve(e, cells, [tool], "open")),
        "carve: remove": undone(c, lambda e: dc.carve(e, cells, [tool], "remove", dc.topology.CarveOptions(whole_cells=False))),
        "carve: refused": refused_in(lambda e: dc.carve(e, [7], [tool], "open")),
        "cut": undone(blocked, lambda e: dc.cut(e, cells, PLANE, 0.1)),
        "cut: disc": undone(blocked, lambda e: dc.cut(e, cells, disc, 0.1)),
        "cut: refused": refused_in(lambda e: dc.cut(e, [7], PLANE, 0.1)),
        "ligature": undone(c, lambda e: dc.ligature(e, PLANE, int(cells[0]))),
        "ligature: place": undone(c, lambda e: dc.ligature(e, PLANE, np.array([0.3, 0.3, 0.3]))),
        "ligature: refused": refused_in(lambda e: dc.ligature(e, PLANE, 7)),
        "draw_together": lambda: dc.topology.draw_together(tied, section, PLANE, dc.topology.TyingOptions(0.5, 1.0), points),
        "draw_together: refused": refused(lambda: dc.topology.draw_together(tied, [], PLANE, dc.topology.TyingOptions(), points)),
    }


def of_ends() -> Calls:
    """Two cells whose common face is open."""
    c = dc.topology.CellComplex(dc.generate_box(cells=[1, 1, 2], size=[1, 1, 2]), threads=1)
    with dc.topology.ComplexEdit(c) as edit:
        dc.topology.unsew(edit.topology, inner_face(edit.map))
        edit.commit()
    plane = dc.topology.Plane(offset=1.0)

    def ends(edit: dc.topology.ComplexEdit) -> list[dc.topology.CellFace]:
        return dc.topology.open_faces(edit, edit.map.cells(), plane, 1e-9)

    def sew(edit: dc.topology.ComplexEdit) -> None:
        a, b = ends(edit)
        m = edit.map
        dart = m.shape(a.cell).first_dart(a.face)
        start, end = m.origin((a.cell, dart)), m.origin(m.phi1((a.cell, dart)))
        position = {v: tuple(edit.position(v)) for v in range(m.vertex_count) if m.is_vertex(v)}
        other = m.shape(b.cell).first_dart(b.face)
        for i in range(4):
            d = (b.cell, other + i)
            if position[m.origin(d)] == position[end] and position[m.origin(m.phi1(d))] == position[start]:
                dc.topology.sew(edit.topology, (a.cell, dart), d)
                return
        raise AssertionError("no dart to sew to")

    return {
        "open_faces": undone(c, ends), "sew": undone(c, sew),
        "open_faces: refused": undone(c, lambda e: refused(lambda: dc.topology.open_faces(e, [7], plane, 0.1))()),
        "reconnect": undone(c, lambda e: dc.reconnect(e, ends(e)[:1], ends(e)[1:])),
        "reconnect: refused": undone(c, lambda e: refused(lambda: dc.reconnect(e, ends(e)[:1], []))()),
    }


def of_subdivision() -> Calls:
    again, coarse, c = complex_of(), complex_of(), complex_of()
    with dc.topology.ComplexEdit(coarse) as edit:
        s = dc.topology.subdivide(edit, first(edit.map)).subdivision
        added = edit.commit().map.added
    dc.topology.update_after_edit(coarse.map, added, s)

    def back_and_forth() -> None:
        with dc.topology.ComplexEdit(again) as edit:
            own = dc.topology.subdivide(edit, first(edit.map)).subdivision
            report = edit.commit()
        dc.topology.update_after_edit(again.map, report.map.added, own)
        with dc.topology.ComplexEdit(again) as edit:
            dc.topology.coarsen(edit, own)
            edit.commit()

    return {
        "subdivide": undone(c, lambda e: dc.topology.subdivide(e, first(e.map))), "subdivide: coarsen": back_and_forth,
        "subdivide: refused": undone(c, lambda e: refused(lambda: dc.topology.subdivide(e, 3))()),
        "divide_into_simplices": undone(c, lambda e: dc.topology.divide_into_simplices(e, e.map.cells()[:3])),
        "divide_into_simplices: refused": undone(c, lambda e: refused(lambda: dc.topology.divide_into_simplices(e, [3]))()),
        "ComplexEdit.refused_cells": undone(
            c, lambda e: e.refused_cells(dc.topology.divide_into_simplices(e, e.map.cells()[:3]))),
        "coarsen": undone(coarse, lambda e: dc.topology.coarsen(e, s)),
        "coarsen: refused": undone(c, lambda e: refused(lambda: dc.topology.coarsen(e, s))()),
        "update_after_edit: subdivision": lambda: dc.topology.update_after_edit(coarse.map, added, s),
        "update_after_edit: subdivision refused": refused(lambda: dc.topology.update_after_edit(c.map, [], s)),
    }


def of_repair() -> Calls:
    c = dc.topology.CellComplex(box(3), threads=1)
    sound = copy.copy(c)
    points = c.positions.copy()
    points[21] += 0.6
    c.move(points)
    bad = [cell.cell for cell in dc.predicates.check_validity(c, threads=1, max_count=100).first]
    assert bad
    return {
        "repair": undone(c, lambda e: dc.topology.repair(e, bad, dc.topology.RepairOptions(max_cells=64))),
        "repair: sound": undone(sound, lambda e: dc.topology.repair(e, e.map.cells())),
        "repair: refused": undone(sound, lambda e: refused(lambda: dc.topology.repair(e, [5]))()),
    }


def calls() -> Calls:
    return of_edits() | of_planes() | of_cuts() | of_ends() | of_subdivision() | of_repair()
