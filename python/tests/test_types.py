"""The stubs say what the package has, and the examples pass mypy --strict."""
from __future__ import annotations

import ast
import functools
import os
import pathlib
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator

import dartcast
import numpy as np
import pytest

PACKAGE = pathlib.Path(dartcast.__file__).parent


def run(tool: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Runs a tool of mypy. `python -m` cannot start stubtest where mypy is compiled."""
    program = f"import sys; from {tool} import main; sys.argv[0] = '{tool}'; sys.exit(main())"
    if tool == "mypy":
        program = "import sys; from mypy.__main__ import console_entry; sys.exit(console_entry())"
    return subprocess.run([sys.executable, "-c", program, *arguments], capture_output=True, text=True, check=False,
                          env=os.environ | {"MYPYPATH": str(PACKAGE.parent), "MYPY_CACHE_DIR": os.devnull})


# What stubtest finds in every module of pybind11, the aliases for annotations, and classes that only calls make.
KNOWN = re.compile(r"metaclass differs$|\.__(copy|deepcopy|signature)__ is not present in stub|"
                   r"_core\.(Floats|Integers|Marks|Path|Points|Records|Vector) is not present at runtime|"
                   r"__init__ is inconsistent, stub does not have \*args")


STUB = ast.parse((PACKAGE / "_core.pyi").read_text(encoding="utf-8"))
ALIASES = {node.targets[0].id: node.value for node in STUB.body
           if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name)}


def classes(body: list[ast.stmt], where: object) -> Iterator[tuple[type, ast.ClassDef]]:
    """All classes of the stub with those of the package, nested ones too."""
    for node in body:
        if isinstance(node, ast.ClassDef):
            found = getattr(where, node.name)
            yield found, node
            yield from classes(node.body, found)


def members(node: ast.ClassDef) -> Iterator[tuple[str, ast.expr]]:
    """Attributes and properties with their types."""
    for item in node.body:
        if isinstance(item, ast.AnnAssign) and isinstance(item.target, ast.Name):
            yield item.target.id, item.annotation
        if isinstance(item, ast.FunctionDef) and any(isinstance(d, ast.Name) and d.id == "property"
                                                     for d in item.decorator_list) and item.returns:
            yield item.name, item.returns


def fits_array(value: object, text: str) -> bool:
    """Whether a value is an array as the stub says: by its dtype, and Points by its shape."""
    if not isinstance(value, np.ndarray):
        return False
    if text in ("Points", "Floats"):
        return value.dtype == np.float64 and (text == "Floats" or (value.ndim == 2 and value.shape[1] == 3))
    return text == "Records" and value.dtype.names is not None or text.endswith(f"[numpy.{value.dtype.name}]") or \
        text.endswith("[numpy.bool_]") and value.dtype == np.bool_


def fits(value: object, kind: ast.expr, scope: type) -> bool:
    """Whether a value is of a type of the stub."""
    text = ast.unparse(kind)
    if isinstance(kind, ast.BinOp):
        return fits(value, kind.left, scope) or fits(value, kind.right, scope)
    if text == "None":
        return value is None
    if text in ("Points", "Floats", "Records") or text.startswith("numpy.typing.NDArray"):
        return fits_array(value, text)
    if text in ALIASES:
        return fits(value, ALIASES[text], scope)
    if isinstance(kind, ast.Subscript):
        head = ast.unparse(kind.value)
        parts = kind.slice.elts if isinstance(kind.slice, ast.Tuple) else [kind.slice]
        if head == "Union":
            return any(fits(value, part, scope) for part in parts)
        if head == "ClassVar":
            return fits(value, kind.slice, scope)
        if head == "list":
            return isinstance(value, list) and all(fits(item, kind.slice, scope) for item in value)
        if head == "dict":
            return isinstance(value, dict) and all(fits(item, parts[1], scope) for item in value.values())
        if head == "tuple":
            return isinstance(value, tuple)
        return head == "Callable" and callable(value)
    if text == "Any":
        return True
    if text == "pathlib.Path":
        return isinstance(value, pathlib.Path)
    if text in ("int", "Vertex", "Cell", "Patch"):
        return type(value) is int
    named = {"float": float, "bool": bool, "str": str}.get(text)
    if named is None:
        where = dartcast._core if hasattr(dartcast._core, text.split(".")[0]) else dartcast.topology
        named = getattr(scope, text, None) or functools.reduce(getattr, text.split("."), where)
    return type(value) is named


@pytest.mark.parametrize("kind, node", [pytest.param(kind, node, id=kind.__name__)
                                        for kind, node in classes(STUB.body, dartcast._core)])
def test_members_have_the_types_of_the_stub(kind: type, node: ast.ClassDef) -> None:
    try:
        made = kind()
    except TypeError:
        made = kind  # only its constants can be looked at
    wrong = [f"{name}: {value!r} is no {ast.unparse(annotation)}" for name, annotation in members(node)
             for value in [getattr(made, name)] if not isinstance(value, property) and not fits(value, annotation, kind)]
    assert not wrong, "\n".join(wrong)


def test_written_files_are_those_of_the_module(root: pathlib.Path, tmp_path: pathlib.Path) -> None:
    shutil.copy(PACKAGE / "__init__.py", tmp_path)
    subprocess.run([sys.executable, str(root / "tools" / "make_stub.py"), str(tmp_path)], check=True,
                   env=os.environ | {"PYTHONPATH": str(PACKAGE.parent)})
    stale = [path.name for path in sorted(tmp_path.glob("*.py*"))
             if path.read_text(encoding="utf-8") != (PACKAGE / path.name).read_text(encoding="utf-8")]
    assert not stale, f"{stale} are not those of the module. Renew them: PYTHONPATH=build/release/python python3 " \
                      "tools/make_stub.py python/dartcast"


def test_no_signature_is_a_draft() -> None:
    drafts = [ast.unparse(node).splitlines()[0] for node in ast.walk(STUB)
              if isinstance(node, ast.FunctionDef) and (node.args.vararg or node.args.kwarg)]
    assert drafts == []


def test_stubs_match_the_module() -> None:
    done = run("mypy.stubtest", "dartcast._core", "--concise")
    found = [line for line in done.stdout.splitlines() if not KNOWN.search(line)]
    assert not found and "not checking" not in done.stdout + done.stderr, "\n".join(found) + done.stderr


def test_package_and_examples_pass_strict(root: pathlib.Path) -> None:
    scripts = sorted(map(str, (root / "examples" / "python").glob("*.py")))
    assert len(scripts) >= 8
    done = run("mypy", "--strict", "--config-file", str(root / "pyproject.toml"), str(PACKAGE), *scripts)
    assert done.returncode == 0, done.stdout + done.stderr
