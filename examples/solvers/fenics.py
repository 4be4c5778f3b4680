"""Particles in a block that FEniCSx deforms (0.8 or later, one process). Where it is missing a stand-in takes its place."""
import numpy as np

import dartcast as dc

try:
    from dolfinx import fem, mesh
    from mpi4py import MPI
except ImportError:
    from stand_ins import MPI, fem, mesh

domain = mesh.create_box(MPI.COMM_WORLD, [[0.0, 0.0, 0.0], [0.4, 0.1, 0.1]], [16, 4, 4])
space = fem.functionspace(domain, ("Lagrange", 1, (3,)))
displacement = fem.Function(space)
# The numbers of FEniCSx are those of its unknowns: take points and cells from the space, not from the mesh.
rest = space.tabulate_dof_coordinates()
environment = dc.Environment(dc.MeshData(rest, {"tetra": space.dofmap.list}))
particles = environment.add_random(500, seed=1)
velocities = np.tile([0.2, 0.1, 0.0], (len(particles), 1))
dt, contacts = 0.01, 0

for step in range(1, 101):
    # 1. The solver's step. Yours is problem.solve(); here the block bends by a formula.
    bend = 0.5 * np.sin(2.0 * np.pi * step * dt)
    displacement.interpolate(lambda x: np.stack([0.0 * x[0], bend * x[0] ** 2, 0.0 * x[0]]))
    environment.move(rest + displacement.x.array.reshape(-1, 3))  # 2. its points are the mesh's
    targets = particles.positions + velocities * dt               # 3. where the particles want to go
    report = environment.advance(particles, targets, dc.Reflect(0.9), velocities=velocities, dt=dt)
    contacts += len(report.contacts)                              # 4. what they met on their way

print(f"{contacts} contacts, {dc.audit(environment.complex, particles).failed} particles in a wrong cell")
