"""Fields at points and cells, steady and in time."""
from __future__ import annotations

import dartcast
import numpy as np
import pytest


def scene():
    return dartcast.Environment(dartcast.generate_box(cells=[2, 2, 2], size=[1.0, 1.0, 1.0], type="tetrahedron"), threads=1)


def at(field, env, x, moment=0):
    """The field at a point."""
    s = env.locate(x).simplex
    corners = env.complex.corners(s)
    w = np.linalg.solve(np.vstack([corners.T, np.ones(4)]), np.append(x, 1.0))
    return field.at(env.complex, s, list(w), corners, moment)


def test_a_linear_field_is_exact_between_points():
    env = scene()
    field = dartcast.VectorField(env.complex, env.positions * [1.0, 2.0, 3.0])
    x = np.array([0.21, 0.34, 0.83])
    assert np.allclose(at(field, env, x), x * [1, 2, 3])
    assert field.steady and field.frame == dartcast.records.FieldFrame.SPACE and field.place == dartcast.records.FieldPlace.POINTS
    assert np.allclose(field.values[:27], env.positions * [1, 2, 3]) and len(field.rest) == 0
    assert not field.values.flags.writeable and dartcast.records.VelocityField is dartcast.VectorField


def test_a_field_of_cells_is_constant_in_each():
    env = scene()
    values = np.arange(3.0 * 48).reshape(-1, 3)
    samples = dartcast.records.field_samples([0.0], [values], dartcast.records.FieldPlace.CELLS)
    field = dartcast.VectorField(env.complex, samples)
    x = np.array([0.21, 0.34, 0.83])
    cell = env.locate(x).simplex.cell
    assert np.array_equal(at(field, env, x), values[env.map.source(cell)])


def test_samples_are_linear_in_time():
    env = scene()
    asked = []

    def read(k):
        asked.append(k)
        return np.full((27, 3), float(k))

    field = dartcast.VectorField(env.complex, dartcast.records.FieldSamples(times=[0.0, 1.0, 2.0], read=read, period=4.0))
    field.hold(0.0, 1.5)
    field.set_times([0.25, 1.5], env.complex)
    assert np.allclose(at(field, env, [0.2, 0.3, 0.4]), 0.25) and np.allclose(at(field, env, [0.2, 0.3, 0.4], 1), 1.5)
    assert sorted(set(asked)) == [0, 1, 2] and not field.steady
    with pytest.raises(dartcast.InvalidArgument, match="moment"):
        at(field, env, [0.2, 0.3, 0.4], 2)
    for times in ([], [np.nan]):
        with pytest.raises(dartcast.InvalidArgument):
            field.set_times(times, env.complex)
    with pytest.raises(dartcast.InvalidArgument):
        field.hold(np.nan, 1.0)


def test_a_field_of_the_mesh_turns_with_it():
    env = scene()
    rest = env.positions
    field = dartcast.VectorField(env.complex, np.tile([1.0, 0, 0], (27, 1)), dartcast.records.FieldFrame.MESH)
    env.move(np.c_[-rest[:, 1], rest[:, 0], rest[:, 2]])
    assert np.allclose(at(field, env, np.array([-0.3, 0.2, 0.4])), [0, 1, 0])
    assert np.allclose(field.rest[:27], rest)


def test_a_field_follows_edits():
    env = scene()
    field = dartcast.VectorField(env.complex, env.positions.copy())
    cell = env.locate([0.21, 0.34, 0.83]).simplex.cell
    report = env.edit(lambda e: dartcast.topology.split_edge(e.topology, (cell, 0)))
    with pytest.raises(dartcast.InvalidArgument, match="missed an edit"):
        at(field, env, np.array([0.21, 0.34, 0.83]))
    field.update_after_edit(report, env.complex)
    for x in np.random.default_rng(1).uniform(0.01, 0.99, (50, 3)):
        assert np.allclose(at(field, env, x), x)


def test_what_does_not_fit_is_refused():
    env, other = scene(), scene()
    field = dartcast.VectorField(env.complex, env.positions.copy())
    with pytest.raises(dartcast.InvalidArgument, match="another"):
        field.set_times([0.0], other.complex)
    with pytest.raises(IndexError):
        field.at(env.complex, (5, 77), [0.25] * 4, np.zeros((4, 3)))
    with pytest.raises(dartcast.InvalidArgument):
        dartcast.VectorField(env.complex, np.zeros((5, 3)))
    with pytest.raises(dartcast.InvalidArgument):
        dartcast.VectorField(env.complex, np.full((27, 3), np.nan))
    with pytest.raises(dartcast.InvalidArgument):
        dartcast.records.field_samples([0.0, 1.0], [np.zeros((27, 3))])
    with pytest.raises(dartcast.InvalidArgument):
        dartcast.VectorField(env.complex, dartcast.records.FieldSamples())
    longer = dartcast.records.field_samples([0.0, 1.0], [np.zeros((27, 3))] * 2)
    longer.times = [0.0, 1.0, 2.0]
    with pytest.raises(IndexError):
        dartcast.VectorField(env.complex, longer).set_times([1.5], env.complex)
    bad = dartcast.topology.ComplexEditReport(placed=[dartcast.topology.PlacedVertex(3, np.array([999]), [1.0])])
    with pytest.raises(dartcast.InvalidArgument, match="edit"):
        field.update_after_edit(bad, env.complex)


def test_what_a_reader_raises_comes_out():
    env = scene()

    def read(k):
        if k:
            raise OSError("no sample")
        return np.zeros((27, 3))

    field = dartcast.VectorField(env.complex, dartcast.records.FieldSamples(times=[0.0, 1.0], read=read))
    with pytest.raises(OSError, match="no sample"):
        field.set_times([0.5], env.complex)
    with pytest.raises(dartcast.InvalidArgument, match="moment"):
        at(field, env, [0.2, 0.3, 0.4])
