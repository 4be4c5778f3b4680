"""Every function has a signature, and the stubs name the arguments of functions as the module does.

stubtest cannot see signatures of pybind11. A call with an argument that no function has is refused with a message that
lists them.
"""
from __future__ import annotations

import ast
import inspect
import pathlib
import re
import types
from collections.abc import Iterator

import dartcast
import pytest

STUB = ast.parse((pathlib.Path(dartcast.__file__).parent / "_core.pyi").read_text(encoding="utf-8"))
# These take a record or its members: their refusal lists the members alone.
MADE_BY_OPTIONS = {"generate_barrel", "generate_box", "generate_maze", "generate_octahedra", "generate_rectangle",
                   "generate_vessel"}
Signature = dict[tuple[str, ...], set[str]]  # the arguments of each overload, and those with a default


def functions(body: list[ast.stmt], where: object, above: str = "") -> Iterator[tuple[str, object, ast.FunctionDef]]:
    """All functions and methods of the stub, each with its name and the object that has it."""
    for node in body:
        if isinstance(node, ast.ClassDef):
            yield from functions(node.body, getattr(where, node.name), f"{above}{node.name}.")
        if isinstance(node, ast.FunctionDef) and not any(re.search(r"^property$|\.setter$", ast.unparse(mark))
                                                         for mark in node.decorator_list):
            yield above + node.name, where, node


def refusal(where: object, name: str) -> str:
    """What the module says to an argument that does not exist."""
    call = where if name == "__init__" else getattr(where, name)
    try:
        call(no_such_argument=0)
    except TypeError as error:
        return str(error)
    pytest.fail(f"{name} takes any argument")


def arguments(signature: str) -> list[str]:
    """The arguments between the outermost brackets of a signature, each with its type and default."""
    parts, depth, quoted = [""], 0, False
    for character in signature[signature.index("(") + 1:]:
        quoted ^= character == "'"
        depth += 0 if quoted else (character in "([{<") - (character in ")]}>")
        if depth < 0:
            break
        if character == "," and depth == 0 and not quoted:
            parts.append("")
        else:
            parts[-1] += character
    return [part.strip() for part in parts if part.strip() not in ("", "*", "/")]


def of_module(message: str, name: str) -> Signature:
    """The signatures that a refusal lists. A record lists its members, and each may be left out."""
    members = re.search(r"has no member 'no_such_argument': it has (.*)$", message)
    if members:
        names = tuple(filter(None, members.group(1).split(", ")))
        return {names: set(names)}
    found: Signature = {}
    for line in re.findall(r"^ +\d+\. (.*)$", message, re.MULTILINE):
        taken = [part for part in arguments(line) if not part.startswith("self:")]
        names = tuple(re.split(r"[:=]", part)[0].strip() for part in taken)
        found.setdefault(names, set()).update(n for n, part in zip(names, taken) if " = " in part)
    assert found, f"{name}: {message}"
    return found


def of_python(function: types.FunctionType) -> Signature:
    """That of a function in Python."""
    parameters = list(inspect.signature(function).parameters.values())[1:]
    return {tuple(p.name for p in parameters): {p.name for p in parameters if p.default is not p.empty}}


def of_stub(nodes: list[ast.FunctionDef]) -> Signature:
    """The signatures of all overloads of one function."""
    found: Signature = {}
    for node in nodes:
        given = node.args
        places = [*given.posonlyargs, *given.args]
        free = {a.arg for a in places[len(places) - len(given.defaults):]}
        free |= {a.arg for a, value in zip(given.kwonlyargs, given.kw_defaults) if value is not None}
        names = tuple(a.arg for a in [*places, *given.kwonlyargs] if a.arg != "self")
        found.setdefault(names, set()).update(free)
    return found


def test_arguments_have_the_names_of_the_module() -> None:
    overloads: dict[str, tuple[object, list[ast.FunctionDef]]] = {}
    for name, where, node in functions(STUB.body, dartcast._core):
        overloads.setdefault(name, (where, []))[1].append(node)
    wrong = []
    for name, (where, nodes) in overloads.items():
        last = name.rsplit(".", 1)[-1]
        if last.startswith("__") and last != "__init__":
            continue  # operators are called without names
        if name in MADE_BY_OPTIONS:
            continue
        own = vars(where).get(last)
        module = of_python(own) if isinstance(own, types.FunctionType) else of_module(refusal(where, last), name)
        if module != of_stub(nodes):
            wrong.append(f"{name}: the module has {module}, the stub {of_stub(nodes)}")
    assert len(overloads) > 600 and not wrong, "\n".join(wrong)


def callables(scope: object, above: str = "") -> Iterator[tuple[str, object]]:
    """All functions of the module, and methods of its classes."""
    for name, value in vars(scope).items():
        if isinstance(value, type) and value.__module__ == "dartcast._core" and not name.startswith("_"):
            yield from callables(value, f"{above}{name}.")
        elif callable(getattr(scope, name)) and not isinstance(value, type) and not name.startswith("_"):
            yield above + name, getattr(scope, name)


def test_every_function_has_a_signature() -> None:
    found = dict(callables(dartcast._core))
    wrong = []
    for name, function in found.items():
        inspect.signature(function)
        first = (function.__doc__ or "").partition("\n")[0]
        if not re.match(rf"{name.rsplit('.', 1)[-1]}\(.*\) -> ", first) or "::" in first:
            wrong.append(f"{name}: {first}")
    assert len(found) > 350 and not wrong, "\n".join(wrong)


def test_signatures_show_names_types_and_defaults() -> None:
    assert str(inspect.signature(dartcast.Environment.update_after_edit)) == \
        "(self, particles, orphaned=<OrphanPolicy.RELOCATE: 1>)"
    assert dartcast.Environment.update_after_edit.__doc__.startswith(
        "update_after_edit(self, particles: Particles, orphaned: OrphanPolicy = OrphanPolicy.RELOCATE) -> UpdateReport\n")
    assert str(inspect.signature(dartcast.Environment)).startswith("(mesh, threads=0")
    assert str(inspect.signature(dartcast.records.StepOptions)) == \
        "(max_contacts: 'int' = 16, tolerance: 'float' = 0.05, max_slices: 'int' = 256, \
max_crossings: 'int' = 1024)"
    assert inspect.signature(dartcast.formats.BoxOptions).parameters["cells"].default == [1, 1, 1]
