"""Particles in a vessel that bends: own motion of the mesh, a response of the library, a figure."""
import sys

import matplotlib.pyplot as plt
import numpy as np

import dartcast as dc

mesh = dc.generate_vessel()
environment = dc.Environment(mesh)
particles = environment.add_random(3000, seed=1)
velocities = np.random.default_rng(1).normal(0.0, 0.05, (len(particles), 3)) + [0.0, 0.0, 0.2]
rest, dt, contacts = environment.positions, 1e-3, []

for step in range(200):
    bend = 10 * np.sin(2 * np.pi * (step + 1) * dt / 0.3)
    environment.move(rest + bend * np.outer(rest[:, 2] ** 2, [0, 1, 0]))
    targets = particles.positions + velocities * dt
    report = environment.advance(particles, targets, dc.Reflect(0.5), velocities=velocities, dt=dt)
    contacts.append(len(report.contacts))

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4))
x = 1e3 * particles.positions
left.scatter(x[:, 2], x[:, 0], s=2, c=np.linalg.norm(velocities, axis=1))
left.set(xlabel="z [mm]", ylabel="x [mm]", aspect="equal")
right.plot(contacts)
right.set(xlabel="step", ylabel="contacts")
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "vessel.png", dpi=90)
