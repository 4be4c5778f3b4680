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


def test_classes_and_amounts_are_kept_apart():
    env = box(3)
    x = np.random.default_rng(4).uniform(0.1, 0.9, (60, 3))
    particles = dartcast.Particles()
    env.add(particles, x)
    tally = dartcast.CellTally(env, classes=2, amounts=2)
    assert (tally.classes, tally.amounts) == (2, 2)
    of_class = np.arange(60) % 2
    amounts = np.column_stack([np.ones(60), np.linspace(-1e-9, 2e-9, 60)])
    env.set_tally(tally, classes=of_class, amounts=amounts.ravel())
    env.advance(particles, np.clip(x + 0.3, 0.05, 0.95))
    assert tally.adds_up() and np.isclose(tally.whole_amount(1), amounts[:, 1].sum(), rtol=1e-14)
    for k in (0, 1):
        assert np.allclose(tally.amount(0, k), tally.residence(k), rtol=1e-12)
        assert np.isclose(tally.amount(1, k).sum(), amounts[of_class == k, 1].sum(), rtol=1e-12)
    assert np.array_equal(tally.visits(), tally.visits(0) + tally.visits(1))
    env.set_tally(tally, amounts=[1.0])
    with pytest.raises(ValueError, match="1 amounts for 60 particles"):
        env.advance(particles, particles.positions)
    with pytest.raises(ValueError, match="no class 2"):
        tally.visits(2)


def test_drag_gives_its_momentum_to_cells():
    env = box(3)
    options = dartcast.SimulationOptions(dt=0.1, drag=2.0, user_data=["w"])
    simulation = dartcast.Simulation(env, options)
    simulation.set_statistics(dartcast.StatisticsOptions(
        cells=["momentum", "energy", "user:w"], cells_every=3, classes_of="diameter", class_bounds=[2e-3]))
    material = dartcast.records.Material(1e-3, 1000.0, 0.0)
    simulation.add([[0.2, 0.5, 0.5], [0.3, 0.4, 0.6]], [0.5, 0.0, 0.0], user_data=[3.0], material=material)
    for _ in range(3):
        simulation.step()
    arrays = simulation.cell_arrays()
    mass = 2 * 1000.0 * np.pi / 6 * 1e-9
    lost = 1 - np.exp(-0.6)
    assert arrays["momentum"].shape == (27, 3)
    assert np.allclose(arrays["momentum"].sum(axis=0), [mass * 0.5 * lost, 0, 0], rtol=1e-12, atol=0)
    assert np.array_equal(arrays["momentum"], arrays["momentum_diameter_0"])
    assert not arrays["energy_diameter_1"].any() and np.isclose(arrays["user:w"].sum(), 2 * 3.0 * 0.3)


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
    assert list(arrays) == dartcast.records.cell_quantities() and arrays["momentum"].shape == (27, 3)
    assert np.isclose(arrays["residence"].sum(), 100 * 0.5)
    assert np.isclose((arrays["concentration"] / 27).sum(), 100)
    with pytest.raises(ValueError, match="did you mean"):
        simulation.set_statistics(dartcast.StatisticsOptions(cells=["track_lenght"]))
