"""Particles in a block that SOFA moves. Where SOFA is missing a stand-in takes its place."""
import numpy as np

import dartcast as dc

try:
    import Sofa
    import Sofa.Core
    import Sofa.Simulation
except ImportError:
    from stand_ins import Sofa

# SOFA's scene: yours has a solver, a mass and a force field, too. Its points are those of dartcast's mesh.
mesh = dc.generate_box(cells=[4, 4, 8], size=[0.1, 0.1, 0.2], type="tetrahedron")
root = Sofa.Core.Node("root")
block = root.addChild("block")
block.addObject("MechanicalObject", name="points", template="Vec3d", position=mesh.points.tolist())
Sofa.Simulation.init(root)

environment = dc.Environment(mesh)
particles = environment.add_random(500, seed=1)
velocities = np.tile([0.0, 0.3, 0.1], (len(particles), 1))
dt, contacts = 0.01, 0

for _ in range(100):
    Sofa.Simulation.animate(root, dt)                            # 1. the solver's step
    environment.move(block.points.position.array())              # 2. its points are the mesh's
    targets = particles.positions + velocities * dt              # 3. where the particles want to go
    report = environment.advance(particles, targets, dc.Reflect(0.9), velocities=velocities, dt=dt)
    contacts += len(report.contacts)                             # 4. what they met on their way

print(f"{contacts} contacts, {dc.audit(environment.complex, particles).failed} particles in a wrong cell")
