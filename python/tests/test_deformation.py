"""Prescribed motions, and frames read by a function."""
from __future__ import annotations

import copy
import threading

import dartcast
import numpy as np
import pytest

REST = np.random.default_rng(1).uniform(-1, 1, (20, 3))


def frames(reader=None, **named):
    return dartcast.DeformationStep(kind="frames", times=[0.0, 1.0, 2.0], reader=reader, **named)


def test_a_turn_is_a_rotation():
    d = dartcast.Deformation([dartcast.DeformationStep(kind=dartcast.records.DeformationKind.ROTATE, period=4.0)], REST)
    x = d.positions(1.0)
    assert len(d) == d.size == 20 and np.allclose(x, np.c_[-REST[:, 1], REST[:, 0], REST[:, 2]])
    out = np.empty_like(REST)
    assert d.positions(1.0, out) is out and np.array_equal(out, x) and not np.shares_memory(x, d.positions(1.0))
    assert dartcast.records.deformation_kind("bend") == dartcast.records.DeformationKind.BEND and dartcast.records.deformation_kind("x") is None


def test_positions_go_into_an_environment():
    env = dartcast.Environment(dartcast.generate_box(cells=[2, 2, 2], size=[1.0, 1.0, 1.0]), threads=1)
    step = dartcast.DeformationStep(kind="twist", amplitude=0.2)
    d = dartcast.Deformation([step], env.positions)
    with env.next_points() as x:
        d.positions(0.25, x)
    assert np.array_equal(env.positions, d.positions(0.25))


def test_frames_are_linear_in_time():
    held = dartcast.Deformation([frames(frames=[REST, 3 * REST, REST])], REST)
    read = dartcast.Deformation([frames(lambda k: [REST, 3 * REST, REST][k])], REST)
    for t in (0.0, 0.5, 1.75, 9.0):
        read.load_frames(t)
        assert np.array_equal(held.positions(t), read.positions(t))
    assert np.allclose(held.positions(0.5), 2 * REST)


def test_what_a_reader_raises_reaches_the_caller():
    def reader(k):
        if k == 1:
            raise OSError("no such frame")
        return REST

    d = dartcast.Deformation([frames(reader)], REST)
    assert np.array_equal(d.positions(-1.0), REST)
    for call in (d.load_frames, d.positions):
        with pytest.raises(OSError, match="no such frame"):
            call(0.5)
    for wrong in (lambda k: REST[:3], lambda k: np.full_like(REST, np.nan)):
        with pytest.raises(dartcast.InvalidMesh):
            dartcast.Deformation([frames(wrong)], REST).positions(0.5)
    with pytest.raises(TypeError):
        dartcast.Deformation([frames(lambda k: 5)], REST).positions(0.5)


def test_a_deformation_ends_while_its_reader_waits_for_the_lock():
    for _ in range(50):
        started = threading.Event()

        def reader(k):
            started.set()
            return REST.copy()

        d = dartcast.Deformation([frames(reader)], REST)
        d.load_frames(0.0)
        other = copy.copy(d)
        del d
        other.positions(1.5)
        del other
        assert started.is_set()


def test_pulls_and_edits_are_added():
    d = dartcast.Deformation([], REST)
    pull = np.zeros_like(REST)
    pull[3] = [0, 0, 1.0]
    d.add_pull(pull, 1.0, 2.0)
    assert np.array_equal(d.positions(1.0), REST) and np.allclose(d.positions(2.0) - REST, pull)
    placed = dartcast.topology.PlacedVertex(20, np.array([0, 1]), [0.5, 0.5], [0, 0, 0])
    d.update_after_edit(dartcast.topology.ComplexEditReport(placed=[placed]), 21)
    assert len(d) == 21 and np.allclose(d.positions(0.0)[20], REST[:2].mean(axis=0))
    for report, size in ((dartcast.topology.ComplexEditReport(), 5),
                         (dartcast.topology.ComplexEditReport(placed=[dartcast.topology.PlacedVertex(21, np.array([99]), [1.0])]), 22),
                         (dartcast.topology.ComplexEditReport(placed=[dartcast.topology.PlacedVertex(21, np.array([1]), [])]), 22)):
        with pytest.raises(dartcast.InvalidArgument):
            d.update_after_edit(report, size)


def test_arguments_that_do_not_fit_are_refused():
    for step in (dict(kind="rotate", period=0.0), dict(kind="pulse", path=[1.0]), dict(kind="bend", axis=[0, 0, 0]),
                 dict(kind="rotate", centre=[np.nan, 0, 0])):
        with pytest.raises(dartcast.InvalidArgument):
            dartcast.Deformation([dartcast.DeformationStep(**step)], REST)
    with pytest.raises(TypeError):
        dartcast.DeformationStep(kind=3.5)
    d = dartcast.Deformation([], REST)
    with pytest.raises(dartcast.InvalidArgument):
        d.positions(np.inf)
    with pytest.raises(dartcast.InvalidArgument):
        d.positions(0.0, np.zeros((3, 3)))
    with pytest.raises(TypeError):
        d.positions(0.0, np.zeros((20, 3), dtype=np.float32))
    with pytest.raises(dartcast.InvalidArgument):
        d.add_pull(REST, 2.0, 1.0)
    with pytest.raises(dartcast.InvalidArgument):
        dartcast.Deformation([dartcast.DeformationStep(kind="twist", axis=[1.0, 0, 0])], REST * [1, 1, 0]).check_plane()
    assert dartcast.records.FRAME_MEMORY > 0 and dartcast.records.MAX_FRAMES_HELD > 1
