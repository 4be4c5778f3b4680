"""Calls every function and setter with arguments of wrong kinds and sizes, drawn at random.

Most arguments are of the kind that the stub asks for, so that calls come further than their first check; their sizes and
numbers are wrong more often than not. A call may raise only errors that a caller expects. Its text is written to
calls.log first, for the case that it crashes or hangs. Equal seeds make equal calls.

Run as a program: wrong_kinds.py [ROUNDS] [SEED] [NAME]. It works in a new folder. With a name it calls that alone.
"""
from __future__ import annotations

import ast
import os
import resource
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterator
from typing import Any, TextIO

import numpy as np

import dartcast as dc
from calls.objects import living
from test_signatures import STUB, functions

EXPECTED = (dc.Error, TypeError, ValueError, OverflowError, MemoryError, IndexError, KeyError, AttributeError, OSError)
MEMORY = 2 << 30  # bytes of addresses; beyond it a call must raise MemoryError
SECONDS = 60.0  # of processor time that a call may take
OF_THE_KIND = 0.8  # share of arguments

Values = dict[str, list[Any]]


def pools(random: np.random.Generator, objects: dict[str, object]) -> Values:
    """Values by the words of annotations that ask for them."""
    points = random.uniform(-1.0, 2.0, (4, 3))
    found: Values = {
        "int": [0, 1, 2, 3, 5, 100, -1, 2**31, 2**32, 2**40, 2**63, 2**70, True],
        "float": [0.0, 0.1, 0.5, 1.0, 2.5, -1.5, 1e-300, 1e300, 2.0**301, float("nan"), float("inf"), 7],
        "bool": [True, False, 1, None], "None": [None],
        "str": ["", "x", "volume", "face", "xmin", "\0", "\ud800", "a" * 5000],
        "Path": ["", "none.vtu", "made.vtu", "made.msh", "made.stl", "made.csv", "made.vtp", "no/such/folder/x.vtu", ".", "\0", "x" * 300],
        "Vector": [[0.1, 0.2, 0.3], points[0], (0.5, 0.5, 0.5), [0.0, 0.0, 0.0], [1e300, 0.0, 0.0], [np.nan, 0.0, 0.0], [0.1, 0.2]],
        "Points": [points, points[:0], np.full((4, 3), np.nan), points[:, :2], points.T, points.astype(np.float32), points[0]],
        "Array": [points, points[0], np.arange(4), np.arange(4, dtype=np.uint32), np.zeros((0, 3)), np.array(["a"]), np.array(3.0),
                  np.ones(4, dtype=bool), np.arange(200), np.full(4, 2**40)],
        "Sequence": [[], [0], [1, 2, 3], [0.5] * 3, [-1], [2**40], ["xmin"], [points], (), [None], [points[0]]],
        "dict": [{}, {"x": 1}, {"tetra": [[0, 1, 2, 3]]}, {None: dc.Slide()}], "Mapping": [{}, {"x": 1}, {1: "a"}],
        "Callable": [len, lambda *_: None, lambda x: x, lambda *a: 1 / 0],
    }
    for name, thing in objects.items():
        found.setdefault(name, []).append(thing)
    return found


ALIASES = {"NDArray": "Array", "ndarray": "Array", "ArrayLike": "Array", "FloatArray": "Array", "Ids": "Array", "Cell": "int",
           "Vertex": "int", "Patch": "int", "PathLike": "Path", "Iterable": "Sequence", "list": "Sequence", "tuple": "Sequence",
           "_Wholes": "Sequence", "_Numbers": "Sequence", "_Pair": "Sequence", "Floats": "Array", "Records": "Array"}


def words(annotation: ast.expr | None) -> list[str]:
    """The names in an annotation, those in brackets last."""
    nodes = ast.walk(annotation) if annotation else []
    return [ALIASES.get(w, w) for w in (n.id if isinstance(n, ast.Name) else n.attr if isinstance(n, ast.Attribute)
                                        else str(n.value) if isinstance(n, ast.Constant) else "" for n in nodes) if w]


class Caller:
    """Draws arguments, and calls."""

    def __init__(self, random: np.random.Generator, log: TextIO) -> None:
        self.random, self.log, self.count = random, log, 0
        self.objects: dict[str, object] = {}
        self.pools: Values = {}

    def refresh(self) -> None:
        self.objects = living()
        self.pools = pools(self.random, self.objects)

    def of(self, pool: list[Any]) -> Any:
        return pool[self.random.integers(len(pool))]

    def made(self, cls: str) -> list[Any]:
        """A record as it is when it is made without arguments."""
        try:
            return [getattr(dc._core, cls)()]
        except (AttributeError, *EXPECTED):
            return []

    def value(self, annotation: ast.expr | None) -> Any:
        kinds = [pool for w in words(annotation) for pool in [self.pools.get(w) or self.made(w)] if pool]
        if kinds and self.random.uniform() < OF_THE_KIND:
            return self.of(self.of(kinds[:3]))
        return self.of(self.of(list(self.pools.values())))

    def arguments(self, node: ast.FunctionDef, is_method: bool) -> tuple[list[Any], dict[str, Any]]:
        asked = node.args.posonlyargs + node.args.args
        asked = asked[1:] if is_method else asked
        needed = len(asked) - len(node.args.defaults)
        count = int(self.random.integers(needed, len(asked) + 1)) if self.random.uniform() < 0.95 else int(self.random.integers(7))
        named = {a.arg: self.value(a.annotation) for a in node.args.kwonlyargs if self.random.uniform() < 0.3}
        return [self.value(a.annotation) for a in asked[:count]], named

    def call(self, name: str, function: Callable[..., object], arguments: list[Any], named: dict[str, Any]) -> None:
        text = ", ".join([ascii(a)[:80] for a in arguments] + [f"{k}={ascii(v)[:80]}" for k, v in named.items()])
        self.log.write(f"{name}({text})\n")
        self.log.flush()
        before = os.times()
        try:
            function(*arguments, **named)
        except (*EXPECTED, ZeroDivisionError):
            pass
        after = os.times()
        taken = after.user + after.system - before.user - before.system
        if taken > SECONDS:
            raise AssertionError(f"{name}({text}) took {taken:.1f} s")
        self.count += 1


def owner(caller: Caller, name: str, where: object) -> object:
    """The object whose method is called: a living one, or a record as it is made."""
    above = name.rpartition(".")[0]
    if above in caller.objects:
        return caller.objects[above]
    try:
        return where() if isinstance(where, type) else None
    except EXPECTED:
        return None


def round_of_calls(caller: Caller, only: str) -> None:
    caller.refresh()
    for name, where, node in functions(STUB.body, dc._core):
        if (only and name != only) or (node.name.startswith("_") and node.name != "__init__"):
            continue
        is_static = any(ast.unparse(mark) == "staticmethod" for mark in node.decorator_list)
        if node.name == "__init__":
            arguments, named = caller.arguments(node, is_method=True)
            caller.call(name, where, arguments, named)  # type: ignore[arg-type]
            continue
        thing = owner(caller, name, where) if isinstance(where, type) and not is_static else where
        if thing is None:
            continue
        arguments, named = caller.arguments(node, is_method=thing is not where)
        caller.call(name, getattr(thing, node.name), arguments, named)
    for name, thing, member, annotation in setters(caller):
        if not only or name == only:
            caller.call(name, lambda value, t=thing, m=member: setattr(t, m, value), [caller.value(annotation)], {})


def setters(caller: Caller) -> Iterator[tuple[str, object, str, ast.expr | None]]:
    def search(body: list[ast.stmt], where: object, above: str) -> Iterator[tuple[str, object, str, ast.expr | None]]:
        for node in body:
            if isinstance(node, ast.ClassDef):
                yield from search(node.body, getattr(where, node.name), f"{above}{node.name}.")
            if isinstance(node, ast.FunctionDef) and any(ast.unparse(m).endswith(".setter") for m in node.decorator_list):
                thing = owner(caller, above + node.name, where)
                if thing is not None:
                    yield f"{above}{node.name}=", thing, node.name, node.args.args[1].annotation
    yield from search(STUB.body, dc._core, "")


def main(rounds: int, seed: int, only: str) -> None:
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    warnings.simplefilter("ignore")
    os.chdir(tempfile.mkdtemp(prefix="dartcast_wrong_kinds_"))
    with open("calls.log", "w", encoding="utf-8", errors="backslashreplace") as log:
        caller = Caller(np.random.default_rng(seed), log)
        for _ in range(rounds):
            round_of_calls(caller, only)
    print(f"{caller.count} calls, in {os.getcwd()}")


if __name__ == "__main__":
    given = sys.argv[1:] + [""] * 3
    main(int(given[0] or 3), int(given[1] or 1), given[2])
