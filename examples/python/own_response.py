"""An own response at walls, for all contacts of a step at once: particles lose a part of the normal speed, at random."""
import sys
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

import dartcast as dc

dt, steps = 2e-3, 300
environment = dc.Environment(dc.generate_bar())
particles = environment.add_random(2000, seed=1)
random = np.random.default_rng(1)
velocities = random.normal(0.0, 5.0, (len(particles), 3))
rest = environment.positions
energy = []


def respond(contacts: Any, walls: Any) -> Any:
    """Changes the velocities, and returns the displacements for the rest of the step, relative to the walls."""
    which, normal = contacts["particle"], contacts["normal"]
    loss = random.uniform(0.0, 0.5, (len(contacts), 1))
    wall = contacts["wall_displacement"] / dt

    def rebound(v: Any) -> Any:
        return v - (2 - loss) * np.minimum(0.0, np.sum(v * normal, axis=1, keepdims=True)) * normal

    velocities[which] = wall + rebound(velocities[which] - wall)
    return rebound(contacts["unused"])


for step in range(steps):
    with environment.next_points() as x:  # the bar swells and shrinks
        x[:] = (rest - [2.5, 2.5, 0]) * [1 + 0.2 * np.sin(0.05 * step), 1, 1] + [2.5, 2.5, 0]
    environment.advance(particles, particles.positions + velocities * dt, respond)
    energy.append(0.5 * np.mean(np.sum(velocities**2, axis=1)))

plt.plot(np.arange(steps) * dt, energy)
plt.gca().set(xlabel="time [s]", ylabel="energy per mass [J/kg]", title="walls move, rebounds lose")
plt.savefig(sys.argv[1] if len(sys.argv) > 1 else "own_response.png", dpi=90)
