#!/usr/bin/env python3
"""Times what Python adds to calls of dartcast, on one thread: prints figures; with --check it fails beyond generous bounds.

The program made from timing.cpp (target dartcast_python_timing) times the same calls in C++; its path is --base.
"""
from __future__ import annotations

import argparse
import subprocess
import sys
import time
from collections.abc import Callable

import dartcast
import numpy as np


def best(call: Callable[[], object], repeats: int, rounds: int = 7) -> float:
    """The least time of a call, in microseconds."""
    times = []
    for _ in range(rounds):
        start = time.perf_counter()
        for _ in range(repeats):
            call()
        times.append((time.perf_counter() - start) / repeats)
    return min(times) * 1e6


def scene(count: int) -> tuple[dartcast.Environment, dartcast.Particles]:
    env = dartcast.Environment(dartcast.generate_box(cells=[16, 16, 16], size=[1.0, 1.0, 1.0]), threads=1)
    return env, env.add_random(count, seed=1)


def best_step(step: Callable[[dartcast.Particles], object], parts: dartcast.Particles) -> float:
    """The least time of a step from the same state, in microseconds."""
    copies = iter([parts.copy() for _ in range(7 * 50)])
    return best(lambda: step(next(copies)), 50)


def time_response() -> tuple[float, int]:
    """What a step's calls of a response add to the built-in one and to the same function on ready arrays."""
    ready: list[tuple[dartcast.Records, dartcast.Records]] = []

    def work(c: dartcast.Records, w: dartcast.Records) -> np.ndarray:
        n = c["normal"]
        return c["unused"] - 2.0 * np.sum(c["unused"] * n, axis=1, keepdims=True) * n

    def keep(c: dartcast.Records, w: dartcast.Records) -> np.ndarray:
        ready.append((c, w))
        return work(c, w)

    env, parts = scene(1000)
    targets = parts.positions + np.array([0.0, 0.0, 0.5])
    v = np.tile([0.0, 0.0, 0.5], (1000, 1))
    options = dartcast.records.StepOptions(max_contacts=2)
    report = env.advance(parts.copy(), targets, keep, options=options)
    asked = best_step(lambda p: env.advance(p, targets, work, options=options), parts)
    plain = best_step(lambda p: env.advance(p, targets, dartcast.Reflect(), velocities=v.copy(), dt=1.0, options=options), parts)
    alone = best(lambda: [work(*r) for r in ready], 50)
    return asked - plain - alone, len(report.contacts)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--base", help="the program of C++ that times the same calls")
    parser.add_argument("--check", action="store_true", help="fail beyond bounds")
    arguments = parser.parse_args()
    env, parts = scene(1000)
    targets = parts.positions.copy()
    x = np.random.default_rng(1).uniform(0, 1, (1_000_000, 3))
    env.locate(x[:10])
    many = scene(100_000)[1]
    plain = np.zeros((100_000, 3))
    response, contacts = time_response()
    figures = {
        "advance 1,000 standing particles [us]": best(lambda: env.advance(parts, targets), 200),
        "positions of 100,000 particles, share of numpy.copy": best(lambda: many.positions, 20) / best(plain.copy, 20),
        f"a response to {contacts} contacts, beyond its own work [us]": response,
        "locate 1,000,000 points [us]": best(lambda: env.locate(x), 1, 3),
    }
    for name, value in figures.items():
        print(f"{name}: {value:.2f}")
    if arguments.base:
        print(subprocess.run([arguments.base], capture_output=True, text=True, check=True).stdout, end="")
    values = list(figures.values())
    return int(arguments.check and (values[1] > 6.0 or values[2] > 120.0))


if __name__ == "__main__":
    sys.exit(main())
