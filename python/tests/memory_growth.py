"""Calls every public function of dartcast many times, and fails where memory grows.

Run as a program: memory_growth.py [CALLS] [WORD]. WORD: only the calls whose names have it. The calls are in calls/.

Two counts are exact: the bytes that malloc() gave and were not freed, which is the memory of C++ and of large objects
of Python, and the small objects of Python. Resident memory would be useless: pages come and go by tens of KiB.

Everything computes with one thread. A second thread takes its memory from another arena and keeps caches of its own,
and which of them grows when depends on the scheduler.
"""
from __future__ import annotations

import ctypes
import gc
import os
import sys
import time
from collections.abc import Callable
from typing import NamedTuple

#: malloc's caches for each thread count as memory in use. This turns them off; it must stand when Python starts.
ENVIRONMENT = {"GLIBC_TUNABLES": "glibc.malloc.tcache_count=0"}
WARM_UP = 20
ROUNDS = 3


class Memory(NamedTuple):
    """Memory in use, or its growth."""

    bytes: int  # of malloc(), whose smallest piece has 32
    objects: int  # small ones of Python


#: What any number of calls may leave: tables of Python and NumPy that become larger once. A leak in each of 200 calls
#: leaves at least 6400 bytes or 200 objects; a list that keeps a pointer of each has 1600 bytes.
BOUND = Memory(1024, 100)


class MallInfo(ctypes.Structure):
    """The result of mallinfo2()."""

    _fields_ = [(name, ctypes.c_size_t) for name in ("arena", "ordblks", "smblks", "hblks", "hblkhd", "usmblks",
                                                     "fsmblks", "uordblks", "fordblks", "keepcost")]


LIBC = ctypes.CDLL(None)
LIBC.mallinfo2.restype = MallInfo


def in_use() -> Memory:
    """Memory in use, of all arenas and of large pieces that have pages of their own."""
    while gc.collect():
        pass
    info = LIBC.mallinfo2()
    return Memory(info.uordblks + info.hblkhd, sys.getallocatedblocks())


def growth(call: Callable[[], object], calls: int) -> Memory:
    """By how much memory grows in `calls` calls; 0 where it is at most BOUND.

    A table that becomes larger once is no leak: the calls are then repeated. Each round has at least as many calls as
    all before it. A list that doubles its memory grows in every round.
    """
    done = max(calls // 4, 1)
    for _ in range(done):
        call()
    grown = Memory(0, 0)
    for _ in range(ROUNDS):
        more = max(calls, done)
        before = in_use()
        for _ in range(more):
            call()
        after = in_use()
        done += more
        grown = Memory(after.bytes - before.bytes, after.objects - before.objects)
        if grown.bytes <= BOUND.bytes and grown.objects <= BOUND.objects:
            return Memory(0, 0)
    return grown


def main() -> int:
    calls = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    word = sys.argv[2] if len(sys.argv) > 2 else ""
    from calls import all_calls

    table: dict[Callable[[], object], str] = {}
    for name, call in all_calls().items():
        if word in name:
            table[call] = f"{table[call]}, {name}" if call in table else name
    for call in table:  # fills caches that many calls share, such as NumPy's small blocks
        for _ in range(WARM_UP):
            call()
    gc.collect()
    gc.freeze()  # the objects that exist by now need no more searching
    failed, start = 0, time.perf_counter()
    for call, name in table.items():
        grown = growth(call, calls)
        if any(grown):
            failed += 1
            print(f"{name}: memory grows by {grown.bytes} bytes and {grown.objects} objects", flush=True)
    seconds = time.perf_counter() - start
    print(f"{len(table)} kinds of calls, {calls} of each, {seconds:.0f} s: memory grows in {failed}")
    return 1 if failed else 0


if __name__ == "__main__":
    if any(os.environ.get(name) != value for name, value in ENVIRONMENT.items()):
        os.execve(sys.executable, [sys.executable, *sys.argv], {**os.environ, **ENVIRONMENT})
    sys.exit(main())
