"""Meshes: from arrays, from generators, from and to files; checks and selections."""
from __future__ import annotations

import copy
import pickle

import numpy as np

import dartcast as dc

from . import Calls, refused
from .scenes import FOLDER, box

POINTS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], dtype=float)
TETRA = np.array([[0, 1, 2, 3], [1, 2, 3, 4]])
#: A file that is no mesh.
BROKEN = b"$MeshFormat\nnonsense\n"


def of_data() -> Calls:
    mesh = box(mixed=True)
    mesh.regions = np.arange(mesh.cell_count)
    mesh.cell_data = {"values in the cells": np.ones(mesh.cell_count)}

    def add_cell() -> None:
        dc.MeshData(POINTS, {"tetra": TETRA}).add_cell("tetrahedron", [0, 1, 2, 4])

    def add_patch_face() -> None:
        dc.MeshData(POINTS, {"tetra": TETRA}).add_patch_face([0, 1, 2], 3)

    def add_cell_refused() -> None:
        dc.MeshData(POINTS, {"tetra": TETRA}).add_cell("tetrahedron", [0.5])

    return {
        "MeshData": lambda: dc.MeshData(POINTS, {"tetra": TETRA}, regions=[1, 2], patches={"inlet": [[0, 2, 1]]},
                                        region_names={1: "the first region of all"}, free=np.array([True, False]),
                                        point_data={"values": POINTS}, cell_data={"values": [1.0, 2.0]}),
        "MeshData: polyhedra": lambda: dc.MeshData(
            POINTS, {"polyhedron": [[[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]]}),
        "MeshData: points refused": refused(lambda: dc.MeshData(POINTS.astype(np.complex64), {"tetra": TETRA})),
        "MeshData: cells refused": refused(lambda: dc.MeshData(POINTS, {"tetra": TETRA + 5})),
        "MeshData: regions refused": refused(lambda: dc.MeshData(POINTS, {"tetra": TETRA}, regions=[1])),
        "MeshData.cell": lambda: mesh.cell(3), "MeshData.cell: refused": refused(lambda: mesh.cell(10**6)),
        "MeshData.patch_face": lambda: mesh.patch_face(3),
        "MeshData.add_cell": add_cell, "MeshData.add_patch_face": add_patch_face,
        "MeshData.add_cell: refused": refused(add_cell_refused),
        "MeshData.__repr__": lambda: repr(mesh), "MeshData.__copy__": lambda: copy.copy(mesh),
        "MeshData.__deepcopy__": lambda: copy.deepcopy(mesh),
        "MeshData.__reduce__": lambda: pickle.loads(pickle.dumps(mesh)),
        "dimension": lambda: dc.formats.dimension("prism"), "dimension: refused": refused(lambda: dc.formats.dimension(8)),
    }


def of_checks() -> Calls:
    mesh = box(mixed=True)
    report = dc.check_and_repair(mesh)
    inverted = dc.MeshData(POINTS, {"tetra": [[0, 2, 1, 3]]})
    flat = dc.MeshData(POINTS * [1.0, 1.0, 0.0], {"tetra": TETRA})
    return {
        "check_and_repair": lambda: dc.check_and_repair(mesh),
        "check_and_repair: repair": lambda: dc.check_and_repair(copy.copy(inverted)),
        "check_and_repair: defects": lambda: dc.check_and_repair(copy.copy(flat)),
        "Finding.add": lambda: dc.formats.Finding("kind").add(3),
        "verdict_name": lambda: dc.formats.verdict_name("warn"),
        "verdict_name: refused": refused(lambda: dc.formats.verdict_name("no")),
        "MeshReport: of a mesh": lambda: (copy.copy(report), repr(report), report.valid, report.verdict),
    }


def of_selections() -> Calls:
    mesh = box()
    mesh.regions = np.arange(27) % 2 + 1
    mesh.region_names = {2: "a lumen with a long name"}
    mesh.cell_data = {"kind": np.arange(27.0)}
    outer = np.array([[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0]], dtype=float)
    rings = [dc.formats.Ring(outer, "rim"), dc.formats.Ring(0.5 * outer + 1.0, "hole")]
    rings[1].points = np.array([[1, 1, 0], [2, 1, 0], [2, 2, 0], [1, 2, 0]], dtype=float)
    return {
        "cells_of_region": lambda: dc.formats.cells_of_region(mesh, "a lumen with a long name"),
        "cells_of_region: refused": refused(lambda: dc.formats.cells_of_region(mesh, "tissue")),
        "select_free_regions": lambda: dc.formats.select_free_regions(mesh, ["a lumen with a long name"]),
        "select_free_regions: refused": refused(lambda: dc.formats.select_free_regions(mesh, ["tissue"])),
        "select_free_values": lambda: dc.formats.select_free_values(mesh, "kind", [1.0, 2.0]),
        "select_free_values: refused": refused(lambda: dc.formats.select_free_values(mesh, "sort", [1.0])),
        "select_patches": lambda: dc.formats.select_patches(copy.copy(mesh), ["xmin"]),
        "select_patches: refused": refused(lambda: dc.formats.select_patches(mesh, ["inlet"])),
        "select_walls": lambda: dc.formats.select_walls(copy.copy(mesh), []),
        "select_walls: refused": refused(lambda: dc.formats.select_walls(mesh, ["nowhere"])),
        "divide_walls": lambda: dc.formats.divide_walls(copy.copy(mesh), 30.0),
        "divide_walls: refused": refused(lambda: dc.formats.divide_walls(dc.MeshData(POINTS, {"tetra": [[0, 2, 1, 3]]}), 30.0)),
        "decompose": lambda: dc.formats.decompose(rings), "decompose: refused": refused(lambda: dc.formats.decompose([])),
        "decompose: ring refused": refused(lambda: dc.formats.decompose([dc.formats.Ring(outer[[0, 2, 1, 3]].copy())])),
    }


def of_generators() -> Calls:
    options = dc.formats.BoxOptions(cells=[2, 2, 2], size=[1.0, 1.0, 1.0], mixed=True, jitter=0.2)
    vessel = {"core": 2, "rings": 1, "tissue_layers": 1, "step_length": 1.5e-3}
    return {
        "generate_box": lambda: dc.generate_box(options), "generate_box: by names": lambda: box(),
        "generate_box: refused": refused(lambda: dc.generate_box(cells=[0, 1, 1])),
        "generate_box: name refused": refused(lambda: dc.generate_box(cell=3)),
        "generate_bar": dc.generate_bar, "bar_options": dc.formats.bar_options,
        "generate_barrel": lambda: dc.generate_barrel(staves=8, rows=4, rings=2),
        "generate_maze": lambda: dc.generate_maze(rooms=[2, 2], obstacles=1),
        "generate_octahedra": lambda: dc.generate_octahedra(cells=[1, 1, 1]),
        "generate_rectangle": lambda: dc.generate_rectangle(cells=[5, 4], size=[1.0, 1.0], type="polygon"),
        "generate_vessel": lambda: dc.generate_vessel(**vessel),
    }


def of_files() -> Calls:
    mesh = box()
    table: Calls = {}
    for ending in sorted(set(dc.formats.mesh_endings()) & set(dc.formats.writable_mesh_endings())):
        path = FOLDER / ("box" + ending)
        dc.write_mesh(mesh, path)
        table[f"write_mesh: {ending}"] = lambda p=path: dc.write_mesh(mesh, p)
        table[f"read_mesh: {ending}"] = lambda p=path: dc.read_mesh(p)
    path, broken, surface = FOLDER / "box.msh", FOLDER / "broken.msh", FOLDER / "tetra.off"
    dc.formats.write_bytes(broken, BROKEN)
    surface.write_text("OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n", encoding="utf-8")
    file = dc.read_mesh(path)
    surfaces = dc.formats.SurfaceScene(surfaces=[dc.formats.NamedSurface(region="lumen", file=surface)])
    return table | {
        "read_mesh: defects": lambda: dc.read_mesh(broken), "read_mesh: refused": refused(lambda: dc.read_mesh(3)),
        "read_mesh: little memory": lambda: dc.read_mesh(path, dc.formats.ReadOptions(max_memory=1000)),
        "read_valid_mesh": lambda: dc.formats.read_valid_mesh(path),
        "read_valid_mesh: refused": refused(lambda: dc.formats.read_valid_mesh(broken)),
        "read_surface": lambda: dc.formats.read_surface(surface),
        "read_surface: refused": refused(lambda: dc.formats.read_surface(FOLDER / "missing.stl")),
        "mesh_surfaces": lambda: dc.formats.mesh_surfaces(surfaces),
        "mesh_surfaces: refused": refused(lambda: dc.formats.mesh_surfaces(dc.formats.SurfaceScene(box=0.5))),
        "check_surface": lambda: dc.formats.check_surface(surface), "check_mesh": lambda: dc.formats.check_mesh(path, threads=1),
        "write_mesh: refused": refused(lambda: dc.write_mesh(mesh, FOLDER / "box.xyz")),
        "write_bytes": lambda: dc.formats.write_bytes(FOLDER / "bytes", b"a few bytes"),
        "write_bytes: refused": refused(lambda: dc.formats.write_bytes(FOLDER / "none" / "bytes", b"")),
        "is_surface_file": lambda: dc.formats.is_surface_file("a.vtu"),
        "mesh_endings": dc.formats.mesh_endings, "surface_endings": dc.formats.surface_endings,
        "writable_mesh_endings": dc.formats.writable_mesh_endings,
        "MeshFile": lambda: dc.formats.MeshFile(mesh, file.report), "MeshFile.__iter__": lambda: list(file),
        "MeshFile.__repr__": lambda: repr(file), "MeshFile: mesh alone": lambda: dc.read_mesh(path).mesh.points,
    }


def of_meshio() -> Calls:
    try:
        import meshio  # noqa: F401
    except ImportError:
        return {}
    mesh = box(mixed=True)
    made = dc.to_meshio(mesh)
    return {"to_meshio": lambda: dc.to_meshio(mesh), "from_meshio": lambda: dc.from_meshio(made)}


def of_parts() -> Calls:
    mesh = box(mixed=True)
    owners = dc.formats.partition(mesh, 3)
    part = dc.formats.mesh_part(mesh, owners, 3, 1)
    path = FOLDER / "pieces.pvtu"
    dc.formats.write_mesh_parts(mesh, 2, path)
    plan = dc.formats.plan_run(mesh, dc.formats.PlanOptions(ranks=2, samples=1))
    return {
        "MeshPart.__repr__": lambda: repr(part),
        "partition": lambda: dc.formats.partition(mesh, 4), "partition: refused": refused(lambda: dc.formats.partition(mesh, 0)),
        "mesh_part": lambda: dc.formats.mesh_part(mesh, owners, 3, 2),
        "mesh_part: refused": refused(lambda: dc.formats.mesh_part(mesh, owners[:4], 3, 2)),
        "has_parts": lambda: dc.formats.has_parts(dc.formats.BoxOptions()),
        "box_part": lambda: dc.formats.box_part(dc.formats.BoxOptions(cells=[4, 4, 4], size=[1.0, 1.0, 1.0]), 3, 1),
        "box_part: refused": refused(lambda: dc.formats.box_part(dc.formats.BoxOptions(mixed=True), 1, 0)),
        "write_mesh_parts": lambda: dc.formats.write_mesh_parts(mesh, 2, path),
        "write_mesh_parts: refused": refused(lambda: dc.formats.write_mesh_parts(mesh, 2, FOLDER / "pieces.vtu")),
        "read_mesh_part": lambda: dc.formats.read_mesh_part(path, 2, 1),
        "read_mesh_part: refused": refused(lambda: dc.formats.read_mesh_part(path, 3, 1)),
        "plan_run": lambda: dc.formats.plan_run(mesh, dc.formats.PlanOptions(ranks=2, particles=20.0, samples=1)),
        "RunPlan.seconds": lambda: plan.seconds(),
        "RunPlan.efficiency": lambda: plan.efficiency(),
        "plan_run: refused": refused(lambda: dc.formats.plan_run(mesh, dc.formats.PlanOptions(ranks=2, step=2.0))),
    }


def calls() -> Calls:
    return of_parts() | of_data() | of_checks() | of_selections() | of_generators() | of_files() | of_meshio()
