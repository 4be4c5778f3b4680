"""MeshData: from arrays, its attributes, and everything that is refused."""
from __future__ import annotations

import copy
import pickle

import dartcast
import numpy as np
import pytest

POINTS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], dtype=float)
TETRA = np.array([[0, 1, 2, 3], [1, 2, 3, 4]])


def two_tetrahedra(**more):
    return dartcast.MeshData(POINTS, {"tetra": TETRA}, **more)


def test_cells_and_points_are_those_given():
    mesh = two_tetrahedra()
    assert np.array_equal(mesh.points, POINTS)
    assert mesh.cell_count == 2 and mesh.dimension == 3
    assert np.array_equal(mesh.connectivity, TETRA.ravel()) and mesh.connectivity.dtype == np.uint32
    assert np.array_equal(mesh.offsets, [0, 4, 8])
    assert np.array_equal(mesh.types, [dartcast.formats.CellType.TETRAHEDRON] * 2)
    assert np.array_equal(mesh.cell(1), TETRA[1])
    assert np.array_equal(mesh.cells["tetra"], TETRA)


@pytest.mark.parametrize("dtype", [np.int8, np.uint8, np.int16, np.int32, np.uint32, np.int64, np.uint64])
def test_any_integer_dtype_gives_the_same_cells(dtype):
    mesh = dartcast.MeshData(POINTS, {"tetra": TETRA.astype(dtype)})
    assert np.array_equal(mesh.cells["tetra"], TETRA)


def test_fortran_order_and_strides_of_cells_are_read_right():
    assert np.array_equal(dartcast.MeshData(POINTS, {"tetra": np.asfortranarray(TETRA)}).cells["tetra"], TETRA)
    wide = np.zeros((4, 8), dtype=int)
    wide[::2, ::2] = TETRA
    assert np.array_equal(dartcast.MeshData(POINTS, {"tetra": wide[::2, ::2]}).cells["tetra"], TETRA)


def test_all_types_keep_their_order():
    cube = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], dtype=float)
    points = np.vstack([cube, [[0.5, 0.5, 2.0]]])
    cells = [("hexahedron", [[0, 1, 3, 2, 4, 5, 7, 6]]), ("pyramid", [[4, 5, 7, 6, 8]])]
    mesh = dartcast.MeshData(points, cells)
    assert list(mesh.types) == [dartcast.formats.CellType.HEXAHEDRON, dartcast.formats.CellType.PYRAMID]
    report = dartcast.check_and_repair(mesh)
    assert report.valid and not report.repairs
    assert report.cells == {"hexahedron": 1, "pyramid": 1}


@pytest.mark.parametrize("order", [[0, 1, 2, 3, 4, 5], [0, 2, 1, 3, 5, 4]], ids=["Gmsh", "VTK"])
def test_a_wedge_of_either_order_is_positive(order):
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1]], dtype=float)
    mesh = dartcast.MeshData(points, {"wedge": [order]})
    report = dartcast.check_and_repair(mesh)
    assert report.valid and not report.repairs
    assert np.array_equal(mesh.cells["wedge"], [[0, 1, 2, 3, 4, 5]])


def test_a_polyhedron_is_given_by_its_faces():
    faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
    mesh = dartcast.MeshData(POINTS[:4], {"polyhedron": [faces]})
    assert [list(f) for f in mesh.cells["polyhedron"][0]] == faces
    assert dartcast.check_and_repair(mesh).valid
    assert list(dartcast.MeshData(POINTS[:4], {"polyhedron4": [faces]}).types) == [dartcast.formats.CellType.POLYHEDRON]


def test_planar_cells_and_their_patches():
    points = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0], [3, 0.5, 0]], dtype=float)
    mesh = dartcast.MeshData(points, {"quad": [[0, 1, 4, 3]], "polygon": [[1, 2, 6, 5, 4]]},
                             patches={"left": np.array([[3, 0]]), "right": [[2, 6], [6, 5]]})
    assert mesh.dimension == 2
    report = dartcast.check_and_repair(mesh)
    assert report.valid and not report.warnings
    assert mesh.patch_names == {1: "left", 2: "right"}
    assert list(mesh.patch_tags) == [1, 2, 2]
    assert list(mesh.patch_face(1)) == [2, 6]


def test_regions_flat_or_by_type():
    flat = two_tetrahedra(regions=[4, -7], region_names={4: "lumen"})
    by_type = two_tetrahedra(regions={"tetra": np.array([4, -7], dtype=np.int16)})
    assert list(flat.regions) == list(by_type.regions) == [4, -7]
    assert flat.region_names == {4: "lumen"}


def test_free_and_data():
    mesh = two_tetrahedra(free=np.array([True, False]), point_data={"t": np.arange(5.0), "v": POINTS},
                          cell_data={"rank": [3, 4], "w": {"tetra": np.ones((2, 2))}})
    assert list(mesh.free) == [1, 0]
    assert np.array_equal(mesh.point_data["t"], np.arange(5.0)) and np.array_equal(mesh.point_data["v"], POINTS)
    assert np.array_equal(mesh.cell_data["rank"], [3, 4]) and mesh.cell_data["w"].shape == (2, 2)


def test_patches_by_name_by_tag_and_by_type():
    mesh = two_tetrahedra(patches={"inlet": [[0, 2, 1]], 9: {"triangle": np.array([[0, 1, 3]])}, "known": [[0, 3, 2]]},
                          patch_names={5: "known"})
    assert dict(zip(mesh.patch_tags.tolist(), mesh.patch_faces.reshape(-1, 3).tolist())) == {
        1: [0, 2, 1], 9: [0, 1, 3], 5: [0, 3, 2]}
    assert mesh.patch_names == {1: "inlet", 5: "known"}


def test_a_named_patch_does_not_take_the_tag_of_another():
    mesh = two_tetrahedra(patches={"inlet": [[0, 2, 1]], 1: [[0, 1, 3]]})
    assert list(mesh.patch_tags) == [2, 1]


@pytest.mark.parametrize("points, text", [
    (POINTS.astype(complex), "expected float64 .n, 3., C-contiguous; got complex128 .5, 3."),
    (POINTS[:, :2].copy(), r"got float64 \(5, 2\)"),
    (POINTS.T, r"got float64 \(3, 5\).*Convert it by x.T"),
    (POINTS.ravel(), r"got float64 \(15,\).*reshape\(-1, 3\), if"),
    (POINTS.astype(np.longdouble), "got float128|got longdouble"),
    (POINTS.astype(np.int64) + 2**53 + 1, "got int64"),
    (POINTS.astype(np.uint64) + 2**53 + 1, "got uint64"),
    (POINTS.astype(bool), "got bool"),
    (POINTS.astype(str), "got <U"),
    ([[0.0, 1.0], [2.0]], "got a list"),
    ("abc", "got a str"),
])
def test_points_are_refused(points, text):
    with pytest.raises(TypeError, match=text):
        dartcast.MeshData(points, {"tetra": TETRA})


@pytest.mark.parametrize("cells, error, text", [
    ({"tetra": TETRA.astype(float)}, TypeError, r"cells\['tetra'\]: expected whole numbers \(n, 4\); got float64"),
    ({"tetra": TETRA[:, :3]}, TypeError, r"got int64 \(2, 3\)"),
    ({"tetra": TETRA > 0}, TypeError, "got bool"),
    ({"tetra": [[0, 1, 2, 5]]}, dartcast.InvalidArgument, "row 0 has 5, which is out of range"),
    ({"tetra": [[0, 1, 2, -1]]}, dartcast.InvalidArgument, "row 0 has -1"),
    ({"tetra": np.array([[0, 1, 2, 2**63 + 1]], dtype=np.uint64)}, dartcast.InvalidArgument, "out of range"),
    ({"tetra10": TETRA}, dartcast.InvalidArgument, "no type of cells here: the types are tetra, "),
    ({"polyhedron": [3]}, TypeError, "list of faces"),
    ({"polyhedron": [[3]]}, TypeError, "whole numbers"),
    ({"polygon": 7}, TypeError, "list of cells"),
    (TETRA, TypeError, "expected a dict by name"),
    ("tetra", TypeError, "expected a dict by name"),
    ([TETRA[:1]], TypeError, "pair"),
    ([(1, TETRA)], TypeError, "name of a type"),
])
def test_cells_are_refused(cells, error, text):
    with pytest.raises(error, match=text):
        dartcast.MeshData(POINTS, cells)


@pytest.mark.parametrize("more, error, text", [
    ({"regions": [1]}, dartcast.InvalidArgument, "regions: expected 2 values"),
    ({"regions": [1.5, 2.0]}, TypeError, "regions: expected whole numbers"),
    ({"regions": [1, 2**31]}, dartcast.InvalidArgument, "out of range"),
    ({"regions": {"quad": [1, 2]}}, dartcast.InvalidArgument, "no values for the cells 'tetra'"),
    ({"regions": {"tetra": [1]}}, dartcast.InvalidArgument, "expected 2 values, one for each cell; got 1"),
    ({"regions": {"tetra": [1, 1], "quad": []}}, dartcast.InvalidArgument, "that the mesh has not"),
    ({"free": [1, 0]}, TypeError, "free: expected bool or uint8"),
    ({"free": np.array([True])}, dartcast.InvalidArgument, "free: expected 2"),
    ({"point_data": {"t": np.zeros(4)}}, dartcast.InvalidArgument, r"point_data\['t'\]: expected 5"),
    ({"point_data": {"t": np.zeros((5, 2, 2))}}, TypeError, "components"),
    ({"point_data": {"t": np.zeros((5, 0))}}, dartcast.InvalidArgument, "no components"),
    ({"point_data": {"t": ["a"] * 5}}, TypeError, "numbers"),
    ({"cell_data": {"t": np.zeros(3)}}, dartcast.InvalidArgument, r"cell_data\['t'\]: expected 2"),
    ({"patches": {"a": [[0, 1, 9]]}}, dartcast.InvalidArgument, r"patches\['a'\]: row 2 has 9"),
    ({"patches": {"a": np.zeros((1, 3))}}, TypeError, r"patches\['a'\]: expected whole numbers"),
    ({"patches": {"a": 3}}, TypeError, "expected faces"),
    ({"patches": {1.5: [[0, 1, 2]]}}, TypeError, "tag"),
    ({"region_names": {"a": 1}}, (TypeError, RuntimeError), ""),
])
def test_values_are_refused(more, error, text):
    with pytest.raises(error, match=text):
        two_tetrahedra(**more)


def test_attributes_are_read_only_copies():
    mesh = two_tetrahedra(regions=[1, 2])
    for name in ("points", "types", "offsets", "connectivity", "regions", "patch_faces", "free"):
        array = getattr(mesh, name)
        assert not array.flags.writeable
        assert not np.shares_memory(array, getattr(mesh, name))
    with pytest.raises(ValueError):
        mesh.points[0, 0] = 7.0


def test_attributes_can_be_set():
    mesh = two_tetrahedra()
    mesh.points = POINTS * 2
    mesh.regions = np.array([1, 2])
    mesh.region_names = {1: "a"}
    mesh.free = np.array([0, 7], dtype=np.uint8)
    mesh.source = [5, 6]
    mesh.point_data = {"t": np.arange(5)}
    assert np.array_equal(mesh.points, POINTS * 2) and list(mesh.free) == [0, 1]
    assert list(mesh.source) == [5, 6] and list(mesh.point_data) == ["t"]
    with pytest.raises(TypeError, match="MeshData.points: expected float64"):
        mesh.points = [[0, 0]]
    with pytest.raises(dartcast.InvalidArgument, match="out of range"):
        mesh.types = [8]
    with pytest.raises(TypeError):
        mesh.regions = np.array([0.5, 1.5])


@pytest.mark.parametrize("break_it, text", [
    (lambda m: setattr(m, "offsets", [0, 4]), "offsets must start with 0"),
    (lambda m: setattr(m, "offsets", [0, 9, 8]), "offsets must start with 0"),
    (lambda m: setattr(m, "offsets", [0, 5, 8]), "5 corners, which its type has not"),
    (lambda m: setattr(m, "connectivity", [0, 1, 2, 3, 1, 2, 3, 99]), "cell 1 has point 99"),
    (lambda m: setattr(m, "points", POINTS[:4].copy()), "cell 1 has point 4"),
    (lambda m: setattr(m, "regions", [1]), "regions has 1 entries"),
    (lambda m: setattr(m, "source", [1]), "source has 1 entries"),
    (lambda m: setattr(m, "free", np.ones(3, dtype=bool)), "free has 3"),
    (lambda m: setattr(m, "patch_tags", [1]), "patch_offsets must"),
    (lambda m: m.add_patch_face([0, 1, 77], 1), "patch face 0 has point 77"),
    (lambda m: m.add_cell("polyhedron", [4, 3, 0, 1, 2]), "polyhedron in cell 2"),
    (lambda m: m.add_cell("polyhedron", [1, 2**32 - 1]), "polyhedron in cell 2"),
    (lambda m: m.add_cell("polyhedron", []), "polyhedron in cell 2"),
])
def test_arrays_that_contradict_each_other_are_refused_by_calls_that_read_them(break_it, text):
    mesh = two_tetrahedra()
    break_it(mesh)
    with pytest.raises(dartcast.InvalidArgument, match=text):
        mesh.cells
    with pytest.raises(dartcast.InvalidArgument, match=text):
        dartcast.formats.select_patches(mesh, [])
    assert not dartcast.check_and_repair(mesh).valid
    with pytest.raises(dartcast.InvalidMesh):
        dartcast.topology.CombinatorialMap(mesh)


def test_cells_and_faces_can_be_added():
    mesh = two_tetrahedra()
    mesh.add_cell(dartcast.formats.CellType.TETRAHEDRON, [0, 1, 2, 4])
    mesh.add_patch_face(np.array([0, 1, 2]), 3)
    assert mesh.cell_count == 3 and list(mesh.cell(2)) == [0, 1, 2, 4]
    assert list(mesh.patch_face(0)) == [0, 1, 2] and list(mesh.patch_tags) == [3]
    with pytest.raises(IndexError):
        mesh.cell(3)
    with pytest.raises(IndexError):
        mesh.patch_face(1)
    with pytest.raises(TypeError):
        mesh.add_cell("tetrahedron", [0.5])


def test_copies_are_independent_and_pickles_are_equal():
    mesh = two_tetrahedra(regions=[1, 2], patches={"inlet": [[0, 2, 1]]}, point_data={"v": POINTS},
                          free=np.array([1, 0], bool))
    for other in (copy.copy(mesh), copy.deepcopy(mesh), pickle.loads(pickle.dumps(mesh))):
        for name in ("points", "types", "offsets", "connectivity", "regions", "free", "patch_faces", "patch_tags"):
            assert np.array_equal(getattr(other, name), getattr(mesh, name)), name
        assert other.patch_names == mesh.patch_names
        assert np.array_equal(other.point_data["v"], POINTS)
        other.points = np.zeros((5, 3))
        assert np.array_equal(mesh.points, POINTS)


def test_type_names_and_dimensions():
    assert dartcast.formats.CELL_TYPE_NAMES[dartcast.formats.CellType.PRISM] == "prism"
    assert [dartcast.formats.dimension(t) for t in dartcast.formats.CellType] == [3] * 5 + [2] * 3
    with pytest.raises(ValueError, match="is no CellType"):
        dartcast.formats.dimension(8)


def test_an_empty_mesh_is_refused_where_it_matters():
    mesh = dartcast.MeshData()
    assert mesh.cell_count == 0 and mesh.cells == {}
    with pytest.raises(dartcast.InvalidMesh):
        dartcast.topology.CellComplex(mesh)
