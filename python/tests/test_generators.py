"""Meshes that the library makes, selections, and cells from drawings."""
from __future__ import annotations

import dartcast
import numpy as np
import pytest


def area(mesh):
    total = 0.0
    for corners in (c for block in mesh.cells.values() for c in block):
        x, y = mesh.points[corners, 0], mesh.points[corners, 1]
        total += 0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))
    return total


def test_options_by_name_or_as_a_record():
    options = dartcast.formats.BoxOptions(cells=[2, 3, 4], size=(2.0, 3.0, 4.0))
    a, b = dartcast.generate_box(options), dartcast.generate_box(cells=(2, 3, 4), size=np.array([2.0, 3.0, 4.0]))
    assert np.array_equal(a.points, b.points) and np.array_equal(a.connectivity, b.connectivity)
    assert a.cell_count == 24 and np.array_equal(a.points.max(axis=0), [2, 3, 4])
    with pytest.raises(TypeError, match="not both"):
        dartcast.generate_box(options, jitter=0.1)
    with pytest.raises(TypeError, match="no member 'cell'"):
        dartcast.generate_box(cell=3)
    with pytest.raises(dartcast.InvalidArgument):
        dartcast.generate_box(cells=[0, 1, 1])


@pytest.mark.parametrize("kind, count", [("hexahedron", 1), ("tetrahedron", 6), ("prism", 2), ("pyramid", 6)])
def test_cubes_are_cut(kind, count):
    assert dartcast.generate_box(cells=[2, 2, 2], size=[1.0, 1.0, 1.0], type=kind).cell_count == 8 * count


def test_the_bar_is_that_of_its_options():
    bar = dartcast.generate_bar()
    assert bar.cell_count == 5 * 5 * 28 and int(bar.free.sum()) == 3 * 3 * 26
    assert list(dartcast.formats.bar_options().cells) == [5, 5, 28]


@pytest.mark.parametrize("mesh", [
    dartcast.generate_octahedra(cells=[2, 1, 1], size=[1.0, 1.0, 1.0]), dartcast.generate_rectangle(cells=[5, 4], size=[1.0, 1.0], type="polygon"),
    dartcast.generate_maze(rooms=[2, 2], obstacles=1),
    dartcast.generate_vessel(core=2, rings=1, tissue_layers=1, step_length=1.5e-3)])
def test_generated_meshes_are_accepted(mesh):
    assert dartcast.check_and_repair(mesh).verdict is dartcast.formats.Verdict.ACCEPT


def test_the_barrel_is_a_closed_surface():
    mesh = dartcast.generate_barrel(staves=8, rows=4, rings=2)
    assert mesh.region_names == {1: "staves", 2: "heads"}
    edges = {}
    for corners in (c for block in mesh.cells.values() for c in block):
        for a, b in zip(corners, np.roll(corners, -1)):
            edges[int(a), int(b)] = edges.get((int(a), int(b)), 0) + 1
    assert all(n == 1 and (b, a) in edges for (a, b), n in edges.items())


def test_jitters():
    assert (dartcast.formats.LARGEST_SQUARE_JITTER, dartcast.formats.LARGEST_POLYGON_JITTER) == (0.45, 0.3)


def test_rings_are_decomposed():
    outer = np.array([[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0]], dtype=float)
    hole = np.array([[1, 1, 0], [2, 1, 0], [2, 2, 0], [1, 2, 0]], dtype=float)
    mesh = dartcast.formats.decompose([dartcast.formats.Ring(outer, "rim"), dartcast.formats.Ring(points=hole, name="hole")],
                              dartcast.formats.DecomposeOptions(with_outside=False))
    inside = mesh.regions == 1
    assert mesh.patch_names == {1: "rim", 2: "hole"} and inside.any()
    free = dartcast.MeshData(np.array(mesh.points), {"polygon": [mesh.cell(c) for c in np.flatnonzero(inside)]})
    assert area(free) == 15.0
    with pytest.raises(dartcast.InvalidMesh, match="ring"):
        dartcast.formats.decompose([dartcast.formats.Ring(outer[[0, 2, 1, 3]].copy())])
    with pytest.raises(dartcast.InvalidArgument):
        dartcast.formats.decompose([])


def test_regions_are_selected():
    mesh = dartcast.generate_box(cells=[2, 1, 1], size=[1.0, 1.0, 1.0])
    mesh.regions = [1, 2]
    mesh.region_names = {2: "lumen"}
    dartcast.formats.select_free_regions(mesh, ["lumen"])
    assert list(mesh.free) == [0, 1]
    dartcast.formats.select_free_regions(mesh, ["1"])
    assert list(mesh.free) == [1, 0]
    with pytest.raises(dartcast.InvalidMesh, match="its regions are: 1, lumen"):
        dartcast.formats.select_free_regions(mesh, ["tissue"])
    assert list(mesh.free) == [1, 0]


def test_values_are_selected():
    mesh = dartcast.generate_box(cells=[3, 1, 1], size=[1.0, 1.0, 1.0])
    mesh.cell_data = {"kind": [5, 6, 7]}
    dartcast.formats.select_free_values(mesh, "kind", [5, 7.0])
    assert list(mesh.free) == [1, 0, 1]
    with pytest.raises(dartcast.InvalidMesh, match="no cell array 'sort'"):
        dartcast.formats.select_free_values(mesh, "sort", [1])


def test_patches_are_selected_and_made():
    mesh = dartcast.generate_box(cells=[2, 2, 2], size=[1.0, 1.0, 1.0])
    dartcast.formats.select_patches(mesh, ["xmin"])
    assert len(mesh.patch_tags) == 4 and set(mesh.patch_names[t] for t in mesh.patch_tags) == {"xmin"}
    dartcast.formats.divide_walls(mesh, 30.0)
    assert sorted(mesh.patch_names.values()) == [f"patch{i}" for i in range(1, 7)]
    with pytest.raises(dartcast.InvalidMesh):
        dartcast.formats.select_patches(mesh, ["inlet"])


def test_walls_are_divided_only_where_the_mesh_is_checked():
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    mesh = dartcast.MeshData(points, {"tetra": [[0, 2, 1, 3]]})
    with pytest.raises(dartcast.InvalidArgument, match="call check_and_repair"):
        dartcast.formats.divide_walls(mesh, 30.0)
    dartcast.check_and_repair(mesh)
    dartcast.formats.divide_walls(mesh, 30.0)
    assert len(mesh.patch_tags) == 4
