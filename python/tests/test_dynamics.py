"""Limits, records of rigid bodies, threads."""
from __future__ import annotations

import copy
import pickle

import dartcast
import numpy as np
import pytest


def test_limits_hold():
    assert dartcast.predicates.is_radius(dartcast.predicates.LARGEST_RADIUS) and not dartcast.predicates.is_radius(-1.0) and not dartcast.predicates.is_radius(np.nan)
    assert dartcast.predicates.is_mass(dartcast.predicates.SMALLEST_MASS) and dartcast.predicates.is_mass(dartcast.predicates.LARGEST_MASS)
    assert not dartcast.predicates.is_mass(0.0) and dartcast.predicates.SPHERE_TIME_BOUND == 2**-30 and dartcast.predicates.TOUCHING_BOUND == 2**-46
    assert dartcast.records.max_threads() >= 1 and dartcast.records.SHARE_TOGETHER == 2**-20 and dartcast.records.ALONG_SHARE == 4e-12


def test_counts_are_summed():
    a = dartcast.predicates.CollisionCounts(pairs_tested=2, deepest=0.5)
    a += dartcast.predicates.CollisionCounts(pairs_tested=3, deepest=0.25)
    assert a.pairs_tested == 5 and a.deepest == 0.5
    c = dartcast.records.Counters(particle_steps=2, contacts=[1, 2, 3])
    c += dartcast.records.Counters(particle_steps=1, contacts=[1, 1, 1], orientation=dartcast.records.TestCounts(4, 1))
    assert c.particle_steps == 3 and list(c.contacts) == [2, 3, 4] and c.orientation.tests == 4
    assert len(c.histogram) == dartcast.records.Counters.HISTOGRAM_SIZE


def test_a_body_turns_about_its_centre():
    body = dartcast.predicates.RigidMover(turns=True, angular_velocity=[0, 0, 2.0], centre=[1.0, 0, 0], velocity=[0, 0, 1.0])
    assert np.allclose(body.velocity_at([2.0, 0, 0]), [0, 2, 1])
    assert dartcast.predicates.Quaternion().w == 1.0 and np.array_equal(dartcast.predicates.Mat3().y, [0, 1, 0])
    assert dartcast.predicates.CachedImpulse.WALL == 2**64 - 1


@pytest.mark.parametrize("record", [
    dartcast.topology.ParticleState([1, 2, 3], 5, 1), dartcast.records.WallHit((1, 2), 3, 4, [0, 0, 1]), dartcast.records.Contact(particle=3),
    dartcast.records.StepOptions(max_contacts=3), dartcast.Reflect(0.5, friction=0.1), dartcast.Slide(),
    dartcast.records.WallResponse("stick"), dartcast.records.Acceleration([0, 0, -9.81], 0.1), dartcast.records.AfterContact([1, 0, 0], True),
    dartcast.topology.Location(), dartcast.records.Counters(), dartcast.records.Audit(1, 0, ""), dartcast.records.Crossing(time=0.5),
    dartcast.formats.TrajectoryPoint(time=0.5), dartcast.records.StepResult(held=True), dartcast.predicates.RigidMover(),
])
def test_records_are_copied_compared_and_saved(record):
    assert copy.copy(record) == record and copy.deepcopy(record) == record
    assert pickle.loads(pickle.dumps(record)) == record
    assert type(record).__name__ in repr(record) and record != 5
    with pytest.raises(TypeError, match="no member"):
        type(record)(nonsense=1)


@pytest.mark.parametrize("make", [
    lambda z: dartcast.topology.BladePath([[[0, 0, 0], [0, 0, z]], [[1, 0, 0], [1, 0, 1]]]),
    lambda z: dartcast.DeformationStep(frames=[np.zeros((2, 3)), np.full((2, 3), z)]),
    lambda z: dartcast.records.MatchOptions(clusters=[[0, 1], [int(z)]]),
])
def test_records_with_lists_of_arrays_are_compared(make):
    assert make(1.0) == make(1.0) and copy.copy(make(1.0)) == make(1.0) and make(1.0) != make(2.0)
    shorter = dartcast.topology.BladePath([[[0, 0, 0], [0, 0, 1.0]]])
    assert make(1.0) != shorter and shorter != dartcast.topology.BladePath()


@pytest.mark.parametrize("cls", [dartcast.records.BodiesStep, dartcast.records.SimulationStep, dartcast.records.SimulationEdit])
def test_records_with_reports_are_copied(cls):
    assert type(copy.copy(cls())) is cls and type(copy.deepcopy(cls())) is cls


def test_members_refuse_other_types():
    for make in (lambda: dartcast.Reflect("much"), lambda: dartcast.records.StepOptions(max_contacts=-1),
                 lambda: dartcast.records.WallResponse("bounce"), lambda: dartcast.records.Acceleration([1, 2]),
                 lambda: dartcast.topology.ParticleState(cell="x"), lambda: dartcast.Reflect(1, 2, 3),
                 lambda: dartcast.Reflect(0.5, restitution=0.5)):
        with pytest.raises((TypeError, ValueError)):
            make()
    state = dartcast.topology.ParticleState()
    state.put((3, 2), [1, 2, 3])
    assert state.at() == (3, 2) and np.array_equal(state.position, [1, 2, 3]) and not state.position.flags.writeable
