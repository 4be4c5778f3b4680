"""The cell of each of a million points, exactly: a slice through a mesh with polyhedra, coloured by cell."""
import sys
import time

import matplotlib.pyplot as plt
import numpy as np

import dartcast as dc

mesh = dc.generate_octahedra(dc.OctahedraOptions(cells=[6, 6, 6], size=[1.0, 1.0, 1.0], blocked_share=0.3, seed=1))
environment = dc.Environment(mesh)
side = np.linspace(-0.1, 1.2, 1000)
x, z = np.meshgrid(side, side)
points = np.stack([x.ravel(), np.full(x.size, 0.5), z.ravel()], axis=1)

start = time.perf_counter()
found = environment.locate(points)
print(f"{len(points)} points in {time.perf_counter() - start:.2f} s")
for place in dc.Place:
    print(f"{place.name.lower()}: {np.count_nonzero(found['place'] == place)}")

cells = np.where(found["place"] == dc.Place.OUTSIDE, np.nan, found["cell"] * 7919 % 97 + 1.0)
free = (found["place"] == dc.Place.FREE).reshape(x.shape)
plt.figure(figsize=(5, 5))
plt.imshow(cells.reshape(x.shape), origin="lower", extent=(-0.1, 1.2, -0.1, 1.2), cmap="turbo")
plt.imshow(np.where(free, np.nan, 1.0), origin="lower", extent=(-0.1, 1.2, -0.1, 1.2), cmap="gray", alpha=0.5)
plt.gca().set(xlabel="x", ylabel="z", title="cells at y = 0.5; blocked ones are grey")
plt.savefig(sys.argv[1] if len(sys.argv) > 1 else "location.png", dpi=90)
