"""How objects look in terminals and notebooks; sets of particles as sequences, and their pickles."""
from __future__ import annotations

import base64
import copy
import pathlib
import pickle
import re

import dartcast as dc
import numpy as np
import pytest

from calls import classes, is_record


def simulation() -> dc.Simulation:
    made = dc.Simulation(dc.Environment(dc.generate_bar()), dc.SimulationOptions(dt=0.1, response=dc.Reflect(0.5)))
    made.add_random(1500, [3.0, 2.0, 1.0])
    for _ in range(5):
        made.step()
    return made


def picture_of(html: str) -> bytes:
    return base64.b64decode(re.search(r"base64,([^']+)", html)[1])


def test_lines_and_tables_have_the_figures(tmp_path: pathlib.Path) -> None:
    made = simulation()
    step = made.step()
    environment, report = made.environment, step.report
    cells = environment.map.cell_count()
    assert repr(environment) == f"<dartcast.Environment: {cells:,} cells, {environment.map.vertex_count:,} vertices>"
    assert repr(made.particles) == "<dartcast.Particles: 1,500 particles>"
    assert repr(made) == "<dartcast.Simulation: 6 steps, 0.6 s, 1,500 particles>"
    assert repr(report) == f"<dartcast.StepReport: {len(report.contacts)} contacts, 0 stopped, 0 held>"
    for one in (environment, made.particles, made, report):
        html = one._repr_html_()
        assert html.startswith("<table>") and "\n" not in repr(one)
        assert set(re.findall(r"\d[\d,.]*", repr(one))) <= set(re.findall(r"\d[\d,.]*", html))
    assert f"<td style='text-align:right'>{environment.map.wall_face_count():,}</td>" in environment._repr_html_()
    assert picture_of(made._repr_html_()).startswith(b"\x89PNG")


def test_a_summary_shows_the_run(tmp_path: pathlib.Path) -> None:
    scene = {"environment": {"generator": "bar"}, "particles": [{"count": 40, "velocity": [1.0, 0.0, 0.0]}],
             "motion": {"dt": 0.1, "steps": 20}}
    summary = dc.run(scene, tmp_path / "<bar>")
    assert repr(summary) == "<dartcast.Summary: 20 steps, 40 particles, 0 escaped, 0 absorbed, 0 lost>"
    html = summary._repr_html_()
    assert summary.state_hash in html and "&lt;bar&gt;" in html and "<bar>" not in html
    assert picture_of(html) == picture_of(dc.read_run(tmp_path / "<bar>")._repr_html_())
    assert repr(dc.read_run(tmp_path / "<bar>")) == "<dartcast.Run: 3 frames, 20 steps>"
    assert "<img" not in dc.run(scene)._repr_html_() and "<img" not in dc.formats.Summary()._repr_html_()


def test_an_object_in_use_says_so() -> None:
    environment = dc.Environment(dc.generate_bar())
    particles = environment.add_random(50, seed=3)
    seen = []

    def respond(contacts: np.ndarray, walls: np.ndarray) -> None:
        seen.append((repr(environment), environment._repr_html_(), repr(particles)))

    environment.advance(particles, particles.positions + [9.0, 0.0, 0.0], respond)
    text = "<dartcast.Environment: in use by a call in another thread>"
    assert seen[0] == (text, f"<pre>{text.replace('<', '&lt;').replace('>', '&gt;')}</pre>",
                       text.replace("Environment", "Particles"))


def test_a_set_of_particles_is_a_sequence() -> None:
    particles = dc.Environment(dc.generate_bar()).add_random(20, seed=5)
    x = particles.positions
    assert np.array_equal(particles[-1].position, x[19]) and np.array_equal(particles[-20].position, x[0])
    assert np.array_equal([state.position for state in particles], x)
    for index in (slice(2, 7), slice(None, None, -3), slice(50, 60), [3, 1, -1], np.array([4, 4]), np.arange(20) % 3 == 0, []):
        chosen = particles[index]
        assert isinstance(chosen, dc.Particles)
        assert np.array_equal(chosen.positions, x[np.array(index, dtype=int)] if isinstance(index, list) else x[index])
    for wrong in (20, -21, [20], np.arange(19) > 3):
        with pytest.raises(IndexError):
            particles[wrong]
    for wrong in (1.0, "a", None):
        with pytest.raises(TypeError):
            particles[wrong]


def test_particles_from_a_pickle_are_the_same_and_move_as_the_same() -> None:
    environment = dc.Environment(dc.generate_bar())
    particles = environment.add_random(100, seed=5)
    environment.advance(particles, particles.positions + [0.7, 0.3, 2.0])
    for again in (pickle.loads(pickle.dumps(particles)), copy.copy(pickle.loads(pickle.dumps(particles)))):
        assert np.array_equal(again.states, particles.states)
        assert np.array_equal(again.held_weights(), particles.held_weights())
        assert (again.vertex_numbers == dc.NONE).all() and again.vertex_numbers.shape == (100, 4)
        with pytest.raises(dc.InvalidArgument, match="of another environment"):
            environment.advance(again, again.positions)
        kept = again[::2]
        kept.remove(np.arange(50) < 10)
        kept.reorder(np.arange(40)[::-1].copy())
        assert np.array_equal(kept.positions, particles.positions[20::2][::-1])
    restored = environment.restored(again.states, again.held_weights())
    target = particles.positions + [-0.5, 0.2, 1.0]
    first, second = environment.advance(particles, target), environment.advance(restored, target)
    assert np.array_equal(particles.states, restored.states) and np.array_equal(first.contacts, second.contacts)
    assert len(pickle.loads(pickle.dumps(dc.Particles()))) == 0


def test_reports_from_a_pickle_are_the_same() -> None:
    environment = dc.Environment(dc.generate_bar())
    particles = environment.add_random(100, seed=5)
    report = environment.advance(particles, particles.positions + [0.7, 0.3, 9.0])
    again = pickle.loads(pickle.dumps(report))
    assert len(report.contacts) > 0 and again.counters == report.counters
    for rows in ("contacts", "walls", "held", "stopped"):
        assert np.array_equal(getattr(again, rows), getattr(report, rows))
    solid = dc.records.SolidMesh([[0, 0, 0], [1, 0, 0]], edges=[[0, 1]])
    for mesh in (pickle.loads(pickle.dumps(solid)), pickle.loads(pickle.dumps(dc.BodyOptions(surface=solid))).surface):
        assert np.array_equal(mesh.points, solid.points) and np.array_equal(mesh.edges, solid.edges)
    with pytest.raises(dc.InvalidArgument, match="of another version"):
        type(report).__new__(type(report)).__setstate__((b"", b"1", b"", b"", b""))


def test_all_records_can_be_pickled() -> None:
    for name, cls in classes().items():
        if is_record(cls):
            assert type(pickle.loads(pickle.dumps(cls()))) is cls, name


def test_states_without_their_weights_are_refused() -> None:
    states = dc.Environment(dc.generate_bar()).add_random(5, seed=5).states
    with pytest.raises(TypeError, match="weights: expected float64 .n, 4."):
        dc.Particles(states, np.zeros((4, 4)))
    with pytest.raises(TypeError, match="states: expected an array as Particles.states"):
        dc.Particles(np.zeros(3))
