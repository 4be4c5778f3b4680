"""The code of the documents runs, block after block, and what it prints is what the page says; their scenes are scenes."""
from __future__ import annotations

import contextlib
import io
import pathlib
import re
import subprocess
import sys
from typing import Any

import pytest

import dartcast

BLOCK = re.compile(r"```python\n(.*?)```(?:\s*```text\n(.*?)```)?", re.DOTALL)
SCENE = re.compile(r"```toml\n(.*?)```", re.DOTALL)
PAGES = ["extending.md", "python.md", "start.md", "questions.md", "howto/deformation.md", "howto/response.md",
         "howto/results.md", "howto/cuts.md", "howto/objects.md", "howto/solvers.md"]


def test_all_pages_with_code_are_here(root: pathlib.Path) -> None:
    found = [p for p in (root / "docs").rglob("*.md") if BLOCK.search(p.read_text(encoding="utf-8"))]
    assert sorted(p.relative_to(root / "docs").as_posix() for p in found) == sorted(PAGES)


@pytest.mark.parametrize("name", PAGES)
def test_code_of_a_page_runs(root: pathlib.Path, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    page = (root / "docs" / name).read_text(encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {"__name__": "page"}
    for block in BLOCK.finditer(page):
        code, expected = block.groups()
        line = page[: block.start()].count("\n") + 2
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            # Line numbers of errors are those of the page.
            exec(compile("\n" * (line - 1) + code, f"docs/{name}", "exec"), names)
        if expected is not None:
            assert printed.getvalue().strip() == expected.strip(), f"docs/{name}:{line}"


def test_the_other_line_of_the_start_page_runs(root: pathlib.Path, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    code, expected = BLOCK.findall((root / "docs" / "start.md").read_text(encoding="utf-8"))[0]
    monkeypatch.chdir(tmp_path)
    dartcast.write_mesh(dartcast.generate_box(cells=[6, 6, 6]), "my.vtu")
    code, count = re.subn(r"= dc[.]generate_box.*# or ", "= ", code)
    assert count == 1
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(code, {"__name__": "page"})
    assert printed.getvalue() == expected


@pytest.mark.parametrize("name", ["start.md", "questions.md", "howto.md", "howto/objects.md"])
def test_scenes_of_a_page_are_scenes(root: pathlib.Path, name: str) -> None:
    scenes = SCENE.findall((root / "docs" / name).read_text(encoding="utf-8"))
    assert scenes
    for text in scenes:
        dartcast.formats.parse_scene(text, f"docs/{name}")


def test_figures_of_the_concepts_are_drawn(root: pathlib.Path, tmp_path: pathlib.Path) -> None:

    subprocess.run([sys.executable, str(root / "site" / "figures.py"), str(tmp_path)], check=True)
    drawn = sorted(p.name for p in tmp_path.glob("*.svg"))
    assert drawn == sorted(p.name for p in (root / "docs" / "concepts").glob("*.svg"))
    pages = "".join(p.read_text(encoding="utf-8") for p in (root / "docs" / "concepts").glob("*.md"))
    assert all(f"({name})" in pages for name in drawn)
