"""Plans of runs on many ranks."""
from __future__ import annotations

import dartcast
import numpy as np
import pytest


def test_a_plan_counts_the_parts_of_a_run():
    mesh = dartcast.generate_box(cells=[8, 8, 8], size=[1.0, 1.0, 1.0])
    plan = dartcast.formats.plan_run(mesh, dartcast.formats.PlanOptions(ranks=4, particles=100.0, samples=1))
    owners = dartcast.formats.partition(mesh, 4)
    ghosts = [len(dartcast.formats.mesh_part(mesh, owners, 4, p).cells) - np.count_nonzero(owners == p) for p in range(4)]
    assert plan.cells.mean == 128.0 and plan.ghosts.mean == np.mean(ghosts) and plan.ghosts.largest == max(ghosts)
    assert plan.neighbours.largest == 3.0 and plan.options.ranks == 4
    assert 0.0 < plan.seconds_walk < plan.seconds() and plan.efficiency() == plan.seconds_alone / plan.seconds()


def test_a_plan_refuses_what_is_out_of_range():
    box = dartcast.generate_box(cells=[2, 2, 2], size=[1.0, 1.0, 1.0])
    with pytest.raises(dartcast.InvalidArgument, match="latency"):
        dartcast.formats.plan_run(box, dartcast.formats.PlanOptions(latency=2.0))
    with pytest.raises(dartcast.InvalidArgument):
        dartcast.formats.plan_run(box, dartcast.formats.PlanOptions(ranks=9))
    with pytest.raises(dartcast.InvalidArgument, match="plane"):
        dartcast.formats.plan_run(dartcast.generate_rectangle(cells=[4, 4], size=[1.0, 1.0]), dartcast.formats.PlanOptions())
    flat = dartcast.MeshData(np.eye(4, 3) * [1.0, 1.0, 0.0], {"tetra": [[0, 1, 2, 3]]})
    with pytest.raises(dartcast.InvalidMesh):
        dartcast.formats.plan_run(flat, dartcast.formats.PlanOptions())
