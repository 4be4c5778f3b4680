"""Random calls on surfaces, bodies, catheters and simulations, for random_calls.py.

Each class has one world. KINDS: how often each of its methods is called. check(): everything is where it should be.
"""
from __future__ import annotations

from typing import Callable, ClassVar

import numpy as np

import dartcast as dc

MAX_CELLS = 600  # a world with more cells is made anew
POLICIES = list(dc.records.OrphanPolicy)


def wrong(state: object, call: Callable[[], object]) -> None:
    """The call must be refused."""
    try:
        call()
    except (dc.Error, TypeError, IndexError, ValueError):
        state.refused += 1
    else:
        raise AssertionError("a wrong call was not refused")


def change(random: np.random.Generator) -> Callable[[dc.topology.ComplexEdit], object]:
    """A random edit of one cell of space."""
    kind, point, normal = random.integers(4), random.uniform(0.2, 0.8, 3), random.normal(size=3)

    def make(edit: dc.topology.ComplexEdit) -> None:
        cell = int(random.choice(edit.map.cells()))
        if kind == 0:
            edit.topology.set_free(cell, not edit.map.is_free(cell))
        elif kind == 1:
            dc.topology.subdivide(edit, cell)
        elif kind == 2:
            dc.topology.split_by_plane(edit, [cell], dc.topology.plane_through(point, normal))
        else:
            dc.topology.remove(edit.topology, cell)
            raise KeyError("out of the edit")
    return make


class SurfaceCalls:
    """Particles on a barrel that is moved and edited."""

    KINDS: ClassVar[dict[str, int]] = {"advance": 4, "step": 3, "move": 1, "mark": 1, "edit": 2, "locate": 2,
                                       "refuse": 2}

    def __init__(self, random: np.random.Generator) -> None:
        self.random, self.refused = random, 0
        self.make()

    def make(self) -> None:
        self.surface = dc.topology.Surface(dc.generate_barrel(staves=8, rows=4, rings=2))
        self.rest = self.surface.positions.copy()
        self.places = dc.topology.SurfaceLocator(self.surface).nearest(self.surface, self.random.normal(0.0, 0.3, (20, 3)))[0]

    def answer(self) -> object:
        restitution = self.random.uniform()
        return [None, lambda c: dc.slid(c, c.unused), lambda c: dc.reflected(c, c.unused, restitution),
                lambda c: dc.topology.AfterSurfaceContact(dc.slid(c, c.unused), True)][self.random.integers(4)]

    def advance(self) -> None:
        ways = self.random.normal(0.0, 0.2, (len(self.places), 3))
        report = dc.advance(self.surface, self.places, ways, self.answer(), threads=2)
        assert len(report.steps) == len(self.places)

    def step(self) -> None:
        i = self.random.integers(len(self.places))
        row = self.places[i]
        place = dc.topology.SurfacePlace((int(row["cell"]), int(row["simplex"])), list(row["weights"]))
        dc.step(self.surface, place, self.random.normal(0.0, 0.2, 3), self.answer(), trace=dc.topology.SurfaceTrace())
        self.places[i] = dc.topology.surface_places([place])[0]

    def move(self) -> None:
        moved = self.surface.positions.copy()
        self.surface.move(moved + self.random.normal(0.0, 0.002, moved.shape))

    def mark(self) -> None:
        self.surface.set_free(int(self.random.choice(self.surface.map.cells())), bool(self.random.uniform() < 0.7))

    def edit(self) -> None:
        if len(self.surface.map.cells()) > MAX_CELLS:
            self.make()
        try:
            with dc.topology.SurfaceEdit(self.surface) as edit:
                cell, dart = int(self.random.choice(edit.map.cells())), int(self.random.integers(5))
                change_edge = [dc.topology.split_edge, dc.topology.merge_edges, dc.topology.merge_faces][self.random.integers(3)]
                change_edge(edit.topology, (cell, dart))
                if self.random.uniform() < 0.2:
                    raise KeyError("out of the edit")
                report = edit.commit()
        except (dc.Error, IndexError, KeyError):
            self.refused += 1
            return
        followed = dc.topology.followed(self.surface, report, self.places)
        self.places = followed[followed["cell"] != dc.NONE].copy()
        if len(self.places) < 5:
            self.make()

    def locate(self) -> None:
        locator = dc.topology.SurfaceLocator(self.surface)
        places, distances = locator.nearest(self.surface, self.random.normal(0.0, 0.3, (5, 3)))
        assert self.surface.contains(places).all() and len(self.surface.point(places)) == len(distances)
        self.check()

    def refuse(self) -> None:
        n = len(self.places)
        bad: list[Callable[[], object]] = [
            lambda: dc.advance(self.surface, self.places, np.zeros((n + 1, 3))),
            lambda: dc.step(self.surface, dc.topology.SurfacePlace(), [0.0, 0.0, 0.1]),
            lambda: self.surface.move(self.rest[1:]), lambda: self.surface.corners((0xFFFFFF0, 0)),
            lambda: self.surface.point(self.places[:, None])]
        wrong(self, bad[self.random.integers(len(bad))])

    def check(self) -> None:
        assert self.surface.contains(self.places).all() and dc.topology.check_integrity(self.surface.map) == []


class BodyCalls:
    """Bodies in a box that is edited."""

    KINDS: ClassVar[dict[str, int]] = {"step": 6, "add": 1, "push": 2, "edit": 1, "restore": 1, "look": 1, "refuse": 1}

    def __init__(self, random: np.random.Generator) -> None:
        self.random, self.refused = random, 0
        self.make()

    def make(self) -> None:
        self.environment = dc.Environment(dc.generate_box(cells=[3, 3, 3], size=[1.0, 1.0, 1.0], jitter=0.1), threads=2)
        options = dc.records.BodiesOptions(dt=1e-2, gravity=[0.0, 0.0, -9.81], collisions=dc.records.BodyCollisionOptions())
        self.bodies = dc.Bodies(self.environment, options, {"zmin": dc.Slide()})
        self.saved = self.bodies.checkpoint()

    def add(self) -> None:
        if len(self.bodies) >= 4:
            self.make()
        points = self.random.uniform(0.2, 0.8, 3) + self.random.normal(0.0, 0.05, (6, 3))
        options = dc.BodyOptions(mass=1.0, radius=0.01, stiffness=self.random.uniform(0.1, 1.0))
        self.bodies.add(points, options)
        self.saved = self.bodies.checkpoint()

    def step(self) -> None:
        self.bodies.step()

    def push(self) -> None:
        v = self.bodies.velocities
        self.bodies.velocities = v + self.random.normal(0.0, 0.5, v.shape)
        if len(self.bodies):
            body = int(self.random.integers(len(self.bodies)))
            self.bodies.apply_impulse(body, self.bodies.predicted_state(body))

    def edit(self) -> None:
        if self.environment.map.cell_count() > MAX_CELLS:
            self.make()
        try:
            self.environment.edit(change(self.random))
        except (dc.EditRefused, KeyError):
            self.refused += 1
            return
        self.bodies.update_after_edit(POLICIES[self.random.integers(len(POLICIES))])
        self.saved = self.bodies.checkpoint()

    def restore(self) -> None:
        self.bodies.restore(self.saved)

    def look(self) -> None:
        for i in range(len(self.bodies)):
            self.bodies.fits(i), self.bodies.energy(i), self.bodies.rigid_motion_of(i)
        assert len(self.bodies.positions) == len(self.bodies.statuses)
        self.check()

    def refuse(self) -> None:
        bad: list[Callable[[], object]] = [
            lambda: self.bodies.energy(99), lambda: self.bodies.add(np.zeros((0, 3)), dc.BodyOptions()),
            lambda: self.bodies.add(np.full((4, 3), np.nan), dc.BodyOptions()),
            lambda: setattr(self.bodies, "velocities", np.full((99, 3), 0.0))]
        wrong(self, bad[self.random.integers(len(bad))])

    def check(self) -> None:
        assert dc.audit(self.environment.complex, self.bodies.particles).failed == 0


class CatheterCalls:
    """A catheter that is pushed and drawn back in a tube that is edited."""

    KINDS: ClassVar[dict[str, int]] = {"step": 6, "edit": 1, "restore": 1, "look": 1, "refuse": 1}

    def __init__(self, random: np.random.Generator) -> None:
        self.random, self.refused = random, 0
        self.make()

    def make(self) -> None:
        mesh = dc.generate_box(cells=[3, 3, 8], size=[1.0, 1.0, 4.0])
        self.environment = dc.Environment(mesh, threads=2)
        options = dc.CatheterOptions(length=3.0, spacing=0.2, tip_length=0.5, tip_curvature=1.0,
                                     entry=[0.5, 0.5, 0.1], direction=[0.1, 0.2, 1.0])
        self.catheter = dc.Catheter(self.environment, options)
        self.saved = self.catheter.checkpoint()

    def step(self) -> None:
        self.catheter.step(dc.CatheterInput(push=self.random.uniform(-0.1, 0.2), turn=self.random.normal()))

    def edit(self) -> None:
        if self.environment.map.cell_count() > MAX_CELLS:
            self.make()
        try:
            self.environment.edit(change(self.random))
        except (dc.EditRefused, KeyError):
            self.refused += 1
            return
        self.catheter.update_after_edit()
        self.saved = self.catheter.checkpoint()

    def restore(self) -> None:
        self.catheter.restore(self.saved)

    def look(self) -> None:
        points = self.catheter.points()
        assert len(self.catheter.frames()) in (len(points), len(points) - 1, 0)
        if len(points) > 2:
            dc.records.camera_path(self.environment, points, dc.records.CameraOptions(spacing=0.2))
        self.check()

    def refuse(self) -> None:
        bad: list[Callable[[], object]] = [
            lambda: self.catheter.step(dc.CatheterInput(push=np.nan)), lambda: self.catheter.restore(3),
            lambda: dc.Catheter(self.environment, dc.CatheterOptions(length=-1.0))]
        wrong(self, bad[self.random.integers(len(bad))])

    def check(self) -> None:
        assert dc.audit(self.environment.complex, self.catheter.particles).failed == 0


class SimulationCalls:
    """A simulation with events, bodies, collisions and statistics."""

    KINDS: ClassVar[dict[str, int]] = {"step": 6, "add": 2, "motion": 1, "event": 1, "edit": 1, "restore": 1, "look": 2,
                                       "make": 1, "refuse": 2}

    def __init__(self, random: np.random.Generator) -> None:
        self.random, self.refused = random, 0
        self.make()

    def make(self) -> None:
        collisions = dc.CollisionOptions() if self.random.uniform() < 0.5 else None
        options = dc.SimulationOptions(dt=0.01, gravity=[0, 0, -9.81], response=dc.Reflect(0.7), collisions=collisions,
                                       patch_responses={"xmax": dc.Escape(), "xmin": dc.Slide()}, user_data=["heat"])
        self.simulation = dc.Simulation(dc.Environment(dc.generate_box(cells=[3, 3, 3], size=[1.0, 1.0, 1.0]), threads=2), options)
        statistics = dc.StatisticsOptions(hits=True, residence=True, pathlines_every=3)
        statistics.planes = [dc.records.SectionPlane("middle", [0.5, 0.5, 0.5], [1.0, 0.0, 0.0])]
        self.simulation.set_statistics(statistics)
        self.simulation.set_after_edit(lambda environment: environment.map.cells())
        self.simulation.add_inlet(self.simulation.environment.map.patch("xmin"), 20.0, [1.0, 0.0, 0.0], 0.01)
        self.saved = self.simulation.checkpoint()

    def add(self) -> None:
        kind = self.random.integers(3)
        x = self.random.uniform(0.1, 0.9, (5, 3))
        if len(self.simulation.particles) > 100:
            self.make()
        if kind == 0:
            self.simulation.add(x, self.random.normal(size=(5, 3)), np.full(5, 0.01), [1.0])
        elif kind == 1:
            self.simulation.add_random(3, self.random.normal(size=3))
        elif self.simulation.bodies is None or len(self.simulation.bodies) < 3:
            self.simulation.add_body(0.2 * x + 0.4, dc.BodyOptions(mass=1.0, radius=0.01))

    def step(self) -> None:
        report = self.simulation.step()
        assert len(report.contacts) == len(report.contact_ids)

    def motion(self) -> None:
        rest = self.simulation.environment.positions.copy()
        kind = self.random.integers(3)
        if kind == 0:
            self.simulation.set_force(dc.VectorField(self.simulation.environment.complex, -rest))
        elif kind == 1 and not self.simulation.deforms:
            wave = dc.DeformationStep(kind="twist", amplitude=0.05, period=0.2, centre=[0.5, 0.5, 0.5])
            self.simulation.set_deformation(dc.Deformation([wave], rest))
        else:
            self.simulation.pull(self.random.normal(0.0, 0.002, rest.shape), 0.05)

    def event(self) -> None:
        if self.simulation.environment.map.cell_count() > MAX_CELLS:
            self.make()
        plane = dc.topology.plane_through(self.random.uniform(0.3, 0.7, 3), self.random.normal(size=3))
        low = self.random.uniform(0.1, 0.5, 3)
        what = [dc.records.Cut(plane, 0.02), dc.records.Carve(dc.topology.box_tool(low, low + 0.3), "open", bool(self.random.integers(2))),
                dc.records.Ligature(plane, list(low), dc.topology.TyingOptions(0.1, 0.5), 0.05)][self.random.integers(3)]
        event = dc.records.Event(self.simulation.time, what, POLICIES[self.random.integers(len(POLICIES))])
        try:
            if self.random.integers(2):
                dc.records.apply(self.simulation, event)
            else:
                self.simulation.set_events([event])
                self.simulation.step()
        except dc.Error:
            self.refused += 1
            self.simulation.set_events([])
        self.saved = self.simulation.checkpoint()

    def edit(self) -> None:
        if self.simulation.environment.map.cell_count() > MAX_CELLS:
            self.make()
        try:
            self.simulation.edit(change(self.random), POLICIES[self.random.integers(len(POLICIES))])
        except (dc.EditRefused, KeyError):
            self.refused += 1
        self.saved = self.simulation.checkpoint()

    def restore(self) -> None:
        try:
            self.simulation.restore(self.saved)
        except dc.Error:  # edits must be repeated, but there are particles
            self.refused += 1

    def look(self) -> None:
        simulation = self.simulation
        assert len(simulation.positions) == len(simulation.ids) == len(simulation.statuses) == len(simulation.held)
        simulation.statistics.hits.faces(), simulation.event_log, simulation.energy(), simulation.state_hash().hex()
        self.check()

    def refuse(self) -> None:
        bad: list[Callable[[], object]] = [
            lambda: self.simulation.add(np.full((2, 3), np.nan), [0, 0, 0]), lambda: self.simulation.catheter(0),
            lambda: self.simulation.user_data(10**6), lambda: self.simulation.pull(np.zeros((2, 3)), 1.0),
            lambda: self.simulation.environment.move(np.zeros((2, 3))),
            lambda: dc.Simulation(self.simulation.environment),
            lambda: self.simulation.add_inlet(1, -1.0, [0, 0, 0])]
        wrong(self, bad[self.random.integers(len(bad))])

    def check(self) -> None:
        assert self.simulation.audit().failed == 0


WORLDS = [SurfaceCalls, BodyCalls, CatheterCalls, SimulationCalls]
