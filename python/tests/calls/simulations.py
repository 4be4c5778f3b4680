"""Simulations, events, statistics, scenes and runs."""
from __future__ import annotations

from collections.abc import Callable

import numpy as np

import dartcast as dc

from . import Calls, refused
from .environments import fail, raising
from .scenes import BODY, COUNT, FOLDER, environment, first, simulation, tube

SCENE = {
    "seed": 3, "environment": {"generator": "box", "cells": [3, 3, 3]},
    "particles": [{"count": COUNT, "velocity": [20.0, 3.0, 10.0]}],
    "motion": {"dt": 0.1, "steps": 3}, "contact": {"response": "reflect", "restitution": 0.9},
}


def changed(change: Callable[[dc.Simulation], object], **options: object) -> Callable[[], None]:
    """A change of a simulation that is made for it, and a step after it."""
    def call() -> None:
        own = simulation(**options)
        change(own)
        own.step()
    return call


def of_making() -> Calls:
    env = environment()
    scene = dc.load_scene(SCENE, threads=1)
    loaded = dc.Simulation(scene, threads=1)
    loaded.step()
    saved = loaded.checkpoint()
    busy = simulation()
    return {
        "Simulation": lambda: dc.Simulation(env, dc.SimulationOptions(dt=0.1, patch_responses={"xmin": dc.Stick()})),
        "Simulation: scene": lambda: dc.Simulation(scene, threads=1),
        "Simulation: checkpoint": lambda: dc.Simulation(scene, saved, threads=1, after_edit=lambda e: None),
        "Simulation: refused": refused(lambda: dc.Simulation(busy.environment)),
        "Simulation: options refused": refused(lambda: dc.Simulation(env, dc.SimulationOptions(dt=-1.0))),
        "Simulation: scene refused": refused(lambda: dc.Simulation(dc.formats.Scene(), threads=1)),
    }


def of_adding() -> Calls:
    x = np.full((3, 3), 0.4)
    catheter = dc.formats.CatheterScene("tool", dc.CatheterOptions(length=0.02, spacing=2e-3, entry=[0.0, 0.0, 1e-3],
                                                           direction=[0.0, 0.0, 1.0]))
    catheter.moves = [dc.formats.CatheterScene.Move(until=1.0, push=1e-3)]
    body = dc.formats.BodyScene("stone", dc.generate_barrel(staves=6, rows=3, rings=1), scale=0.3, at=[0.5, 0.5, 0.5],
                        sampling=dc.records.SamplingOptions(spacing=0.1))
    own = simulation()
    inlet = own.environment.map.patch("xmin")

    def add_catheter() -> None:
        made = dc.Simulation(tube(), dc.SimulationOptions(dt=0.1))
        made.add(catheter)
        made.steer(0, dc.CatheterInput(push=1e-4, turn=0.1))
        made.step()
        made.catheter(0).points()
        made.catheter_step(0)
        made.catheter_summaries()

    def add_solid() -> None:
        line = dc.formats.SolidScene("line", np.array([[0.4, 0.5, 0.5], [0.6, 0.5, 0.5]]))
        line.moves = [dc.formats.SolidScene.Move(until=1.0, velocity=[0.0, 0.0, 0.1])]
        made = simulation()
        made.add(line)
        made.steer_solid(0, [0.0, 0.1, 0.1])
        made.step()
        assert made.solids is not None and made.solids_step.made[0] == 1.0
        made.solids.audit()
        made.solid_summaries()

    def add_body() -> None:
        made = simulation()
        made.add_body(BODY, dc.BodyOptions(mass=2.0))
        made.add(body)
        made.step()
        made.bodies.velocities = made.bodies.velocities * 0.5
        made.body_summaries()

    return {
        "Simulation.__repr__": lambda: repr(own),
        "Simulation.add": changed(lambda s: s.add(x, [1.0, 0.0, 0.0], 0.01)),
        "Simulation.add: arrays": changed(
            lambda s: s.add(x, np.ones((3, 3)), np.full(3, 0.01), [1.0]), user_data=["heat"]),
        "Simulation.add: refused": refused(lambda: own.add(x, np.ones((2, 3)))),
        "Simulation.add: body": add_body, "Simulation.add_body": add_body, "Simulation.body_summaries": add_body,
        "Simulation.add: catheter": add_catheter, "Simulation.catheter": add_catheter,
        "Simulation.catheter_step": add_catheter, "Simulation.catheter_summaries": add_catheter,
        "Simulation.solid_summaries": add_solid,
        "Simulation.catheter: refused": refused(lambda: own.catheter(3)),
        "Simulation.add_body: refused": refused(lambda: own.add_body(BODY, dc.BodyOptions(mass=-1.0))),
        "Simulation.add_random": changed(lambda s: s.add_random(5, [1.0, 2.0, 3.0], 0.01)),
        "Simulation.add_random: refused": refused(lambda: own.add_random(5, [np.nan] * 3)),
        "Simulation.add_inlet": changed(lambda s: s.add_inlet(inlet, 100.0, [1.0, 0.0, 0.0])),
        "Simulation.add_inlet: refused": refused(lambda: own.add_inlet(inlet, -1.0, [1.0, 0.0, 0.0])),
    }


def of_motion() -> Calls:
    own = simulation()
    n = len(own.environment.positions)
    pull = np.zeros((n, 3))

    def with_field(set_it: Callable[[dc.Simulation, dc.VectorField], None]) -> Callable[[], None]:
        def change(s: dc.Simulation) -> None:
            set_it(s, dc.VectorField(s.environment.complex, s.environment.positions.copy()))
        return changed(change, drag=1.0)

    def deform(s: dc.Simulation) -> None:
        step = dc.DeformationStep(kind="twist", amplitude=0.1)
        s.set_deformation(dc.Deformation([step], s.environment.positions.copy()))

    def read_frames(s: dc.Simulation) -> None:
        rest = s.environment.positions.copy()
        step = dc.DeformationStep(kind="frames", times=[0.0, 1.0, 2.0], reader=lambda k: rest * (1.0 + 0.1 * k))
        s.set_deformation(dc.Deformation([step], rest))

    other = dc.VectorField(environment().complex, np.zeros((n, 3)))
    return {
        "Simulation.set_field": with_field(lambda s, f: s.set_field(f)),
        "Simulation.set_force": with_field(lambda s, f: s.set_force(f)),
        "Simulation.set_field: refused": refused(lambda: own.set_field(other)),
        "Simulation.set_force: refused": refused(lambda: own.set_force(other)),
        "Simulation.set_deformation": changed(deform), "Simulation.set_deformation: frames": changed(read_frames),
        "Simulation.set_deformation: refused": refused(
            lambda: own.set_deformation(dc.Deformation([], np.zeros((3, 3))))),
        "Simulation.pull": changed(lambda s: s.pull(pull, 0.2)),
        "Simulation.pull: refused": refused(lambda: own.pull(pull[1:], 0.2)),
        "Simulation.steer: refused": refused(lambda: own.steer(0, dc.CatheterInput(push=1e-3))),
        "Simulation.steer_solid: refused": refused(lambda: own.steer_solid(0, [0.0, 0.0, 1.0])),
        "pull_around": lambda: dc.pull_around(own.environment.positions, [0.4] * 3, [0.0, 0.0, 0.1], 0.3),
        "pull_around: refused": refused(lambda: dc.pull_around(own.environment.positions, [0.4] * 3, [0.0, 0.0, 0.1], 0.0)),
    }


def of_changes() -> Calls:
    own = simulation()
    cut = dc.records.Cut(dc.topology.plane_through([0.3, 0.3, 0.3], [0.0, 0.0, 1.0]), 0.05)
    events = [dc.records.Event(0.0, cut), dc.records.Event(0.1, dc.records.Carve(dc.topology.box_tool([0.1] * 3, [0.4] * 3), "open"), "absorb")]
    tied = dc.records.Event(0.0, dc.records.Ligature(cut.surface, [0.3, 0.3, 0.3], dc.topology.TyingOptions(0.2, 0.5), 0.3))
    crowded = dc.formats.AdaptiveSubdivisionScene(1, dc.records.AdaptiveSubdivisionOptions(max_particles=1, min_particles=0))

    def follow(s: dc.Simulation) -> None:
        s.set_after_edit(lambda env: env.map.cells())
        s.set_events(events)
        s.step()
        s.event_log

    def raise_after_edit(s: dc.Simulation) -> None:
        s.set_after_edit(raising)
        s.set_events(events)
        refused(s.step)()
        s.set_after_edit(None)

    return {
        "Simulation.set_events": changed(follow), "Simulation.set_after_edit": changed(follow),
        "Simulation.set_after_edit: raised": lambda: raise_after_edit(simulation()),
        "Simulation.set_after_edit: refused": refused(lambda: own.set_after_edit(3)),
        "Simulation.set_events: refused": refused(lambda: own.set_events([dc.records.Event(-1.0, cut)])),
        "Simulation.set_remeshing": changed(lambda s: s.set_remeshing(dc.formats.RemeshScene(every=1))),
        "Simulation.set_adaptive_subdivision": changed(lambda s: s.set_adaptive_subdivision(crowded)),
        "Simulation.adapt": changed(lambda s: (s.set_adaptive_subdivision(crowded), s.adapt())),
        "Simulation.edit": changed(lambda s: s.edit(lambda edit: dc.topology.subdivide(edit, first(edit.map)))),
        "Simulation.edit: raised": refused(lambda: own.edit(fail)),
        "Simulation.edit: refused": refused(lambda: own.edit(3)), "Simulation.repair": own.repair,
        "apply": changed(lambda s: dc.records.apply(s, dc.records.Event(0.0, cut))),
        "apply: ligature": changed(lambda s: dc.records.apply(s, tied)),
        "apply: refused": refused(lambda: dc.records.apply(own, dc.records.Event(0.0, dc.records.Cut(dc.topology.Plane([0, 0, 0]), 0.1)))),
        "kind_of": lambda: dc.records.kind_of(events[0]),
    }


def of_states() -> Calls:
    own = simulation(user_data=["heat"])
    saved = own.checkpoint()

    def step() -> None:
        own.step()
        own.restore(saved)

    def go_to() -> None:
        made = dc.Simulation(environment(), dc.SimulationOptions(dt=0.1))
        made.go_to(3)

    def spheres(s: dc.Simulation) -> None:
        s.add_random(5, [1.0, 2.0, 3.0], 0.05)
        s.step()

    return {
        "Simulation.step": step, "Simulation.restore": step, "Simulation.checkpoint": own.checkpoint,
        "Simulation.step: spheres": changed(spheres, collisions=dc.CollisionOptions()),
        "Simulation.go_to": go_to, "Simulation.go_to: refused": refused(lambda: own.go_to(3)),
        "Simulation.restore: refused": refused(lambda: own.restore(3)),
        "Simulation.user_data": lambda: own.user_data(3),
        "Simulation.set_user_data": lambda: own.set_user_data(3, [1.0]),
        "Simulation.user_data: refused": refused(lambda: own.user_data(99)),
        "Simulation.set_user_data: refused": refused(lambda: own.set_user_data(3, [1.0, 2.0])),
        "Simulation.energy": own.energy, "Simulation.unwrapped": own.unwrapped,
        "Simulation.audit": own.audit, "Simulation.state_hash": own.state_hash,
        "Simulation.totals_of_all": own.totals_of_all, "Simulation.alive": own.alive,
    }


def of_forces() -> Calls:
    drop = dc.records.Material(1e-4, 1000.0, 2.0)
    forces = dc.records.ForceOptions([dc.records.Force.PUTNAM, dc.records.Force.LORENTZ, dc.records.Force.BROWNIAN],
                                     dc.records.Fluid(1.2, 1.8e-5, 0.0, 293.0))
    own = dc.Simulation(environment(), dc.SimulationOptions(dt=0.1, forces=forces, diffusion=1e-6))
    own.add([[0.4, 0.4, 0.4]], [0.0, 0.0, 0.0], material=drop)
    arrays = {"LawParticles": "ids positions velocities diameters densities charges_per_mass user_data time",
              "LawSamples": "velocities gradients rates", "LawResult": "accelerations rates rotations"}

    def by_law() -> None:
        made = simulation()

        def law(*given: object) -> None:
            for part, names in zip(given, arrays.values()):
                for name in names.split():
                    getattr(part, name)

        made.set_law(law)
        made.step()
        made.set_law(None)

    def raise_in_law(s: dc.Simulation) -> None:
        s.set_law(raising)
        refused(s.step)()

    return {
        "Simulation.set_law": by_law, "Simulation.set_law: refused": refused(lambda: own.set_law(3)),
        "Simulation.set_law: raised": lambda: raise_in_law(simulation()),
        "Simulation.diameters": lambda: own.diameters, "Simulation.densities": lambda: own.densities,
        "Simulation.charges_per_mass": lambda: own.charges_per_mass,
        "Simulation.add: material": refused(lambda: own.add([[0.4, 0.4, 0.4]], [0.0] * 3, material=[[0.0] * 3])),
        **{name: refused(getattr(dc.records, name)) for name in arrays},
        **{f"{part}.{name}": by_law for part, names in arrays.items() for name in names.split()},
    }


def of_statistics() -> Calls:
    plane = dc.records.SectionPlane("middle", [0.5, 0.5, 0.5], [0.0, 0.0, 1.0])
    options = dc.StatisticsOptions(hits=True, residence=True, pathlines_every=2, cells=["visits"])
    options.planes = [plane]
    before, after = np.random.default_rng(1).uniform(0, 1, (2, 50, 3))
    own = simulation()
    own.set_statistics(options)
    report, env = own.step().report, own.environment
    hits, points = own.statistics.hits, own.statistics.path_points
    faces, ended = hits.faces(), hits.ended_by_patch()
    edited = environment()
    edited.edit(lambda edit: dc.topology.subdivide(edit, first(edit.map)))
    broken = faces.copy()
    broken["cell"] = 77
    return {
        "Simulation.set_statistics": changed(lambda s: s.set_statistics(options)),
        "Simulation.set_statistics: refused": refused(lambda: own.set_statistics(
            dc.StatisticsOptions(planes=[dc.records.SectionPlane("no name")]))),
        "find_crossings": lambda: dc.records.find_crossings([plane], before, after, threads=1),
        "find_crossings: refused": refused(lambda: dc.records.find_crossings([plane], before, after[1:], threads=1)),
        "Simulation.cell_arrays": own.cell_arrays, "cell_quantities": dc.records.cell_quantities,
        "check_cell_quantities": lambda: dc.records.check_cell_quantities(["visits"]),
        "check_cell_quantities: refused": refused(lambda: dc.records.check_cell_quantities(["visit"])),
        "WallHits": dc.WallHits, "WallHits.add": lambda: dc.WallHits().add(env, report),
        "WallHits.add: refused": refused(lambda: dc.WallHits().add(environment(1), report)),
        "WallHits.update_after_edit": lambda: dc.WallHits().update_after_edit(edited),
        "WallHits.of": lambda: hits.of((int(faces["cell"][0]), int(faces["face"][0]))), "WallHits.faces": hits.faces,
        "WallHits.ended_by_patch": hits.ended_by_patch, "WallHits.by_patch": lambda: hits.by_patch(env),
        "WallHits.restore": lambda: dc.WallHits().restore(env, faces, ended),
        "WallHits.restore: refused": refused(lambda: dc.WallHits().restore(env, broken, ended)),
        "ResidenceTimes.mean": dc.records.ResidenceTimes().mean, "StatisticsOptions.any": options.any,
        "StatisticsOptions.pathlines": options.pathlines,
        "write_wall_hits": lambda: dc.formats.write_wall_hits(env, hits, FOLDER / "hits.vtp"),
        "write_wall_hits: refused": refused(lambda: dc.formats.write_wall_hits(env, hits, FOLDER / "none" / "hits.vtp")),
        "write_pathlines": lambda: dc.formats.write_pathlines(points, FOLDER / "pathlines.vtp"),
        "write_pathlines: refused": refused(lambda: dc.formats.write_pathlines(faces, FOLDER / "pathlines.vtp")),
    }


def of_scenes() -> Calls:
    text = dc.scene_text(SCENE)
    file = FOLDER / "scene.toml"
    file.write_text(text, encoding="utf-8")
    scene = dc.formats.parse_scene(text, file)
    return {
        "scene_text": lambda: dc.scene_text(SCENE),
        "scene_text: refused": refused(lambda: dc.scene_text({"a": object()})),
        "parse_scene": lambda: dc.formats.parse_scene(text, file),
        "parse_scene: refused": refused(lambda: dc.formats.parse_scene("seed = 'three'", file)),
        "parse_scene: no TOML": refused(lambda: dc.formats.parse_scene("[environment", file)),
        "read_scene": lambda: dc.formats.read_scene(file),
        "read_scene: refused": refused(lambda: dc.formats.read_scene(FOLDER / "none.toml")),
        "load_scene": lambda: dc.load_scene(SCENE, threads=1),
        "load_scene: file": lambda: dc.load_scene(file, threads=1),
        "load_scene: refused": refused(lambda: dc.load_scene({"environment": {"sice": 3}}, threads=1)),
        "load_scene_files": lambda: dc.formats.load_scene_files(scene, threads=1),
    }


def of_runs() -> Calls:
    scene = dc.load_scene(SCENE, threads=1)
    options = dc.formats.RunOptions(threads=1)
    summary = dc.run(SCENE, threads=1)
    out = FOLDER / "out"
    shown = FOLDER / "shown"
    dc.run(SCENE, shown, threads=1)
    few = dc.formats.ReportOptions(particles=2, frames=2)
    return {
        "write_lagrangian": refused(lambda: dc.formats.write_lagrangian(shown, FOLDER / "none")),
        "write_sources": refused(lambda: dc.formats.write_sources(shown, FOLDER / "none")),
        "write_report": lambda: dc.formats.write_report(shown, few),
        "write_report: refused": refused(lambda: dc.formats.write_report(FOLDER / "none")),
        "report_file": lambda: dc.formats.report_file(shown),
        "run_scene": lambda: dc.formats.run_scene(scene, options), "run": lambda: dc.run(SCENE, threads=1, audit=True),
        "run: folder": lambda: dc.run(SCENE, out, threads=1),
        "run: cancelled": lambda: dc.run(SCENE, threads=1, progress=lambda done, all_: done < 2),
        "run: raised": refused(lambda: dc.run(SCENE, threads=1, progress=raising)),
        "run: refused": refused(lambda: dc.run(dc.formats.Scene(), threads=1)),
        "summary_json": lambda: dc.formats.summary_json(summary), "summary_text": lambda: dc.formats.summary_text(summary),
        "histogram_text": lambda: dc.formats.histogram_text(summary), "version": dc.formats.version,
    }


def calls() -> Calls:
    return (of_making() | of_adding() | of_motion() | of_changes() | of_states() | of_forces() | of_statistics()
            | of_scenes() | of_runs())
