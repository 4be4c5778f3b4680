"""A catheter is steered into the right branch of a vessel: it turns where its tip heads for the wrong side."""
import sys

import matplotlib.pyplot as plt
import numpy as np

import dartcast as dc

environment = dc.Environment(dc.generate_vessel())
entry, direction = [0.0, -0.006376, -0.026761], [0.0, 0.472, 0.882]
catheter = dc.Catheter(environment, dc.CatheterOptions(length=0.06, spacing=1e-3, stiffness=1e-9, tip_length=8e-3,
                                                       tip_curvature=120.0, entry=entry, direction=direction))
paths = []
for _ in range(150):
    tip = catheter.frames()[0] if catheter.inserted > 0 else None
    wrong = tip is not None and np.dot(tip.normal, [1.0, 0.0, 0.0]) < 0.5  # the bend does not point to the right
    done = catheter.step(dc.CatheterInput(push=3e-4, turn=0.3 if wrong else 0.0))
    paths.append(catheter.points())
    if done.pushed < 1e-6:
        break  # there is no way on

left = 1e3 * environment.positions
plt.scatter(left[:, 2], left[:, 0], s=0.2, c="0.8")
for points in paths[::15] + [paths[-1]]:
    plt.plot(1e3 * points[:, 2], 1e3 * points[:, 0], lw=1)
plt.gca().set(aspect="equal", xlabel="z [mm]", ylabel="x [mm]", title=f"{1e3 * catheter.inserted:.0f} mm inserted")
plt.savefig(sys.argv[1] if len(sys.argv) > 1 else "catheter.png", dpi=90)
