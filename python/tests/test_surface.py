"""Particles on surfaces: paths and contacts with a known geometry, edits that they follow, and refusals."""
from __future__ import annotations

import dartcast
import numpy as np
import pytest


def sheet(columns: int = 3) -> dartcast.topology.Surface:
    """Unit squares in a row along x, at z = 0. The normals point to +z."""
    x, y = np.meshgrid(np.arange(columns + 1.0), [0.0, 1.0])
    points = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    up = columns + 1
    quads = np.array([[i, i + 1, i + 1 + up, i + up] for i in range(columns)])
    return dartcast.topology.Surface(dartcast.MeshData(points, {"quad": quads}))


def fold() -> dartcast.topology.Surface:
    """Two squares with the edge x = 1 in common: one lies in the plane z = 0, the other stands upright."""
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [1, 0, 1], [1, 1, 1]], dtype=float)
    return dartcast.topology.Surface(dartcast.MeshData(points, {"quad": np.array([[0, 1, 2, 3], [1, 4, 5, 2]])}))


def at(surface: dartcast.topology.Surface, x: list[float]) -> dartcast.topology.SurfacePlace:
    return dartcast.topology.SurfaceLocator(surface).nearest(surface, x).place


def test_a_flat_path_is_straight() -> None:
    surface = sheet()
    place, trace = at(surface, [0.25, 0.5, 0.0]), dartcast.topology.SurfaceTrace()
    step = dartcast.step(surface, place, [2.5, 0.125, 0.0], trace=trace)
    assert step.end == dartcast.topology.SurfaceEnd.ARRIVED and step.length == pytest.approx(np.hypot(2.5, 0.125))
    assert np.allclose(surface.point(place), [2.75, 0.625, 0.0])
    assert not trace.contacts and len(trace.crossings) == step.crossings
    borders = [c for c in trace.crossings if c.dart is not None]  # without the diagonals of the squares
    assert [c.point[0] for c in borders] == pytest.approx([1.0, 2.0])
    assert [c.time for c in borders] == pytest.approx([0.3, 0.7])
    assert all(c.kind == dartcast.Kind.EDGE for c in borders)


def test_a_path_goes_on_straight_over_a_fold() -> None:
    surface = fold()
    place = at(surface, [0.5, 0.25, 0.0])
    step = dartcast.step(surface, place, [1.0, 0.5, 0.0])
    assert step.end == dartcast.topology.SurfaceEnd.ARRIVED
    assert np.allclose(surface.point(place), [1.0, 0.75, 0.5])
    assert np.allclose(step.direction, np.array([0.0, 0.5, 1.0]) / np.hypot(1.0, 0.5))


def test_a_contact_at_the_border_has_time_point_and_sides() -> None:
    surface, trace = sheet(1), dartcast.topology.SurfaceTrace()
    place = at(surface, [0.25, 0.5, 0.0])
    step = dartcast.step(surface, place, [1.5, 0.25, 0.0], trace=trace)
    contact, = trace.contacts
    assert step.end == dartcast.topology.SurfaceEnd.STOPPED and contact.kind == dartcast.Kind.EDGE
    assert contact.time_of_impact == pytest.approx(0.5)
    assert np.allclose(contact.point, [1.0, 0.625, 0.0]) and np.allclose(contact.unused, [0.75, 0.125, 0.0])
    assert np.allclose(contact.normal, [-1.0, 0.0, 0.0])
    assert np.allclose(contact.sides, [[0.0, 1.0, 0.0], [0.0, -1.0, 0.0]])


@pytest.mark.parametrize("respond, end", [(lambda c: dartcast.reflected(c, c.unused), [0.5, 0.625, 0.0]),
                                          (lambda c: dartcast.reflected(c, c.unused, 0.5), [0.75, 0.625, 0.0]),
                                          (lambda c: dartcast.slid(c, c.unused), [1.0, 0.625, 0.0]),
                                          (lambda c: None, [1.0, 0.5625, 0.0])])
def test_responses_have_their_known_end(respond: object, end: list[float]) -> None:
    """From x = 0.25 by (1.25, 0.125): the border is met after 0.75, so (0.5, 0.05) is left."""
    surface = sheet(1)
    place = at(surface, [0.5, 0.5, 0.0])
    dartcast.step(surface, place, [1.0, 0.125, 0.0], respond)
    assert np.allclose(surface.point(place), end)


def test_many_places_step_as_one_by_one() -> None:
    surface = dartcast.topology.Surface(dartcast.generate_barrel(staves=8, rows=4, rings=2))
    random = np.random.default_rng(7)
    starts = dartcast.topology.SurfaceLocator(surface).nearest(surface, random.normal(0.0, 0.3, (40, 3)))[0]
    ways = random.normal(0.0, 0.2, (40, 3))
    many = starts.copy()
    report = dartcast.advance(surface, many, ways)
    for i in range(40):
        place = dartcast.topology.SurfacePlace((int(starts["cell"][i]), int(starts["simplex"][i])), starts["weights"][i])
        step = dartcast.step(surface, place, ways[i], particle=i)
        assert step.length == report.steps["length"][i]
        assert np.array_equal(surface.point(place), surface.point(many[i:i + 1])[0])
    assert np.allclose(report.steps["length"], np.linalg.norm(ways, axis=1), rtol=1.0)
    assert surface.contains(many).all()


def test_a_move_carries_places_along() -> None:
    surface = fold()
    place = at(surface, [0.25, 0.75, 0.0])
    moved = surface.positions * [2.0, 3.0, 4.0] + [1.0, 0.0, 0.0]
    surface.move(moved)
    assert np.array_equal(surface.positions, moved) and np.allclose(surface.point(place), [1.5, 2.25, 0.0])


def test_the_other_side_of_an_edge() -> None:
    surface = fold()
    walls = found = 0
    for t in surface.triangles():
        for edge in range(3):
            across = surface.across(t, edge)
            walls += across.wall
            if across.triangle is not None:
                back = surface.across(across.triangle, across.edge)
                assert back.triangle == tuple(t) and back.edge == edge
                found += 1
    assert walls == 6 and found == 6  # six open edges; the fold and two diagonals, each seen from both sides


def test_a_blocked_face_is_a_wall_and_holds() -> None:
    surface = sheet()
    place, inside = at(surface, [0.5, 0.5, 0.0]), at(surface, [1.5, 0.5, 0.0])
    assert inside.triangle is not None
    surface.set_free(inside.triangle.cell, False)
    assert dartcast.step(surface, place, [1.0, 0.0, 0.0]).end == dartcast.topology.SurfaceEnd.STOPPED
    assert surface.point(place)[0] == pytest.approx(1.0)
    assert dartcast.step(surface, inside, [0.1, 0.0, 0.0]).end == dartcast.topology.SurfaceEnd.HELD


def test_a_limit_ends_a_step() -> None:
    surface = sheet()
    step = dartcast.step(surface, at(surface, [0.5, 0.25, 0.0]), [2.0, 0.0, 0.0],
                         options=dartcast.topology.SurfaceOptions(max_crossings=2))
    assert step.end == dartcast.topology.SurfaceEnd.LIMIT and step.crossings == 2 and step.remaining[0] > 0.5


def test_places_follow_an_edit() -> None:
    surface = sheet()
    xs = np.array([[0.25, 0.75, 0.0], [1.25, 0.75, 0.0], [2.5, 0.5, 0.0], [0.5, 0.5, 0.0]])
    places = dartcast.topology.SurfaceLocator(surface).nearest(surface, xs)[0]
    cell = int(places["cell"][0])
    with dartcast.topology.SurfaceEdit(surface) as edit:
        middle = dartcast.topology.split_edge(edit.topology, (cell, 0))
        assert np.isclose(edit.position(middle.vertex)[2], 0.0)
        a = next(dartcast.topology.Dart(middle.cells[0], k) for k in range(5)
                 if edit.map.origin((middle.cells[0], k)) == middle.vertex)
        opposite = edit.map.phi1(edit.map.phi1(a))
        assert len(dartcast.topology.split_face(edit.topology, a, opposite)) == 2
        report = edit.commit()
    assert report.gone and {g.source for g in report.gone} == {0}
    for i, x in enumerate(xs):
        old = dartcast.topology.SurfacePlace((int(places["cell"][i]), int(places["simplex"][i])), places["weights"][i])
        new = dartcast.topology.followed(surface, report, old)
        assert new is not None and np.allclose(surface.point(new), x)
    assert len(surface.positions) == 9


def test_places_of_a_removed_face_are_gone() -> None:
    surface = sheet()
    place, other = at(surface, [0.5, 0.5, 0.0]), at(surface, [2.5, 0.5, 0.0])
    assert place.triangle is not None
    with dartcast.topology.SurfaceEdit(surface) as edit:
        dartcast.topology.remove(edit.topology, place.triangle.cell)
        report = edit.commit()
    assert dartcast.topology.followed(surface, report, place) is None
    assert dartcast.topology.followed(surface, report, other) == other


def test_an_edit_without_a_commit_changes_nothing() -> None:
    surface = sheet()
    before, cells = surface.positions.copy(), surface.map.cells().tolist()
    with dartcast.topology.SurfaceEdit(surface) as edit:
        dartcast.topology.split_edge(edit.topology, (cells[0], 0))
    with pytest.raises(KeyError, match="mine"), dartcast.topology.SurfaceEdit(surface) as edit:
        dartcast.topology.split_edge(edit.topology, (cells[0], 0))
        raise KeyError("mine")
    assert np.array_equal(surface.positions, before) and surface.map.cells().tolist() == cells


def test_an_open_edit_locks_the_surface() -> None:
    surface = sheet()
    with dartcast.topology.SurfaceEdit(surface):
        with pytest.raises(dartcast.Error):
            surface.move(surface.positions.copy())
        with pytest.raises(dartcast.Error):
            dartcast.topology.SurfaceEdit(surface)
    surface.move(surface.positions.copy())


def test_an_exception_in_a_response_leaves_the_places() -> None:
    surface = sheet(1)
    places = dartcast.topology.surface_places([at(surface, [0.5, 0.5, 0.0])] * 3)
    saved = places.copy()

    def respond(contact: dartcast.topology.SurfaceContact) -> None:
        raise ArithmeticError("from the response")

    with pytest.raises(ArithmeticError, match="from the response"):
        dartcast.advance(surface, places, np.full((3, 3), [1.0, 0.0, 0.0]), respond)
    assert np.array_equal(places, saved)


def test_what_does_not_fit_is_refused() -> None:
    surface = sheet()
    place = at(surface, [0.5, 0.5, 0.0])
    t = place.triangle
    assert t is not None
    with pytest.raises(dartcast.InvalidMesh):
        dartcast.topology.Surface(dartcast.MeshData(np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]]),
                                           {"triangle": np.array([[0, 1, 2]])}))
    with pytest.raises(dartcast.InvalidMesh):  # a face without area: nothing is moved
        surface.move(surface.positions * [0.0, 1.0, 1.0])
    assert surface.point(place)[0] == pytest.approx(0.5)
    with pytest.raises(dartcast.InvalidArgument):
        surface.move(surface.positions[1:].copy())
    with pytest.raises(dartcast.InvalidArgument):
        surface.set_free(10**6, False)
    with pytest.raises(dartcast.InvalidArgument):
        surface.across(t, 3)
    with pytest.raises(dartcast.InvalidArgument):
        dartcast.step(surface, place, [np.nan, 0.0, 0.0])
    with pytest.raises(dartcast.InvalidArgument):
        dartcast.step(surface, dartcast.topology.SurfacePlace(t, [0.9, 0.9, 0.9]), [0.1, 0.0, 0.0])
    with pytest.raises(dartcast.InvalidArgument):
        dartcast.step(surface, place, [0.1, 0.0, 0.0], options=dartcast.topology.SurfaceOptions(max_contacts=0))
    locator = dartcast.topology.SurfaceLocator(surface)
    surface.move(surface.positions + [0.0, 0.0, 1.0])
    with pytest.raises(dartcast.InvalidArgument):
        locator.nearest(surface, np.zeros((2, 3)))


def test_tangents_turn_around_a_corner() -> None:
    surface = sheet(1)
    t = surface.triangles()[0]
    a, b, c = surface.corners(t)
    assert np.allclose(dartcast.topology.tangent(surface, t, 0, 0.0, np.linalg.norm(b - a)), b - a)
    turned = dartcast.topology.tangent(surface, t, 0, np.pi / 2)
    assert np.dot(turned, b - a) == pytest.approx(0.0, abs=1e-12) and np.dot(turned, c - a) > 0.0
