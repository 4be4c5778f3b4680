"""Objects used from two threads at once: the second thread gets InUse, and the first is not disturbed."""
from __future__ import annotations

import threading
from collections.abc import Callable

import dartcast
import numpy as np
import pytest


def refused_while(run: Callable[[Callable[[], None]], object], use: Callable[[], object]) -> BaseException:
    """Calls `run` with a function that it calls inside the object; meanwhile another thread uses the object."""
    raised: list[BaseException] = []

    def inside() -> None:
        def other() -> None:
            try:
                use()
            except BaseException as e:  # noqa: BLE001: the test looks at it
                raised.append(e)
        thread = threading.Thread(target=other)
        thread.start()
        thread.join()

    run(inside)
    assert len(raised) >= 1, "the other thread was not refused"
    assert type(raised[0]) is dartcast.InUse, repr(raised[0])
    return raised[0]


def box() -> dartcast.Environment:
    return dartcast.Environment(dartcast.generate_box(cells=[2, 2, 2], size=[1.0, 1.0, 1.0]))


def once(call: Callable[[], None]) -> Callable[..., None]:
    """A callback that calls at its first time alone. As a response it stops the particles."""
    left = [call]
    return lambda *_: left.pop()() if left else None


def advancing(environment: dartcast.Environment,
              particles: dartcast.Particles) -> Callable[[Callable[[], None]], object]:
    """Particles that meet walls, where the environment is in use."""
    return lambda inside: environment.advance(particles, particles.positions + 1.0, once(inside))


def test_an_environment_and_its_particles() -> None:
    environment = box()
    particles = environment.add_random(20, seed=1)
    run = advancing(environment, particles)
    assert "environment is in use" in str(refused_while(run, lambda: environment.locate([0.5, 0.5, 0.5])))
    refused_while(run, lambda: environment.move(environment.positions.copy()))
    refused_while(run, lambda: particles.positions)
    assert len(particles) == 20 and dartcast.audit(environment.complex, particles).failed == 0


@pytest.mark.parametrize("use", [lambda s: s.step(), lambda s: s.state_hash(), lambda s: s.positions,
                                 lambda s: s.checkpoint(), lambda s: s.add_random(1, [0.0, 0.0, 0.0])])
def test_a_simulation(use: Callable[[dartcast.Simulation], object]) -> None:
    simulation = dartcast.Simulation(box(), dartcast.SimulationOptions(dt=0.1))
    simulation.add_random(10, [1.0, 2.0, 3.0])

    def run(inside: Callable[[], None]) -> None:
        simulation.set_after_edit(once(inside))
        simulation.edit(lambda edit: dartcast.topology.subdivide(edit, int(edit.map.cells()[0])))

    refused_while(run, lambda: use(simulation))
    simulation.set_after_edit(None)
    use(simulation)
    assert simulation.audit().failed == 0


def test_a_deformation() -> None:
    rest = np.zeros((4, 3))
    inside: list[Callable[[], None]] = []

    def reader(k: int) -> np.ndarray:
        if inside:
            inside.pop()()
        return rest + k

    step = dartcast.DeformationStep(kind="frames", times=[0.0, 1.0, 2.0, 3.0], reader=reader)
    deformation = dartcast.Deformation([step], rest)

    def run(call: Callable[[], None]) -> None:
        inside.append(call)
        deformation.positions(2.5)

    refused_while(run, lambda: deformation.positions(0.5))
    assert np.allclose(deformation.positions(2.5), 2.5)


def test_a_surface() -> None:
    surface = dartcast.topology.Surface(dartcast.generate_barrel(staves=8, rows=4, rings=2))
    cells = surface.map.cells()
    for c in cells[::2]:
        surface.set_free(int(c), False)
    place = dartcast.topology.SurfacePlace(surface.triangles()[-1], [0.3, 0.3, 0.4])
    rest = surface.positions.copy()

    def run(inside: Callable[[], None]) -> None:
        called = once(inside)
        for way in np.random.default_rng(1).normal(0.0, 1.0, (20, 3)):
            dartcast.step(surface, dartcast.topology.SurfacePlace(place.triangle, place.weights), way, called)

    refused_while(run, lambda: surface.move(rest))
    surface.move(rest)


def test_bodies_and_a_catheter() -> None:
    """They compute on their environment: while it is in use they are, too."""
    environment = dartcast.Environment(dartcast.generate_box(cells=[3, 3, 10], size=[0.01, 0.01, 0.05],
                                                             origin=[-0.005, -0.005, 0.0]))
    bodies = dartcast.Bodies(environment, dartcast.records.BodiesOptions(dt=1e-2))
    bodies.add(np.array([[0.0, 0.0, 0.03], [0.001, 0.0, 0.03]]), dartcast.BodyOptions())
    catheter = dartcast.Catheter(environment, dartcast.CatheterOptions(
        length=0.02, spacing=2e-3, entry=[0.0, 0.0, 1e-3], direction=[0.0, 0.0, 1.0]))
    particles = environment.add_random(20, seed=1)
    run = advancing(environment, particles)
    refused_while(run, bodies.step)
    refused_while(run, lambda: catheter.step(dartcast.CatheterInput(push=1e-3)))
    bodies.step()
    assert catheter.step(dartcast.CatheterInput(push=1e-3)).pushed == 1e-3


def test_two_threads_in_long_calls() -> None:
    """Two threads step one simulation as fast as they can: each step is whole, or refused."""
    simulation = dartcast.Simulation(dartcast.Environment(dartcast.generate_box(cells=[4, 4, 4], size=[1.0, 1.0, 1.0])),
                                     dartcast.SimulationOptions(dt=0.1))
    simulation.add_random(2000, [1.0, 2.0, 3.0])
    done, refused = [0, 0], [0, 0]

    def work(i: int) -> None:
        for _ in range(60):
            try:
                simulation.step()
                done[i] += 1
            except dartcast.InUse:
                refused[i] += 1

    threads = [threading.Thread(target=work, args=(i,)) for i in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert simulation.steps == sum(done) and sum(done) + sum(refused) == 120
    assert simulation.audit().failed == 0
