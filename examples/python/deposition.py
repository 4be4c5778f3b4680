"""Deposition in a branching vessel: which wall faces particles hit, and how many stick to each patch."""
import sys

import matplotlib.pyplot as plt
import numpy as np

import dartcast as dc

mesh = dc.generate_vessel()
environment = dc.Environment(mesh)
simulation = dc.Simulation(environment, dc.SimulationOptions(
    dt=2e-3, drag=200.0, gravity=[0.0, -9.81, 0.0], response=dc.Stick(),
    patch_responses={"outlet_left": dc.Escape(), "outlet_right": dc.Escape(), "inlet": dc.Reflect()}))
velocity = mesh.point_data["velocity"]
simulation.set_field(dc.VectorField(environment.complex, velocity))
simulation.add_inlet(environment.map.patch("inlet"), 20000.0, [0.0, 0.0, 0.1])
hits = dc.WallHits()
for _ in range(500):
    hits.add(environment, simulation.step().report)

for name, count in zip(environment.map.patch_names, hits.by_patch(environment)):
    print(f"{name or '(others)'}: {count}")
faces = hits.faces()
views = [environment.map.view(cell) for cell in faces["cell"].tolist()]
corners = [[view.vertex(i) for i in view.shape.corners(face)] for view, face in zip(views, faces["face"].tolist())]
points = environment.positions
centres = np.array([points[c].mean(axis=0) for c in corners]) * 1e3
figure, axes = plt.subplots(2, 1, figsize=(8, 6), sharex=True)
for axis, across, name in zip(axes, (0, 1), "xy"):
    drawn = axis.scatter(centres[:, 2], centres[:, across], c=faces["hits"], s=6, cmap="inferno_r", norm="log")
    axis.set(ylabel=f"{name} [mm]", aspect="equal")
axes[1].set_xlabel("z [mm]")
figure.colorbar(drawn, ax=axes, label="hits per face")
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "deposition.png", dpi=90)
