"""Environments: places, sets of particles, moves, edits."""
from __future__ import annotations

import copy
import warnings

import dartcast
import numpy as np
import pytest


def box(n=2, **options):
    return dartcast.Environment(dartcast.generate_box(cells=[n, n, n], size=[1.0, 1.0, 1.0], **options), threads=1)


def centred(env):
    parts, added = env.add(np.array([[0.25, 0.25, 0.25], [0.6, 0.7, 0.8], [0.9, 0.1, 0.2]]))
    assert added.all()
    return parts


def test_a_point_is_in_its_cell():
    env = box()
    found = env.locate([0.25, 0.25, 0.25])
    assert found.place == dartcast.Place.FREE and env.map.source(found.simplex.cell) == 0
    assert env.locate([2.0, 0.0, 0.0]).place == dartcast.Place.OUTSIDE
    assert env.locate([2.0, 0.0, 0.0]).simplex is None
    corner = env.locate([0.5, 0.5, 0.5])
    assert corner.kind == dartcast.Kind.VERTEX and corner.dart is not None


def test_many_points_are_located_as_one_by_one():
    env = box(3)
    x = np.random.default_rng(1).uniform(-0.2, 1.2, (200, 3))
    x[:3] = [[1 / 3, 0.5, 0.5], [0.0, 0.0, 0.0], [2.0, 2.0, 2.0]]
    rows = env.locate(x)
    inside = ((x >= 0) & (x <= 1)).all(axis=1)
    assert ((rows["place"] == dartcast.Place.FREE) == inside).all()
    assert (rows["cell"][~inside] == dartcast.NONE).all()
    for point, row in zip(x, rows):
        one = env.locate(point)
        assert one.place == row["place"] and one.kind == row["kind"]
        assert one.simplex is None or one.simplex == (row["cell"], row["simplex"])


def test_rays_leave_the_unit_cube_where_they_must():
    env = box(3)
    random = np.random.default_rng(2)
    x = random.uniform(0.1, 0.9, (100, 3))
    d = random.normal(size=(100, 3))
    hits, cells, first = env.cast_rays(x, d, cells=True)
    unit = d / np.linalg.norm(d, axis=1)[:, None]
    away = (np.where(d > 0, 1.0, 0.0) - x) / unit
    assert hits["hit"].all() and (hits["origin"] == dartcast.Place.FREE).all()
    assert np.allclose(hits["distance"], away.min(axis=1), rtol=1e-12)
    assert np.allclose(hits["point"], x + unit * hits["distance"][:, None])
    wall = away.argmin(axis=1)
    assert (hits["normal"][np.arange(100), wall] == -np.sign(d[np.arange(100), wall])).all()
    assert len(first) == 101 and first[-1] == len(cells) and (np.diff(first) > 0).all()
    assert (cells[first[1:] - 1] == hits["cell"])[hits["kind"] == dartcast.Kind.FACE].all()
    near = env.cast_rays(x, d, 1e-3)
    assert not near["hit"].any() and np.isinf(near["distance"]).all() and (near["cell"] == dartcast.NONE).all()


def test_locate_refuses_what_is_no_point():
    env = box()
    with pytest.raises(ValueError, match="finite|range"):
        env.locate([np.nan, 0.0, 0.0])
    with pytest.raises(TypeError, match="complex64"):
        env.locate(np.zeros((4, 3), dtype=np.complex64))
    with pytest.raises(TypeError, match="three numbers"):
        env.locate([1.0, 2.0])


class Frame:
    """As a frame of pandas: NumPy makes an array of it."""

    def __init__(self, values):
        self.values = values

    def __array__(self, dtype=None, copy=None):
        return np.asarray(self.values, dtype)


@pytest.mark.parametrize("change", [
    lambda x: x.tolist(), lambda x: tuple(map(tuple, x)), lambda x: x.astype(np.float32), lambda x: x.astype(">f8"),
    np.asfortranarray, lambda x: np.repeat(x, 2, axis=0)[::2], lambda x: x[::-1][::-1], Frame,
    lambda x: np.concatenate([x, x], axis=1)[:, :3], lambda x: list(x)])
def test_numbers_in_any_array_are_the_same_to_the_bit(change):
    env = box(4)
    x = np.random.default_rng(3).uniform(0, 1, (50, 3)).astype(np.float32).astype(float)
    plain, _ = env.add(x)
    given, added = env.add(change(x))
    assert added.all() and given.states.tobytes() == plain.states.tobytes()
    assert env.locate(change(x)).tobytes() == env.locate(x).tobytes()
    env.advance(given, change(x[::-1].copy()))
    env.advance(plain, x[::-1].copy())
    assert given.states.tobytes() == plain.states.tobytes()
    assert dartcast.MeshData(change(x), {"tetra": [[0, 1, 2, 3]]}).points.tobytes() == x.tobytes()


def test_whole_numbers_are_points_too():
    env = box()
    assert env.locate([[0, 0, 1], [1, 1, 1]])["place"].tolist() == [dartcast.Place.FREE] * 2
    assert env.locate(np.ones((1, 3), dtype=np.int64))["kind"].tolist() == [dartcast.Kind.VERTEX]


def test_an_array_that_a_call_writes_to_is_not_copied():
    env = box()
    parts = centred(env)
    with pytest.raises(TypeError, match="velocities: expected float64"):
        env.advance(parts, parts.positions, dartcast.Slide(), velocities=np.zeros((3, 3), dtype=np.float32), dt=0.1)
    with pytest.raises(TypeError, match="velocities: expected float64"):
        env.advance(parts, parts.positions, dartcast.Slide(), velocities=np.zeros((3, 3)).tolist(), dt=0.1)


def test_free_regions_are_chosen_by_name():
    mesh = dartcast.generate_vessel()
    tissue = dartcast.Environment(mesh, free=["tissue"])
    lumen = dartcast.Environment(mesh)
    x = np.array([[0.0, 0.0, -0.01]])
    assert lumen.locate(x)["place"][0] == dartcast.Place.FREE
    assert tissue.locate(x)["place"][0] == dartcast.Place.BLOCKED
    with pytest.raises(dartcast.InvalidMesh, match="lumen"):
        dartcast.Environment(mesh, free=["bone"])


def test_a_mesh_with_a_defect_is_refused():
    mesh = dartcast.generate_box(cells=[1, 1, 1])
    points = mesh.points.copy()
    points[0] = np.nan
    mesh.points = points
    with pytest.raises(dartcast.InvalidMesh):
        dartcast.Environment(mesh)


def test_particles_are_added_where_cells_are_free():
    env = box(3, blocked_layer=True)
    x = np.array([[0.5, 0.5, 0.5], [0.1, 0.1, 0.1], [3.0, 0.0, 0.0]])
    with pytest.warns(UserWarning, match="add: 2 of 3 positions are in no free cell"):
        parts, added = env.add(x)
    assert len(parts) == 1 and added.tolist() == [True, False, False]
    assert env.locate(x)["place"].tolist() == [dartcast.Place.FREE, dartcast.Place.BLOCKED, dartcast.Place.OUTSIDE]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        added, indices = env.add(parts, np.array([[0.4, 0.5, 0.5], [0.1, 0.1, 0.1]]))
    assert len(parts) == 2 and added.tolist() == [True, False] and indices.tolist() == [1]
    at = parts[0]
    assert env.add(parts, at.at(), at.position) and len(parts) == 3
    assert not env.add(parts, at.at(), [0.1, 0.1, 0.1]) and len(parts) == 3
    assert not env.add(parts, (dartcast.NONE - 7, 0), [0.5, 0.5, 0.5])


def test_random_particles_fill_the_free_volume_evenly():
    env = box(2, jitter=0.3)
    parts = env.add_random(4000, seed=3)
    x = parts.positions
    assert len(parts) == 4000 and dartcast.audit(env.complex, parts).failed == 0
    assert np.abs(x.mean(axis=0) - 0.5).max() < 0.02 and np.abs((x < 0.25).mean(axis=0) - 0.25).max() < 0.03
    assert np.array_equal(x, env.add_random(4000, seed=3).positions)
    assert not np.array_equal(x, env.add_random(4000, seed=4).positions)
    blocked = box(2)
    blocked.edit(lambda e: [e.topology.set_free(int(c), False) for c in e.map.cells()])
    with pytest.raises(dartcast.InvalidArgument, match="no free cell"):
        blocked.add_random(1)


def test_arrays_of_particles_are_copies():
    env = box()
    parts = centred(env)
    for name in ("positions", "cells", "simplices", "touching_counts", "held", "states", "vertex_numbers"):
        first, second = getattr(parts, name), getattr(parts, name)
        assert not np.shares_memory(first, second) and not first.flags.writeable and len(first) == 3
    before = parts.positions
    env.add(parts, np.random.default_rng(1).uniform(0, 1, (5000, 3)))
    assert np.array_equal(before, parts.positions[:3])
    points = env.positions
    assert not points.flags.writeable and not np.shares_memory(points, env.positions)
    assert parts.vertex_numbers.shape == (5003, 4) and parts.held_weights().shape == (5003, 4)
    corners = env.complex.positions[parts.vertex_numbers[0]]
    assert np.array_equal(corners, env.complex.corners(parts[0].at()))


def test_particles_are_removed_reordered_selected_and_replaced():
    env = box()
    parts = centred(env)
    x = parts.positions
    parts.reorder([2, 0, 1])
    assert np.array_equal(parts.positions, x[[2, 0, 1]])
    some = parts.selected(np.array([0, 2]))
    assert np.array_equal(some.positions, x[[2, 1]])
    env.advance(some, some.positions + [0.0, 0.01, 0.0])
    parts.replace([0, 2], some)
    assert np.array_equal(parts.positions, [x[2] + [0, 0.01, 0], x[0], x[1] + [0, 0.01, 0]])
    other = copy.copy(parts)
    other.truncate(5)
    assert len(other) == 3
    some.truncate(1)
    assert len(some) == 1 and np.array_equal(env.advance(some, some.positions).contacts["particle"], [])
    parts.remove(np.array([True, False, False]))
    assert len(parts) == 2 and len(other) == 3 and len(other.copy()) == 3 and parts.size == 2
    with pytest.raises(dartcast.InvalidArgument):
        parts.remove(np.zeros(3, dtype=bool))
    with pytest.raises(dartcast.InvalidArgument):
        parts.reorder([0, 0])
    with pytest.raises(dartcast.InvalidArgument):
        parts.selected([9])
    with pytest.raises(dartcast.InvalidArgument):
        parts.replace([0], parts)
    with pytest.raises(IndexError):
        parts[2]
    with pytest.raises(IndexError):
        parts.held_weights(2)
    with pytest.raises(TypeError, match="bool or uint8"):
        parts.remove(np.zeros(2))


def test_saved_states_are_restored():
    env = box()
    parts = env.add_random(100)
    again = env.restored(parts.states, parts.held_weights())
    assert again.states.tobytes() == parts.states.tobytes()
    env.advance(again, again.positions)
    for name, value in (("cell", 77), ("simplex", 60000), ("position", [5, 5, 5]), ("touching_count", 200)):
        broken = parts.states.copy()
        broken[name][7] = value
        with pytest.raises(dartcast.InvalidArgument):
            env.restored(broken, parts.held_weights())
    held = parts.states.copy()
    held["held"][3] = True
    with pytest.raises(dartcast.InvalidArgument, match="held_weights"):
        env.restored(held)
    with pytest.raises(TypeError, match="Particles.states"):
        env.restored(parts.positions)
    with pytest.raises(TypeError, match="weights"):
        env.restored(parts.states, np.zeros((3, 4)))


def test_moves_carry_particles_along():
    env = box()
    parts = centred(env)
    x, rest = parts.positions, env.positions
    env.move(rest + [1.0, 0.0, 0.0])
    assert env.awaits_advance(parts)
    env.advance(parts, x + [1, 0, 0])
    assert np.allclose(parts.positions, x + [1, 0, 0], atol=1e-12) and not env.awaits_advance(parts)
    with pytest.raises(dartcast.InvalidArgument):
        env.move(rest[:-1])
    with pytest.raises(TypeError, match="Convert it by x.T"):
        env.move(rest.T)
    env.move(rest)
    env.move(rest)
    with pytest.raises(dartcast.InvalidArgument, match="missed"):
        env.advance(parts, x)


def test_next_points_are_written_without_a_copy():
    env = box()
    parts = centred(env)
    x, rest = parts.positions, env.positions
    for k in (1, 2):
        with env.next_points() as p:
            p[:] = rest + [0.1 * k, 0, 0]
            assert np.array_equal(env.positions, rest + [0.1 * (k - 1), 0, 0])
            for call in (lambda: env.advance(parts, x), lambda: env.move(rest), lambda: env.edit(lambda e: None),
                         lambda: env.next_points().__enter__(), lambda: env.trace(parts, 0, x)):
                with pytest.raises(dartcast.InvalidArgument, match="next_points"):
                    call()
        assert np.array_equal(env.positions, rest + [0.1 * k, 0, 0])
        assert not p.flags.writeable
        with pytest.raises(ValueError):
            p[0, 0] = 7.0
        env.advance(parts, parts.positions)
    assert np.allclose(parts.positions, x, atol=1e-12)


def test_memory_of_next_points_outlives_the_environment_and_no_edit():
    env = box()
    with env.next_points() as p:
        p[:] = env.positions
        view = p[3:]
    with pytest.raises(dartcast.InvalidArgument, match="delete"):
        env.edit(lambda e: None)
    del p
    with pytest.raises(dartcast.InvalidArgument, match="delete"):
        env.edit(lambda e: None)
    del view
    env.edit(lambda e: None)
    with env.next_points() as p:
        p[:] = env.positions
    del env
    assert np.isfinite(p).all()


def test_a_block_that_raises_moves_nothing():
    env = box()
    parts, waiting = centred(env), centred(env)
    rest = env.positions
    env.move(rest + [0.5, 0, 0])
    env.advance(parts, parts.positions)
    with pytest.raises(RuntimeError, match="mine"):
        with env.next_points() as p:
            p[:] = 7.0
            raise RuntimeError("mine")
    assert np.array_equal(env.positions, rest + [0.5, 0, 0]) and not p.flags.writeable
    env.advance(parts, parts.positions)
    for call in (lambda: env.advance(waiting, waiting.positions), lambda: env.trace(waiting, 0, waiting.positions),
                 lambda: env.update_after_edit(waiting)):
        with pytest.raises(dartcast.InvalidArgument, match="written over"):
            call()
    env.move(rest)
    env.advance(parts, parts.positions)
    block = env.next_points()
    with block:
        pass
    with pytest.raises(dartcast.InvalidArgument, match="has ended"):
        block.__enter__()


def test_inversions_are_known_before_a_move():
    env = box()
    rest = env.positions
    folded = rest.copy()
    folded[13] += [2.0, 0, 0]
    first = env.first_inversion(folded)
    assert first is not None and 0.0 < first.how.safe_time < 0.5
    assert env.first_inversion(rest) is None
    way = env.move_until_inverted(folded, 0.5)
    assert 0.0 < way < 0.5 and env.validity().valid
    with pytest.raises(dartcast.InvalidArgument, match="share"):
        env.move_until_inverted(folded, np.nan)
    with pytest.raises(dartcast.InvalidArgument):
        env.first_inversion(rest[1:])


def test_edits_change_the_cells_and_particles_follow():
    env = box()
    parts = centred(env)
    cell = parts[0].cell
    kept = []

    def block(edit):
        kept.append(edit)
        edit.topology.set_free(cell, False)
        with pytest.raises(dartcast.InUse):
            env.locate([0.1, 0.1, 0.1])

    report = env.edit(block)
    assert env.edit_count == 1 and env.last_edit == report
    with pytest.raises(dartcast.InvalidArgument, match="ended"):
        kept[0].position(0)
    with pytest.raises(dartcast.InvalidArgument, match="update_after_edit"):
        env.advance(parts, parts.positions)
    moved, held, gone = parts.copy(), parts.copy(), parts.copy()
    result = env.update_after_edit(moved)
    assert len(result.orphaned) == 1 and result.orphaned["place"][0] == dartcast.Place.BLOCKED
    assert np.isclose(result.orphaned["distance"][0], 0.25) and not moved.held.any()
    assert env.update_after_edit(held, "hold").orphaned["outcome"][0] == dartcast.records.OrphanPolicy.HOLD
    assert held.held.tolist() == [True, False, False] and np.isclose(held.held_weights(0).sum(), 1.0)
    env.update_after_edit(gone, dartcast.records.OrphanPolicy.ABSORB)
    assert len(gone) == 2


def test_a_mesh_is_replaced_and_particles_keep_their_places():
    env = box()
    parts = centred(env)
    places = parts.positions.copy()
    finer = dartcast.generate_box(cells=[6, 5, 4], size=env.positions.max(axis=0))
    env.replace(finer)
    assert env.edit_count == 1 and env.last_edit.replaced and len(env.positions) == 7 * 6 * 5
    assert env.update_after_edit(parts).located == len(parts) and (parts.positions == places).all()
    env.advance(parts, places)


def test_an_edit_that_raises_changes_nothing():
    env = box()
    before = env.map.cells()

    def fails(edit):
        dartcast.topology.remove(edit.topology, int(edit.map.cells()[0]))
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        env.edit(fails)
    assert np.array_equal(env.map.cells(), before) and env.edit_count == 0


def test_parts_keep_the_environment_alive():
    env = box()
    complex_, map_ = env.complex, env.map
    del env
    assert len(map_.cells()) == 8 and complex_.point_count == 27
    with pytest.raises(dartcast.InvalidArgument):
        dartcast.topology.ComplexEdit(complex_)
    with pytest.raises(dartcast.InvalidArgument):
        complex_.move(complex_.positions)


def test_threads_are_set():
    env = box()
    assert env.threads == 1
    env.threads = 2
    assert env.threads == 2
    with pytest.raises(dartcast.Error):
        env.threads = dartcast.records.max_threads() + 1
    with pytest.raises(ValueError):
        env.threads = -1
    dartcast.records.check_threads(1)
    with pytest.raises(dartcast.InvalidArgument):
        dartcast.records.check_threads(10**6)


def test_particles_of_another_environment_are_refused():
    env, other = box(), box()
    parts = centred(other)
    for call in (lambda: env.add(parts, np.zeros((1, 3))), lambda: env.advance(parts, parts.positions),
                 lambda: env.check_advance(parts), lambda: env.trace(parts, 0, parts.positions)):
        with pytest.raises(dartcast.InvalidArgument, match="another environment"):
            call()


def test_placement_and_forecast_name_the_cell_of_the_map():
    env = box()
    parts = centred(env)
    state = parts[0]
    corners = env.complex.corners(state.at())
    ahead = dartcast.topology.forecast(env.map, state, corners)
    assert ahead.kind in (dartcast.Kind.VOLUME, dartcast.Kind.FACE, dartcast.Kind.EDGE) and ahead.dart is not None
    inside = dartcast.topology.placement(env.map, state.at(), corners, corners.mean(axis=0))
    assert inside.kind in (dartcast.Kind.VOLUME, dartcast.Kind.FACE)
    with pytest.raises(dartcast.InvalidArgument):
        dartcast.topology.forecast(env.map, dartcast.topology.ParticleState(), corners)
    with pytest.raises(dartcast.InvalidArgument):
        dartcast.topology.placement(env.map, (12345, 0), corners, [0, 0, 0])
    bad = parts[0]
    bad.touching_count = 9
    with pytest.raises(dartcast.InvalidArgument, match="3 walls"):
        dartcast.topology.forecast(env.map, bad, corners)
