"""Grains of two sizes fall into a box that is tilted to and fro."""
import sys

import matplotlib.pyplot as plt
import numpy as np

import dartcast as dc

scene = {
    "environment": {"generator": "box", "cells": [4, 4, 6], "size": [0.2, 0.2, 0.3]},
    "deformation": {"kind": "swing", "axis": [0, 1, 0], "centre": [0.1, 0.1, 0.0], "amplitude": 0.3, "period": 1.0},
    "particles": [{"inlet": "zmax", "rate": 600.0, "radius": 5e-3, "velocity": [0, 0, -0.5]},
                  {"inlet": "zmax", "rate": 60.0, "radius": 1e-2, "velocity": [0, 0, -0.5]}],
    "motion": {"dt": 2e-3, "gravity": [0, 0, -9.81]},
    "contact": {"response": "reflect", "restitution": 0.3, "friction": 0.4},
    "collisions": {"restitution": 0.3, "friction": 0.4, "density": 2500.0},
}
simulation = dc.Simulation(dc.load_scene(scene))
heights = []
for _ in range(500):
    simulation.step()
    heights.append(np.median(simulation.positions[:, 2]) if len(simulation.positions) else np.nan)

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4))
x, radii = simulation.positions, simulation.radii
for centre, radius in zip(x, radii):
    left.add_patch(plt.Circle((centre[0], centre[2]), radius, color="C1" if radius > 7e-3 else "C0", alpha=0.5, lw=0))
left.set(xlim=(-0.1, 0.3), ylim=(-0.05, 0.35), aspect="equal", xlabel="x [m]", ylabel="z [m]", title=f"{len(x)} grains")
right.plot(np.arange(len(heights)) * 2e-3, heights)
right.set(xlabel="time [s]", ylabel="median height [m]")
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "grains.png", dpi=90)
