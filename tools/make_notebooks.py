#!/usr/bin/env python3
"""Writes each example of Python as a notebook, executed, with its pictures. Usage: make_notebooks.py OUT [SCRIPT]...

The docstring is the title, all imports are a cell, and so is each paragraph behind them. The picture that a script saves is shown instead. It needs nbconvert
and ipykernel, and dartcast on PYTHONPATH. OUT gets NAME.ipynb and NAME.html.
"""
from __future__ import annotations

import ast
import os
import pathlib
import re
import sys

import nbconvert
import nbformat
from nbconvert.preprocessors import ExecutePreprocessor

ROOT = pathlib.Path(__file__).resolve().parent.parent
TIMEOUT = 600  # of a cell, s
FILE_OF_SCRIPT = re.compile(r"^import sys\n|^.*savefig\(sys\.argv.*\n", re.MULTILINE)


def notebook_of(script: str) -> nbformat.NotebookNode:
    """A notebook, not executed. Code that Python knows as one statement stays in one cell."""
    tree = ast.parse(script)
    title = ast.get_docstring(tree) or ""
    code = FILE_OF_SCRIPT.sub("", script[script.index('"""', 3) + 3:]).strip()
    cells = re.split(r"\n\n+(?=[^\s#)\]}])(?!import |from )", code)
    new = nbformat.v4
    return new.new_notebook(cells=[new.new_markdown_cell(f"# {title}"), *map(new.new_code_cell, cells)],
                            metadata={"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}})


def execute(notebook: nbformat.NotebookNode, folder: pathlib.Path) -> None:
    """Runs all cells in a folder. Raises CellExecutionError if one raises."""
    os.environ.pop("MPLBACKEND", None)  # pictures belong into the notebook
    ExecutePreprocessor(timeout=TIMEOUT, kernel_name="python3").preprocess(notebook, {"metadata": {"path": str(folder)}})


def main() -> int:
    out = pathlib.Path(sys.argv[1]).resolve()
    out.mkdir(parents=True, exist_ok=True)
    for script in map(pathlib.Path, sys.argv[2:] or sorted((ROOT / "examples" / "python").glob("*.py"))):
        notebook = notebook_of(script.read_text(encoding="utf-8"))
        execute(notebook, out)
        nbformat.write(notebook, out / f"{script.stem}.ipynb")
        (out / f"{script.stem}.html").write_text(nbconvert.HTMLExporter().from_notebook_node(notebook)[0], encoding="utf-8")
        print(out / f"{script.stem}.ipynb")
    return 0


if __name__ == "__main__":
    sys.exit(main())
