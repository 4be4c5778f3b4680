"""A box that processes share by cells: mpirun -n 4 python3 shared.py. Each makes its part, and has the particles in it."""
import numpy as np
from mpi4py import MPI

import dartcast

ranks = dartcast.mpi_ranks(MPI.COMM_WORLD)
box = dartcast.formats.BoxOptions(cells=[40, 40, 40], size=[40.0, 40.0, 40.0])
environment = dartcast.SharedEnvironment(dartcast.formats.box_part(box, ranks.size, ranks.rank), ranks)
particles = dartcast.SharedParticles()
starts = np.column_stack([0.04 * np.arange(1000), np.full(1000, 20.0), np.full(1000, 20.0)])
environment.add(particles, starts)
left = 0
for step in range(100):
    left += environment.advance(particles, particles.positions + [0.1, 0.05, 0.0]).left
left = int(ranks.sum(np.array([left], np.uint64))[0])
count, failed = environment.count(particles), environment.audit(particles).failed
if ranks.rank == 0:
    print(f"{ranks.size} ranks: {count} particles, {left} went to another rank, {failed} are not where they should be")
