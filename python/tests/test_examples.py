"""Every example runs, is short, and draws its picture."""
from __future__ import annotations

import os
import pathlib
import subprocess
import sys

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
