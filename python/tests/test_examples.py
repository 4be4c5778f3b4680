"""Every example runs as a script, is short, and draws its picture; as a notebook one does, and all are turned into some."""
from __future__ import annotations

import ast
import base64
import os
import pathlib
import re
import runpy
import subprocess
import sys
from typing import Any

import dartcast
import numpy as np
import pytest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
SCRIPTS = sorted((ROOT / "examples" / "python").glob("*.py"))


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_example(script: pathlib.Path, tmp_path: pathlib.Path) -> None:
    lines = script.read_text(encoding="utf-8").splitlines()
    assert len(lines) <= 40, f"{script.name} has {len(lines)} lines"
    assert (ROOT / "docs" / "python" / f"{script.stem}.png").exists(), "its picture is missing in docs/python"
    picture = tmp_path / "picture.png"
    done = subprocess.run([sys.executable, str(script), str(picture)], cwd=tmp_path, capture_output=True, text=True,
                          check=False, env=os.environ | {"MPLBACKEND": "agg"})
    assert done.returncode == 0, done.stderr
    assert picture.read_bytes().startswith(b"\x89PNG")


sys.path.insert(0, str(ROOT / "tools"))


def test_every_example_is_a_notebook_of_the_same_statements() -> None:
    import make_notebooks
    for script in SCRIPTS:
        text = script.read_text(encoding="utf-8")
        cells = make_notebooks.notebook_of(text).cells
        assert cells[0].source == "# " + ast.get_docstring(ast.parse(text)) and len(cells) > 2
        assert not any("import" in cell.source for cell in cells[2:])
        code = "\n".join(cell.source for cell in cells[1:])
        statements = [ast.unparse(s) for s in ast.parse(text).body[1:]]
        left_out = [s for s in statements if s not in [ast.unparse(t) for t in ast.parse(code).body]]
        assert all("savefig(sys.argv" in s or s == "import sys" for s in left_out) and "sys.argv" not in code, script.name


def test_a_notebook_shows_the_run_and_its_figures(tmp_path: pathlib.Path) -> None:
    """The one whose cells show objects. The code of all is that of the scripts, which run in the test above."""
    done = subprocess.run([sys.executable, str(ROOT / "tools" / "make_notebooks.py"), str(tmp_path),
                           str(ROOT / "examples" / "python" / "results.py")], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    page = (tmp_path / "results.html").read_text(encoding="utf-8")
    pictures = re.findall(r"data:image/png;base64,([A-Za-z0-9+/=\s]{5000,})", page)  # nbconvert has small ones of its own
    assert "<caption>dartcast.Run</caption>" in page and len(pictures) == 2
    assert all(base64.b64decode(picture).startswith(b"\x89PNG") for picture in pictures)
    assert "500/500" in page and "for pandas.DataFrame" in page


@pytest.mark.parametrize("name", ["sofa", "blender", "fenics"])
def test_a_loop_with_a_solver_runs_with_its_stand_in(name: str, tmp_path: pathlib.Path) -> None:
    file = ROOT / "examples" / "solvers" / f"{name}.py"
    # A solver that is installed is not what the test is about.
    program = f"import runpy, sys; sys.modules.update(Sofa=None, bpy=None, dolfinx=None); sys.path.insert(0, {str(file.parent)!r}); " \
              f"runpy.run_path({str(file)!r})"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    count = int(re.search(r"(\d+) contacts", done.stdout)[1])
    assert count > 0 and "0 particles in a wrong cell" in done.stdout or name == "blender", done.stdout


def variables(name: str, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """The variables of an example when it has run."""
    monkeypatch.setattr(sys, "argv", [name, str(tmp_path / "picture.png")])
    monkeypatch.setenv("MPLBACKEND", "agg")
    return runpy.run_path(str(ROOT / "examples" / "python" / f"{name}.py"))


def test_each_hit_of_deposition_is_a_contact(tmp_path, monkeypatch, capsys):
    found = variables("deposition", tmp_path, monkeypatch)
    contacts = found["simulation"].totals.contacts_by_patch
    names = found["environment"].map.patch_names
    assert capsys.readouterr().out.splitlines() == [f"{n or '(others)'}: {c}" for n, c in zip(names, contacts)]
    assert contacts[names.index("wall")] > 10_000 and found["faces"]["hits"].sum() == sum(contacts)


def test_each_tracer_is_in_the_scene_or_has_an_age(tmp_path, monkeypatch):
    found = variables("tracers", tmp_path, monkeypatch)
    totals = found["simulation"].totals
    ages = np.concatenate(list(found["ages"].values()))
    assert totals.injected == 4000 and len(ages) == totals.escaped == 4000 - len(found["simulation"].particles)
    # The vessel is some 60 mm long, and the flow is nowhere faster than 0.34 m/s.
    assert ages.min() > 0.15 and ages.max() <= found["simulation"].time


def test_a_cut_replaces_the_cells_that_it_names(tmp_path, monkeypatch, capsys):
    found = variables("cut", tmp_path, monkeypatch)
    removed, added = (int(word) for word in capsys.readouterr().out.split() if word.isdigit())
    before = dartcast.Environment(dartcast.generate_vessel()).map
    assert found["environment"].map.cell_count() == before.cell_count() - removed + added
    assert dartcast.audit(found["environment"].complex, found["particles"]).failed == 0


def test_points_are_in_the_cells_that_contain_them(tmp_path, monkeypatch):
    found = variables("location", tmp_path, monkeypatch)
    environment, points = found["environment"], found["points"]
    positions, map_ = environment.positions, environment.map
    planes = []
    for cell in map_.cells().tolist():
        view = map_.view(cell)
        corners = [positions[[view.vertex(i) for i in view.shape.corners(f)]] for f in range(view.shape.face_count)]
        normals = np.array([np.cross(c[1] - c[0], c[2] - c[0]) for c in corners])
        middle = positions[[view.vertex(i) for i in range(view.shape.point_count)]].mean(axis=0)
        offsets = np.array([n @ c[0] for n, c in zip(normals, corners)])
        planes.append((cell, normals * (side := np.sign(offsets - normals @ middle))[:, None], offsets * side))
    for i in np.random.default_rng(1).integers(len(points), size=100):
        inside = [cell for cell, normals, offsets in planes if (normals @ points[i] <= offsets + 1e-12).all()]
        place = dartcast.Place(found["found"]["place"][i])
        if place == dartcast.Place.OUTSIDE:
            assert inside == []
        else:
            assert found["found"]["cell"][i] in inside
            assert map_.is_free(int(found["found"]["cell"][i])) == (place == dartcast.Place.FREE)
