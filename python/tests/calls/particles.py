"""Sets of particles, states, responses, audits, spheres and trajectories."""
from __future__ import annotations

import copy
import pickle

import numpy as np

import dartcast as dc

from . import Calls, refused
from .environments import answers, raising
from .scenes import COUNT, with_particles


def of_sets() -> Calls:
    _, particles = with_particles()
    marks, order = np.arange(COUNT) < 3, np.arange(COUNT)[::-1].copy()
    some = particles.selected([0, 2])
    return {
        "Particles": dc.Particles, "Particles.__len__": lambda: len(particles), "Particles.copy": particles.copy,
        "Particles: of states": lambda: dc.Particles(particles.states, particles.held_weights()),
        "Particles: refused": refused(lambda: dc.Particles(particles.states[:3], particles.held_weights())),
        "Particles.__repr__": lambda: (repr(particles), particles._repr_html_()),
        "Particles.__reduce__": lambda: pickle.loads(pickle.dumps(particles)),
        "Particles.__iter__": lambda: list(particles), "Particles.__getitem__: some": lambda: particles[1:4],
        "Particles.__getitem__": lambda: particles[3], "Particles.__getitem__: refused": refused(lambda: particles[99]),
        "Particles.__copy__": lambda: copy.copy(particles), "Particles.__deepcopy__": lambda: copy.deepcopy(particles),
        "Particles.held_weights": particles.held_weights,
        "Particles.held_weights: one": lambda: particles.held_weights(3),
        "Particles.held_weights: refused": refused(lambda: particles.held_weights(99)),
        "Particles.remove": lambda: particles.copy().remove(marks),
        "Particles.truncate": lambda: particles.copy().truncate(2),
        "Particles.remove: refused": refused(lambda: particles.remove(marks[1:])),
        "Particles.reorder": lambda: particles.reorder(order),
        "Particles.reorder: refused": refused(lambda: particles.reorder([0, 0])),
        "Particles.selected": lambda: particles.selected(np.array([0, 2])),
        "Particles.selected: refused": refused(lambda: particles.selected([99])),
        "Particles.replace": lambda: particles.replace([0, 2], some),
        "Particles.replace: refused": refused(lambda: particles.replace([0], some)),
    }


def of_states() -> Calls:
    env, particles = with_particles()
    m = env.map
    state = particles[0]
    corners = env.complex.corners(state.at())
    return {
        "forecast": lambda: dc.topology.forecast(m, state, corners),
        "forecast: refused": refused(lambda: dc.topology.forecast(m, dc.topology.ParticleState(), corners)),
        "placement": lambda: dc.topology.placement(m, state.at(), corners, [0.5, 0.5, 0.5]),
        "placement: refused": refused(lambda: dc.topology.placement(m, (12345, 0), corners, [0, 0, 0])),
        "ParticleState.at": state.at, "ParticleState.put": lambda: dc.topology.ParticleState().put((3, 2), [1, 2, 3]),
        "StepOptions.check": dc.records.StepOptions().check,
        "StepOptions.check: refused": refused(dc.records.StepOptions(max_slices=0).check),
        "check_threads": lambda: dc.records.check_threads(1),
        "check_threads: refused": refused(lambda: dc.records.check_threads(10**6)),
        "max_threads": dc.records.max_threads, "is_radius": lambda: dc.predicates.is_radius(1.0), "is_mass": lambda: dc.predicates.is_mass(1.0),
        "RigidMover.velocity_at": lambda: dc.predicates.RigidMover(turns=True).velocity_at([2.0, 0, 0]),
        "RigidMotion.velocity_at": lambda: dc.records.RigidMotion().velocity_at([2.0, 0, 0]),
    }


def of_audits() -> Calls:
    env, particles = with_particles()
    ids, v = np.arange(COUNT), np.zeros((COUNT, 3))
    h, other = dc.records.StateHash((1, 2)), dc.records.StateHash((1, 2))

    def sum_of(a: object, b: object) -> None:
        a += b

    return {
        "audit": lambda: dc.audit(env.complex, particles, threads=1),
        "audit: refused": refused(lambda: dc.audit(env.complex, particles, threads=10**6)),
        "Audit.__iadd__": lambda: sum_of(dc.records.Audit(1, 1, "a long text on what is wrong"), dc.records.Audit(1, 1, "another")),
        "Counters.__iadd__": lambda: sum_of(dc.records.Counters(particle_steps=2), dc.records.Counters()),
        "CollisionCounts.__iadd__": lambda: sum_of(dc.predicates.CollisionCounts(), dc.predicates.CollisionCounts()),
        "StateHash": dc.records.StateHash, "StateHash: words": lambda: dc.records.StateHash((1, 2)),
        "StateHash.add": lambda: dc.records.StateHash().add(ids, particles, v),
        "StateHash.add: one": lambda: dc.records.StateHash().add(3, particles[3], [0, 0, 0]),
        "StateHash.add: refused": refused(lambda: h.add(ids[1:], particles, v)),
        "StateHash.__iadd__": lambda: sum_of(dc.records.StateHash(), h), "StateHash.__eq__": lambda: h == other,
        "StateHash.__copy__": lambda: copy.copy(h), "StateHash.hex": h.hex, "StateHash.__repr__": lambda: repr(h),
    }


def of_responses() -> Calls:
    env, particles = with_particles()
    v, statuses = np.ones((COUNT, 3)), np.zeros(COUNT, np.uint8)
    report = env.advance(particles, particles.positions + 5.0, options=dc.records.StepOptions(max_contacts=1))
    walls = report.walls_of(0)
    responses = dc.records.WallResponses({None: dc.Slide(), "zmax": dc.Reflect(0.25)}, env.map)
    contact = dc.topology.SurfaceContact(normal=[0, 0, 1])
    return {
        "WallResponses": lambda: dc.records.WallResponses({None: dc.Slide(), "zmax": dc.Reflect(0.25)}, env.map),
        "WallResponses: refused": refused(lambda: dc.records.WallResponses({"zmax": dc.Slide()})),
        "WallResponses.set": lambda: responses.set(1, dc.Stick()), "WallResponses.of": lambda: responses.of(1),
        "WallResponses.set: refused": refused(lambda: responses.set(1, 5)),
        "respond_with": lambda: dc.respond_with(dc.Stick(), v, statuses, 0.1),
        "respond_with: refused": refused(lambda: dc.respond_with(dc.Stick(), v, statuses, 0.0)),
        "hold_stopped": lambda: dc.records.hold_stopped(report, dc.Reflect(), v, None, 0.1),
        "hold_stopped: refused": refused(lambda: dc.records.hold_stopped(report, dc.Reflect(), v[1:], None, 0.1)),
        "reflected": lambda: dc.reflected([1, 0, 2], walls, 0.5, 0.1), "slid": lambda: dc.slid([1, 0, 2], walls, walls),
        "reflected: surface": lambda: dc.reflected(contact, [1, 0, 2], 0.5),
        "slid: surface": lambda: dc.slid(contact, [1, 0, 2]),
        "reflected: refused": refused(lambda: dc.reflected("x", walls, 0.5, 0.1)),
        "StepReport.walls_of": lambda: report.walls_of(0),
        "StepReport.__repr__": lambda: (repr(report), report._repr_html_()),
        "StepReport.earlier_walls_of": lambda: report.earlier_walls_of(0),
        "StepReport.walls_of: refused": refused(lambda: report.walls_of(99)),
    }


def of_spheres() -> Calls:
    env, particles = with_particles()
    saved, which = particles.copy(), np.arange(COUNT)
    targets = particles.positions + np.random.default_rng(2).normal(0.0, 1.0, (COUNT, 3))
    radii, stepper = np.full(COUNT, 0.05), dc.SphereStepper()

    def advance(options: dict[str, object], f: object) -> None:
        f(env, particles, radii, targets, **options)
        particles.replace(which, saved)

    table: Calls = {"SphereStepper": dc.SphereStepper}
    for name, options in answers().items():
        if not name.startswith("rounds"):
            table[f"advance_spheres: {name}"] = lambda o=options: advance(o, dc.advance_spheres)
            table[f"SphereStepper.advance: {name}"] = lambda o=options: advance(o, stepper.advance)
    table |= of_points_among_moving_walls()
    wrong = {"respond": raising, "per_contact": True}
    table["SphereStepper.advance: raised"] = refused(lambda: advance(wrong, stepper.advance))
    table["advance_spheres: refused"] = refused(lambda: dc.advance_spheres(env, particles, radii[1:], targets))
    return table


def of_points_among_moving_walls() -> Calls:
    env, particles = with_particles()
    targets, stepper = particles.positions, dc.SimultaneousStepper()

    def advance(options: dict[str, object]) -> None:
        env.move(np.array(env.positions))
        stepper.advance(env, particles, targets, **options)

    table: Calls = {"SimultaneousStepper": dc.SimultaneousStepper}
    for name, options in answers().items():
        if not name.startswith("rounds"):
            table[f"SimultaneousStepper.advance: {name}"] = lambda o=options: advance(o)
    table["SimultaneousStepper.advance: refused"] = refused(
        lambda: stepper.advance(env, particles, targets[1:]))
    return table


def of_trajectories() -> Calls:
    plane = dc.Environment(dc.generate_rectangle(cells=[4, 4], size=[1.0, 1.0]), threads=1)
    particles, _ = plane.add(np.array([[0.1, 0.15, 0.0]]))
    traces = plane.trace(particles, 0, np.array([[0.8, 0.85, 0.0], [1.4, 0.85, 0.0]]))
    trace = traces[1]
    return {
        "trajectory_points": lambda: dc.formats.trajectory_points(traces),
        "trajectory_csv": lambda: dc.formats.trajectory_csv(plane.map, traces),
        "trajectory_svg": lambda: dc.formats.trajectory_svg(plane.complex, traces),
        "trajectory_svg: refused": refused(lambda: dc.formats.trajectory_svg(plane.complex, [])),
        "Trace.walls_of": lambda: trace.walls_of(0), "Trace.earlier_walls_of": lambda: trace.earlier_walls_of(0),
        "Trace.walls_of: refused": refused(lambda: trace.walls_of(99)),
    }


def calls() -> Calls:
    return of_sets() | of_states() | of_audits() | of_responses() | of_spheres() | of_trajectories()
