"""Random calls on one environment: add, remove, reorder, move, advance, edit, restore, and calls that must be refused.
Between them random calls on surfaces, bodies, catheters and simulations (random_solids.py).

Run as a program: random_calls.py [CALLS] [SEED]. It is made to run under an address sanitizer, and stops at the first
particle that is not where its state says. Equal seeds make equal calls.
"""
from __future__ import annotations

import sys
from typing import Any, Callable

import numpy as np

import dartcast as dc
from random_solids import WORLDS

MAX_CELLS = 1500  # an environment with more cells is made anew
RESPONSES = [None, dc.Reflect(0.5, friction=0.1), dc.Slide(), dc.Stick(), dc.Absorb(),
             {None: dc.Reflect(0.9), "xmin": dc.Slide(), "xmax": dc.Escape()}]


class Calls:
    """The environment, its sets of particles, and one method for each kind of call."""

    KINDS = {"add": 3, "remove": 2, "reorder": 1, "select": 2, "advance_some": 4, "move": 1, "edit": 1, "look": 1,
             "refuse": 2}

    def __init__(self, random: np.random.Generator) -> None:
        self.random, self.refused = random, 0
        self.make()

    def make(self) -> None:
        box = dc.formats.BoxOptions(cells=[4, 4, 4], size=[4.0, 4.0, 4.0], mixed=True, blocked_share=0.1, jitter=0.2,
                            seed=int(self.random.integers(1000)))
        self.environment = dc.Environment(dc.generate_box(box), threads=2)
        self.sets = [dc.Particles() for _ in range(3)]

    def one(self) -> dc.Particles:
        return self.sets[self.random.integers(len(self.sets))]

    def add(self) -> None:
        x = self.random.uniform(-0.5, 4.5, (self.random.integers(1, 20), 3))
        self.environment.add(self.one(), x)

    def remove(self) -> None:
        particles = self.one()
        share = 0.9 if len(particles) > 300 else 0.1
        particles.remove(self.random.uniform(size=len(particles)) < share)

    def reorder(self) -> None:
        particles = self.one()
        particles.reorder(self.random.permutation(len(particles)))

    def select(self) -> None:
        particles = self.one()
        which = np.flatnonzero(self.random.uniform(size=len(particles)) < 0.3)
        particles.replace(which, particles.selected(which))

    def advance(self) -> None:
        for particles in self.sets:
            self.advance_one(particles)

    def advance_some(self) -> None:
        self.advance_one(self.one())

    def advance_one(self, particles: dc.Particles) -> None:
        n = len(particles)
        velocities = self.random.normal(0.0, 1.0, (n, 3))
        targets = particles.positions + 0.3 * velocities
        kind = self.random.integers(len(RESPONSES) + 2)
        if kind == len(RESPONSES):
            self.environment.advance(particles, targets, lambda contacts, walls: -0.5 * contacts["unused"])
        elif kind == len(RESPONSES) + 1:
            self.environment.advance(particles, targets, lambda contact, walls, earlier: -contact.unused,
                                     per_contact=True)
        elif RESPONSES[kind] is None:
            self.environment.advance(particles, targets)
        else:
            self.environment.advance(particles, targets, RESPONSES[kind], velocities=velocities, dt=0.3,
                                     statuses=np.zeros(n, np.uint8))

    def move(self) -> None:
        moved = self.environment.positions.copy()
        moved += self.random.normal(0.0, 0.01, moved.shape)
        self.environment.move_until_inverted(moved, 0.9)
        self.advance()

    def edit(self) -> None:
        if self.environment.map.cell_count() > MAX_CELLS:
            self.make()
        cell = int(self.random.choice(self.environment.map.cells()))
        plane = dc.topology.plane_through(self.random.uniform(0.5, 3.5, 3), self.random.normal(size=3))
        kind = self.random.integers(4)

        def make(edit: dc.topology.ComplexEdit) -> None:
            if kind == 0:
                edit.topology.set_free(cell, not edit.map.is_free(cell))
            elif kind == 1:
                dc.topology.split_by_plane(edit, [cell], plane)
            elif kind == 2:
                dc.topology.subdivide(edit, cell)
            else:
                raise KeyError("out of the edit")

        try:
            self.environment.edit(make)
        except (dc.EditRefused, KeyError):
            self.refused += 1
            return
        for particles in self.sets:
            self.environment.update_after_edit(particles, self.random.choice(list(dc.records.OrphanPolicy)))

    def look(self) -> None:
        particles = self.one()
        assert particles.positions.shape == (len(particles), 3)
        self.environment.locate(self.random.uniform(-1, 5, (10, 3)))
        assert dc.audit(self.environment.complex, particles).failed == 0
        if len(particles):
            self.environment.trace(particles, 0, self.random.uniform(0, 4, (2, 3)))

    def refuse(self) -> None:
        """Calls with arguments that do not fit: each raises an error and changes nothing."""
        particles, n = self.one(), len(self.one())
        bad: list[Callable[[], object]] = [
            lambda: self.environment.advance(particles, np.zeros((len(particles) + 1, 3))),
            lambda: self.environment.advance(particles, np.full((len(particles) + 1, 3), np.nan)),
            lambda: self.environment.move(np.zeros((3, 3))),
            lambda: self.environment.locate(np.full((2, 3), np.inf)),
            lambda: particles.reorder([n + 10]),
            lambda: particles.selected([len(particles)]),
            lambda: self.environment.map.is_free(0xFFFFFFF0),
            lambda: self.environment.add(particles, np.zeros((3, 2))),
        ]
        call = bad[self.random.integers(len(bad))]
        try:
            call()
        except (dc.Error, TypeError, IndexError, ValueError):
            self.refused += 1
        else:
            raise AssertionError("a wrong call was not refused")


    def check(self) -> None:
        assert sum(dc.audit(self.environment.complex, particles).failed for particles in self.sets) == 0


def run(calls: int, seed: int) -> list[Any]:
    """Half of the calls are on the environment. Returns the worlds as they are then."""
    random = np.random.default_rng(seed)
    worlds: list[Any] = [world(random) for world in (Calls, *WORLDS)]
    kinds = [[name for name, weight in world.KINDS.items() for _ in range(weight)] for world in worlds]
    for _ in range(calls):
        i = int(random.integers(2 * len(WORLDS)))
        i = i + 1 if i < len(WORLDS) else 0
        getattr(worlds[i], kinds[i][random.integers(len(kinds[i]))])()
    for world in worlds:
        world.check()
    return worlds


if __name__ == "__main__":
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    done = run(count, int(sys.argv[2]) if len(sys.argv) > 2 else 1)
    print(f"{count} calls, {sum(world.refused for world in done)} refused, {sum(map(len, done[0].sets))} particles, "
          f"{done[0].environment.map.cell_count()} cells, state {done[-1].simulation.state_hash().hex()}")
