"""The cell of each of a million points, exactly: a slice through a mesh with polyhedra, coloured by cell."""
import sys
import time
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

import dartcast as dc

mesh = dc.generate_octahedra(cells=[6, 6, 6], size=[1.0, 1.0, 1.0], blocked_share=0.3, seed=1)
environment = dc.Environment(mesh)
side = np.linspace(-0.1, 1.2, 1000)
x, z = np.meshgrid(side, side)
points = np.stack([x.ravel(), np.full(x.size, 0.5), z.ravel()], axis=1)

start = time.perf_counter()
found = environment.locate(points)
print(f"{len(points)} points in {time.perf_counter() - start:.2f} s")
for place in dc.Place:
    print(f"{place.name.lower()}: {np.count_nonzero(found['place'] == place)}")

def picture(values: Any, place: dc.Place) -> Any:
    return np.where(found["place"] == place, values, np.nan).reshape(x.shape)


extent = (-0.1, 1.2, -0.1, 1.2)
plt.figure(figsize=(5, 5))
plt.imshow(picture(found["cell"] * 7919 % 97, dc.Place.FREE), origin="lower", extent=extent, cmap="turbo")
plt.imshow(picture(0.6, dc.Place.BLOCKED), origin="lower", extent=extent, cmap="gray", vmin=0, vmax=1)
plt.gca().set(xlabel="x", ylabel="z", title="cells at y = 0.5; blocked ones are grey")
plt.savefig(sys.argv[1] if len(sys.argv) > 1 else "location.png", dpi=90)
