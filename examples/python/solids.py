"""The figure 21 of the paper: edges between particles pass through a ridge; those of a solid do not."""
import sys
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

import dartcast as dc

mesh = dc.generate_box(cells=[5, 3, 5], size=[5.0, 3.0, 5.0])
free = np.ones(mesh.cell_count, dtype=np.uint8)
free[[2 + 5 * y for y in range(3)]] = 0  # a ridge on the floor, one unit high
mesh.free = free
block = dc.generate_box(cells=[1, 1, 1], size=[2.6, 0.8, 0.5], origin=[1.2, 1.1, 2.5])
fall = np.array([0.0, 0.0, -0.03])


def by_particles(steps: int) -> Any:
    environment, corners = dc.Environment(mesh), dc.Particles()
    environment.add(corners, block.points)
    for _ in range(steps):
        environment.advance(corners, corners.positions + fall)
    return corners.positions.copy()


def by_solid(steps: int) -> Any:
    solids = dc.SolidSet(dc.Environment(mesh))
    solids.add(dc.solid_of_cells(block))
    for _ in range(steps):
        solids.advance(solids.positions + fall, dc.SolidStepOptions(rounds=0))  # rigid: it stops as a whole
    return solids.positions


figure, axes = plt.subplots(1, 2, figsize=(8, 4), sharey=True)
for axis, title, corners in zip(axes, ("particles at the corners", "a solid"), (by_particles(60), by_solid(60))):
    axis.fill([0, 2, 2, 3, 3, 5, 5, 0], [0, 0, 1, 1, 0, 0, -0.2, -0.2], color="0.75")
    for begin, end in ((0, 1), (1, 5), (5, 4), (4, 0)):
        axis.plot(corners[[begin, end], 0], corners[[begin, end], 2], "o-", color="tab:blue")
    axis.set(aspect="equal", title=title, xlabel="x", xlim=(0, 5), ylim=(-0.2, 3.5))
plt.savefig(sys.argv[1] if len(sys.argv) > 1 else "solids.png", dpi=90, bbox_inches="tight")
