"""Small scenes, which the calls share."""
from __future__ import annotations

import pathlib
import tempfile
from collections.abc import Callable

import numpy as np

import dartcast as dc

COUNT = 10  # particles
OWN_FOLDER = tempfile.TemporaryDirectory(prefix="dartcast-calls-")  # goes with the program
FOLDER = pathlib.Path(OWN_FOLDER.name)


def box(n: int = 3, **options: object) -> dc.MeshData:
    return dc.generate_box(cells=[n, n, n], size=[1.0, 1.0, 1.0], **options)


def complex_of(n: int = 2, **options: object) -> dc.topology.CellComplex:
    return dc.topology.CellComplex(box(n, **options), threads=1)


def environment(n: int = 3, **options: object) -> dc.Environment:
    return dc.Environment(box(n, **options), threads=1)


def with_particles(n: int = 3) -> tuple[dc.Environment, dc.Particles]:
    env = environment(n)
    return env, env.add_random(COUNT, seed=5)


def first(m: dc.topology.CombinatorialMap) -> int:
    return int(m.cells()[0])


def inner_face(m: dc.topology.CombinatorialMap) -> tuple[int, int]:
    c = first(m)
    return c, next(f for f in range(m.shape(c).face_count) if m.opposite((c, f)) is not None)


def outer_face(m: dc.topology.CombinatorialMap) -> tuple[int, int]:
    c = first(m)
    return c, next(f for f in range(m.shape(c).face_count) if m.opposite((c, f)) is None)


def simulation(**options: object) -> dc.Simulation:
    """Of particles in a box, in which all of them meet walls at every step."""
    named = {"dt": 0.1, "response": dc.Reflect(0.5)} | options
    made = dc.Simulation(environment(), dc.SimulationOptions(**named))
    made.add_random(COUNT, [20.0, 3.0, 10.0])
    return made


def tube() -> dc.Environment:
    """A vessel of some hundred cells along the z axis."""
    return dc.Environment(dc.generate_box(cells=[3, 3, 10], size=[0.01, 0.01, 0.05], origin=[-0.005, -0.005, 0.0]),
                          threads=1)


def catheter(env: dc.Environment) -> dc.Catheter:
    options = dc.CatheterOptions(length=0.02, spacing=2e-3, entry=[0.0, 0.0, 1e-3], direction=[0.0, 0.1, 1.0])
    made = dc.Catheter(env, options)
    for _ in range(3):
        made.step(dc.CatheterInput(push=1e-3))
    return made


BODY = np.array([[0.5, 0.5, 0.6], [0.6, 0.5, 0.6], [0.5, 0.6, 0.6], [0.5, 0.5, 0.7]])


def bodies(env: dc.Environment) -> dc.Bodies:
    made = dc.Bodies(env, dc.records.BodiesOptions(dt=1e-2, gravity=[0.0, 0.0, -10.0]))
    made.add(BODY, dc.BodyOptions(mass=2.0))
    return made


def undone(c: dc.topology.CellComplex, edit: Callable[[dc.topology.ComplexEdit], object]) -> Callable[[], None]:
    """An edit that is not committed."""
    def call() -> None:
        with dc.topology.ComplexEdit(c) as open_edit:
            edit(open_edit)
    return call


class OneRank(dc.Ranks):
    """A process alone."""

    rank, size = 0, 1

    def gather(self, data: bytes) -> list[bytes]:
        return [data]

    def broadcast(self, data: bytes) -> bytes:
        return data

    def exchange(self, data: list[bytes]) -> list[bytes]:
        return data

    def sum(self, values: np.ndarray) -> np.ndarray:
        return values

    def fail(self, why: str) -> bool:
        return True
