"""The stubs say what the package has, and the examples pass mypy --strict."""
from __future__ import annotations

import os
import pathlib
import subprocess
import sys

import dartcast

PACKAGE = pathlib.Path(dartcast.__file__).parent


def run(tool: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Runs a tool of mypy. `python -m` cannot start stubtest where mypy is compiled."""
    program = f"import sys; from {tool} import main; sys.argv[0] = '{tool}'; sys.exit(main())"
    if tool == "mypy":
        program = "import sys; from mypy.__main__ import console_entry; sys.exit(console_entry())"
    return subprocess.run([sys.executable, "-c", program, *arguments], capture_output=True, text=True, check=False,
                          env=os.environ | {"MYPYPATH": str(PACKAGE.parent), "MYPY_CACHE_DIR": os.devnull})


def test_stubs_match_the_module(root: pathlib.Path) -> None:
    done = run("mypy.stubtest", "dartcast", "--mypy-config-file", str(root / "pyproject.toml"))
    assert done.returncode == 0, done.stdout + done.stderr


def test_package_and_examples_pass_strict(root: pathlib.Path) -> None:
    scripts = sorted(map(str, (root / "examples" / "python").glob("*.py")))
    assert len(scripts) >= 8
    done = run("mypy", "--strict", "--config-file", str(root / "pyproject.toml"), str(PACKAGE), *scripts)
    assert done.returncode == 0, done.stdout + done.stderr
