"""Simulations: against steps of the environment, results as copies, checkpoints, statistics, use by two."""
from __future__ import annotations

import dartcast
import numpy as np
import pytest


def bar(**options: object) -> dartcast.Simulation:
    return dartcast.Simulation(dartcast.Environment(dartcast.generate_bar()),
                               dartcast.SimulationOptions(dt=0.1, response=dartcast.Reflect(0.5), **options))


def test_the_program_of_the_readme() -> None:
    simulation = bar()
    simulation.add(np.array([[2.5, 2.5, 14.0]]), [30.0, 0.0, 1.0])
    contacts = simulation.step().contacts
    assert contacts["time_of_impact"].tolist() == pytest.approx([0.5]) and contacts["point"][0, 0] == pytest.approx(4.0)
    assert np.allclose(simulation.velocities, [[-15.0, 0.0, 1.0]])


def test_positions_are_copies_that_cannot_be_written() -> None:
    simulation = bar()
    simulation.add_random(20, [1.0, 2.0, 3.0])
    before = simulation.positions
    kept = before.copy()
    simulation.step()
    assert np.array_equal(before, kept) and not np.array_equal(simulation.positions, kept)
    with pytest.raises(ValueError):
        before[0, 0] = 1.0


def test_a_checkpoint_goes_on_with_the_same_bits() -> None:
    simulation = bar()
    simulation.add_random(50, [3.0, 2.0, 1.0])
    for _ in range(5):
        simulation.step()
    saved = simulation.checkpoint()
    hashes = []
    for _ in range(2):
        for _ in range(5):
            simulation.step()
        hashes.append(simulation.state_hash().hex())
        simulation.restore(saved)
    assert hashes[0] == hashes[1] and simulation.steps == 5


def test_the_environment_is_the_simulations_alone() -> None:
    environment = dartcast.Environment(dartcast.generate_bar())
    simulation = dartcast.Simulation(environment, dartcast.SimulationOptions(dt=0.1))
    with pytest.raises(dartcast.InvalidArgument):
        environment.move(environment.positions.copy())
    assert simulation.audit().failed == 0


def test_statistics_count_all_contacts() -> None:
    simulation = bar()
    options = dartcast.StatisticsOptions(hits=True, pathlines_every=10)
    options.planes = [dartcast.SectionPlane("middle", [0.0, 0.0, 14.0], [0.0, 0.0, 1.0])]
    simulation.set_statistics(options)
    simulation.add_random(200, [5.0, 3.0, 10.0])
    contacts = crossed = 0
    for _ in range(20):
        before = simulation.positions
        contacts += len(simulation.step().contacts)
        after = simulation.positions
        crossed += np.count_nonzero((before[:, 2] < 14.0) & (after[:, 2] >= 14.0))
    statistics = simulation.statistics
    assert statistics.hits.faces()["hits"].sum() == contacts > 0
    assert statistics.planes[0].forward.count == crossed > 0
    assert set(statistics.path_points["id"].tolist()) == set(range(0, 200, 10))


def test_crossings_are_those_of_the_signs() -> None:
    random = np.random.default_rng(1)
    before, after = random.uniform(-1, 1, (2, 1000, 3))
    found = dartcast.find_crossings([dartcast.SectionPlane("p", [0, 0, 0], [0, 0, 2])], before, after)
    crossed = (before[:, 2] < 0) != (after[:, 2] < 0)
    assert np.array_equal(found["particle"], np.flatnonzero(crossed))
    assert np.array_equal(found["forward"], after[crossed, 2] >= 0)


def test_hits_refuse_the_report_of_another_environment() -> None:
    simulation = bar()
    simulation.add_random(100, [5.0, 3.0, 10.0])
    report = simulation.step().report
    assert len(report.contacts)
    small = dartcast.Environment(dartcast.generate_box(cells=[1, 1, 1]))
    with pytest.raises(dartcast.InvalidArgument, match="another environment"):
        dartcast.WallHits().add(small, report)


def test_events_cut_while_particles_flow() -> None:
    simulation = dartcast.Simulation(dartcast.Environment(dartcast.generate_vessel()),
                                     dartcast.SimulationOptions(dt=1e-3))
    simulation.add_random(200, [0.0, 0.0, 0.1])
    cut = dartcast.Cut(dartcast.Disc(centre=[0.0, 0.0, -0.012], radius=6e-3), 1.2e-3)
    report = dartcast.apply(simulation, dartcast.Event(0.0, cut))
    assert report.cells_added > report.cells_removed > 0 and report.cells_opened > 0
    simulation.step()
    assert simulation.audit().failed == 0
