"""Tracers in the flow of a vessel: how long they stay, and where they leave."""
import sys

import matplotlib.pyplot as plt
import numpy as np

import dartcast as dc

mesh = dc.generate_vessel()
environment = dc.Environment(mesh)
options = dc.SimulationOptions(dt=2e-3, integrator="rk4", response=dc.Slide(),
                               patch_responses={"outlet_left": dc.Escape(), "outlet_right": dc.Escape()})
simulation = dc.Simulation(environment, options)
velocity = mesh.point_data["velocity"]
simulation.set_field(dc.VectorField(environment.complex, velocity))
simulation.add_inlet(environment.map.patch("inlet"), 2000.0, [0, 0, 0])
names = environment.map.patch_names
births: dict[int, float] = {}
ages: dict[str, list[float]] = {"outlet_left": [], "outlet_right": []}

for _ in range(1000):
    step = simulation.step()
    for identity in simulation.ids:
        births.setdefault(int(identity), simulation.time)
    for identity, contact in zip(step.contact_ids, step.contacts):
        if names[contact["patch"]] in ages:
            ages[names[contact["patch"]]].append(simulation.time - births[int(identity)])

for name, values in ages.items():
    plt.hist(values, bins=60, range=(0, 2), alpha=0.6, label=f"{name}: {len(values)}")
plt.legend()
plt.gca().set(xlabel="residence time [s]", ylabel="tracers")
plt.savefig(sys.argv[1] if len(sys.argv) > 1 else "tracers.png", dpi=90)
