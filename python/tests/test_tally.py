"""Tallies by cell from Python."""
import gc

import numpy as np
import pytest

import dartcast


def box(n):
    return dartcast.Environment(dartcast.generate_box(cells=[n, n, n], size=[1.0, 1.0, 1.0]), threads=1)


def test_a_tally_adds_up_to_the_paths():
    env = box(3)
    x = np.random.default_rng(4).uniform(0.1, 0.9, (200, 3))
    particles = dartcast.Particles()
    env.add(particles, x)
    tally = dartcast.CellTally(env)
    env.set_tally(tally)
    velocities = np.random.default_rng(5).normal(size=(200, 3))
    env.advance(particles, x + 0.4 * velocities, respond=dartcast.Reflect(1.0), velocities=velocities, dt=0.4)
    assert tally.adds_up() and tally.age() == 200
    assert np.isclose(tally.track_length().sum(), tally.path_length(), rtol=1e-12)
    assert np.isclose(tally.residence().sum(), 200, rtol=1e-12)
    assert len(tally.visits()) == 27 and tally.visits().sum() > 0 and tally.deposited().sum() == 0
    env.set_tally(None)
    before = tally.path_length()
    env.advance(particles, particles.positions)
    assert tally.path_length() == before
    with pytest.raises(ValueError, match="another environment"):
        box(3).set_tally(tally)


def test_a_tally_may_go_before_its_environment():
    env = box(3)
    particles = dartcast.Particles()
    env.add(particles, [[0.5, 0.5, 0.5]])
    env.set_tally(dartcast.CellTally(env))
    gc.collect()
    env.advance(particles, [[0.9, 0.5, 0.5]])


def test_a_tally_that_has_missed_an_edit_is_not_read():
    with pytest.raises(TypeError):
        dartcast.CellTally(None)
    env = box(2)
    tally = dartcast.CellTally(env)
    env.edit(lambda edit: dartcast.topology.subdivide(edit, next(iter(edit.map.cells()))))
    for call in (tally.visits, tally.track_length, lambda: tally.deposit(next(iter(env.map.cells())))):
        with pytest.raises(dartcast.InvalidArgument, match="missed an edit"):
            call()
    tally.update_after_edit()
    assert len(tally.visits()) == env.map.cell_count()


def test_rays_have_lengths():
    env = box(3)
    x = np.random.default_rng(2).uniform(0.1, 0.9, (50, 3))
    d = np.random.default_rng(3).normal(size=(50, 3))
    hits, cells, first, lengths = env.cast_rays(x, d, lengths=True)
    assert len(lengths) == len(cells)
    assert np.allclose(np.add.reduceat(lengths, first[:-1].astype(int)), hits["distance"], rtol=1e-12)
    with pytest.raises(ValueError, match="lengths"):
        env.cast_rays(x, d, lengths=False)


def test_a_simulation_has_arrays_of_cells():
    env = box(3)
    simulation = dartcast.Simulation(env, dartcast.SimulationOptions(dt=0.1))
    simulation.set_statistics(dartcast.StatisticsOptions(cells=dartcast.records.cell_quantities()))
    simulation.add_random(100, [1.0, 0.2, 0.0])
    for _ in range(5):
        simulation.step()
    arrays = simulation.cell_arrays()
    assert list(arrays) == dartcast.records.cell_quantities()
    assert np.isclose(arrays["residence"].sum(), 100 * 0.5)
    assert np.isclose((arrays["concentration"] / 27).sum(), 100)
    with pytest.raises(ValueError, match="did you mean"):
        simulation.set_statistics(dartcast.StatisticsOptions(cells=["track_lenght"]))
