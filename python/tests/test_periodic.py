"""Periodic pairs: crossings of particles, images of a simulation, and refusals."""
from __future__ import annotations

import dartcast as dc
import numpy as np
import pytest


def box(**pairs: list[float]) -> dc.MeshData:
    """Cubes of edge 1, 4 x 2 x 2. `pairs`: for each side that leads to the opposite one, the way there."""
    mesh = dc.generate_box(dc.formats.BoxOptions(cells=[4, 2, 2]))
    other = {"max": "min", "min": "max"}
    mesh.periodic = [dc.formats.PeriodicPair(a=a, b=a[0] + other[a[1:]], translate=way) for a, way in pairs.items()]
    return mesh


def test_a_particle_crosses_to_the_other_side() -> None:
    environment = dc.Environment(box(xmax=[-4.0, 0.0, 0.0]))
    particles, _ = environment.add(np.array([[3.5, 0.5, 0.5], [0.5, 0.5, 0.5]]))
    report = environment.advance(particles, np.array([[8.25, 1.5, 1.5], [-0.25, 0.5, 0.5]]))
    assert np.array_equal(particles.positions, [[0.25, 1.5, 1.5], [3.75, 0.5, 0.5]])
    assert not len(report.contacts) and not len(report.stopped)
    crossings = report.crossings
    assert crossings["particle"].tolist() == [0, 0, 1] and crossings["back"].tolist() == [False, False, True]
    assert crossings["time"] == pytest.approx([0.5 / 4.75, 4.5 / 4.75, 2.0 / 3.0])
    assert crossings["point"][:, 0].tolist() == [0.0, 0.0, 4.0]
    assert np.array_equal(crossings["turn"][0], np.eye(3))


def test_a_simulation_counts_images() -> None:
    environment = dc.Environment(box(xmax=[-4.0, 0.0, 0.0], ymin=[0.0, 2.0, 0.0]))
    options = dc.SimulationOptions(dt=0.5, user_data=["image_xmax", "image_ymin"])
    simulation = dc.Simulation(environment, options)
    simulation.add(np.array([[0.5, 0.5, 0.5]]), np.array([3.0, -1.0, 0.0]))
    for _ in range(8):
        simulation.step()
    assert np.allclose(simulation.unwrapped(), [[12.5, -3.5, 0.5]])
    assert simulation.user_data(0).tolist() == [3.0, 2.0]


def test_what_is_no_pair_is_refused() -> None:
    with pytest.raises(dc.InvalidMesh, match='periodic pair "xmax", "xmin": the corner at'):
        dc.Environment(box(xmax=[-3.0, 0.0, 0.0]))
    environment = dc.Environment(box(xmax=[-4.0, 0.0, 0.0]))
    points = environment.positions.copy()
    points[0, 1] -= 0.5
    with pytest.raises(dc.InvalidArgument, match="comes 0.5 off its partner"):
        environment.move(points)
