"""Properties of living objects, and classes that Python cannot construct."""
from __future__ import annotations

import pickle

import numpy as np

import dartcast as dc

from . import Calls, classes, is_record, refused, scenes


def of_meshes() -> dict[str, object]:
    mesh = scenes.box(mixed=True)
    mesh.regions = np.arange(mesh.cell_count)
    mesh.region_names = {1: "a region with a long name"}
    mesh.point_data = {"values at the points": np.ones((len(mesh.points), 3))}
    mesh.cell_data = {"values in the cells": np.ones(mesh.cell_count)}
    c = scenes.complex_of()
    moved = c.positions.copy()
    moved[0] = 0.9
    c.move(moved)
    return {"MeshData": mesh, "CellComplex": c, "CombinatorialMap": c.map, "CellView": c.map.view(scenes.first(c.map)),
            "Shape": c.map.shape(scenes.first(c.map)), "WallTriangles": dc.topology.wall_triangles(c)}


def of_edits() -> dict[str, object]:
    c = scenes.complex_of()
    edit = dc.topology.ComplexEdit(c)
    made = dc.topology.subdivide(edit, scenes.first(edit.map))
    surface = dc.topology.Surface(dc.generate_barrel(staves=8, rows=4, rings=2))
    return {"ComplexEdit": edit, "Transaction": edit.topology, "Subdivided": made, "Subdivision": made.subdivision,
            "SurfaceEdit": dc.topology.SurfaceEdit(surface),
            "Surface": dc.topology.Surface(dc.generate_barrel(staves=8, rows=4, rings=2))}


def of_particles() -> dict[str, object]:
    env, particles = scenes.with_particles()
    env.edit(lambda edit: dc.topology.subdivide(edit, scenes.first(edit.map)))
    update = env.update_after_edit(particles)
    targets = particles.positions + 2.0
    spheres = particles.copy()
    trace = env.trace(particles, 0, targets)[0]
    overlapping = dc.advance_spheres(env, spheres, np.full(scenes.COUNT, 0.05), targets)
    report = env.advance(particles, targets, options=dc.records.StepOptions(max_contacts=1))
    field = dc.VectorField(env.complex, env.positions.copy())
    return {"Environment": env, "Particles": particles, "UpdateReport": update, "Trace": trace, "StepReport": report,
            "SphereReport": overlapping, "VectorField": field, "Deformation": dc.Deformation([], env.positions),
            "StateHash": dc.records.StateHash((1, 2)), "MeshFile": dc.formats.MeshFile(scenes.box(), dc.formats.MeshReport())}


def of_solids() -> dict[str, object]:
    bodies = scenes.bodies(scenes.environment())
    bodies.step()
    saved = bodies.checkpoint()
    catheter = scenes.catheter(scenes.tube())
    surface = dc.topology.Surface(dc.generate_barrel(staves=8, rows=4, rings=2))
    place = dc.topology.SurfaceLocator(surface).nearest(surface, [0.3, 0.01, 0.02]).place
    trace = dc.topology.SurfaceTrace()
    report = dc.advance(surface, dc.topology.surface_places([place]), np.array([[0.0, 0.5, 0.1]]), threads=1)
    dc.step(surface, place, [0.0, 0.5, 0.1], trace=trace)
    solids = dc.SolidSet(scenes.environment())
    rod = dc.solid_of_polyline(np.array([[0.4, 0.5, 0.5], [0.6, 0.5, 0.5]]))
    placement = solids.add(rod)
    return {"SolidMesh": rod, "SolidSet": solids, "SolidPlacement": placement, "SolidAudit": solids.audit(), "SolidCheckpoint": solids.checkpoint(),
            "SolidStep": solids.advance(solids.positions), "Bodies": bodies, "BodiesCheckpoint": saved, "BodiesCheckpoint.Particle": saved.particles[0],
            "Catheter": catheter, "CatheterCheckpoint": catheter.checkpoint(), "SurfaceTrace": trace,
            "SurfaceReport": report}


def of_simulations() -> dict[str, object]:
    simulation = scenes.simulation()
    options = dc.StatisticsOptions(hits=True, residence=True, pathlines_every=2)
    options.planes = [dc.records.SectionPlane("a-plane-with-a-long-name", [0.5, 0.5, 0.5], [0.0, 0.0, 1.0])]
    simulation.set_statistics(options)
    simulation.add_body(scenes.BODY, dc.BodyOptions(mass=2.0))
    simulation.step()
    return {"Simulation": simulation, "SimulationCheckpoint": simulation.checkpoint(),
            "Statistics": simulation.statistics, "CellTally": dc.CellTally(scenes.environment())}


def of_parts() -> dict[str, object]:
    part = dc.formats.box_part(dc.formats.BoxOptions(cells=[3, 3, 3], size=[1.0, 1.0, 1.0]), 1, 0)
    environment = dc.SharedEnvironment(part, scenes.OneRank(), 1)
    particles = dc.SharedParticles(2)
    environment.add(particles, np.full((5, 3), 0.4))
    return {"MeshPart": part, "SharedEnvironment": environment, "SharedParticles": particles}


#: They exist during the call of a law alone: simulations.py has them.
OF_A_LAW = {"LawParticles", "LawSamples", "LawResult"}


def living() -> dict[str, object]:
    return of_parts() | of_meshes() | of_edits() | of_particles() | of_solids() | of_simulations()


def calls() -> Calls:
    table: Calls = {}
    objects = living()
    for name, cls in classes().items():
        if is_record(cls) or name in OF_A_LAW:
            continue
        if "__setstate__" in vars(cls):
            for member in ("__getstate__", "__setstate__"):
                table[f"{name}.{member}"] = lambda o=objects[name]: pickle.loads(pickle.dumps(o))
        for member, value in vars(cls).items():
            if isinstance(value, property):
                table[f"{name}.{member}"] = lambda o=objects[name], m=member: getattr(o, m)
                if value.fset is not None:
                    own = getattr(objects[name], member)
                    table[f"{name}.{member}="] = lambda o=objects[name], m=member, v=own: setattr(o, m, v)
                    table[f"{name}.{member}=: refused"] = refused(
                        lambda o=objects[name], m=member: setattr(o, m, Ellipsis))
        try:
            cls()
        except TypeError as error:
            if "No constructor" in str(error):
                table[name] = refused(cls)
    return table
