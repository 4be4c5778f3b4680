"""Particles on surfaces, bodies, catheters."""
from __future__ import annotations

import numpy as np

import dartcast as dc

from . import Calls, refused
from .environments import raising
from .scenes import BODY, bodies, catheter, environment, first, tube

WAYS = np.random.default_rng(3).normal(0.0, 0.3, (5, 3))


def barrel() -> dc.MeshData:
    return dc.generate_barrel(staves=8, rows=4, rings=2)


def of_surfaces() -> Calls:
    mesh, surface = barrel(), dc.topology.Surface(barrel())
    locator = dc.topology.SurfaceLocator(surface)
    x = np.array([[0.3, 0.01, 0.02], [0.0, 0.3, 0.1]])
    place = locator.nearest(surface, x[0]).place
    places, t = dc.topology.surface_places([place] * 5), place.triangle
    rest, face = surface.positions.copy(), first(surface.map)
    table: Calls = {}
    for name in ("vertices", "corners", "normal"):
        table[f"Surface.{name}"] = lambda f=getattr(surface, name): f(t)
        table[f"Surface.{name}: refused"] = refused(lambda f=getattr(surface, name): f((0xFFFFFF0, 0)))
    return table | {
        "Surface": lambda: dc.topology.Surface(mesh), "Surface: refused": refused(lambda: dc.topology.Surface(dc.MeshData())),
        "Surface.move": lambda: surface.move(rest, threads=1),
        "Surface.move: refused": refused(lambda: surface.move(rest[1:])),
        "Surface.set_free": lambda: (surface.set_free(face, False), surface.set_free(face, True)),
        "Surface.set_free: refused": refused(lambda: surface.set_free(0xFFFFFF0, True)),
        "Surface.triangles": surface.triangles, "Surface.across": lambda: surface.across(t, 0),
        "Surface.across: refused": refused(lambda: surface.across(t, 3)),
        "Surface.contains": lambda: surface.contains(place), "Surface.contains: many": lambda: surface.contains(places),
        "Surface.point": lambda: surface.point(place), "Surface.point: many": lambda: surface.point(places),
        "Surface.point: refused": refused(lambda: surface.point(dc.topology.SurfacePlace())),
        "Surface.place": lambda: surface.place(t, [0.2, 0.3, 0.5]),
        "Surface.place: refused": refused(lambda: surface.place((0xFFFFFF0, 0), [0.2, 0.3, 0.5])),
        "surface_places": lambda: dc.topology.surface_places([place, place]),
        "surface_places: refused": refused(lambda: dc.topology.surface_places([3])),
        "nearest_in_triangle": lambda: dc.topology.nearest_in_triangle(surface, t, x[0]),
        "nearest_in_triangle: refused": refused(lambda: dc.topology.nearest_in_triangle(surface, (0xFFFFFF0, 0), x[0])),
        "SurfaceLocator": lambda: dc.topology.SurfaceLocator(surface),
        "SurfaceLocator.nearest": lambda: dc.topology.SurfaceLocator(surface).nearest(surface, x[0]),
        "SurfaceLocator.nearest: many": lambda: dc.topology.SurfaceLocator(surface).nearest(surface, x),
        "SurfaceLocator.nearest: refused": refused(lambda: locator.nearest(surface, x)),
        "tangent": lambda: dc.topology.tangent(surface, t, 0, 0.3),
        "tangent: refused": refused(lambda: dc.topology.tangent(surface, (0xFFFFFF0, 0), 0, 0.3)),
    }


def of_surface_steps() -> Calls:
    """Particles that meet the walls of faces that are not free."""
    surface = dc.topology.Surface(barrel())
    place = dc.topology.SurfaceLocator(surface).nearest(surface, [0.3, 0.01, 0.02]).place
    for c in surface.map.cells()[::3]:
        surface.set_free(int(c), bool(c == place.triangle.cell))
    places, saved = dc.topology.surface_places([place] * 5), dc.topology.surface_places([place] * 5)

    def step(respond: object) -> None:
        for way in WAYS:
            dc.step(surface, dc.topology.SurfacePlace(place.triangle, place.weights), way, respond, trace=dc.topology.SurfaceTrace())

    def advance(respond: object) -> None:
        places[:] = saved
        dc.advance(surface, places, WAYS, respond, threads=1)

    table: Calls = {"SurfaceTrace": dc.topology.SurfaceTrace}
    for name, respond in {"none": None, "slide": lambda c: dc.slid(c, c.unused),
                          "record": lambda c: dc.topology.AfterSurfaceContact(dc.slid(c, c.unused), True)}.items():
        table[f"step: {name}"] = lambda r=respond: step(r)
        table[f"advance: {name}"] = lambda r=respond: advance(r)
    for name, respond in {"raised": raising, "wrong answer": lambda c: "text"}.items():
        table[f"step: {name}"] = refused(lambda r=respond: step(r))
        table[f"advance: {name}"] = refused(lambda r=respond: advance(r))
    table["step: refused"] = refused(lambda: dc.step(surface, dc.topology.SurfacePlace(), WAYS[0]))
    table["advance: refused"] = refused(lambda: dc.advance(surface, places, WAYS[1:], threads=1))
    return table


def of_surface_edits() -> Calls:
    surface = dc.topology.Surface(barrel())
    x = np.array([0.3, 0.01, 0.02])
    held = dc.topology.Surface(barrel())
    edit = dc.topology.SurfaceEdit(held)

    def undone() -> None:
        with dc.topology.SurfaceEdit(surface) as own:
            v = dc.topology.split_edge(own.topology, (first(own.map), 0)).vertex
            own.place(v, own.position(v))

    def raised() -> None:
        with dc.topology.SurfaceEdit(surface) as own:
            dc.topology.split_edge(own.topology, (first(own.map), 0))
            raise KeyError("out of the edit")

    def committed() -> None:
        own = dc.topology.Surface(barrel())
        place = dc.topology.SurfaceLocator(own).nearest(own, x).place
        with dc.topology.SurfaceEdit(own) as own_edit:
            dc.topology.split_edge(own_edit.topology, (place.triangle.cell, 0))
            report = own_edit.commit()
        dc.topology.followed(own, report, place)
        dc.topology.followed(own, report, dc.topology.surface_places([place]))

    other = dc.topology.SurfaceEditReport(map=dc.topology.EditReport(added=[0xFFFFFF0]))
    return {
        "SurfaceEdit": lambda: dc.topology.SurfaceEdit(surface), "SurfaceEdit.__enter__": undone, "SurfaceEdit.__exit__": undone,
        "SurfaceEdit: refused": refused(lambda: dc.topology.SurfaceEdit(held)), "SurfaceEdit.__exit__: raised": refused(raised),
        "SurfaceEdit.position": lambda: edit.position(0), "SurfaceEdit.place": undone,
        "SurfaceEdit.position: refused": refused(lambda: edit.position(10**6)),
        "SurfaceEdit.place: refused": refused(lambda: edit.place(0, [np.nan, 0.0, 0.0])),
        "SurfaceEdit.commit": committed, "followed": committed,
        "followed: refused": refused(lambda: dc.topology.followed(surface, other, dc.topology.SurfacePlace())),
    }


def of_bodies() -> Calls:
    env = environment()
    own, mover = bodies(env), bodies(env)
    saved, state = mover.checkpoint(), own.predicted_state(0)
    table: Calls = {}
    for name in ("predicted_state", "id", "first_particle", "particle_count", "fits", "surface", "energy",
                 "rigid_motion_of"):
        table[f"Bodies.{name}"] = lambda f=getattr(own, name): f(0)
        table[f"Bodies.{name}: refused"] = refused(lambda f=getattr(own, name): f(9))

    def step() -> None:
        mover.step()
        mover.restore(saved)

    def edited() -> None:
        own_env = environment()
        own_bodies = bodies(own_env)
        own_env.edit(lambda edit: dc.topology.subdivide(edit, first(edit.map)))
        own_bodies.update_after_edit()

    def moved() -> None:
        own_env = environment()
        bodies(own_env).move_with(own_env.positions + [0.01, 0.0, 0.0])

    return table | {
        "Bodies.move_with": moved, "Bodies.audit": own.audit,
        "Bodies.move_with: refused": refused(lambda: own.move_with(np.zeros((2, 3)))),
        "Bodies": lambda: dc.Bodies(env, dc.records.BodiesOptions(dt=0.01), {"zmin": dc.Stick()}),
        "Bodies: refused": refused(lambda: dc.Bodies(env, dc.records.BodiesOptions(dt=0.01), {"nowhere": dc.Stick()})),
        "Bodies.add": lambda: bodies(env),
        "Bodies.add: refused": refused(lambda: own.add(BODY, dc.BodyOptions(mass=-1.0))),
        "Bodies.add: outside": lambda: dc.Bodies(env, dc.records.BodiesOptions(dt=0.01)).add(BODY + 3.0, dc.BodyOptions()),
        "Bodies.step": step, "Bodies.restore": step, "Bodies.checkpoint": own.checkpoint,
        "Bodies.restore: refused": refused(lambda: own.restore(3)),
        "Bodies.apply_impulse": lambda: own.apply_impulse(0, state),
        "Bodies.apply_impulse: refused": refused(lambda: own.apply_impulse(9, state)),
        "Bodies.update_after_edit": edited, "Bodies.__len__": lambda: len(own), "Bodies.state_hash": own.state_hash,
    }


def of_samples() -> Calls:
    mesh, options = barrel(), dc.records.SamplingOptions(spacing=0.2)
    table: Calls = {}
    for name in ("sample_solid", "sample_surface", "sample_volume"):
        table[name] = lambda f=getattr(dc, name): f(mesh, options)
        table[f"{name}: refused"] = refused(lambda f=getattr(dc, name): f(mesh, dc.records.SamplingOptions(spacing=-1.0)))
    table["overlapping_clusters"] = lambda: dc.records.overlapping_clusters(BODY, 0.2)
    table["overlapping_clusters: refused"] = refused(lambda: dc.records.overlapping_clusters(BODY, -1.0))
    return table


def of_catheters() -> Calls:
    env = tube()
    own, mover = catheter(env), catheter(env)
    saved, points = mover.checkpoint(), own.points()
    options = dc.CatheterOptions(length=0.02, spacing=2e-3, entry=[0.0, 0.0, 1e-3], direction=[0.0, 0.0, 1.0])

    def step() -> None:
        mover.step(dc.CatheterInput(push=1e-3, turn=0.1))
        mover.restore(saved)

    def edited() -> None:
        own_env = tube()
        own_catheter = catheter(own_env)
        own_env.edit(lambda edit: dc.topology.subdivide(edit, first(edit.map)))
        own_catheter.update_after_edit()

    def moved() -> None:
        own_env = tube()
        catheter(own_env).move_with(own_env.positions + [1e-4, 0.0, 0.0])

    return {
        "Catheter": lambda: dc.Catheter(env, options),
        "Catheter: refused": refused(lambda: dc.Catheter(env, dc.CatheterOptions(length=-1.0))),
        "Catheter.step": step, "Catheter.restore": step, "Catheter.checkpoint": own.checkpoint,
        "Catheter.step: refused": refused(lambda: own.step(dc.CatheterInput(push=np.nan))),
        "Catheter.restore: refused": refused(lambda: own.restore(3)),
        "Catheter.move_with": moved, "Catheter.contacts": own.contacts, "Catheter.audit": own.audit,
        "Catheter.move_with: refused": refused(lambda: own.move_with(np.zeros((2, 3)))),
        "Catheter.update_after_edit": edited, "Catheter.points": own.points, "Catheter.frames": own.frames,
        "Catheter.state_hash": own.state_hash,
        "camera_path": lambda: dc.records.camera_path(env, points, dc.records.CameraOptions(spacing=1e-3)),
        "camera_path: refused": refused(lambda: dc.records.camera_path(env, points, dc.records.CameraOptions(spacing=-1.0))),
    }


ROD = np.array([[0.4, 0.5, 0.5], [0.6, 0.5, 0.5]])


def solid_set(env: dc.Environment) -> dc.SolidSet:
    solids = dc.SolidSet(env)
    solids.add(dc.solid_of_polyline(ROD))
    return solids


def of_solid_sets() -> Calls:
    env = environment()
    mesh, rod, solids = dc.generate_box(cells=[1, 1, 1]), dc.solid_of_polyline(ROD), solid_set(env)
    down = ROD - np.array([0.0, 0.0, 0.1])

    def added() -> None:
        own = solid_set(env)
        assert own.add(rod).solid == 1
        own.remove(0)

    def edited() -> None:
        own = solid_set(environment())
        own.environment.edit(lambda edit: dc.topology.subdivide(edit, first(edit.map)))
        own.update_after_edit()

    def moved() -> None:
        own = solid_set(environment())
        assert own.move_with(down, own.environment.positions + 0.01).walls_made == 1.0

    return {
        "SolidMesh": lambda: dc.records.SolidMesh(ROD, edges=[[0, 1]]), "SolidMesh: refused": refused(lambda: dc.records.SolidMesh(3)),
        "SolidMesh: refused edges": refused(lambda: dc.records.SolidMesh(ROD, [[0, 1, 2]])),
        "SolidMesh: refused triangles": refused(lambda: dc.records.SolidMesh(ROD, triangles=[0.5])),
        "solid_of_surface": lambda: dc.solid_of_surface(barrel()),
        "solid_of_surface: refused": refused(lambda: dc.solid_of_surface(mesh)),
        "solid_of_cells": lambda: dc.solid_of_cells(mesh),
        "solid_of_cells: refused": refused(lambda: dc.solid_of_cells(barrel())),
        "solid_of_polyline": lambda: dc.solid_of_polyline(ROD),
        "solid_of_polyline: refused": refused(lambda: dc.solid_of_polyline(3)),
        "SolidSet": lambda: dc.SolidSet(env), "SolidSet: refused": refused(lambda: dc.SolidSet(None)),
        "SolidSet.add": added, "SolidSet.remove": added,
        "SolidSet.add: refused": refused(lambda: solids.add(dc.records.SolidMesh(ROD[:0]))),
        "SolidSet.remove: refused": refused(lambda: solids.remove(7)),
        "SolidSet.update_after_edit": edited, "SolidSet.move_with": moved,
        "SolidSet.move_with: refused": refused(lambda: solids.move_with(ROD, ROD)),
        "SolidSet.set_inverse_masses": lambda: solids.set_inverse_masses(np.ones(2)),
        "SolidSet.set_inverse_masses: refused": refused(lambda: solids.set_inverse_masses(np.ones(3))),
        "SolidSet.advance": lambda: solids.advance(down, dc.SolidStepOptions(rounds=3)),
        "SolidSet.advance: refused": refused(lambda: solids.advance(np.full((2, 3), np.nan))),
        "SolidSet.audit": solids.audit, "SolidSet.checkpoint": solids.checkpoint, "SolidSet.__len__": lambda: len(solids),
        "SolidSet.restore": lambda: solids.restore(solids.checkpoint()),
        "SolidSet.restore: refused": refused(lambda: solids.restore(3)),
    }


def calls() -> Calls:
    return (of_solid_sets() | of_surfaces() | of_surface_steps() | of_surface_edits() | of_bodies() | of_samples() | of_catheters())
