"""Solids: no edge and no triangle crosses a wall."""
from __future__ import annotations

import numpy as np
import pytest

import dartcast as dc


def with_obstacle() -> dc.Environment:
    """Unit cubes; the one from 2 to 3 along each axis is blocked."""
    mesh = dc.generate_box(cells=[5, 5, 5], size=[5.0, 5.0, 5.0])
    free = np.ones(mesh.cell_count, dtype=np.uint8)
    free[62] = 0
    mesh.free = free
    return dc.Environment(mesh, threads=1)


def test_an_edge_does_not_cut_a_corner() -> None:
    solids = dc.SolidSet(with_obstacle())
    placed = solids.add(dc.solid_of_polyline(np.array([[2.5, 0.5, 1.5], [2.5, 0.5, 3.7]])))
    assert placed.solid == 0 and placed.refusal == dc.records.SolidRefusal.NONE and len(placed.vertices) == 0
    step = solids.advance(np.array([[2.5, 2.1, 1.5], [2.5, 2.1, 3.7]]), dc.SolidStepOptions(rounds=0))
    assert step.cut == 1 and step.made[0] == pytest.approx(15 / 16 * 1.5 / 1.6, abs=1e-5)
    contact = step.contacts[0]
    assert contact["kind"] == dc.records.SolidContactKind.EDGE_EDGE and contact["wall_kind"] == dc.Kind.EDGE
    assert contact["count"] == 2 and list(contact["vertices"][:2]) == [0, 1]
    assert contact["normal"][1] == pytest.approx(-1.0) and contact["wall_point"][1] == pytest.approx(2.0)
    assert contact["weights"].sum() == pytest.approx(1.0)
    assert solids.positions[:, 1].max() < 2.0
    audit = solids.audit()
    assert (audit.checked, audit.failed, audit.first) == (1, 0, "")


def test_a_place_that_is_not_free_is_refused() -> None:
    solids = dc.SolidSet(with_obstacle())
    placed = solids.add(dc.records.SolidMesh(np.array([[0.5, 2.5, 2.5], [1.5, 2.5, 2.5], [3.5, 2.5, 2.5]]),
                                     edges=np.array([[0, 1], [1, 2]])))
    assert placed.refusal == dc.records.SolidRefusal.MEETS_WALL and placed.solid is None and list(placed.vertices) == [1, 2]
    assert len(solids) == solids.size == 0 and solids.stuck == []


def test_walls_that_move_take_a_solid_along() -> None:
    env = with_obstacle()
    solids = dc.SolidSet(env)
    solids.add(dc.solid_of_cells(dc.generate_box(cells=[1, 1, 1], size=[0.4, 0.4, 0.4], origin=[0.5, 0.5, 0.1])))
    floor = env.positions.copy()
    floor[:, 2] += 0.3 * (1.0 - floor[:, 2] / 5.0)
    step = solids.move_with(solids.positions, floor)
    assert step.walls_made == 1.0 and step.corrected == 1 and len(step.contacts) > 0
    assert solids.positions[:, 2].min() > 0.3
    assert np.array_equal(env.positions, floor)
    assert dc.audit(env.complex, solids.particles).failed == 0
    env.move(floor)
    with pytest.raises(dc.InvalidArgument, match="without its solids"):
        solids.advance(solids.positions)


def test_a_surface_keeps_its_triangles() -> None:
    mesh = dc.solid_of_surface(dc.generate_barrel(staves=8, rows=4, rings=2))
    assert mesh.triangles.dtype == np.uint32 and mesh.triangles.shape[1] == 3
    assert mesh.triangles.max() == len(mesh.points) - 1 and mesh.edges.shape == (0, 2)


def test_solids_that_meet_stop_at_each_other() -> None:
    solids = dc.SolidSet(with_obstacle())
    first = solids.add(dc.solid_of_polyline(np.array([[0.5, 0.5, 0.5], [0.5, 1.5, 0.5]])))
    line = np.array([[0.8, 1.0, 0.2], [0.8, 1.0, 0.8]])
    assert solids.add(dc.solid_of_polyline(line), [first.solid]).other is None
    refused = solids.add(dc.solid_of_polyline(line - [0.3, 0.0, 0.0]), [0, 1])
    assert refused.refusal == dc.records.SolidRefusal.MEETS_SOLID and refused.other == 0 and len(refused.vertices) == 2
    step = solids.advance(solids.positions + np.array([[0.6, 0.0, 0.0]] * 2 + [[0.0, 0.0, 0.0]] * 2))
    assert step.made[0] == pytest.approx(15 / 16 * 0.5, abs=1e-5) and step.made[1] == 1.0
    meeting = step.meetings[0]
    assert (meeting["solid"], meeting["other"], meeting["count"]) == (1, 0, 2)
    assert meeting["time_of_impact"] == pytest.approx(0.5, abs=1e-5) and meeting["normal"][0] == pytest.approx(1.0)
    assert meeting["gap"] == pytest.approx(0.3 / 16, abs=1e-5) and solids.audit().failed == 0
