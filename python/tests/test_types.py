"""The stubs say what the package has, and the examples pass mypy --strict."""
from __future__ import annotations

import os
import pathlib
import re
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


# What stubtest finds in every module of pybind11, the aliases for annotations, and classes that only calls make.
KNOWN = re.compile(r"metaclass differs$|\.__(copy|deepcopy)__ is not present in stub|"
                   r"_core\.(Floats|Integers|Marks|Path|Points|Records|Vector) is not present at runtime|"
                   r"__init__ is inconsistent, stub does not have \*args")


def test_stubs_match_the_module() -> None:
    done = run("mypy.stubtest", "dartcast._core", "--concise")
    found = [line for line in done.stdout.splitlines() if not KNOWN.search(line)]
    assert not found and "not checking" not in done.stdout + done.stderr, "\n".join(found) + done.stderr


def test_package_and_examples_pass_strict(root: pathlib.Path) -> None:
    scripts = sorted(map(str, (root / "examples" / "python").glob("*.py")))
    assert len(scripts) >= 8
    done = run("mypy", "--strict", "--config-file", str(root / "pyproject.toml"), str(PACKAGE), *scripts)
    assert done.returncode == 0, done.stdout + done.stderr
