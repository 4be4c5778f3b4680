"""Every public name of C++ has its name in Python, and the other way round. Exceptions: names/*.toml, each with a reason.

Rules: `A::b` is `dartcast.A.b`, or in one of its modules. Values of enumerations and constants are in upper case. Operators are the methods that
Python has for them. An exemption of a class holds for all its members.
"""
from __future__ import annotations

import enum
import pathlib
import re
import sys
import tomllib

import dartcast

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
sys.path.insert(0, str(ROOT / "tools"))

import read_headers  # noqa: E402

MODULES = (dartcast, dartcast.formats, dartcast.predicates, dartcast.records, dartcast.topology)
OPERATORS = {"operator[]": "__getitem__", "operator==": "__eq__", "operator+=": "__iadd__", "operator-=": "__isub__",
             "operator*=": "__imul__", "operator+": "__add__", "operator-": "__sub__", "operator*": "__mul__",
             "operator()": "__call__", "size": "__len__"}
# What every class of C++ has, and Python by itself.
UNNAMED = re.compile(r"~\w+|operator=|operator<=>|operator\w+")


def exceptions() -> tuple[dict[str, str], dict[str, str], dict[str, str]]:
    """Exempt names of C++ (reason), renamed ones (name in Python), names of Python alone (reason)."""
    exempt: dict[str, str] = {}
    renamed: dict[str, str] = {}
    python: dict[str, str] = {}
    for path in sorted((HERE / "names").glob("*.toml")):
        tables = tomllib.loads(path.read_text(encoding="utf-8"))
        assert not set(tables) - {"exempt", "renamed", "python"}, f"{path}: tables are exempt, renamed and python"
        exempt |= tables.get("exempt", {})
        renamed |= {name: entry["is"] if isinstance(entry, dict) else entry
                    for name, entry in tables.get("renamed", {}).items()}
        python |= tables.get("python", {})
    return exempt, renamed, python


def python_name(name: read_headers.Name) -> str | None:
    """The name that Python should have; none where it needs none."""
    *classes, last = name.name.split("::")
    if UNNAMED.fullmatch(last) or (classes and last == classes[-1]):
        return None
    if name.kind in ("value", "constant"):
        last = last.upper()
    return ".".join([*classes, OPERATORS.get(last, last) if last.startswith("operator") else last])


def has(name: str) -> bool:
    """Whether dartcast.NAME exists; size may be __len__."""
    first = name.split(".")[0]
    at: object = next((module for module in MODULES if hasattr(module, first)), dartcast)
    for part in name.split("."):
        if part == "size" and not hasattr(at, part):
            part = "__len__"
        if not hasattr(at, part) or (part == "__eq__" and getattr(at, part) is object.__eq__):
            return False
        at = getattr(at, part)
    return True


def cpp_names() -> dict[str, read_headers.Name]:
    return {name.name: name for name in read_headers.read_headers(ROOT / "include" / "dartcast")}


def public(names: object) -> list[str]:
    return [name for name in names if not name.startswith("_")]  # type: ignore[attr-defined]


def python_names() -> set[str]:
    """All public names of the package: functions, classes, their members."""
    found: set[str] = set()
    everything = {name: value for module in MODULES for name, value in vars(module).items()}
    for name in public(everything):
        value = everything[name]
        if isinstance(value, type(dartcast)):
            continue  # a module
        found.add(name)
        if isinstance(value, type):
            members = value.__members__ if issubclass(value, enum.Enum) else vars(value)
            is_error = issubclass(value, BaseException)
            found |= {f"{name}.{member}" for member in public(members) if not is_error}
            found |= {f"{name}.{inner}.{member}" for inner in public(vars(value))
                      if isinstance(getattr(value, inner), type) for member in public(vars(getattr(value, inner)))}
    return found


def covers(table: dict[str, str], name: str, mark: str) -> bool:
    parts = name.split(mark)
    return any(mark.join(parts[:i]) in table for i in range(1, len(parts) + 1))


def test_every_name_of_cpp_is_in_python() -> None:
    exempt, renamed, _ = exceptions()
    missing = []
    for name, found in cpp_names().items():
        if covers(exempt, name, "::"):
            continue
        wanted = renamed.get(name) or python_name(found)
        if wanted is not None and not has(wanted):
            missing.append(f"{found.header}:{found.line}: {name}: no dartcast.{wanted}")
    assert not missing, "\n".join(["", *missing, f"{len(missing)} names are missing"])


def test_every_name_of_python_is_in_cpp() -> None:
    _, renamed, python = exceptions()
    known = {python_name(name) for name in cpp_names().values()} | set(renamed.values())
    known |= {name.rsplit(".", 1)[0] + ".size" for name in known if name and name.endswith(".__len__")}
    unknown = sorted(name for name in python_names() if name not in known and not covers(python, name, "."))
    assert not unknown, "\n".join(["", *unknown, f"{len(unknown)} names are in no header and in no names/*.toml"])


def test_exceptions_name_what_exists() -> None:
    exempt, renamed, python = exceptions()
    names, ours = set(cpp_names()), python_names()
    stale = [name for name in [*exempt, *renamed] if name not in names]
    stale += [name for name in python if name not in ours and not has(name)]
    assert not stale, f"names/*.toml names what does not exist: {', '.join(stale)}"
    both = [name for name in exempt if name in renamed]
    assert not both, f"exempt and renamed: {', '.join(both)}"
    short = [name for name, reason in [*exempt.items(), *python.items()] if len(reason) < 8]
    assert not short, f"without a reason: {', '.join(short)}"


def described(value: object) -> bool:
    """Whether a docstring says more than the signatures that pybind11 writes. Enumerations have the text of Enum else."""
    text = getattr(value, "__doc__", None) or ""
    signature = re.compile(r"(\d+\. )?\w+\(.*\) -> .*|Overloaded function\.")
    inherited = isinstance(value, type) and text == getattr(value.__base__, "__doc__", None)
    return not inherited and any(line.strip() and not signature.fullmatch(line.strip()) for line in text.splitlines())


def test_every_class_and_function_has_a_docstring() -> None:
    """Attributes need one only where their name does not say it: the headers decide."""
    missing = []
    for name, found in cpp_names().items():
        wanted = python_name(found)
        if found.kind not in ("class", "enum", "function") or wanted is None or not has(wanted) or "__" in wanted:
            continue
        value: object = next(module for module in MODULES if hasattr(module, wanted.split(".")[0]))
        for part in wanted.split("."):
            value = getattr(value, part)
        if (callable(value) or found.doc) and not described(value):
            missing.append(name)
    assert not missing, f"no docstring: {', '.join(missing)}"
