"""Meshes from and to files, and meshio's meshes."""
from __future__ import annotations

import pathlib

import dartcast
import numpy as np
import pytest

meshio = pytest.importorskip("meshio")

TETRAHEDRON = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n"


def mixed_box():
    return dartcast.generate_box(cells=[2, 2, 2], size=[1.0, 1.0, 1.0], mixed=True, blocked_layer=False, seed=3)


@pytest.mark.parametrize("ending", sorted(set(dartcast.formats.mesh_endings()) & set(dartcast.formats.writable_mesh_endings())))
def test_a_written_mesh_is_read_back(tmp_path, ending):
    mesh = mixed_box()
    path = tmp_path / ("box" + ending)
    dartcast.write_mesh(mesh, path)
    back, report = dartcast.read_mesh(path)
    assert report.valid and report.verdict is dartcast.formats.Verdict.ACCEPT
    assert np.array_equal(back.points, mesh.points)
    assert {name: len(cells) for name, cells in back.cells.items()} == {n: len(c) for n, c in mesh.cells.items()}
    assert len(back.patch_tags) == len(mesh.patch_tags)


@pytest.mark.parametrize("ending", ["vtu", "vtk"])
def test_free_cells_are_read_back(tmp_path, ending):
    mesh = dartcast.generate_box(cells=[3, 3, 3], size=[1.0, 1.0, 1.0], blocked_layer=True)
    assert sum(mesh.free) == 1
    dartcast.write_mesh(mesh, tmp_path / f"box.{ending}")
    back, _ = dartcast.read_mesh(tmp_path / f"box.{ending}")
    assert list(back.free) == list(mesh.free)


def test_a_meshb_of_meshio_is_read(tmp_path):
    mesh = dartcast.generate_box(cells=[3, 2, 2], size=[1.0, 1.0, 1.0], type="tetrahedron")
    path = tmp_path / "box.meshb"
    meshio.write(path, meshio.Mesh(mesh.points, [("tetra", mesh.cells["tetra"])]))
    back, report = dartcast.read_mesh(path)
    assert report.valid and report.format == "Medit binary"
    assert np.array_equal(back.points, mesh.points) and np.array_equal(back.cells["tetra"], mesh.cells["tetra"])


def test_files_of_tetgen_are_read(tmp_path):
    mesh = dartcast.generate_box(cells=[3, 2, 2], size=[1.0, 1.0, 1.0], type="tetrahedron")
    meshio.write(tmp_path / "box.node", meshio.Mesh(mesh.points, [("tetra", mesh.cells["tetra"])]))
    for ending in ("node", "ele"):
        back, report = dartcast.read_mesh(tmp_path / f"box.{ending}")
        assert report.valid and report.format == "TetGen"
        assert np.array_equal(back.points, mesh.points) and np.array_equal(back.cells["tetra"], mesh.cells["tetra"])


def test_a_mesh_around_a_surface(tmp_path):
    surface = tmp_path / "tetrahedron.off"
    surface.write_text(TETRAHEDRON, encoding="utf-8")
    scene = dartcast.formats.SurfaceScene(surfaces=[dartcast.formats.NamedSurface(region="lumen", file=surface)], box=2.0)
    mesh, report = dartcast.formats.mesh_surfaces(scene)
    assert report.valid, report
    corners = mesh.points[mesh.cells["tetra"]]
    edges = corners[:, 1:] - corners[:, :1]
    volumes = np.linalg.det(edges) / 6.0
    lumen = np.array([mesh.region_names[tag] == "lumen" for tag in mesh.regions])
    assert volumes[lumen].sum() == pytest.approx(1.0 / 6.0, rel=1e-12)
    assert volumes.sum() == pytest.approx(8.0, rel=1e-12)
    with pytest.raises(dartcast.InvalidArgument, match="box"):
        dartcast.formats.mesh_surfaces(dartcast.formats.SurfaceScene(surfaces=scene.surfaces, box=1.0))


def test_paths_may_be_texts_or_paths(tmp_path):
    path = tmp_path / "box.vtu"
    dartcast.write_mesh(mixed_box(), str(path))
    for given in (path, str(path), pathlib.PurePath(path)):
        assert dartcast.formats.read_valid_mesh(given).report.valid
        assert dartcast.formats.check_mesh(given, threads=1).report.valid
    with pytest.raises(TypeError):
        dartcast.read_mesh(3)


def test_a_file_that_is_no_mesh_is_a_defect_or_an_error(tmp_path):
    path = tmp_path / "broken.msh"
    dartcast.formats.write_bytes(path, b"$MeshFormat\nnonsense\n")
    assert path.read_bytes() == b"$MeshFormat\nnonsense\n"
    report = dartcast.read_mesh(path).report
    assert not report.valid and report.defects[0].kind == "file"
    with pytest.raises(dartcast.InvalidMesh, match="broken.msh"):
        dartcast.formats.read_valid_mesh(path)
    with pytest.raises(dartcast.InvalidMesh):
        dartcast.formats.read_surface(tmp_path / "missing.stl")
    with pytest.raises(dartcast.InvalidMesh, match="broken.msh"):
        dartcast.Environment(path)
    with pytest.raises(dartcast.InvalidMesh, match="broken.msh"):
        dartcast.Environment(dartcast.read_mesh(path))


def test_a_missing_file_and_a_surface_are_no_meshes(tmp_path):
    for call in (dartcast.read_mesh, dartcast.Environment):
        for name in ("nofile.vtu", "nofile.stl"):
            with pytest.raises(FileNotFoundError, match=name) as raised:
                call(tmp_path / name)
            assert raised.value.filename == str(tmp_path / name)
    surface = tmp_path / "tetra.off"
    surface.write_text(TETRAHEDRON, encoding="utf-8")
    for call in (dartcast.read_mesh, dartcast.Environment):
        with pytest.raises(dartcast.InvalidArgument, match=r"this is a surface: read_surface\(\) reads it"):
            call(surface)


def test_an_environment_is_made_from_a_file(tmp_path):
    path = tmp_path / "box.vtu"
    mesh = dartcast.generate_box(cells=[3, 2, 1])
    mesh.regions = [1, 2] * 3
    mesh.region_names = {1: "left", 2: "right"}
    dartcast.write_mesh(mesh, path)
    for given in (path, str(path), dartcast.read_mesh(path), dartcast.read_mesh(path).mesh):
        environment = dartcast.Environment(given, 1, ["left"])
        assert np.array_equal(environment.positions, mesh.points)
        assert environment.locate([0.5, 0.5, 0.5]).place == dartcast.Place.FREE
        assert environment.locate([1.5, 0.5, 0.5]).place == dartcast.Place.BLOCKED


def test_a_mesh_that_contradicts_itself_is_not_written(tmp_path):
    mesh = mixed_box()
    mesh.offsets = [0, 1]
    with pytest.raises(dartcast.InvalidArgument, match="offsets"):
        dartcast.write_mesh(mesh, tmp_path / "box.vtu")
    with pytest.raises(dartcast.InvalidArgument, match="cannot write files"):
        dartcast.write_mesh(mixed_box(), tmp_path / "box.xyz")
    assert list(tmp_path.iterdir()) == []


def test_a_memory_limit_is_kept(tmp_path):
    path = tmp_path / "box.vtu"
    dartcast.write_mesh(mixed_box(), path)
    file = dartcast.read_mesh(path, dartcast.formats.ReadOptions(max_memory=1000))
    assert not file.report.valid


def test_surfaces(tmp_path):
    path = tmp_path / "tetra.off"
    path.write_text(TETRAHEDRON)
    assert dartcast.formats.is_surface_file(path) and not dartcast.formats.is_surface_file("a.vtu")
    assert ".off" in dartcast.formats.surface_endings()
    mesh, report = dartcast.formats.read_surface(path)
    assert report.valid and report.surface and mesh.cell_count == 4
    assert dartcast.formats.check_surface(path).report.cells == {"triangle": 4}


def test_the_mesh_of_a_file_can_be_changed_in_place(tmp_path):
    path = tmp_path / "box.vtu"
    dartcast.write_mesh(dartcast.generate_box(), path)
    file = dartcast.read_mesh(path)
    file.mesh.regions = [7]
    assert list(file.mesh.regions) == [7]
    mesh = file.mesh
    del file
    assert list(mesh.regions) == [7]


def read_by_meshio(path):
    mesh = meshio.read(path)
    for name, values in mesh.cell_data.items():
        mesh.cell_data[name] = [np.asarray(v) for v in values]
    return mesh


@pytest.mark.parametrize("ending", [".msh", ".mesh"])
def test_a_mesh_from_meshio_is_that_of_the_own_reader(tmp_path, ending):
    path = tmp_path / ("box" + ending)
    dartcast.write_mesh(mixed_box(), path)
    own = dartcast.read_mesh(path).mesh
    mesh = dartcast.from_meshio(read_by_meshio(path))
    report = dartcast.check_and_repair(mesh)
    assert report.valid and not report.repairs
    assert np.array_equal(mesh.points, own.points)

    def cells(m):
        return {frozenset(c.tolist()) for block in m.cells.values() for c in block}
    assert cells(mesh) == cells(own)


def test_patches_and_regions_come_from_gmsh(tmp_path):
    path = tmp_path / "box.msh"
    mesh = dartcast.generate_box(cells=[2, 2, 2], size=[1.0, 1.0, 1.0])
    mesh.regions = [1, 2] * 4
    mesh.region_names = {1: "left", 2: "right"}
    dartcast.write_mesh(mesh, path)
    back = dartcast.from_meshio(read_by_meshio(path))
    assert sorted(back.regions) == sorted(mesh.regions)
    assert back.region_names == mesh.region_names and back.patch_names == mesh.patch_names

    def faces(m):
        return {(t, frozenset(f.tolist())) for t, f in zip(m.patch_tags, m.patch_faces.reshape(-1, 4))}
    assert faces(back) == faces(mesh)


def test_to_meshio_and_back():
    mesh = mixed_box()
    mesh.regions = np.arange(mesh.cell_count) % 3 + 1
    mesh.cell_data = {"w": np.arange(float(mesh.cell_count))}
    mesh.point_data = {"v": np.array(mesh.points)}
    made = dartcast.to_meshio(mesh)
    assert sum(len(b.data) for b in made.cells) == mesh.cell_count + len(mesh.patch_tags)
    back = dartcast.from_meshio(made)
    assert back.patch_names == mesh.patch_names
    assert {n: c.tolist() for n, c in back.cells.items()} == {n: c.tolist() for n, c in mesh.cells.items()}
    order = np.argsort(mesh.types, kind="stable")
    assert np.array_equal(back.regions, mesh.regions[order])
    assert np.array_equal(back.cell_data["w"], mesh.cell_data["w"][order])
    assert np.array_equal(back.point_data["v"], mesh.points)


def test_polyhedra_go_through_meshio():
    mesh = dartcast.generate_octahedra(cells=[1, 1, 1])
    back = dartcast.from_meshio(dartcast.to_meshio(mesh))
    assert [[f.tolist() for f in c] for c in back.cells["polyhedron"]] == [
        [f.tolist() for f in c] for c in mesh.cells["polyhedron"]]


def test_a_planar_mesh_goes_through_meshio():
    mesh = dartcast.generate_rectangle(cells=[4, 4], size=[1.0, 1.0], mixed=True)
    back = dartcast.from_meshio(dartcast.to_meshio(mesh))
    assert {n: len(c) for n, c in back.cells.items()} == {n: len(c) for n, c in mesh.cells.items()}
    assert len(back.patch_tags) == len(mesh.patch_tags) == 16
    assert dartcast.check_and_repair(back).valid


def test_points_of_the_plane_get_a_third_coordinate():
    given = meshio.Mesh(np.array([[0, 0], [1, 0], [0, 1.0]]), [("triangle", np.array([[0, 1, 2]]))])
    mesh = dartcast.from_meshio(given)
    assert mesh.points.shape == (3, 3) and dartcast.check_and_repair(mesh).valid


def test_a_mesh_without_cells_is_refused():
    with pytest.raises(ValueError, match="expected cells such as tetra"):
        dartcast.from_meshio(meshio.Mesh(np.zeros((2, 3)), [("line", np.array([[0, 1]]))]))


@pytest.mark.parametrize("compression", [None, "none", "small"])
def test_meshio_reads_the_frames_of_a_run(tmp_path, compression):
    output = {"every": 2} if compression is None else {"every": 2, "compression": compression}
    dartcast.run({"environment": {"generator": "vessel", "core": 2, "rings": 1, "tissue_layers": 1, "step_length": 1.5e-3},
                  "deformation": [{"kind": "pulse", "amplitude": 0.1, "period": 0.1, "field": "pulse_direction"}],
                  "particles": [{"count": 5}], "motion": {"dt": 1e-3, "steps": 2}, "output": output}, tmp_path / "run")
    mesh = meshio.read(tmp_path / "run" / "environment_000002.vtu")
    own = dartcast.read_mesh(tmp_path / "run" / "environment_000002.vtu").mesh
    assert np.array_equal(mesh.points, own.points)
    assert sum(len(block.data) for block in mesh.cells) == own.cell_count
    assert np.array_equal(mesh.point_data["velocity"], own.point_data["velocity"])
    assert set(np.concatenate(mesh.cell_data["free"])) == {0, 1} and "region" in mesh.cell_data
    names = [name for name in bytes(mesh.field_data["region_names"].tolist()).split(b"\0") if name]
    assert sorted(names) == [b"1 lumen", b"2 tissue"] and own.region_names == {1: "lumen", 2: "tissue"}


def test_meshio_reads_a_written_mesh(tmp_path):
    mesh = mixed_box()
    mesh.regions = np.arange(mesh.cell_count) % 2 + 1
    mesh.region_names = {1: "ä <wall>", 2: "b"}
    dartcast.write_mesh(mesh, tmp_path / "a.vtu")
    read = meshio.read(tmp_path / "a.vtu")
    assert np.array_equal(read.points, mesh.points)
    assert sum(len(block.data) for block in read.cells) == mesh.cell_count + len(mesh.patch_tags)
    back = dartcast.read_mesh(tmp_path / "a.vtu").mesh
    assert back.region_names == mesh.region_names and back.patch_names == mesh.patch_names
