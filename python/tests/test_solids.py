"""Bodies, catheters and surfaces: conserved quantities, exact containment, places."""
from __future__ import annotations

import dartcast
import numpy as np
import pytest


def test_a_body_falls_freely() -> None:
    environment = dartcast.Environment(dartcast.generate_box(cells=[4, 4, 4], size=[4.0, 4.0, 4.0]))
    bodies = dartcast.Bodies(environment, dartcast.BodiesOptions(dt=1e-2, gravity=[0.0, 0.0, -10.0]))
    points = np.array([[2.0, 2.0, 3.0], [2.2, 2.0, 3.0], [2.0, 2.2, 3.0], [2.0, 2.0, 3.2]])
    assert bodies.add(points, dartcast.BodyOptions(mass=2.0)).body == 0
    for _ in range(20):
        bodies.step()
    fallen = points.mean(axis=0)[2] - bodies.positions.mean(axis=0)[2]
    assert fallen == pytest.approx(0.5 * 10.0 * 0.2**2, rel=1e-6)


def test_samples_of_a_solid_are_inside() -> None:
    barrel = dartcast.generate_barrel()
    samples = dartcast.sample_solid(barrel, dartcast.SamplingOptions(spacing=0.1))
    radius = np.hypot(samples.points[:, 0], samples.points[:, 1])
    assert radius.max() < 0.25 + 1e-9 and samples.on_surface > 10


def test_a_catheter_stays_in_the_lumen() -> None:
    environment = dartcast.Environment(dartcast.generate_vessel())
    catheter = dartcast.Catheter(environment, dartcast.CatheterOptions(
        length=0.03, spacing=1e-3, entry=[0.0, -0.006376, -0.026761], direction=[0.0, 0.472, 0.882]))
    for _ in range(20):
        catheter.step(dartcast.CatheterInput(push=5e-4))
    points = catheter.points()
    assert catheter.inserted == pytest.approx(0.01, rel=0.05)
    assert (environment.locate(points)["place"] == dartcast.Place.FREE).all()


def test_places_on_a_surface_keep_their_length() -> None:
    surface = dartcast.Surface(dartcast.generate_barrel())
    locator = dartcast.SurfaceLocator(surface)
    found = locator.nearest(surface, [0.3, 0.01, 0.02])
    assert found.distance == pytest.approx(0.05, abs=0.01)
    assert surface.contains(found.place)


def test_stale_handles_raise() -> None:
    surface = dartcast.Surface(dartcast.generate_barrel())
    with pytest.raises((dartcast.InvalidArgument, IndexError)):
        surface.corners((0xFFFFFF0, 0))
