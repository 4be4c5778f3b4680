"""Predicates, shapes, maps with their edits, complexes, and their validity."""
from __future__ import annotations

import copy
from collections.abc import Callable

import numpy as np

import dartcast as dc

from . import Calls, refused
from .scenes import box, complex_of, first, inner_face, outer_face

X = np.random.default_rng(1).integers(-3, 4, (4, 50, 3)) * 0.1


def of_predicates() -> Calls:
    a, b, c, d = X
    table: Calls = {}
    for name in ("orient3d", "orient3d_exact", "orient3d_value"):
        table[name] = lambda f=getattr(dc.predicates, name): f(a, b, c, d)
        table[f"{name}: one"] = lambda f=getattr(dc.predicates, name): f([0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1])
        table[f"{name}: refused"] = refused(lambda f=getattr(dc.predicates, name): f(a, b, c[:3], d))
    for name in ("orient2d", "orient2d_exact", "orient2d_value"):
        table[name] = lambda f=getattr(dc.predicates, name): f(a, b, c)
        table[f"{name}: one"] = lambda f=getattr(dc.predicates, name): f([0, 0, 0], [1, 0, 0], [0, 1, 0])
        table[f"{name}: refused"] = refused(lambda f=getattr(dc.predicates, name): f(a, b.astype(np.complex64), c))
    line = dc.predicates.SymbolicPerturbation([0, 0, 0], X[0, :3].copy())
    plane = dc.predicates.PlanarSymbolicPerturbation([0, 0, 0], np.zeros((0, 3)))
    return table | {
        "in_exact_range": lambda: dc.predicates.in_exact_range(a), "in_exact_range: one": lambda: dc.predicates.in_exact_range([0, 0, 0]),
        "flushed": lambda: dc.predicates.flushed(a), "flushed: one": lambda: dc.predicates.flushed([1e-301, 0, 0]),
        "are_extents": lambda: dc.predicates.are_extents([1, 1, 1], 2.0), "bound_holds": lambda: dc.predicates.bound_holds([1, 1, 1]),
        "filter_applies": lambda: dc.predicates.filter_applies([1, 1, 1]),
        "are_plane_extents": lambda: dc.predicates.are_plane_extents(1, 1, 2),
        "plane_bound_holds": lambda: dc.predicates.plane_bound_holds(1, 1),
        "plane_filter_applies": lambda: dc.predicates.plane_filter_applies(1, 1),
        "extent_of": lambda: dc.predicates.extent_of(a), "extent_of: refused": refused(lambda: dc.predicates.extent_of(np.zeros((0, 3)))),
        "rounds_nothing": lambda: dc.predicates.rounds_nothing([4, 4, 4], a),
        "SymbolicPerturbation": lambda: dc.predicates.SymbolicPerturbation([0, 0, 0], X[0, :3].copy()),
        "SymbolicPerturbation: refused": refused(lambda: dc.predicates.SymbolicPerturbation([0, 0, 0], a)),
        "SymbolicPerturbation.of_line": lambda: line.of_line([1, 0, 0], [2, 0, 0], [3, 1, 0]),
        "SymbolicPerturbation.of_line: refused": refused(lambda: line.of_line([np.nan] * 3, [2, 0, 0], [3, 1, 0])),
        "PlanarSymbolicPerturbation": lambda: dc.predicates.PlanarSymbolicPerturbation([0, 0, 0], np.zeros((0, 3))),
        "PlanarSymbolicPerturbation.of_line": lambda: plane.of_line([1, 0, 0]),
    }


def of_shapes() -> Calls:
    m = complex_of().map
    shape = m.shape(first(m))
    key = shape.key
    table: Calls = {"Shape": lambda: dc.topology.Shape(key), "Shape: refused": refused(lambda: dc.topology.Shape(dc.topology.ShapeKey()))}
    for name in ("origin", "face_of", "phi1", "phi_1", "phi2", "first_dart", "degree", "corners", "triangle_count",
                 "face_of_point"):
        table[f"Shape.{name}"] = lambda f=getattr(shape, name): f(1)
        table[f"Shape.{name}: refused"] = refused(lambda f=getattr(shape, name): f("x"))
    for name in ("triangle", "triangle_from_other_side", "entry"):
        table[f"Shape.{name}"] = lambda f=getattr(shape, name): f(1, 0)
        table[f"Shape.{name}: refused"] = refused(lambda f=getattr(shape, name): f(60, 0))
    table["Shape.feature"] = lambda: shape.feature([0, 1])
    table["Shape.feature: refused"] = refused(lambda: shape.feature([]))
    return table


def of_maps() -> Calls:
    mesh = box(2)
    m = dc.topology.CombinatorialMap(mesh)
    other = copy.copy(m)
    cells, c = m.cells(), first(m)
    view = m.view(c)
    face = inner_face(m)
    table: Calls = {}
    for name in ("phi1", "phi_1", "phi2", "phi3", "alpha1", "origin", "face", "flat", "opposite", "point", "patch"):
        table[f"CombinatorialMap.{name}"] = lambda f=getattr(m, name): f((c, 1))
        table[f"CombinatorialMap.{name}: refused"] = refused(lambda f=getattr(m, name): f((c, 60)))
    for name in ("view", "shape", "handle", "type", "source", "is_free", "has_flat", "contains"):
        table[f"CombinatorialMap.{name}"] = lambda f=getattr(m, name): f(c)
        table[f"CombinatorialMap.{name}: refused"] = refused(lambda f=getattr(m, name): f(1.5))
    for name in ("type", "source", "is_free", "has_flat"):
        table[f"CombinatorialMap.{name}: many"] = lambda f=getattr(m, name): f(cells)
        table[f"CombinatorialMap.{name}: many refused"] = refused(lambda f=getattr(m, name): f(cells + 1000))
    return table | {
        "CombinatorialMap": lambda: dc.topology.CombinatorialMap(mesh),
        "CombinatorialMap: refused": refused(lambda: dc.topology.CombinatorialMap(dc.MeshData())),
        "CombinatorialMap.patch: name": lambda: m.patch("ymin"),
        "CombinatorialMap.patch: name refused": refused(lambda: m.patch("inlet")),
        "CombinatorialMap.pool_of": lambda: dc.topology.CombinatorialMap.pool_of("prism"),
        "CombinatorialMap.wall_face_count": m.wall_face_count, "CombinatorialMap.cells": m.cells,
        "CombinatorialMap.set_free": lambda: (m.set_free(c, False), m.set_free(c, True)),
        "CombinatorialMap.set_free: refused": refused(lambda: m.set_free(7, False)),
        "CombinatorialMap.cell_count": m.cell_count, "CombinatorialMap.slot_count": lambda: m.slot_count(1),
        "CombinatorialMap.type_of": lambda: m.type_of(1),
        "CombinatorialMap.type_of: refused": refused(lambda: m.type_of(5)),
        "CombinatorialMap.is_vertex": lambda: m.is_vertex(26),
        "CombinatorialMap.may_touch_wall": lambda: m.may_touch_wall(13),
        "CombinatorialMap.may_touch_wall: refused": refused(lambda: m.may_touch_wall(27)),
        "CombinatorialMap.__eq__": lambda: m == other, "CombinatorialMap.__copy__": lambda: copy.copy(m),
        "CombinatorialMap.__deepcopy__": lambda: copy.deepcopy(m),
        "CellView.vertex": lambda: view.vertex(2), "CellView.neighbour": lambda: view.neighbour(face[1]),
        "CellView.neighbour_face": lambda: view.neighbour_face(face[1]), "CellView.is_wall": lambda: view.is_wall(0),
        "CellView.vertex: refused": refused(lambda: view.vertex(60)),
        "CellView.neighbour: refused": refused(lambda: view.neighbour(60)),
    }


def of_orbits() -> Calls:
    m = dc.topology.CombinatorialMap(box(2))
    c = first(m)
    draft = dc.topology.draft_of(m, c)
    table: Calls = {}
    for name in ("vertex_orbit", "edge_orbit", "face_orbit", "cell_orbit"):
        table[name] = lambda f=getattr(dc.topology, name): f(m, (c, 0))
        table[f"{name}: refused"] = refused(lambda f=getattr(dc.topology, name): f(m, (c, 60)))
    return table | {
        "find_dart": lambda: dc.topology.find_dart(m, c, 0, 1), "check_integrity": lambda: dc.topology.check_integrity(m),
        "check_integrity: refused": refused(lambda: dc.topology.check_integrity(m, [7])),
        "draft_of": lambda: dc.topology.draft_of(m, c), "draft_of: refused": refused(lambda: dc.topology.draft_of(m, 7)),
        "form_of": lambda: dc.topology.form_of(draft), "forms_of": lambda: dc.topology.forms_of([draft, draft], 3),
    }


def split_quad(t: dc.topology.Transaction) -> np.ndarray:
    """Splits an inner face of the first cell from corner to corner. Returns the cells on its sides."""
    c, f = inner_face(t.map)
    dart = t.map.shape(c).first_dart(f)
    return dc.topology.split_face(t, (c, dart), (c, dart + 2))


def split_hexahedron(t: dc.topology.Transaction) -> np.ndarray:
    """Splits a cube into two prisms."""
    for ends in ((0, 3), (4, 7)):
        c = first(t.map)
        for f in range(t.map.shape(c).face_count):
            dart = t.map.shape(c).first_dart(f)
            corners = [t.map.origin((c, dart + i)) for i in range(t.map.shape(c).degree(f))]
            if set(ends) <= set(corners):
                a, b = (dart + corners.index(v) for v in ends)
                if abs(a - b) == 2:
                    dc.topology.split_face(t, (c, a), (c, b))
                    break
    c = first(t.map)
    loop = [0, 3, 7, 4]
    return dc.topology.split_cell(t, [dc.topology.find_dart(t.map, c, a, b) for a, b in zip(loop, loop[1:] + loop[:1])])


def merge_prisms(t: dc.topology.Transaction) -> None:
    one = int(split_hexahedron(t)[0])
    shared = next(f for f in range(5) if t.map.opposite((one, f)) is not None)
    dc.topology.merge_cells(t, (one, shared))


def merge_split_edge(t: dc.topology.Transaction) -> None:
    split = dc.topology.split_edge(t, (first(t.map), 0))
    dart = next((int(c), k) for c in split.cells for k in range(t.map.shape(int(c)).dart_count)
                if t.map.origin((int(c), k)) == split.vertex)
    dc.topology.merge_edges(t, dart)


def replace_with_point(t: dc.topology.Transaction) -> None:
    c = first(t.map)
    draft = dc.topology.draft_of(t.map, c)
    draft.point = t.add_vertex(0, 7)
    t.replace([c], [draft])


def to_savepoint(t: dc.topology.Transaction) -> None:
    point = t.savepoint()
    dc.topology.remove(t, first(t.map))
    t.roll_back(point)
    dc.topology.remove(t, first(t.map))
    t.roll_back()


def of_transactions() -> Calls:
    m, cube, square = (dc.topology.CombinatorialMap(mesh) for mesh in
                       (box(2), box(1), dc.generate_rectangle(cells=[2, 2], size=[1.0, 1.0])))
    marked = dc.topology.Transaction(dc.topology.CombinatorialMap(box(2)))
    dc.topology.split_edge(marked, (first(marked.map), 0))

    def undone(edit: Callable[[dc.topology.Transaction], object], on: dc.topology.CombinatorialMap = m) -> Callable[[], None]:
        def call() -> None:
            with dc.topology.Transaction(on) as t:
                edit(t)
        return call

    def refused_in(edit: Callable[[dc.topology.Transaction], object]) -> Callable[[], None]:
        return undone(lambda t: refused(lambda: edit(t))())

    def commit() -> None:
        with dc.topology.Transaction(copy.copy(m)) as t:
            dc.topology.split_edge(t, (first(t.map), 0))
            t.commit()

    def mark() -> None:
        for free in (False, True):
            with dc.topology.Transaction(m) as t:
                t.set_free(first(t.map), free)
                t.commit()

    def open_wall(t: dc.topology.Transaction) -> None:
        dc.topology.unsew(t, inner_face(t.map))

    def close_and_open(t: dc.topology.Transaction) -> None:
        dc.topology.set_walls(t, [inner_face(t.map)], 0)
        walls = dc.topology.inner_walls(t.map)
        assert len(walls) == 2
        dc.topology.remove_walls(t, walls)

    return {
        "Transaction": lambda: dc.topology.Transaction(m),
        "Transaction: refused": undone(lambda t: refused(lambda: dc.topology.Transaction(m))()),
        "Transaction: in C++": undone(lambda t: [t.added(), t.removed(), t.marked(), t.merged()]),
        "Transaction.add_vertex": undone(replace_with_point), "Transaction.replace": undone(replace_with_point),
        "Transaction.add_vertex: refused": refused_in(lambda t: t.add_vertex(0, 4000000)),
        "Transaction.replace: refused": refused_in(lambda t: t.replace([first(t.map)], [dc.topology.CellDraft()])),
        "Transaction.set_free": undone(lambda t: t.set_free(first(t.map), False)), "Transaction.set_free: commit": mark,
        "Transaction.note_merged": undone(lambda t: t.note_merged(t.add_vertex(0, 1), 0)),
        "Transaction.savepoint": undone(to_savepoint), "Transaction.roll_back": undone(to_savepoint),
        "Transaction.commit": commit, "Transaction.added": marked.added, "Transaction.removed": marked.removed,
        "Transaction.marked": marked.marked, "Transaction.merged": marked.merged,
        "Transaction.created": lambda: marked.created(0),
        "Transaction.created: refused": refused(lambda: marked.created(9)),
        "Transaction.__enter__": undone(lambda t: None), "Transaction.__exit__": undone(lambda t: None),
        "Transaction.__exit__: raised": refused(undone(lambda t: {}["no key"])),
        "split_edge": undone(lambda t: dc.topology.split_edge(t, (first(t.map), 0))),
        "split_edge: refused": refused_in(lambda t: dc.topology.split_edge(t, (first(t.map), 60))),
        "split_face": undone(split_quad), "split_face: polygon": undone(lambda t: dc.topology.split_face(
            t, (first(t.map), 0), (first(t.map), 2)), square),
        "split_cell": undone(split_hexahedron, cube), "split_cell: refused": refused_in(lambda t: dc.topology.split_cell(t, [])),
        "merge_cells": undone(merge_prisms, cube),
        "merge_cells: refused": refused_in(lambda t: dc.topology.merge_cells(t, outer_face(t.map))),
        "merge_faces": undone(lambda t: dc.topology.merge_faces(t, (first(t.map), 0)), cube),
        "merge_edges": undone(merge_split_edge),
        "merge_edges: refused": refused_in(lambda t: dc.topology.merge_edges(t, (first(t.map), 0))),
        "sew: refused": refused_in(lambda t: dc.topology.sew(t, (first(t.map), 0), (first(t.map), 1))),
        "unsew": undone(open_wall), "unsew: refused": refused_in(lambda t: dc.topology.unsew(t, outer_face(t.map))),
        "set_walls": undone(lambda t: dc.topology.set_walls(t, [inner_face(t.map)], 0)),
        "set_walls: refused": refused_in(lambda t: dc.topology.set_walls(t, [outer_face(t.map)], 0)),
        "inner_walls": lambda: dc.topology.inner_walls(m),
        "remove_walls": undone(close_and_open),
        "remove_walls: refused": refused_in(lambda t: dc.topology.remove_walls(t, [inner_face(t.map)])),
        "remove": undone(lambda t: dc.topology.remove(t, first(t.map))),
        "remove: refused": refused_in(lambda t: dc.topology.remove(t, 7)),
    }


def of_complexes() -> Calls:
    mesh, c = box(2), complex_of()
    simplex = (first(c.map), 0)
    rest, later = c.positions.copy(), c.positions * 2.0
    moving = complex_of()

    def see_walls() -> None:
        walls = dc.topology.wall_triangles(c)
        assert len(walls.triangles) == len(walls.faces) > 0
        assert walls.points(c.positions).shape == (len(walls.vertices), 3)

    table: Calls = {}
    for name in ("vertices", "corners", "previous_corners"):
        table[f"CellComplex.{name}"] = lambda f=getattr(c, name): f(simplex)
        table[f"CellComplex.{name}: refused"] = refused(lambda f=getattr(c, name): f((simplex[0], 60)))
    return table | {
        "CellComplex": lambda: dc.topology.CellComplex(mesh, threads=1),
        "wall_triangles": see_walls,
        "WallTriangles.points: refused": refused(lambda: dc.topology.wall_triangles(c).points(np.zeros((2, 3)))),
        "CellComplex: refused": refused(lambda: dc.topology.CellComplex(dc.MeshData())),
        "CellComplex.move": lambda: (moving.move(later), moving.move(rest)),
        "CellComplex.move: refused": refused(lambda: moving.move(rest[1:])),
        "CellComplex.before_move": c.before_move, "CellComplex.__copy__": lambda: copy.copy(c),
        "CellComplex.__deepcopy__": lambda: copy.deepcopy(c),
        "to_mesh": lambda: dc.topology.to_mesh(c), "to_mesh: vertices": lambda: dc.topology.to_mesh(c, with_vertices=True),
        "raised": lambda: dc.topology.raised([[1, 2, 9], [3, 4, 9], [5, 7, 9], [0, 0, 0]]),
    }


def of_validity() -> Calls:
    c = complex_of()
    before, after = c.positions.copy(), c.positions.copy()
    after[13] = [0.5, 0.5, 2.0]
    bad = complex_of()
    bad.move(after)
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.25, 0.25, 1]], dtype=float)
    flat = corners * [1.0, 1.0, -3.0]
    return {
        "check_cell": lambda: dc.predicates.check_cell(c.map, after, first(c.map)),
        "check_cell: refused": refused(lambda: dc.predicates.check_cell(c.map, after, 12)),
        "check_validity": lambda: dc.predicates.check_validity(c, threads=1),
        "check_validity: invalid": lambda: dc.predicates.check_validity(bad, threads=1),
        "check_validity: positions": lambda: dc.predicates.check_validity(c.map, after, threads=1),
        "check_validity: refused": refused(lambda: dc.predicates.check_validity(c.map, after[1:], threads=1)),
        "find_inversion": lambda: dc.predicates.find_inversion(corners, flat),
        "find_inversion: refused": refused(lambda: dc.predicates.find_inversion(corners, flat, -1.0)),
        "first_inversion": lambda: dc.predicates.first_inversion(bad, threads=1),
        "first_inversion: none": lambda: dc.predicates.first_inversion(c, threads=1),
        "first_inversion: positions": lambda: dc.predicates.first_inversion(c.map, before, after, threads=1),
        "first_inversion: refused": refused(lambda: dc.predicates.first_inversion(c.map, before, after[1:], threads=1)),
        "move_towards": lambda: dc.predicates.move_towards(c, before, after, 0.1, threads=1),
        "move_towards: refused": refused(lambda: dc.predicates.move_towards(c, before, after, 2.0, threads=1)),
    }


def calls() -> Calls:
    return (of_predicates() | of_shapes() | of_maps() | of_orbits() | of_transactions() | of_complexes()
            | of_validity())
