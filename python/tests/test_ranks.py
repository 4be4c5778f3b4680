"""Ranks: those of threads, as another transport would be, and those of mpi4py."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import threading

import dartcast
import numpy
import pytest

SCENE = {
    "environment": {"generator": "box", "cells": [5, 5, 5], "blocked_share": 0.1},
    "particles": [{"count": 300, "velocity": [3.0, 1.0, 0.5]}],
    "motion": {"dt": 0.02, "steps": 30},
    "contact": {"restitution": 0.5},
    "output": {"every": 10, "report": False},
}


SCENE_TEXT = """
[environment]
generator = "box"
cells = [5, 5, 5]
[[particles]]
count = 300
velocity = [3.0, 1.0, 0.5]
[motion]
dt = 0.02
[contact]
restitution = 0.5
"""


class Group:
    """What the threads of a group leave for each other."""

    def __init__(self, size):
        self.barrier = threading.Barrier(size)
        self.rows = [None] * size


class ThreadRanks(dartcast.Ranks):
    def __init__(self, group, rank):
        self.group = group
        self.number = rank

    @property
    def rank(self):
        return self.number

    @property
    def size(self):
        return len(self.group.rows)

    def exchange(self, data):
        self.group.rows[self.number] = data
        self.group.barrier.wait()
        received = [row[self.number] for row in self.group.rows]
        self.group.barrier.wait()
        return received

    def gather(self, data):
        received = self.exchange([data] + [b""] * (self.size - 1))
        return received if self.number == 0 else []

    def broadcast(self, data):
        return self.exchange([data] * self.size)[0]

    def sum(self, values):
        parts = self.exchange([values.tobytes()] * self.size)
        return numpy.sum([numpy.frombuffer(p, numpy.uint64) for p in parts], axis=0, dtype=numpy.uint64)

    def fail(self, why):
        self.group.barrier.abort()
        return True


def run_on_threads(size, **arguments):
    return on_threads(size, lambda ranks: dartcast.run(SCENE, threads=1, ranks=ranks, **arguments))


def on_threads(size, call):
    group = Group(size)
    results = [None] * size

    def work(rank):
        try:
            results[rank] = call(ThreadRanks(group, rank))
        except Exception as error:  # looked at by the test
            results[rank] = error

    threads = [threading.Thread(target=work, args=(rank,)) for rank in range(size)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return results


@pytest.mark.parametrize("partition", ["particles", "cells"])
def test_runs_are_those_of_one_process(tmp_path, partition):
    one = dartcast.run(SCENE, tmp_path / "one", threads=1)
    results = run_on_threads(3, out=tmp_path / "three", partition=partition)
    assert [r.ranks for r in results] == [3, 3, 3]
    assert results[0].state_hash == one.state_hash
    assert results[0].totals.counters.contacts == one.totals.counters.contacts
    expected = (tmp_path / "one/stats.csv").read_text().splitlines()
    if partition == "cells":  # tests are not counted
        expected[1:] = [uncounted(row) for row in expected[1:]]
    assert (tmp_path / "three/stats.csv").read_text().splitlines() == expected


def uncounted(row):
    fields = row.split(",")
    return ",".join(fields[:8] + 4 * [""] + fields[12:])


def twisted(points, step):
    return points + 0.05 * numpy.sin(0.4 * step) * numpy.sin(points[:, [1, 2, 0]])


BOX = dartcast.formats.BoxOptions(cells=[6, 5, 5], size=[6.0, 5.0, 5.0], jitter=0.2)


def starts():
    return numpy.random.default_rng(3).uniform(0.1, 4.9, (200, 3))


def ways(ids, step):
    return numpy.array([numpy.random.default_rng([i, step]).uniform(-0.8, 0.8, 3) for i in ids]).reshape(-1, 3)


def back(contact, walls, earlier):
    return -0.5 * contact.unused


def stepped_alone():
    environment = dartcast.Environment(dartcast.generate_box(BOX), threads=1)
    particles = dartcast.Particles()
    environment.add(particles, starts())
    rest = environment.positions
    for step in range(8):
        environment.move(twisted(rest, step))
        targets = particles.positions + ways(range(len(particles)), step)
        environment.advance(particles, targets, back, per_contact=True)
    return dict(zip(range(len(particles)), map(tuple, particles.positions)))


def stepped(ranks):
    environment = dartcast.SharedEnvironment(dartcast.formats.box_part(BOX, ranks.size, ranks.rank), ranks, threads=1)
    particles = dartcast.SharedParticles(1)
    assert (environment.add(particles, starts()) == dartcast.Place.FREE).all()
    for i, identity in enumerate(particles.ids):
        particles.set_user_data(i, [float(identity)])
    rest = environment.positions
    left = 0
    for step in range(8):
        environment.move(twisted(rest, step))
        left += environment.advance(particles, particles.positions + ways(particles.ids, step), back).left
        assert [particles.user_data(i)[0] for i in range(len(particles))] == list(particles.ids)
    assert left > 10 and environment.count(particles) == 200
    assert environment.audit(particles).failed == 0
    return dict(zip(particles.ids, map(tuple, particles.positions)))


def test_a_shared_environment_steps_as_one():
    parts = on_threads(3, stepped)
    assert all(isinstance(p, dict) for p in parts), parts
    assert {i: x for p in parts for i, x in p.items()} == stepped_alone()


def test_simulations_are_shared():
    scene = dartcast.formats.parse_scene(SCENE_TEXT, "scene.toml")

    def simulate(ranks, partition="particles"):
        simulation = dartcast.Simulation(scene, 1, ranks, partition)
        for _ in range(20):
            simulation.step()
        return simulation.state_hash(), simulation.alive(), simulation.totals_of_all().counters.particle_steps

    alone = simulate(None)
    for partition in ("particles", "cells"):
        results = on_threads(3, lambda ranks, p=partition: simulate(ranks, p))
        assert results == [alone] * 3


def test_a_part_may_be_the_mesh_of_a_scene():
    scene = dartcast.formats.parse_scene(SCENE_TEXT, "scene.toml")

    def simulate(ranks):
        own = dartcast.formats.parse_scene(SCENE_TEXT, "scene.toml")
        own.environment.mesh = dartcast.formats.box_part(scene.environment.mesh, ranks.size, ranks.rank)
        simulation = dartcast.Simulation(own, 1, ranks, "cells")
        for _ in range(20):
            simulation.step()
        return simulation.state_hash()

    alone = dartcast.Simulation(scene, 1)
    for _ in range(20):
        alone.step()
    assert on_threads(2, simulate) == [alone.state_hash()] * 2


def test_a_rank_that_cancels_ends_the_run_on_all(tmp_path):
    def progress(done, _):
        if done == 10 and threading.current_thread() is not threading.main_thread() and next(turns) == 0:
            raise ValueError("no more")

    turns = iter(range(100))
    results = run_on_threads(2, out=tmp_path, progress=progress)
    assert sorted(type(r).__name__ for r in results) == ["Summary", "ValueError"]
    assert all(r.cancelled and r.steps == 10 for r in results if isinstance(r, dartcast.formats.Summary))


def test_a_rank_that_fails_ends_the_others(tmp_path):
    (tmp_path / "other.txt").write_text("not a run")
    results = run_on_threads(2, out=tmp_path)
    assert "the folder holds other files" in str(results[0])
    assert isinstance(results[1], Exception)


PROGRAM = """
import sys
import dartcast
from mpi4py import MPI
ranks = dartcast.mpi_ranks(MPI.COMM_WORLD)
assert ranks.size == MPI.COMM_WORLD.size and ranks.rank == MPI.COMM_WORLD.rank
scene = {scene!r}
summary = dartcast.run(scene, sys.argv[1], threads=1, ranks=ranks, partition=sys.argv[2])
if ranks.rank == 0:
    print(summary.state_hash)
"""


def mpi_environment():
    return {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
            "OMPI_MCA_rmaps_base_oversubscribe": "1",
            "PYTHONPATH": str(pathlib.Path(dartcast.__file__).parent.parent)}


@pytest.mark.parametrize("partition", ["particles", "cells"])
def test_mpi4py_gives_ranks(tmp_path, partition):
    pytest.importorskip("mpi4py")
    if shutil.which("mpirun") is None:
        pytest.skip("mpirun is not installed")
    program = tmp_path / "program.py"
    program.write_text(PROGRAM.format(scene=SCENE))
    done = subprocess.run(["mpirun", "-n", "3", sys.executable, program, tmp_path / "out", partition],
                          env=mpi_environment(), capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == dartcast.run(SCENE, threads=1).state_hash


def test_the_example_runs(tmp_path):
    pytest.importorskip("mpi4py")
    if shutil.which("mpirun") is None:
        pytest.skip("mpirun is not installed")
    example = pathlib.Path(__file__).resolve().parent.parent.parent / "examples" / "mpi" / "shared.py"
    done = subprocess.run(["mpirun", "-n", "3", sys.executable, example], env=mpi_environment(), capture_output=True,
                          text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    assert re.match(r"3 ranks: 1000 particles, [1-9]\d* went to another rank, 0 are not", done.stdout), done.stdout
