"""Spheres: contacts at their surface, overlaps."""
from __future__ import annotations

import dartcast
import numpy as np
import pytest


def scene(z=0.5):
    env = dartcast.Environment(dartcast.generate_box(cells=[2, 2, 2], size=[1.0, 1.0, 1.0]), threads=1)
    parts, _ = env.add(np.array([[0.3, 0.35, z]]))
    return env, parts


def test_a_sphere_touches_a_wall_with_its_surface():
    env, parts = scene()
    report = dartcast.advance_spheres(env, parts, np.array([0.1]), parts.positions + [[0, 0, 1.0]])
    c = report.step.contacts
    assert np.isclose(c["time_of_impact"][0], 0.4) and np.allclose(c["point"][0], [0.3, 0.35, 1.0])
    assert np.allclose(parts.positions, [[0.3, 0.35, 0.9]]) and len(report.overlaps) == 0


def test_a_radius_of_zero_is_a_point():
    env, parts = scene()
    other = parts.copy()
    targets = parts.positions + [[0.3, 0.1, 1.0]]
    env.advance(parts, targets)
    stepper = dartcast.SphereStepper()
    stepper.advance(env, other, np.zeros(1), targets, clearances=np.zeros(1))
    assert parts.states.tobytes() == other.states.tobytes()


def test_points_and_walls_move_at_the_same_time():
    env, parts = scene()
    x = parts.positions
    env.move(env.positions * [1, 1, 0.5] + [0, 0, 0.5])  # the floor rises to the middle
    velocities = np.array([[0.0, 0.0, -0.1]])
    report = dartcast.SimultaneousStepper().advance(env, parts, x + velocities, dartcast.Reflect(),
                                                    velocities=velocities, dt=1.0)
    time = x[0, 2] / 0.6  # they meet where x - 0.1 t = 0.5 t
    assert np.isclose(report.contacts["time_of_impact"][0], time, atol=1e-5)
    assert np.allclose(velocities, [[0, 0, 1.1]])  # twice the wall's, and its own turned round
    assert np.allclose(parts.positions[0, 2], 0.5 * time + 1.1 * (1 - time), atol=1e-5)


def test_responses_work_as_for_points():
    for respond in (dartcast.Reflect(), lambda c, w, e: c.unused * [1, 1, -1]):
        env, parts = scene()
        named = dict(per_contact=True) if callable(respond) else dict(velocities=np.array([[0, 0, 1.0]]), dt=1.0)
        dartcast.advance_spheres(env, parts, np.array([0.1]), parts.positions + [[0, 0, 0.6]], respond, **named)
        assert np.allclose(parts.positions, [[0.3, 0.35, 0.7]])


def test_an_overlap_is_reported_and_left():
    env, parts = scene(z=0.98)
    report = dartcast.advance_spheres(env, parts, np.array([0.1]), parts.positions)
    o = report.overlaps[0]
    assert np.isclose(o["depth"], 0.08) and abs(o["left"]) < 1e-12 and np.allclose(o["normal"], [0, 0, -1])
    assert np.allclose(parts.positions[0, 2], 0.9)


def test_arguments_that_do_not_fit_are_refused():
    env, parts = scene()
    x = parts.positions
    stepper = dartcast.SphereStepper()
    for radii, named, error in ((np.array([-1.0]), {}, dartcast.InvalidArgument),
                                (np.array([np.nan]), {}, dartcast.InvalidArgument),
                                (np.zeros(2), {}, dartcast.InvalidArgument),
                                (np.zeros(1, dtype=np.complex64), {}, TypeError),
                                (np.zeros(1), dict(clearances=np.zeros(2)), dartcast.InvalidArgument),
                                (np.zeros(1), dict(respond=lambda c, w: None), dartcast.InvalidArgument)):
        with pytest.raises(error):
            stepper.advance(env, parts, radii, x, **named)
    with pytest.raises(TypeError, match="targets"):
        stepper.advance(env, parts, np.zeros(1), x.astype(np.complex64))
    assert np.array_equal(parts.positions, x)
