"""Environments: places, moves, edits, steps with every kind of answer, traces."""
from __future__ import annotations

from collections.abc import Callable

import numpy as np

import dartcast as dc

from . import Calls, refused
from .scenes import COUNT, OneRank, box, environment, first, with_particles


def of_making() -> Calls:
    mesh = box()
    mesh.regions = np.arange(27) % 2 + 1
    env, particles = with_particles()
    x = np.random.default_rng(1).uniform(-0.2, 1.2, (20, 3))
    state = particles[0]
    states, weights = particles.states, particles.held_weights()
    broken = states.copy()
    broken["cell"][3] = 77

    return {
        "Environment": lambda: dc.Environment(mesh, threads=1),
        "Environment: free": lambda: dc.Environment(mesh, threads=1, free=["1"]),
        "Environment: refused": refused(lambda: dc.Environment(mesh, threads=1, free=["bone"])),
        "Environment.__repr__": lambda: (repr(env), env._repr_html_()),
        "Environment.locate": lambda: env.locate([0.25, 0.25, 0.25]), "Environment.locate: many": lambda: env.locate(x),
        "Environment.locate: refused": refused(lambda: env.locate([np.nan, 0.0, 0.0])),
        "Environment.cast_rays": lambda: env.cast_rays(x, x), "Environment.cast_rays: cells": lambda: env.cast_rays(
            x, x, 0.5, cells=True),
        "Environment.cast_rays: lengths": lambda: env.cast_rays(x, x, 0.5, lengths=True),
        "Environment.cast_rays: refused": refused(lambda: env.cast_rays(x, np.zeros_like(x))),
        "Environment.validity": env.validity, "Environment.awaits_advance": lambda: env.awaits_advance(particles),
        "Environment.check_advance": lambda: env.check_advance(particles),
        "Environment.check_advance: refused": refused(
            lambda: env.check_advance(particles, dc.records.StepOptions(max_slices=0))),
        "Environment.add": lambda: env.add(x), "Environment.add: one": lambda: env.add(
            dc.Particles(), state.at(), state.position),
        "Environment.add: set": lambda: env.add(dc.Particles(), x),
        "Environment.add: refused": refused(lambda: env.add(particles, np.zeros((3, 2)))),
        "Environment.add_at": lambda: env.add_at(dc.Particles(), state.at(), [0.25] * 4),
        "Environment.add_random": lambda: env.add_random(COUNT, seed=3),
        "Environment.restored": lambda: env.restored(states, weights),
        "Environment.restored: refused": refused(lambda: env.restored(broken, weights)),
    }


def of_tallies() -> Calls:
    env, particles = with_particles()
    tally, other = dc.CellTally(env, amounts=1), dc.CellTally(environment())
    env.set_tally(tally)
    env.advance(particles, particles.positions + [0.1, 0.2, 0.1])
    cell = int(particles[0].cell)
    return {
        "CellTally": lambda: dc.CellTally(env), "CellTally.track_length": tally.track_length,
        "CellTally.residence": tally.residence, "CellTally.visits": tally.visits, "CellTally.deposited": tally.deposited,
        "CellTally.path_length": tally.path_length, "CellTally.age": tally.age, "CellTally.adds_up": tally.adds_up,
        "CellTally.take_back": lambda: tally.take_back(cell, 0.0), "CellTally.deposit": lambda: tally.deposit(cell),
        "CellTally.amount": lambda: tally.amount(0), "CellTally.amount: refused": refused(lambda: tally.amount(1)),
        "CellTally.whole_amount": lambda: tally.whole_amount(0),
        "CellTally.whole_amount: refused": refused(lambda: tally.whole_amount(1)),
        "CellTally.take_back_amounts": lambda: tally.take_back_amounts(cell, [0.0]),
        "CellTally.take_back_amounts: refused": refused(lambda: tally.take_back_amounts(cell, [])),
        "CellTally.visits: refused": refused(lambda: tally.visits(1)),
        "CellTally.take_back: refused": refused(lambda: tally.take_back(99999, 0.0)),
        "CellTally.deposit: refused": refused(lambda: tally.deposit(99999)),
        "CellTally.update_after_edit": dc.CellTally(env).update_after_edit, "CellTally.reset": dc.CellTally(env).reset,
        "Environment.set_tally": lambda: env.set_tally(None), "Environment.set_tally: refused": refused(
            lambda: env.set_tally(other)),
    }


def of_moves() -> Calls:
    env, replaced = environment(), environment()
    rest = env.positions.copy()
    later, folded = rest + [0.1, 0.0, 0.0], rest.copy()
    folded[21] += [2.0, 0.0, 0.0]

    def next_points() -> None:
        for points in (later, rest):
            with env.next_points() as x:
                x[:] = points

    def leave_next_points() -> None:
        with env.next_points() as x:
            x[0] = 7.0
            raise KeyError("out of the block")

    return {
        "Environment.move": lambda: (env.move(later), env.move(rest)),
        "Environment.move: refused": refused(lambda: env.move(rest[1:])),
        "Environment.next_points": next_points, "NextPoints.__enter__": next_points, "NextPoints.__exit__": next_points,
        "NextPoints.__exit__: raised": refused(leave_next_points), "Environment.next_points: unused": env.next_points,
        "Environment.first_inversion": lambda: env.first_inversion(folded),
        "Environment.first_inversion: none": lambda: env.first_inversion(later),
        "Environment.first_inversion: refused": refused(lambda: env.first_inversion(rest[1:])),
        "Environment.replace": lambda: replaced.replace(dc.generate_box(cells=[3, 3, 3])),
        "Environment.replace: refused": refused(lambda: replaced.replace(dc.generate_rectangle(cells=[2, 2]))),
        "Environment.move_until_inverted": lambda: (env.move_until_inverted(folded, 0.5), env.move(rest)),
        "Environment.move_until_inverted: refused": refused(lambda: env.move_until_inverted(rest, np.nan)),
    }


def fail(edit: dc.topology.ComplexEdit) -> None:
    dc.topology.remove(edit.topology, first(edit.map))
    raise KeyError("out of the edit")


def of_edits() -> Calls:
    marked, marking = with_particles()
    env, particles = with_particles()
    refusing = environment()
    subdividing, inside = with_particles()

    cell = marking[0].cell

    def mark() -> None:
        for free in (False, True):
            marked.edit(lambda edit: edit.topology.set_free(cell, free))
            marked.update_after_edit(marking, "hold")

    def subdivide() -> None:
        made: list[dc.topology.Subdivision] = []
        report = subdividing.edit(lambda edit: made.append(dc.topology.subdivide(edit, first(edit.map)).subdivision))
        dc.topology.update_after_edit(subdividing.map, report.map.added, made[0])
        subdividing.update_after_edit(inside, "hold")
        subdividing.edit(lambda edit: dc.topology.coarsen(edit, made[0]))
        subdividing.update_after_edit(inside, "hold")

    def orphans() -> None:
        """In an environment of its own."""
        own = environment()
        own_particles = own.add_random(COUNT, seed=5)
        own.edit(lambda edit: [edit.topology.set_free(int(c), False) for c in edit.map.cells()[::2]])
        for policy in ("hold", "relocate", "absorb"):
            own.update_after_edit(own_particles.copy(), policy)

    return {
        "Environment.edit": mark, "Environment.edit: subdivide": subdivide,
        "Environment.edit: raised": refused(lambda: refusing.edit(fail)),
        "Environment.edit: refused": refused(lambda: refusing.edit(lambda edit: dc.topology.remove(edit.topology, 3))),
        "Environment.edit: no function": refused(lambda: refusing.edit(3)),
        "Environment.update_after_edit": orphans,
        "Environment.update_after_edit: nothing": lambda: env.update_after_edit(particles),
        "Environment.update_after_edit: refused": refused(lambda: env.update_after_edit(particles, "no policy")),
    }


def raising(*arguments: object) -> None:
    raise KeyError("out of the response")


def answers() -> dict[str, dict[str, object]]:
    """Keyword arguments of advance() for each kind of answer."""
    velocities = np.ones((COUNT, 3))
    by_library = {"velocities": velocities, "dt": 0.3, "statuses": np.zeros(COUNT, np.uint8)}
    table: dict[str, dict[str, object]] = {
        "none": {}, "rounds": {"respond": lambda contacts, walls: -0.5 * contacts["unused"]},
        "rounds, marks": {"respond": lambda c, walls: (-0.5 * c["unused"], np.zeros(len(c), dtype=bool))},
        "per contact": {"respond": lambda contact, walls, earlier: -contact.unused, "per_contact": True},
        "per contact, record": {"respond": lambda contact, walls, earlier: dc.records.AfterContact(-contact.unused),
                                "per_contact": True},
        "per contact, stop": {"respond": lambda contact, walls, earlier: None, "per_contact": True}}
    for response in (dc.Reflect(0.5, friction=0.1), dc.Slide(), dc.Stick(), dc.Absorb(), dc.Escape(),
                     dc.records.WallResponse("slide"), dc.records.WallResponses(dc.Slide())):
        table[repr(response)] = {"respond": response} | by_library
    table["by patch"] = {"respond": {None: dc.Reflect(0.9), "xmin": dc.Slide()}} | by_library
    table["acceleration"] = {"respond": dc.Reflect(), "acceleration": dc.records.Acceleration([0, 0, -1.0], 0.3)} | by_library
    return table


def wrong_answers() -> dict[str, dict[str, object]]:
    """Keyword arguments with which advance() is refused."""
    return {
        "raised in a round": {"respond": raising}, "raised per contact": {"respond": raising, "per_contact": True},
        "shape": {"respond": lambda contacts, walls: np.zeros((1, 2))},
        "type": {"respond": lambda contact, walls, earlier: "text", "per_contact": True},
        "no velocities": {"respond": dc.Reflect()}, "no response": {"respond": "slide"},
        "patch": {"respond": {"nowhere": dc.Slide()}, "velocities": np.zeros((COUNT, 3)), "dt": 1.0},
        "options": {"options": dc.records.StepOptions(max_slices=0)}}


def of_steps() -> Calls:
    env, particles = with_particles()
    targets = particles.positions + np.random.default_rng(2).normal(0.0, 1.0, (COUNT, 3))
    saved, which = particles.copy(), np.arange(COUNT)

    def step(options: dict[str, object]) -> Callable[[], None]:
        def call() -> None:
            env.advance(particles, targets, **options)
            particles.replace(which, saved)
        return call

    table: Calls = {"Environment.advance: " + name: step(options) for name, options in answers().items()}
    table |= {"Environment.trace: " + name: lambda o=options: env.trace(particles, 0, targets[:2], **o)
              for name, options in answers().items() if not name.startswith("rounds")}
    table |= {"Environment.advance: refused, " + name: refused(step(options))
              for name, options in wrong_answers().items()}
    table["Environment.advance: refused, targets"] = refused(lambda: env.advance(particles, targets[1:]))
    table["Environment.trace: refused"] = refused(lambda: env.trace(particles, COUNT, targets[:2]))
    table["Environment.trace: raised"] = refused(
        lambda: env.trace(particles, 0, particles.positions[:1] + 5.0, raising, per_contact=True))
    return table


def of_shared() -> Calls:
    part = dc.formats.box_part(dc.formats.BoxOptions(cells=[3, 3, 3], size=[1.0, 1.0, 1.0]), 1, 0)
    env = dc.SharedEnvironment(part, OneRank(), 1)
    particles = dc.SharedParticles(2)
    env.add(particles, np.full((5, 3), 0.4))
    grown = np.zeros((1, 3)) + 0.5

    def add() -> None:
        env.add(dc.SharedParticles(), grown)

    def advance(respond: object = None) -> None:
        env.move(env.positions)
        env.advance(particles, particles.positions + 0.25, respond)

    return {
        "SharedParticles": lambda: dc.SharedParticles(3), "SharedParticles: refused": refused(
            lambda: dc.SharedParticles(10**9)),
        "SharedParticles.__len__": lambda: len(particles),
        "SharedParticles.user_data": lambda: particles.user_data(1),
        "SharedParticles.user_data: refused": refused(lambda: particles.user_data(99)),
        "SharedParticles.set_user_data": lambda: particles.set_user_data(1, [1.0, 2.0]),
        "SharedParticles.set_user_data: refused": refused(lambda: particles.set_user_data(1, [1.0])),
        "SharedStep": lambda: dc.records.SharedStep(left=1),
        "SharedEnvironment": lambda: dc.SharedEnvironment(part, OneRank(), threads=1),
        "SharedEnvironment: refused": refused(lambda: dc.SharedEnvironment(
            dc.formats.box_part(dc.formats.BoxOptions(cells=[3, 3, 3], size=[1.0, 1.0, 1.0]), 2, 0), OneRank())),
        "SharedEnvironment.whole": lambda: env.whole(int(particles.cells[0])),
        "SharedEnvironment.whole: refused": refused(lambda: env.whole(10**6)),
        "SharedEnvironment.add": add,
        "SharedEnvironment.add: refused": refused(lambda: env.add(particles, grown[0])),
        "SharedEnvironment.move": advance,
        "SharedEnvironment.move: refused": refused(lambda: env.move(grown)),
        "SharedEnvironment.advance": advance,
        "SharedEnvironment.advance: function": lambda: advance(lambda contact, walls, earlier: None),
        "SharedEnvironment.advance: refused": refused(lambda: env.advance(particles, grown)),
        "SharedEnvironment.count": lambda: env.count(particles),
        "SharedEnvironment.audit": lambda: env.audit(particles),
    }


def calls() -> Calls:
    return of_shared() | of_making() | of_tallies() | of_moves() | of_edits() | of_steps()
