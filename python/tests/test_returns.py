"""Each function returns what its stub says: one call of each, those of memory_growth.py, whose result is looked at."""
from __future__ import annotations

import ast
import collections
from collections.abc import Iterator

import calls
import dartcast
from test_types import STUB, fits

#: Calls whose result is another function's: they make an object first, or go on with the result.
ELSEWHERE = {"Bodies.add", "MeshFile.__iter__", "Particles.__iter__"}


def returns(body: list[ast.stmt], scope: object, before: str) -> Iterator[tuple[str, ast.expr, object]]:
    """All functions and methods of the stub with their results, and the class that has them."""
    for node in body:
        if isinstance(node, ast.ClassDef):
            yield from returns(node.body, getattr(scope, node.name), f"{before}{node.name}.")
        elif isinstance(node, ast.FunctionDef) and node.returns is not None:
            yield before + node.name, node.returns, scope


def test_results_have_the_types_of_the_stub() -> None:
    """Calls that do and undo end without a result, or with a tuple of two."""
    stub: dict[str, list[tuple[ast.expr, object]]] = collections.defaultdict(list)
    for name, kind, scope in returns(STUB.body, dartcast._core, ""):
        stub[name].append((kind, scope))
    wrong, looked_at = [], 0
    for key, call in calls.all_calls().items():
        name, _, case = key.partition(":")
        if "refused" in case or name not in stub or name in ELSEWHERE:
            continue
        value, kinds = call(), [ast.unparse(kind) for kind, _ in stub[name]]
        if value is None or (type(value) is tuple and not any("tuple" in kind for kind in kinds)):
            continue
        looked_at += 1
        if not any(fits(value, kind, scope) for kind, scope in stub[name]):
            wrong.append(f"{key}: {str(value)[:80]} ({type(value).__name__}) is no {' or '.join(kinds)}")
    assert not wrong, "\n".join(wrong)
    assert looked_at > 400
