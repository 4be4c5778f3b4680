"""A vessel is cut open while particles flow: they go out through the gap into the tissue."""
import sys

import matplotlib.pyplot as plt
import numpy as np

import dartcast as dc

environment = dc.Environment(dc.generate_vessel())
particles = environment.add_random(5000, seed=1)
disc = dc.Disc(centre=[0.0, 0.0, -0.012], normal=[0.0, 0.0, 1.0], radius=6e-3)
random = np.random.default_rng(1)
radius = []

for step in range(200):
    if step == 50:
        tools = dc.thicken(disc, 1.5e-3)
        cells = dc.cells_near(environment.complex, tools)
        report = environment.edit(lambda edit: dc.carve(edit, cells, tools, "open"))
        environment.update_after_edit(particles)
        print(f"{len(report.map.removed)} cells replaced by {len(report.map.added)}")
    x = particles.positions
    environment.advance(particles, x + random.normal(0.0, 2e-4, x.shape), dc.Slide(), velocities=np.zeros_like(x), dt=1.0)
    x = particles.positions
    near = np.abs(x[:, 2] + 0.012) < 7.5e-4
    radius.append(np.quantile(np.hypot(x[near, 0], x[near, 1]), 0.9) * 1e3)

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4))
x = 1e3 * particles.positions
left.scatter(x[:, 2], x[:, 0], s=1, c=np.hypot(x[:, 0], x[:, 1]))
left.set(xlabel="z [mm]", ylabel="x [mm]", aspect="equal", title="after the cut")
right.plot(radius)
right.set(xlabel="step", ylabel="90% of the particles at the cut are within [mm]")
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "cut.png", dpi=90)
