"""The code of docs/python.md runs, block after block, and what it prints is what the page says."""
from __future__ import annotations

import contextlib
import io
import pathlib
import re
from typing import Any

import pytest

BLOCK = re.compile(r"```python\n(.*?)```(?:\s*```text\n(.*?)```)?", re.DOTALL)


def test_code_of_the_tour_runs(root: pathlib.Path, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = (root / "docs" / "python.md").read_text(encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {"__name__": "tour"}
    blocks = list(BLOCK.finditer(page))
    assert len(blocks) >= 10
    for block in blocks:
        code, expected = block.groups()
        line = page[: block.start()].count("\n") + 2
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            # Line numbers of errors are those of the page.
            exec(compile("\n" * (line - 1) + code, "docs/python.md", "exec"), names)
        if expected is not None:
            assert printed.getvalue().strip() == expected.strip(), f"docs/python.md:{line}"
