"""The results of a run, read back from its folder: compared with a simulation of the same scene, step by step."""
from __future__ import annotations

import io
import pathlib
import subprocess
import sys
from types import ModuleType, SimpleNamespace
from typing import Any

import dartcast as dc
import matplotlib
import meshio
import numpy as np
import pandas
import pytest
import xarray

matplotlib.use("agg")

SCENE: dict[str, Any] = {
    "environment": {"generator": "vessel", "core": 2, "rings": 1, "tissue_layers": 1, "step_length": 1.5e-3},
    "deformation": [{"kind": "bend", "amplitude": 0.5, "period": 0.1, "axis": [0.0, 0.0, 1.0], "direction": [0.0, 1.0, 0.0],
                     "length": 0.06}],
    "particles": [{"count": 200, "velocity": [0.0, 0.02, 0.0]}, {"inlet": "inlet", "rate": 4000.0, "velocity": [0.0, 0.0, 0.4]}],
    "motion": {"dt": 1e-3, "steps": 60, "field": "velocity", "drag": 50.0},
    "contact": {"response": "absorb", "patch": {"inlet": {"response": "reflect"}, "outlet_left": {"response": "escape"},
                                                "outlet_right": {"response": "escape"}}},
    "statistics": {"residence": True, "pathlines": {"every": 7}},
    "output": {"every": 20, "contacts": True},
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    made = tmp_path_factory.mktemp("run") / "vessel"
    dc.run(SCENE, made)
    return made


@pytest.fixture
def run(folder: pathlib.Path) -> dc.formats.Run:
    return dc.read_run(folder)


def simulated(steps: int) -> tuple[dc.Simulation, list[np.ndarray]]:
    """The same steps without files, with the contacts of each."""
    simulation = dc.Simulation(dc.load_scene(SCENE))
    return simulation, [dc.flat(simulation.step().contacts) for _ in range(steps)]


def test_frames_are_the_states_of_the_simulation(run: dc.formats.Run) -> None:
    assert len(run) == 4 and run.times.tolist() == pytest.approx([0.0, 0.02, 0.04, 0.06])
    for frame in (run[1], run[-1]):
        simulation, _ = simulated(frame.step)
        assert np.array_equal(frame.positions, simulation.positions)
        assert np.array_equal(frame.arrays["velocity"], simulation.velocities)
        assert np.array_equal(frame.arrays["id"], simulation.ids)
        assert np.array_equal(frame.mesh.points, simulation.environment.positions)


def test_a_run_is_a_sequence_of_frames(run: dc.formats.Run) -> None:
    assert [frame.step for frame in run] == [0, 20, 40, 60] == [run[i].step for i in range(-4, 0)]
    assert [frame.step for frame in run[1:]] == [20, 40, 60] and [frame.step for frame in run[::-2]] == [60, 20]
    for wrong in (4, -5):
        with pytest.raises(IndexError, match="there are 4"):
            run[wrong]
    with pytest.raises(TypeError):
        run["0"]


def test_nothing_is_read_before_it_is_asked_for(folder: pathlib.Path, tmp_path: pathlib.Path) -> None:
    for name in ("scene.toml", "particles.pvd", "stats.csv"):
        (tmp_path / name).write_bytes((folder / name).read_bytes())
    run = dc.read_run(tmp_path)
    frames = list(run)
    assert len(frames) == 4 and frames[2].step == 40 and len(run.stats) == 60
    with pytest.raises(FileNotFoundError):
        frames[2].positions
    with pytest.raises(dc.InvalidArgument, match="the run has no summary.json"):
        run.summary


def test_contacts_are_those_of_the_steps(run: dc.formats.Run) -> None:
    simulation, steps = simulated(60)
    contacts = np.concatenate(steps)
    assert len(run.contacts) == len(contacts) == run.summary["contacts"]["total"] > 100
    for column, of in (("x", "point_x"), ("y", "point_y"), ("z", "point_z"), ("normal_z", "normal_z")):
        assert np.array_equal(np.sort(run.contacts[column]), np.sort(contacts[of]))
    names = simulation.environment.map.patch_names
    assert sorted(run.contacts["patch"]) == sorted(names[patch] for patch in contacts["patch"])


def test_tables_have_numbers_and_texts(run: dc.formats.Run) -> None:
    simulation, _ = simulated(60)
    assert run.stats["step"].tolist() == list(range(1, 61)) and run.stats["step"].dtype == np.int64
    assert run.stats["alive"][-1] == len(simulation.positions) and run.stats["absorbed"].sum() == simulation.totals.absorbed
    assert run.stats["kinetic_energy"][-1] == simulation.energy().kinetic
    deposition = run.table("deposition")
    assert dict(zip(deposition["patch"], deposition["deposited"]))["wall"] == run.summary["deposition"]["wall"]["deposited"]
    with pytest.raises(dc.InvalidArgument, match="the run has no planes.csv"):
        run.table("planes")


def test_another_folder_is_refused(tmp_path: pathlib.Path) -> None:
    with pytest.raises(dc.InvalidArgument, match="no folder of a run"):
        dc.read_run(tmp_path)


@pytest.mark.parametrize("compression", ["none", "small", "fast"])
def test_frames_of_any_compression(tmp_path: pathlib.Path, compression: str, monkeypatch: pytest.MonkeyPatch) -> None:
    scene = {"environment": {"generator": "bar"}, "particles": [{"count": 3000, "velocity": [1.0, 0.0, 0.0]}],
             "motion": {"dt": 0.1, "steps": 2}, "output": {"compression": compression}}
    dc.run(scene, tmp_path)
    simulation = dc.Simulation(dc.load_scene(scene))
    frame = dc.read_run(tmp_path)[0]
    if compression == "fast":  # no part of Python unpacks LZ4
        monkeypatch.setitem(sys.modules, "lz4", None)
        with pytest.raises(ImportError, match="lz4"):
            frame.positions
    else:
        assert np.array_equal(frame.positions, simulation.positions)
    assert np.array_equal(frame.mesh.points, simulation.environment.positions)


def test_pieces_of_ranks_are_one_frame(folder: pathlib.Path, run: dc.formats.Run, tmp_path: pathlib.Path) -> None:
    (tmp_path / "scene.toml").write_text("", encoding="utf-8")
    for frame in run[1:3]:
        (tmp_path / frame.file.name).write_bytes(frame.file.read_bytes())
    pieces = "".join(f'<Piece Source="{frame.file.name}"/>' for frame in run[1:3])
    (tmp_path / "particles_000007.pvtp").write_text(f'<VTKFile type="PPolyData"><PPolyData>{pieces}</PPolyData></VTKFile>',
                                                    encoding="utf-8")
    (tmp_path / "particles.pvd").write_text('<VTKFile type="Collection"><Collection><DataSet timestep="0.5" '
                                            'file="particles_000007.pvtp"/></Collection></VTKFile>', encoding="utf-8")
    frame = dc.read_run(tmp_path)[0]
    assert (frame.step, frame.time) == (7, 0.5)
    assert np.array_equal(frame.positions, np.concatenate([run[1].positions, run[2].positions]))
    assert np.array_equal(frame.arrays["id"], np.concatenate([run[1].arrays["id"], run[2].arrays["id"]]))


def test_paths_go_through_all_steps(run: dc.formats.Run) -> None:
    paths = run.paths()
    assert all(identity % 7 == 0 for identity in paths) and len(paths) > 20
    end = dict(zip(run[-1].arrays["id"].tolist(), run[-1].positions))
    alive = [identity for identity in paths if identity in end]
    assert alive and all(np.array_equal(paths[identity][-1], end[identity]) for identity in alive)


def test_paths_go_from_frame_to_frame_where_there_are_no_pathlines(tmp_path: pathlib.Path) -> None:
    dc.run(SCENE | {"statistics": {}}, tmp_path)
    run = dc.read_run(tmp_path)
    start = run[0]
    paths = run.paths()
    assert set(start.arrays["id"].tolist()) <= set(paths)
    assert all(np.array_equal(paths[i][0], x) for i, x in zip(start.arrays["id"].tolist(), start.positions))
    assert max(map(len, paths.values())) == 4


def test_meshio_gets_the_particles(run: dc.formats.Run, tmp_path: pathlib.Path) -> None:
    mesh = run[-1].to_meshio()
    assert isinstance(mesh, meshio.Mesh) and mesh.cells[0].type == "vertex"
    mesh.write(tmp_path / "particles.vtu")
    assert np.array_equal(meshio.read(tmp_path / "particles.vtu").point_data["velocity"], run[-1].arrays["velocity"])


def test_xarray_gets_all_frames(run: dc.formats.Run) -> None:
    data = run.to_xarray()
    assert isinstance(data, xarray.Dataset) and dict(data.sizes) == {"time": 4, "particle": data.particle.size, "axis": 3}
    for k, frame in enumerate(run):
        at = data.isel(time=k).sel(particle=frame.arrays["id"])
        assert np.array_equal(at.position, frame.positions) and np.array_equal(at.velocity, frame.arrays["velocity"])
        assert int(data.position.isel(time=k, axis=0).notnull().sum()) == len(frame)


class Grid:
    """A stand-in for a data set of pyvista. Its cells must be as VTK has them."""

    def __init__(self, *arrays: Any) -> None:
        *self.cells, self.points = arrays
        self.point_data: dict[str, Any] = {}
        self.cell_data: dict[str, Any] = {}


@pytest.mark.parametrize("options", [{"type": "tetrahedron"}, {"type": "mixed"}, {"generator": "octahedra"}, {"type": "prism"}],
                         ids=str)
def test_pyvista_gets_cells_as_vtk_has_them(tmp_path: pathlib.Path, options: dict[str, Any],
                                            monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyvista", SimpleNamespace(PolyData=Grid, UnstructuredGrid=Grid, MultiBlock=dict))
    dc.run({"environment": {"generator": "box", "cells": [2, 2, 2]} | options, "particles": [{"count": 10}],
            "motion": {"dt": 0.1, "steps": 1}}, tmp_path)
    frame = dc.read_run(tmp_path)[0]
    blocks = frame.to_pyvista()
    assert np.array_equal(blocks["particles"].points, frame.positions)
    assert np.array_equal(blocks["particles"].point_data["id"], frame.arrays["id"])
    grid, mesh = blocks["environment"], frame.mesh
    words, types = grid.cells
    at, faces_of_wedges = 0, [[0, 1, 2], [3, 5, 4], [0, 3, 4, 1], [1, 4, 5, 2], [2, 5, 3, 0]]  # of vtkWedge, outwards
    for c, kind in enumerate(types):
        cell = words[at + 1:at + 1 + words[at]]
        at += 1 + words[at]
        assert sorted(cell.tolist()) == sorted(mesh.cell(c).tolist())
        if kind == 13:
            x = grid.points[cell]
            for face in faces_of_wedges:
                a, b, d = x[face[0]], x[face[1]], x[face[2]]
                assert np.dot(np.cross(b - a, d - a), a - x.mean(axis=0)) > 0.0
        elif kind == 42:
            assert cell.tolist() == mesh.cell(c).tolist()
    assert at == len(words) and len(types) == mesh.cell_count


def axes_of(run: dc.formats.Run, what: str) -> Any:
    axes = run.plot(what)
    assert axes.get_title() == what
    axes.figure.savefig(io.BytesIO(), dpi=30)
    return axes


def test_plots_show_the_figures_of_the_summary(run: dc.formats.Run) -> None:
    deposited, escaped = axes_of(run, "deposition").containers
    table = {label.get_text(): bar.get_height() for label, bar in zip(deposited[0].axes.get_xticklabels(), deposited)}
    assert table == {patch: d["deposited"] for patch, d in run.summary["deposition"].items() if d["deposited"] + d["escaped"]}
    assert sum(bar.get_height() for bar in escaped) == run.stats["escaped"].sum()
    labels = [text.get_text() for text in axes_of(run, "residence").get_legend().get_texts()]
    absorbed = run.summary["statistics"]["residence_time"]["absorbed"]
    assert [label for label in labels if label.startswith("absorbed, wall")] == [f"absorbed, wall: {absorbed['wall']['count']:,}"]
    kinetic, potential = axes_of(run, "energy").lines
    assert np.array_equal(kinetic.get_ydata(), run.stats["kinetic_energy"]) and len(potential.get_ydata()) == 60
    shares = axes_of(run, "penetration").collections
    top = shares[2].get_paths()[0].vertices[:, 1]
    assert top.max() == pytest.approx(1.0) and len(shares) == 3
    assert len(axes_of(run, "paths").lines) == len(run.paths())
    points = axes_of(run, "particles").collections[-1].get_offsets()
    assert np.allclose(np.sort(points[:, 0]), np.sort(run[-1].positions[:, 2]))
    with pytest.raises(dc.InvalidArgument, match="there is no 'depth': there are deposition, residence"):
        run.plot("depth")


def test_walls_of_cells_of_all_types_close_the_mesh() -> None:
    """The area of the walls is that of the box, of any cells; a blocked cell is no part of them."""
    from dartcast._plots import walls_of

    def area(mesh: dc.MeshData) -> float:
        total = 0.0
        for walls in walls_of(mesh):
            x = mesh.points[walls]
            total += sum(float(np.linalg.norm(np.cross(x[:, i] - x[:, 0], x[:, i + 1] - x[:, 0]), axis=1).sum()) / 2
                         for i in range(1, walls.shape[1] - 1))
        return total

    for options in ({"type": "tetrahedron"}, {"type": "hexahedron"}, {"type": "prism"}, {"type": "pyramid"}, {"mixed": True}):
        mesh = dc.generate_box(cells=[3, 2, 2], size=[3.0, 2.0, 2.0], **options)
        assert area(mesh) == pytest.approx(32.0), options
    cube = dc.generate_box(cells=[1, 1, 1], size=[1.0, 1.0, 1.0])
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]  # points x slowest
    corners = np.lexsort((cube.points[:, 2], cube.points[:, 1], cube.points[:, 0]))
    assert area(dc.MeshData(cube.points[corners], {"polyhedron": [faces]})) == pytest.approx(6.0)
    mesh = dc.generate_box(cells=[3, 1, 1], size=[3.0, 1.0, 1.0], type="hexahedron")
    mesh.free = np.array([1, 0, 1], dtype=np.uint8)
    assert area(mesh) == pytest.approx(12.0)
    assert sum(len(walls) for walls in walls_of(dc.generate_rectangle(cells=[3, 2], type="polygon"))) >= 10


def test_flat_records_are_what_pandas_takes() -> None:
    environment = dc.Environment(dc.generate_bar())
    particles = environment.add_random(50, seed=3)
    report = environment.advance(particles, particles.positions + [9.0, 0.0, 0.0])
    frame = pandas.DataFrame(dc.flat(report.contacts))
    assert len(frame) == len(report.contacts) > 10 and list(frame.columns)[:8] == [
        "particle", "kind", "last", "patch", "time_of_impact", "point_x", "point_y", "point_z"]
    assert np.array_equal(frame[["normal_x", "normal_y", "normal_z"]].to_numpy(), report.contacts["normal"])
    states = dc.flat(particles.states)
    assert "touching_cell_0" in states.dtype.names and np.array_equal(states["position_y"], particles.positions[:, 1])
    places = dc.topology.surface_places([dc.topology.SurfacePlace()])
    assert dc.flat(places).dtype.names == ("cell", "simplex", "weights_x", "weights_y", "weights_z")
    assert len(dc.flat(report.contacts[:0])) == 0


def test_a_bar_shows_progress(tmp_path: pathlib.Path) -> None:
    program = ("import sys; sys.modules['tqdm.auto'] = None if sys.argv[1] == 'without' else sys.modules.get('tqdm.auto')\n"
               "if sys.modules['tqdm.auto'] is None and sys.argv[1] == 'with': del sys.modules['tqdm.auto']\n"
               "import dartcast as dc\n"
               "scene = {'environment': {'generator': 'bar'}, 'motion': {'dt': 0.1, 'steps': 7}, 'particles': [{'count': 5}]}\n"
               "assert dc.run(scene, progress=True).steps == 7 and dc.run(scene, progress=False).steps == 7\n")
    for tqdm, text in (("with", "7/7"), ("without", "7 of 7 steps (100%)")):
        done = subprocess.run([sys.executable, "-c", program, tqdm], capture_output=True, text=True, check=False)
        assert done.returncode == 0 and text in done.stderr and done.stdout == "", done.stderr
        assert "building the map, placing particles" in done.stderr, done.stderr


def test_the_stages_before_the_first_step_are_told(tmp_path: pathlib.Path) -> None:
    dc.write_mesh(dc.generate_bar(), tmp_path / "bar.vtu")
    scene = dc.load_scene({"environment": {"mesh": str(tmp_path / "bar.vtu")}, "motion": {"steps": 2}, "particles": [{"count": 5}]})
    told: list[str] = []
    dc.formats.run_scene(scene, on_stage=told.append)
    assert told[-1] == "building the map, placing particles"
    steps: list[int] = []
    with pytest.raises(ZeroDivisionError):  # before the first step
        dc.formats.run_scene(scene, progress=lambda done, _: steps.append(done), on_stage=lambda _: 1 // 0)
    assert steps == []
    with pytest.raises(TypeError, match="on_stage: expected a function of a text"):
        dc.formats.run_scene(scene, on_stage=3)


def test_plots_need_matplotlib_and_pictures_do_without(monkeypatch: pytest.MonkeyPatch, run: dc.formats.Run) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib.figure", ModuleType("matplotlib.figure"))
    assert "<img" not in run._repr_html_() and "<table>" in run._repr_html_()
