#!/usr/bin/env python3
"""Writes the stub of the extension module, and the modules that give its names to users, from the module itself.

PYTHONPATH=build/release/python python3 tools/make_stub.py python/dartcast

The names that __init__.py takes stay there. All others are in the modules of MODULES, by the header that has them.

Types in signatures are those of results. An argument may be more: a list instead of an array, a text instead of a member
of an enumeration. There is one section for each public header, by which the site divides its pages.
"""
from __future__ import annotations

import enum
import inspect
import pathlib
import re
import sys
import textwrap
from collections.abc import Iterator

import dartcast._core as core
import numpy

import read_headers

HEAD = '''"""The types of the extension module, one section for each public header. Written by tools/make_stub.py.

Docstrings are those of the headers, at run time. `Points` is float64 (n, 3), C-contiguous; an argument may be all
that numpy.asarray() makes such an array of.
"""
from __future__ import annotations

import enum
import os
import pathlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from types import TracebackType
from typing import Any, ClassVar, Literal, Union, overload

import numpy
import numpy.typing

from ._ids import Cell, CellFace, CellHandle, Dart, Patch, SimplexId, Vertex
from ._ranks import Ranks as _Ranks

__version__: str

Points = numpy.typing.NDArray[numpy.float64]
Floats = numpy.typing.NDArray[numpy.float64]
Integers = numpy.typing.NDArray[numpy.integer[Any]]
Marks = Union[numpy.typing.NDArray[numpy.bool_], numpy.typing.NDArray[numpy.uint8]]
Records = numpy.typing.NDArray[numpy.void]
Vector = Union[Sequence[float], Floats]
Path = Union[str, os.PathLike[str]]
_Points = numpy.typing.ArrayLike
_Numbers = Union[Sequence[float], Floats]
_Wholes = Union[Sequence[int], Integers]
_Pair = tuple[int, int]
_Response = Union[WallResponse, Reflect, Slide, Stick, Absorb, Escape]
_Responses = Union[_Response, WallResponses, Mapping[str, _Response], Mapping[int, _Response], Mapping[Union[str, int, None], _Response]]
_Round = Callable[[Records, Records], Union[Points, tuple[Points, Marks], None]]
_Single = Callable[[Contact, list[WallHit], list[WallHit]], Union[Vector, AfterContact, None]]
_Respond = Union[_Responses, ContactCallback, _Round, _Single]
_SurfaceRespond = Callable[[SurfaceContact], Union[AfterSurfaceContact, Vector, None]]
'''
#: The modules with what no simple program needs, and their headers.
MODULES = {
    "predicates": ("Exact signs of determinants, and the bounds of numbers.", "dynamics predicates validity"),
    "topology": ("Maps and complexes, and their edits.", "cell_complex cell_shape combinatorial_map complex_edit cutting "
                 "map_edits particle_state remeshing surface walls"),
    "formats": ("Files of meshes, scenes and runs, and the scenes in them.", "decompose generators mesh_check mesh_data "
                "mesh_files mesh_part mesh_selection plan report run scene scene_file statistics_files trajectory"),
    "records": ("Options of options, and results of calls.", ""),
}
IDS = "".join(f"from ._ids import {name} as {name}\n" for name in
              ("Cell", "CellFace", "CellHandle", "Dart", "Patch", "SimplexId", "Vertex"))
MORE = {"topology": IDS, "formats": "from ._results import Frame as Frame\nfrom ._results import Run as Run\n"}
NUMBERS = ("Cell", "Vertex", "Patch")
PAIRS = ("Dart", "CellFace", "SimplexId", "CellHandle")
#: What an argument may be, and what a result is.
ARGUMENTS = {**dict.fromkeys(NUMBERS, "int"), **dict.fromkeys(PAIRS, "_Pair"), "list": "Sequence", "dict": "Mapping",
             "Integers": "_Wholes", "Points": "_Points", "Floats": "_Numbers", "WallResponse": "_Response", "WallResponses": "_Responses", "Responses": "_Responses",
             "Respond": "_Respond", "SurfaceRespond": "_SurfaceRespond", "Ranks": "_Ranks"}
RESULTS = {"Vector": "Floats", "Path": "pathlib.Path", "Integers": "NDArray[uint32]", "Iterator": "Iterator[Any]"}
EXIT = ("self, type: type[BaseException] | None, value: BaseException | None, traceback: TracebackType | None")
#: Methods with signatures of their own, and those that stubs leave out.
SPECIAL = {"__eq__": "self, other: object"}
LEFT_OUT = {"__repr__", "__reduce__", "__copy__", "__deepcopy__", "__getstate__", "__setstate__", "__get__", "__hash__"}


def split(text: str, mark: str = ",") -> list[str]:
    """Parts between marks that are in no brackets and in no quotes."""
    parts, depth, quoted = [""], 0, False
    for at, character in enumerate(text):
        quoted ^= character == "'"
        if not quoted:
            depth += (character in "([{") - (character in ")]}")
        if depth == 0 and not quoted and text.startswith(mark, at):
            parts.append("")
        else:
            parts[-1] += character
    return [part.strip() for part in parts if part.strip()]


def type_of(text: str, argument: bool, member: bool = False) -> str:
    """A type of a signature as a stub has it. `member`: of a record, where an id may be none."""
    text = re.sub(r"\[\d+\]", "", text.strip())  # an array of C++ has a length
    unions = split(text, "|")
    if len(unions) > 1:
        return " | ".join(type_of(part, argument, member) for part in unions)
    head, bracket, inner = text.partition("[")
    parts = split(inner[:-1]) if bracket else []
    if text == "dict":
        return "dict[str, Any]"
    if head == "Callable":
        given = ", ".join(type_of(part, not argument) for part in split(parts[0][1:-1]))
        return f"Callable[[{given}], {type_of(parts[1], argument)}]"
    if head == "Optional":
        return f"{type_of(parts[0], argument)} | None"
    if head == "Union":
        return " | ".join(type_of(part, argument) for part in parts)
    if head == "Numbers":
        return f"NDArray[{parts[0]}]" if not argument else "_Numbers" if parts[0] == "float64" else "_Wholes"
    if isinstance(getattr(core, head, None), enum.EnumMeta) and argument:
        return f"{head} | int | str"
    if parts and head != "NDArray":
        return f"{ARGUMENTS.get(head, head) if argument else head}[{', '.join(type_of(p, argument, member) for p in parts)}]"
    made = (ARGUMENTS if argument else RESULTS).get(text, text)
    return f"{made} | None" if member and text in (*NUMBERS[:2], *PAIRS) else made


def default_of(value: object) -> str:
    """A default as a stub can show it."""
    if isinstance(value, enum.Enum):
        return f"{type(value).__name__}.{value.name}"
    return repr(value) if value is None or isinstance(value, (bool, int, str)) or \
        (isinstance(value, float) and numpy.isfinite(value)) else "..."


def with_none(kind: str, default: object) -> str:
    """A pointer or a function of C++ may be null: its default says so."""
    return f"{kind} | None" if default is None and "None" not in kind.split(" | ") else kind


class Function:
    """One line of a docstring: "name(self, x: int = 0) -> float"."""

    def __init__(self, line: str) -> None:
        self.name, _, rest = line.partition("(")
        depth = 1
        for end, character in enumerate(rest):
            depth += (character in "([{") - (character in ")]}")
            if depth == 0:
                break
        self.arguments = split(rest[:end])
        self.result = rest[end + 1:].removeprefix(" -> ")

    def text(self, name: str) -> str:
        given = []
        for argument in self.arguments:
            declared, _, default = argument.partition(" = ")
            known, _, kind = declared.partition(":")
            shown = default if re.fullmatch(r"-?[\d.]+(e[-+]?\d+)?|True|False|None|'.*'|[A-Z]\w+\.[A-Z]\w*", default) else "..."
            given.append(declared if not kind else
                         f"{known}: {with_none(type_of(kind, True), None if default == 'None' else ...)}" +
                         (f" = {shown}" if default else ""))
        result = "None" if name == "__init__" else type_of(self.result, False)
        return f"def {name}({', '.join(given)}) -> {result}: ..."


def functions(value: object) -> list[Function]:
    """The signatures of all overloads: lines of the docstring."""
    name = re.escape(value.__name__)
    return [Function(line) for line in re.findall(rf"^{name}\(.*\) -> .*$", inspect.cleandoc(value.__doc__ or ""), re.MULTILINE)]


def choices(function: Function) -> list[Function]:
    """A function whose result is "A or B": it takes an argument "X or Y", or a flag that chooses B. One for each."""
    if " or " not in function.result:
        return [function]
    found = []
    for i, result in enumerate(function.result.split(" or ")):
        given, is_point = [], False
        for argument in function.arguments:
            name, _, kind = argument.partition(": ")
            if kind == "Vector or Points":  # an array of one point is an array, too
                is_point = i == 1
                argument = f"{name}: {['list[float]', 'Points | Vector'][i]}"
            elif " or " in kind:
                argument = f"{name}: {kind.split(' or ')[i]}"
            elif kind == "bool = False":
                given += ["*"] if i else []
                argument = f"{name}: {['Literal[False] = False', 'Literal[True]'][i]}"
            given.append(argument)
        found.append(Function(f"{function.name}({', '.join(given)}) -> {'Any' if is_point else result}"))
    return found


def overloads(texts: list[str]) -> list[str]:
    return texts if len(texts) == 1 else [line for text in texts for line in ("@overload", text)]


class Stub:
    def __init__(self) -> None:
        core._write_signatures_of_properties()
        names = read_headers.read_headers(pathlib.Path(__file__).resolve().parent.parent / "include" / "dartcast")
        self.headers = {name.name.upper() if name.kind == "constant" else name.name: name.header for name in names}

    def record_arguments(self, cls: type) -> list[str]:
        return [f"{p.name}: {with_none(type_of(p.annotation, True, True), p.default)} = {default_of(p.default)}"
                for p in inspect.signature(cls).parameters.values()]

    def function(self, name: str, value: object) -> list[str]:
        found = functions(value)
        if any("**kwargs" in f.arguments for f in found):  # the members of its options, by name
            options = Function(f"{name}({found[0].arguments[0]}) -> {found[0].result}")
            record = re.search(r"(\w+Options)", found[0].arguments[0])[1]
            named = ", ".join(["*", *self.record_arguments(getattr(core, record))])
            return overloads([options.text(name), f"def {name}({named}) -> {options.result}: ..."])
        return overloads([choice.text(name) for f in found for choice in choices(f)])

    def member(self, name: str, value: object) -> Iterator[str]:
        if isinstance(value, property):
            read = functions(value.fget)[0].result
            yield from ("@property", f"def {name}(self) -> {type_of(read, False)}: ...")
            if value.fset is not None:
                kind = functions(value.fset)[0].arguments[1].partition(": ")[2]
                yield from (f"@{name}.setter", f"def {name}(self, value: {type_of(kind, True)}) -> None: ...")
        elif isinstance(value, staticmethod):
            yield from ("@staticmethod", *self.function(name, value.__func__))
        elif isinstance(value, type):
            yield from self.class_of(name, value)
        elif name == "__exit__":
            yield f"def {name}({EXIT}) -> None: ..."
        elif name in SPECIAL:
            yield f"def {name}({SPECIAL[name]}) -> bool: ..."
        elif callable(value):
            yield from self.function(name, value)
        elif not name.startswith("_"):
            yield f"{name}: ClassVar[{type(value).__name__}]"

    def record(self, cls: type) -> Iterator[str]:
        for parameter in inspect.signature(cls).parameters.values():
            read, given = (with_none(type_of(parameter.annotation, argument, True), parameter.default)
                           for argument in (False, True))
            if read == given:
                yield f"{parameter.name}: {read}"
            else:
                yield from ("@property", f"def {parameter.name}(self) -> {read}: ...", f"@{parameter.name}.setter",
                            f"def {parameter.name}(self, value: {given}) -> None: ...")
        yield f"def __init__({', '.join(['self', *self.record_arguments(cls)])}) -> None: ..."

    def class_of(self, name: str, cls: type) -> Iterator[str]:
        if issubclass(cls, (enum.Enum, BaseException)):
            bases = ", ".join("enum.IntEnum" if b is enum.IntEnum else b.__name__ for b in cls.__bases__)
            values = [f"    {m.name} = {m.value}" for m in cls] if issubclass(cls, enum.Enum) else []
            yield from (f"class {name}({bases}):" + ("" if values else " ..."), *values)
            return
        is_record = "__signature__" in vars(cls)
        lines = list(self.record(cls)) if is_record else []
        known = set(inspect.signature(cls).parameters) | {"__init__"} if is_record else set()
        for member, value in vars(cls).items():
            shown = not member.startswith("_") or (callable(value) and member.startswith("__"))
            if shown and member not in known | LEFT_OUT and not member.startswith("__pyb"):
                lines += self.member(member, value)
        yield from (f"class {name}:" + ("" if lines else " ..."), *(f"    {line}" for line in lines))

    def top(self, name: str, value: object) -> list[str]:
        if isinstance(value, type):
            return list(self.class_of(name, value)) if value.__name__ == name else [f"{name} = {value.__name__}"]
        if callable(value):
            return self.function(name, value)
        kind = {tuple: "tuple[str, ...]", numpy.dtype: "numpy.dtype[numpy.void]"}
        return [f"{name}: {next((k for t, k in kind.items() if isinstance(value, t)), type(value).__name__)}"]

    def sections(self) -> Iterator[tuple[str, str, object]]:
        """All names of the module, each with its header. What Python alone has belongs to what comes before it."""
        header = "error.hpp"
        for name, value in vars(core).items():
            if not name.startswith("_"):
                header = self.headers.get(name, header)
                yield header, name, value

    def text(self) -> str:
        sections: dict[str, list[str]] = {}
        for header, name, value in self.sections():
            sections.setdefault(header, []).extend(self.top(name, value))
        text = HEAD + "".join(f"\n# --- {header}\n" + "\n".join(lines) + f"\n# --- end of {header}\n"
                              for header, lines in sorted(sections.items()))
        return re.sub(r"\bNDArray\[(bool|float64|u?int\d+)\]",
                      lambda m: f"numpy.typing.NDArray[numpy.{m[1].replace('bool', 'bool_')}]", text)

    def modules(self, folder: pathlib.Path) -> dict[str, str]:
        """The modules of Python, by their names."""
        kept = re.findall(r"(\w+) as \1", (folder / "__init__.py").read_text(encoding="utf-8"))
        names: dict[str, list[str]] = {module: [] for module in MODULES}
        for header, name, _ in self.sections():
            if name not in kept:
                names[next((m for m, (_, headers) in MODULES.items() if header[:-4] in headers.split()), "records")].append(name)
        return {module: f'"""{MODULES[module][0]} Written by tools/make_stub.py."""\nfrom ._core import (\n' +
                textwrap.fill(", ".join(f"{name}@as@{name}" for name in sorted(found)), 118, initial_indent="    ",
                              subsequent_indent="    ").replace("@", " ") + ")\n" + MORE.get(module, "")
                for module, found in names.items()}


def main() -> int:
    folder = pathlib.Path(sys.argv[1])
    stub = Stub()
    (folder / "_core.pyi").write_text(stub.text(), encoding="utf-8")
    for module, text in stub.modules(folder).items():
        (folder / f"{module}.py").write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
