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
    options.planes = [dartcast.records.SectionPlane("middle", [0.0, 0.0, 14.0], [0.0, 0.0, 1.0])]
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
    found = dartcast.records.find_crossings([dartcast.records.SectionPlane("p", [0, 0, 0], [0, 0, 2])], before, after)
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
    cut = dartcast.records.Cut(dartcast.Disc(centre=[0.0, 0.0, -0.012], radius=6e-3), 1.2e-3)
    report = dartcast.records.apply(simulation, dartcast.records.Event(0.0, cut))
    assert report.cells_added > report.cells_removed > 0 and report.cells_opened > 0
    simulation.step()
    assert simulation.audit().failed == 0


def test_a_steered_catheter_goes_as_its_input_says() -> None:
    simulation = dartcast.Simulation(dartcast.Environment(dartcast.generate_vessel()), dartcast.SimulationOptions(dt=1e-3))
    options = dartcast.CatheterOptions(length=0.03, spacing=1e-3, entry=[0.0, -0.006376, -0.026761], direction=[0.0, 0.472, 0.882])
    simulation.add(dartcast.formats.CatheterScene("steered", options))
    for push in (2e-4, 0.0, -1e-4):
        simulation.steer(0, dartcast.CatheterInput(push=push))
        before = simulation.catheter(0).inserted
        for _ in range(5):
            simulation.step()
        assert simulation.catheter(0).inserted - before == pytest.approx(5 * push)
    with pytest.raises(dartcast.InvalidArgument, match="no catheter 1 to steer"):
        simulation.steer(1, dartcast.CatheterInput())
    with pytest.raises(dartcast.InvalidArgument, match="turn must be between"):
        simulation.steer(0, dartcast.CatheterInput(turn=7.0))


def test_setters_refuse_what_is_out_of_range() -> None:
    simulation = bar()
    simulation.add_random(5, [1.0, 2.0, 3.0])
    before = simulation.state_hash().hex()
    environment = simulation.environment
    n = len(environment.positions)
    plane = dartcast.topology.plane_through([2.0, 2.0, 14.0], [0.0, 0.0, 1.0])
    wrong = [
        lambda: simulation.add(np.full((2, 3), 2.5), np.zeros((3, 3))),
        lambda: simulation.add(np.full((2, 3), 2.5), [np.inf, 0.0, 0.0]),
        lambda: simulation.add(np.full((2, 3), np.nan), [0.0, 0.0, 0.0]),
        lambda: simulation.add(np.full((2, 3), 2.5), [0.0, 0.0, 0.0], -1.0),
        lambda: simulation.add(np.full((2, 3), 2.5), [0.0, 0.0, 0.0], np.ones(3)),
        lambda: simulation.add(np.full((2, 3), 2.5), [0.0, 0.0, 0.0], user_data=[1.0]),
        lambda: simulation.add_random(3, [np.nan, 0.0, 0.0]),
        lambda: simulation.add_random(2**40, [0.0, 0.0, 0.0]),
        lambda: simulation.add_inlet(60000, 1.0, [0.0, 0.0, 1.0]),
        lambda: simulation.add_body(np.full((1, 3), 2.5), dartcast.BodyOptions(mass=-1.0)),
        lambda: simulation.set_events([dartcast.records.Event(-1.0, dartcast.records.Cut(plane, 0.1))]),
        lambda: simulation.set_adaptive_subdivision(dartcast.formats.AdaptiveSubdivisionScene(
            1, dartcast.records.AdaptiveSubdivisionOptions(max_particles=1, min_particles=2))),
        lambda: simulation.set_deformation(dartcast.Deformation([], np.zeros((n + 1, 3)))),
        lambda: simulation.pull(np.zeros((n + 1, 3)), 1.0),
        lambda: simulation.pull(np.zeros((n, 3)), -1.0),
        lambda: simulation.catheter(0),
        lambda: simulation.go_to(5),
        lambda: simulation.user_data(99),
    ]
    for i, call in enumerate(wrong):
        with pytest.raises((dartcast.InvalidArgument, IndexError)):
            call()
            pytest.fail(f"call {i} was not refused")
    assert simulation.state_hash().hex() == before and simulation.step().duration == 0.1


@pytest.mark.parametrize("named", [{"dt": 0.0}, {"dt": np.nan}, {"substeps": 0}, {"drag": -1.0},
                                   {"gravity": [np.inf, 0.0, 0.0]}, {"patch_responses": {"none": dartcast.Slide()}},
                                   {"response": dartcast.Reflect(1.5)}])
def test_options_out_of_range_are_refused(named: dict[str, object]) -> None:
    with pytest.raises(dartcast.InvalidArgument):
        dartcast.Simulation(dartcast.Environment(dartcast.generate_bar()),
                            dartcast.SimulationOptions(**({"dt": 0.1} | named)))


def test_a_function_is_called_once_after_each_edit() -> None:
    simulation = bar()
    simulation.add_random(50, [1.0, 2.0, 3.0])
    cells: list[int] = []
    simulation.set_after_edit(lambda environment: cells.append(environment.map.cell_count()))
    for _ in range(3):
        simulation.edit(lambda edit: dartcast.topology.subdivide(edit, int(edit.map.cells()[0])))
    assert cells == sorted(set(cells)) and len(cells) == 3 and cells[-1] == simulation.environment.map.cell_count()
    simulation.set_after_edit(None)
    simulation.edit(lambda edit: dartcast.topology.subdivide(edit, int(edit.map.cells()[0])))
    assert len(cells) == 3


def test_an_exception_after_an_edit_comes_out_as_itself() -> None:
    simulation = bar()
    simulation.add_random(50, [1.0, 2.0, 3.0])
    before = simulation.environment.map.cell_count()

    def fail(environment: dartcast.Environment) -> None:
        raise ArithmeticError("mine")

    simulation.set_after_edit(fail)
    with pytest.raises(ArithmeticError, match="mine"):
        simulation.edit(lambda edit: dartcast.topology.subdivide(edit, int(edit.map.cells()[0])))
    simulation.set_after_edit(None)
    assert simulation.environment.map.cell_count() > before  # the edit is whole: the function is called at its end
    simulation.step()
    assert simulation.audit().failed == 0 and len(simulation.particles) == 50


def test_an_exception_in_an_edit_undoes_it() -> None:
    simulation = bar()
    simulation.add_random(50, [1.0, 2.0, 3.0])
    before = simulation.state_hash().hex(), simulation.environment.map.cell_count(), simulation.environment.edit_count

    def fail(edit: dartcast.topology.ComplexEdit) -> None:
        dartcast.topology.subdivide(edit, int(edit.map.cells()[0]))
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        simulation.edit(fail)
    assert before == (simulation.state_hash().hex(), simulation.environment.map.cell_count(),
                      simulation.environment.edit_count)


def test_a_checkpoint_of_another_scene_is_refused() -> None:
    simulation = bar()
    simulation.add_random(20, [3.0, 2.0, 1.0])
    simulation.step()
    saved = simulation.checkpoint()
    other = dartcast.Simulation(dartcast.Environment(dartcast.generate_box(cells=[1, 1, 1])),
                                dartcast.SimulationOptions(dt=0.1))
    other.add_random(3, [1.0, 0.0, 0.0])
    before = other.state_hash().hex()
    with pytest.raises(dartcast.InvalidArgument):
        other.restore(saved)
    assert other.state_hash().hex() == before and other.audit().failed == 0


def vessel(events: list[dartcast.records.Event]) -> dartcast.Simulation:
    simulation = dartcast.Simulation(dartcast.Environment(dartcast.generate_vessel()),
                                     dartcast.SimulationOptions(dt=1e-3))
    simulation.add_random(200, [0.0, 0.0, 0.1])
    simulation.set_events(events)
    return simulation


@pytest.mark.parametrize("kind, what", [
    ("CUT", lambda: dartcast.records.Cut(dartcast.Disc(centre=[0.0, 0.0, -0.012], radius=6e-3), 1.2e-3)),
    ("CARVE", lambda: dartcast.records.Carve(dartcast.topology.box_tool([-4e-3, -4e-3, -4e-3], [4e-3, 4e-3, 4e-3]), "open")),
    ("LIGATURE", lambda: dartcast.records.Ligature(dartcast.topology.plane_through([0.0, 0.0, 0.0], [0.0, 0.0, 1.0]), [0.0, 0.0, 0.0],
                                           dartcast.topology.TyingOptions(0.2, 5e-3), 2e-3)),
    ("OPEN", lambda: dartcast.records.OpenCells(np.flatnonzero(dartcast.generate_vessel().free == 0)[:100])),
    ("CLOSE", lambda: dartcast.records.CloseCells(np.flatnonzero(dartcast.generate_vessel().free)[:100]))])
def test_events_happen_at_their_time(kind: str, what: object) -> None:
    assert callable(what)
    simulation = vessel([dartcast.records.Event(2e-3, what())])
    reports = []
    for _ in range(4):
        simulation.step()
        reports.append(len(simulation.event_log.events))
    assert reports == [0, 0, 1, 1]  # before the step that begins at 2 ms
    event, = simulation.event_log.events
    assert event.kind == dartcast.records.EventKind[kind] and event.step == 2 and event.time == pytest.approx(2e-3)
    assert event.cells_added + event.cells_opened + event.cells_blocked > 0
    assert simulation.audit().failed == 0


def test_events_that_cannot_happen_say_why() -> None:
    far = dartcast.records.Ligature(dartcast.topology.plane_through([0.0, 0.0, 9.0], [0.0, 0.0, 1.0]), [0.0, 0.0, 9.0],
                            dartcast.topology.TyingOptions(0.2, 5e-3), 2e-3)
    simulation = vessel([dartcast.records.Event(0.0, far)])
    simulation.step()
    refused, = simulation.event_log.events
    assert "crosses no free cell" in refused.refused and simulation.audit().failed == 0


def test_crowded_cells_are_subdivided_and_merged() -> None:
    simulation = dartcast.Simulation(dartcast.Environment(dartcast.generate_box(cells=[2, 2, 2], size=[1.0, 1.0, 1.0])),
                                     dartcast.SimulationOptions(dt=0.1))
    simulation.add(np.random.default_rng(1).uniform(0.01, 0.49, (60, 3)), [0.0, 0.0, 0.0])
    simulation.set_adaptive_subdivision(dartcast.formats.AdaptiveSubdivisionScene(
        0, dartcast.records.AdaptiveSubdivisionOptions(max_particles=30, min_particles=4)))
    report = simulation.adapt()
    assert report.subdivided == 1 and report.merged == 0 and report.waiting == 0 and not report.refused
    assert simulation.environment.map.cell_count() > 8 and simulation.audit().failed == 0


def test_cells_that_a_motion_inverts_are_repaired() -> None:
    environment = dartcast.Environment(dartcast.generate_box(cells=[2, 2, 2], size=[1.0, 1.0, 1.0]))
    simulation = dartcast.Simulation(environment, dartcast.SimulationOptions(dt=0.1))
    simulation.add_random(40, [0.5, 0.25, 0.125])
    assert not simulation.repair().mended
    displacement = np.zeros((27, 3))
    displacement[13] = [0.55, 0.0, 0.0]  # the middle vertex passes the wall face's plane at x = 1
    simulation.pull(displacement, 0.1)
    simulation.step()
    assert not simulation.environment.validity().valid
    report = simulation.repair()
    assert report.mended or report.left
    assert simulation.audit().failed == 0
