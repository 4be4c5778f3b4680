"""No call leaks memory, and the calls of memory_growth.py are those of all functions. Random calls keep all in its place."""
from __future__ import annotations

import os
import pathlib
import subprocess
import sys

import calls
import memory_growth
from conftest import full

HERE = pathlib.Path(__file__).resolve().parent

#: Functions that leak in each call, and one that does not; the program prints their growth.
PLANTED = """
import ctypes, sys
sys.path.insert(0, sys.argv[1])
import memory_growth
import numpy as np
import dartcast
kept, cycles, map_ = [], [], dartcast.CombinatorialMap(dartcast.generate_box())

def in_a_list(): kept.append(None)
def in_malloc(): ctypes.CDLL(None).malloc(16)
def object_of_dartcast(): ctypes.pythonapi.Py_IncRef(ctypes.py_object(map_.view(0x20000000)))
def array(): ctypes.pythonapi.Py_IncRef(ctypes.py_object(np.zeros(100_000)))
def cycle(): cycle = []; cycle.append(cycle); map_.cells()

for call in (in_a_list, in_malloc, object_of_dartcast, array, cycle):
    print(memory_growth.growth(call, 300))
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
    done = run("-c", PLANTED, str(HERE))
    assert done.returncode == 0, done.stderr
    in_a_list, in_malloc, object_of_dartcast, array, cycle = map(int, done.stdout.split())
    assert in_a_list >= 8 * 300 and in_malloc >= 32 * 300 and object_of_dartcast > 32 * 300 and array > 800_000 * 300
    assert cycle == 0


def test_memory_does_not_grow() -> None:
    done = run(str(HERE / "memory_growth.py"), "10000" if full() else "300")
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-4000:]


def test_random_calls_leave_everything_in_its_place() -> None:
    done = run(str(HERE / "random_calls.py"), "100000" if full() else "500")
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-4000:]
