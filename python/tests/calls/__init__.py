"""Calls of every public function of dartcast, on small scenes, for memory_growth.py.

A call can be repeated without end: it leaves all objects as they were. Objects that are meant to grow are made anew in
each call: simulations that get particles, events or pulls, deformations with pulls, sums of hits, meshes with added
cells.

The name of a call is that of its function: "dimension", "Shape.phi1" (a method), "Shape" (the constructor), "Shape.key"
(reading a property), "MeshData.free=" (setting it). What follows a colon tells several calls of one function apart.
"""
from __future__ import annotations

import enum
import types
from collections.abc import Callable

import dartcast as dc

MODULES = (dc, dc.formats, dc.predicates, dc.records, dc.topology)
Calls = dict[str, Callable[[], object]]

#: Methods that Python itself gives a class.
BY_PYTHON = {"__new__", "__init__", "__getattribute__", "__setattr__", "__delattr__", "__class_getitem__"}
#: Methods that every record has.
OF_RECORDS = ("__repr__", "__eq__", "__reduce__", "__deepcopy__")
#: Names without calls, and why. Enumerations and errors have none either: they are Python's own classes.
EXEMPT = {
    "Cell": "typing.NewType: a name for types", "Vertex": "typing.NewType: a name for types",
    "Patch": "typing.NewType: a name for types",
    "mpi_ranks": "Python's own: test_ranks.py has it",
    "read_run": "Python's own: test_results.py has it", "flat": "Python's own: test_results.py has it",
    "Dart": "a NamedTuple, without code of its own", "CellFace": "a NamedTuple, without code of its own",
    "CellHandle": "a NamedTuple, without code of its own", "SimplexId": "a NamedTuple, without code of its own",
}


def refused(call: Callable[[], object]) -> Callable[[], None]:
    """The call must raise an error."""
    def try_it() -> None:
        try:
            call()
        except (dc.Error, TypeError, ValueError, IndexError, AttributeError, KeyError, OSError):
            return
        raise AssertionError("a wrong call was not refused")
    return try_it


def is_record(cls: type) -> bool:
    """Whether the class is a plain record: it is made, read, compared and copied in the same way as all others."""
    return "__reduce__" in vars(cls) and "__eq__" in vars(cls)


def classes() -> dict[str, type]:
    """All classes with code in C++, nested ones too; not their second names."""
    found: dict[str, type] = {}

    def search(scope: object, before: str) -> None:
        for name, value in vars(scope).items():
            if isinstance(value, type) and not name.startswith("_") and value.__qualname__ == before + name \
                    and value.__module__ == "dartcast._core" and not issubclass(value, (enum.Enum, BaseException)):
                found[before + name] = value
                search(value, before + name + ".")
    for module in MODULES:
        search(module, "")
    return found


def names() -> set[str]:
    """Every function, constructor, method and property of the package."""
    found = {name for module in MODULES for name, value in vars(module).items()
             if callable(value) and not isinstance(value, (type, types.ModuleType)) and not name.startswith("_")}
    for name, cls in classes().items():
        found.add(name)
        for member, value in vars(cls).items():
            if isinstance(value, property):
                found |= {f"{name}.{member}"} | ({f"{name}.{member}="} if value.fset else set())
            elif (callable(value) or isinstance(value, staticmethod)) and not isinstance(value, type) \
                    and member not in BY_PYTHON and (member.startswith("__") or not member.startswith("_")):
                found.add(f"{name}.{member}")
    return found - set(EXEMPT)


def covered(table: Calls) -> set[str]:
    """The names that the table calls. The call of a record is all that records have in common."""
    found = {name.partition(":")[0] for name in table}
    for name, cls in classes().items():
        if is_record(cls) and name in found:
            found |= {f"{name}.{member}" for member in OF_RECORDS}
            for member, value in vars(cls).items():
                if isinstance(value, property):
                    found |= {f"{name}.{member}", f"{name}.{member}="}
    return found


def all_calls() -> Calls:
    from . import editing, environments, fields, meshes, objects, particles, records, simulations, solids, topology

    table: Calls = {}
    for part in (records, objects, meshes, topology, editing, environments, particles, fields, solids, simulations):
        table |= part.calls()
    return table
