"""No call leaks memory, and the table of calls has all functions. Random calls leave every particle in its place."""
from __future__ import annotations

import os
import pathlib
import subprocess
import sys

import calls
import memory_growth
import pytest
from conftest import full

HERE = pathlib.Path(__file__).resolve().parent

#: Four functions that leak in each call, and one that does not. The program prints the growth of each.
PLANTED = """
import ctypes, sys
sys.path.insert(0, sys.argv[1])
import memory_growth
import numpy as np
import dartcast
kept, libc, python = [], ctypes.CDLL(None), ctypes.pythonapi
map_ = dartcast.topology.CombinatorialMap(dartcast.generate_box())

def append(): kept.append(None)
def malloc(): libc.malloc(16)
def view(): python.Py_IncRef(ctypes.py_object(map_.view(0x20000000)))
def array(): python.Py_IncRef(ctypes.py_object(np.zeros(1000)))
def cycle(): cycle = [map_.cells()]; cycle.append(cycle)

for call in (append, malloc, view, array, cycle):
    print(*memory_growth.growth(call, 200))
"""


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, *arguments], capture_output=True, text=True,
                          env=os.environ | memory_growth.ENVIRONMENT)


def test_the_calls_are_those_of_all_functions() -> None:
    table = calls.all_calls()
    missing = sorted(calls.names() - calls.covered(table))
    assert not missing, f"no calls of: {', '.join(missing)}"
    unknown = sorted({name.partition(":")[0] for name in table} - calls.names())
    assert not unknown, f"calls of functions that are not there: {', '.join(unknown)}"


def test_planted_leaks_are_found() -> None:
    if memory_growth.in_use().bytes == 0:
        pytest.skip("a sanitizer has replaced malloc, which then counts nothing")
    done = run("-c", PLANTED, str(HERE))
    assert done.returncode == 0, done.stderr
    append, malloc, view, array, cycle = (tuple(map(int, line.split())) for line in done.stdout.splitlines())
    assert append[0] >= 8 * 200 and malloc[0] >= 32 * 200 and view[1] >= 200 and array[0] >= 8000 * 200
    assert cycle == (0, 0)


def test_memory_does_not_grow() -> None:
    done = run(str(HERE / "memory_growth.py"), "10000" if full() else "200")
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-4000:]


def test_random_calls_leave_everything_in_its_place() -> None:
    done = run(str(HERE / "random_calls.py"), "100000" if full() else "2000")
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-4000:]
