#!/usr/bin/env python3
"""Runs scenes/validation and draws the results beside their formulas: validation.py SCENES PICTURE.

Dots are results of runs, lines are formulas. docs/validation.md says what each scene is, tests/scene/validation_test.cpp
compares all particles.
"""
from __future__ import annotations

import math
import pathlib
import sys
import tempfile
from typing import Any

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

import dartcast as dc  # noqa: E402

DOTS: dict[str, Any] = {"color": "#0072b2", "marker": "o", "markersize": 4, "linestyle": "none"}
LINE: dict[str, Any] = {"color": "0.25", "linewidth": 1.2}
AIR, MU, WATER, GRAVITY = 1.2, 1.8e-5, 1000.0, 9.81


def run(name: str) -> Any:
    """The frames of a scene."""
    folder = pathlib.Path(tempfile.mkdtemp())
    dc.run(SCENES / f"{name}.toml", folder)
    return list(dc.read_run(folder))


def by_id(frame: Any, name: str) -> Any:
    values = frame.positions if name == "position" else frame.arrays[name]
    return values[np.argsort(frame.arrays["id"])]


def times(frames: Any) -> Any:
    return np.array([frame.time for frame in frames])


def formula(axis: Any, x: Any, y: Any) -> None:
    axis.plot(x, y, **LINE)


def putnam(d: float) -> float:
    """The speed at which Putnam's drag balances gravity and buoyancy, by bisection."""
    low, high = 0.0, 100.0
    for _ in range(100):
        v = 0.5 * (low + high)
        re = AIR * v * d / MU
        drag = (1 + re ** (2 / 3) / 6 if re <= 1000 else 0.424 * re / 24) * 18 * MU * v / (WATER * d * d)
        low, high = (v, high) if drag < GRAVITY * (1 - AIR / WATER) else (low, v)
    return low


def terminal(axis: Any) -> None:
    d = np.genfromtxt(SCENES / "terminal.csv", delimiter=",", names=True)["diameter"]
    speed = -by_id(run("terminal")[-1], "velocity")[:, 2]
    axis.loglog(1e6 * d, speed, **DOTS)
    x = np.geomspace(d.min(), d.max(), 100)
    formula(axis, 1e6 * x, [putnam(one) for one in x])
    axis.set(title="terminal speed of drops", xlabel="diameter, um", ylabel="m/s")


def stopping(axis: Any) -> None:
    frames = run("stopping")
    d = np.genfromtxt(SCENES / "stopping.csv", delimiter=",", names=True)["diameter"]
    kn = 2 * 6.6e-8 / d
    tau = WATER * d**2 / (18 * MU) * (1 + kn * (1.257 + 0.4 * np.exp(-1.1 / kn)))
    t = np.linspace(0, times(frames)[-1], 200)
    for i, one in enumerate(tau):
        way = np.array([by_id(f, "position")[i, 0] for f in frames]) - 0.01
        axis.plot(times(frames)[1:], 1e3 * way[1:], **DOTS)
        formula(axis, t, 1e3 * 10 * one * (1 - np.exp(-t / one)))
    axis.set(title="way of drops thrown at 10 m/s", xlabel="s", ylabel="mm", yscale="log")


def diffusion(axis: Any) -> None:
    frames = run("diffusion")[1:]
    square = [((f.positions - [0.51, 0.52, 0.53]) ** 2).sum(axis=1).mean() for f in frames]
    axis.plot(times(frames), square, **DOTS)
    t = np.linspace(0, times(frames)[-1], 2)
    formula(axis, t, 6 * 2e-3 * t)
    axis.set(title="diffusion: mean square of the way", xlabel="s", ylabel="m$^2$")


def brownian(axis: Any) -> None:
    frames = run("brownian")[1:]
    mass = 1000 * np.pi * 5e-8**3 / 6
    tau, s2 = 1000 * 5e-8**2 / (18 * MU), 1.380649e-23 * 293.15 / mass
    axis.plot(1e9 * times(frames), [(f.arrays["velocity"] ** 2).mean() / s2 for f in frames], **DOTS)
    t = np.linspace(0, times(frames)[-1], 200)
    formula(axis, 1e9 * t, 1 - np.exp(-2 * t / tau))
    axis.set(title="Brownian: variance of the velocity", xlabel="ns", ylabel="of k T / m")


def turbulence(axis: Any) -> None:
    frames = run("turbulence")[1:]
    axis.plot(times(frames), [((f.positions - [0.01, 0.02, 0.03]) ** 2).mean() for f in frames], **DOTS)
    t, variance, life = np.linspace(0, times(frames)[-1], 200), 0.01, 0.2
    formula(axis, t, variance * np.where(t < life, t**2 - t**3 / (3 * life), life * t - life**2 / 3))
    axis.set(title="turbulence: variance of the place", xlabel="s", ylabel="m$^2$")


def sizes(axis: Any) -> None:
    d = 1e6 * dc.Simulation(dc.load_scene(SCENES / "sizes.toml")).diameters
    x = np.linspace(1, 20, 400)
    normal = np.vectorize(lambda u: 0.5 * (1 + math.erf(u / math.sqrt(2))))
    lognormal = normal(np.log(x / 5) / np.log(1.8))
    rosin = np.where(x < 10, 1 - np.exp(-((x / 5) ** 2.5)), 1 - np.exp(-(2**2.5)))
    for drawn, law in ((d[:5000], lognormal), (d[5000:], rosin)):
        formula(axis, x, (law - law[0]) / (law[-1] - law[0]))
        axis.plot(np.quantile(drawn, np.linspace(0, 1, 21)), np.linspace(0, 1, 21), **DOTS)
    axis.set(title="sizes of drops", xlabel="diameter, um", ylabel="share of smaller ones")


def absorption(axis: Any) -> None:
    frames = run("absorption")
    axis.plot(times(frames), [len(f.positions) / len(frames[0].positions) for f in frames], **DOTS)
    t, n = np.linspace(0, times(frames)[-1], 200), np.arange(1, 200)
    formula(axis, t, 6 / np.pi**2 * (np.exp(-np.outer(t, n**2) * np.pi**2) / n**2).sum(axis=1))
    axis.set(title="left in an absorbing ball", xlabel="D t / R$^2$", ylabel="share")


def penetration(axis: Any) -> None:
    stuck = run("penetration")[-1].positions[:, 2]
    z = np.linspace(1, 20, 20)
    axis.plot(z, [1 - (stuck < one).sum() / 6000 for one in z], **DOTS)
    x = 0.0125 * np.linspace(0, 20, 200)
    short = 1 - 2.56 * x ** (2 / 3) + 1.2 * x + 0.177 * x ** (4 / 3)
    far = 0.819 * np.exp(-3.657 * x) + 0.097 * np.exp(-22.3 * x) + 0.032 * np.exp(-57 * x)
    formula(axis, x / 0.0125, np.where(x < 0.02, short, far))
    axis.set(title="diffusion to a tube's wall: come as far", xlabel="z, radii", ylabel="share")


def bend(axis: Any) -> None:
    last, radius = run("bend")[-1], 2.5e-3
    d = last.arrays["diameter"]
    x, _, z = last.positions.T
    kept = (z > 0) & (x > -5.6 * radius) & (np.abs(last.arrays["velocity"]).max(axis=1) == 0)
    stokes = WATER * d**2 * 3 / (18 * MU * radius)
    groups = (0.1, 0.2, 0.3, 0.5, 0.8)
    axis.plot(groups, [(kept & (abs(stokes - one) < 0.01)).sum() / 800 for one in groups], **DOTS)
    s = np.linspace(0.02, 0.9, 200) / 0.171
    formula(axis, 0.171 * s, 1 - (1 + s ** (0.452 * s + 2.242)) ** (-2 / np.pi))
    axis.set(title="bend: deposition, and Pui et al. 1987", xlabel="St", ylabel="share")


def oscillation(axis: Any) -> None:
    frames = run("oscillation")
    t, turn = np.linspace(0, times(frames)[-1], 400), 4j * np.pi
    for i, density in enumerate((2650, 1000, 100)):
        axis.plot(times(frames), [1e3 * by_id(f, "velocity")[i, 0] if len(f.positions) else np.nan for f in frames], **DOTS)
        k, tau = 1000 / density, density * 1e-6 / 18e-3
        response = (1 / tau + 1.5 * k * turn) / (1 / tau + (1 + k / 2) * turn)
        formula(axis, t, (response * np.exp(turn * t)).real - response.real * np.exp(-t / (tau * (1 + k / 2))))
    axis.set(title="in water that oscillates", xlabel="s", ylabel="mm/s")


def settling(axis: Any) -> None:
    stuck = run("settling")[-1].positions[:, 2]
    z = np.linspace(1, 20, 20)
    axis.plot(z, [(stuck < one).sum() / 3000 for one in z], **DOTS)
    root = np.cbrt(0.0075 * np.linspace(0, 20, 200))
    formula(axis, root**3 / 0.0075, 2 / np.pi * ((2 * root**3 - root) * np.sqrt(1 - root**2) + np.arcsin(root)))
    axis.set(title="sunk in a tube", xlabel="z, radii", ylabel="share")


def uniform(axis: Any) -> None:
    x = run("uniform")[-1].positions
    for one in ((x[:, 0] ** 2 + x[:, 1] ** 2) / 1.00574**2, x[:, 2] / 20):
        axis.plot(np.quantile(one, np.linspace(0, 1, 21)), np.linspace(0, 1, 21), **DOTS)
    formula(axis, np.array([0, 1]), np.array([0, 1]))
    axis.set(title="a cloud in a pulsing tube", xlabel="(r / R)$^2$, and z / L", ylabel="share within")


SCENES = pathlib.Path(sys.argv[1])
plt.rcParams.update({"svg.hashsalt": "dartcast", "svg.fonttype": "none", "font.size": 9, "axes.titlesize": 9.5})
figure, axes = plt.subplots(4, 3, figsize=(10, 11.2), layout="constrained")
ALL = (terminal, stopping, oscillation, diffusion, brownian, turbulence, sizes, uniform, absorption, penetration, settling, bend)
for draw, axis in zip(ALL, axes.flat):
    draw(axis)
    axis.grid(color="0.92")
figure.savefig(sys.argv[2], metadata={"Date": None, "Creator": None})
