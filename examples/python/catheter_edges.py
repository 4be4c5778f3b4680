"""A catheter bends over the edge of a thin wall. Without edges its points alone meet the wall, which cuts through it."""
import sys

import matplotlib.pyplot as plt
import numpy as np

import dartcast as dc

mesh = dc.generate_box(cells=[9, 3, 8], size=[9.0, 3.0, 8.0])
points = mesh.points.copy()
x = points[:, 0]
points[:, 0] = np.where(x <= 4.0, x * 1.1, 9.0 - (9.0 - x) * 1.1)  # the fifth cell of nine is a fifth as wide
mesh.points = points
free = np.ones(mesh.cell_count, dtype=np.uint8)
free[[4 + 9 * (y + 3 * z) for y in range(3) for z in range(5)]] = 0  # a thin wall, five units high
mesh.free = free

figure, axes = plt.subplots(1, 2, figsize=(8, 4), sharey=True)
for axis, edges in zip(axes, (False, True)):
    catheter = dc.Catheter(dc.Environment(mesh), dc.CatheterOptions(
        length=7.2, spacing=0.9, stiffness=0.2, entry=[0.7, 1.5, 5.6], direction=[1.0, 0.0, 0.0], edges=edges))
    for step in range(160):
        catheter.step(dc.CatheterInput(push=0.1, load=[0.0, 0.0, -0.02 if step > 40 else 0.0]))
    line = catheter.points()
    axis.fill([4.4, 4.6, 4.6, 4.4], [0, 0, 5, 5], color="0.6")
    axis.plot(line[:, 0], line[:, 2], "o-", color="tab:blue", markersize=4)
    axis.set(aspect="equal", title=f"edges={edges}", xlabel="x", xlim=(0, 9), ylim=(2, 7))
plt.savefig(sys.argv[1] if len(sys.argv) > 1 else "catheter_edges.png", dpi=90, bbox_inches="tight")
