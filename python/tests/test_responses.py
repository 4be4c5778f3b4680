"""The responses of the library: values, per patch, velocities and statuses in place."""
from __future__ import annotations

import dartcast
import numpy as np
import pytest
from dartcast import Absorb, Escape, ParticleStatus, Reflect, Slide, Stick

DT = 0.5


def scene(patch="zmax"):
    """One particle that meets the wall z = 1 after half of its way, and its velocity."""
    env = dartcast.Environment(dartcast.generate_box(cells=[2, 2, 2], size=[1.0, 1.0, 1.0]), threads=1)
    parts, _ = env.add(np.array([[0.3, 0.3, 0.9]]))
    return env, parts, np.array([[0.2, 0.0, 0.4]])


def step(respond, **named):
    env, parts, v = scene()
    statuses = np.zeros(1, dtype=np.uint8)
    report = env.advance(parts, parts.positions + v * DT, respond, velocities=v, statuses=statuses, dt=DT, **named)
    return parts.positions[0], v[0], statuses[0], report


@pytest.mark.parametrize("respond, x, v, status", [
    (Reflect(), [0.4, 0.3, 0.9], [0.2, 0, -0.4], ParticleStatus.ALIVE),
    (Reflect(0.5), [0.4, 0.3, 0.95], [0.2, 0, -0.2], ParticleStatus.ALIVE),
    (Reflect(0.5, friction=0.1), [0.385, 0.3, 0.95], [0.14, 0, -0.2], ParticleStatus.ALIVE),
    (Slide(), [0.4, 0.3, 1.0], [0.2, 0, 0], ParticleStatus.ALIVE),
    (Stick(), [0.35, 0.3, 1.0], [0, 0, 0], ParticleStatus.STUCK),
    (Absorb(), [0.35, 0.3, 1.0], [0.2, 0, 0.4], ParticleStatus.ABSORBED),
    (Escape(), [0.35, 0.3, 1.0], [0.2, 0, 0.4], ParticleStatus.ESCAPED),
    (dartcast.records.WallResponse("slide"), [0.4, 0.3, 1.0], [0.2, 0, 0], ParticleStatus.ALIVE),
    (dartcast.records.WallResponse("reflect", 0.5, stick_below=0.5), [0.35, 0.3, 1.0], [0, 0, 0], ParticleStatus.STUCK),
    (dartcast.records.WallResponse("reflect", 0.5, stick_below=0.3), [0.4, 0.3, 0.95], [0.2, 0, -0.2], ParticleStatus.ALIVE),
    (dartcast.records.WallResponse(table=dartcast.records.RestitutionTable([0.1, 1.0], [0.0, 90.0], [0.5] * 4)),
     [0.4, 0.3, 0.95], [0.2, 0, -0.2], ParticleStatus.ALIVE),
    ({"zmax": Slide()}, [0.4, 0.3, 1.0], [0.2, 0, 0], ParticleStatus.ALIVE),
    ({"zmin": Slide()}, [0.4, 0.3, 0.9], [0.2, 0, -0.4], ParticleStatus.ALIVE),
    ({None: Stick(), "xmin": Slide()}, [0.35, 0.3, 1.0], [0, 0, 0], ParticleStatus.STUCK),
    ({6: Slide(), None: Stick()}, [0.4, 0.3, 1.0], [0.2, 0, 0], ParticleStatus.ALIVE),
    (dartcast.records.WallResponses(Slide()), [0.4, 0.3, 1.0], [0.2, 0, 0], ParticleStatus.ALIVE),
])
def test_a_response_writes_velocity_and_status(respond, x, v, status):
    found_x, found_v, found_status, report = step(respond)
    assert np.allclose(found_x, x, atol=1e-12) and np.allclose(found_v, v, atol=1e-12)
    assert found_status == status and len(report.contacts) >= 1


def test_statuses_may_be_left_out():
    env, parts, v = scene()
    env.advance(parts, parts.positions + v * DT, Absorb(), velocities=v, dt=DT)
    assert np.allclose(parts.positions, [[0.35, 0.3, 1.0]])


def test_a_ready_callback_does_the_same():
    env, parts, v = scene()
    statuses = np.zeros(1, dtype=np.uint8)
    ready = dartcast.respond_with(Stick(), v, statuses, DT)
    targets = parts.positions + v * DT
    traced = env.trace(parts, 0, targets, ready)
    assert traced[0].contacts["time_of_impact"].tolist() == pytest.approx([0.5])
    v[:] = [[0.2, 0, 0.4]]
    statuses[:] = 0
    env.advance(parts, targets, ready)
    assert statuses[0] == ParticleStatus.STUCK and np.array_equal(v, [[0, 0, 0]])
    added, _ = env.add(parts, np.array([[0.5, 0.5, 0.5]]))
    assert added.all()
    with pytest.raises(dartcast.InvalidArgument, match="2 particles; got 1"):
        env.advance(parts, parts.positions, ready)


def test_an_acceleration_gives_the_energy_of_the_contact():
    fall = dartcast.records.Acceleration([0, 0, -10.0], DT)
    x, v, status, _ = step(Reflect(), acceleration=fall)
    assert v[2] < 0 and status == ParticleStatus.ALIVE
    assert not np.array_equal(x, step(Reflect())[0])


@pytest.mark.parametrize("named, error", [
    (dict(respond=Reflect()), dartcast.InvalidArgument),
    (dict(respond=Reflect(), velocities=np.zeros((1, 3))), dartcast.InvalidArgument),
    (dict(respond=Reflect(), velocities=np.zeros((1, 3)), dt=0.0), dartcast.InvalidArgument),
    (dict(respond=Reflect(), velocities=np.zeros((1, 3)), dt=np.nan), dartcast.InvalidArgument),
    (dict(respond=Reflect(), velocities=np.zeros((2, 3)), dt=1.0), dartcast.InvalidArgument),
    (dict(respond=Reflect(), velocities=np.zeros((1, 3), dtype=int), dt=1.0), TypeError),
    (dict(respond=Reflect(), velocities=np.broadcast_to(np.zeros(3), (1, 3)), dt=1.0), TypeError),
    (dict(respond=Reflect(), velocities=np.zeros((1, 3)), statuses=np.zeros(1), dt=1.0), TypeError),
    (dict(respond=Reflect(), velocities=np.zeros((1, 3)), statuses=np.zeros(2, dtype=np.uint8), dt=1.0),
     dartcast.InvalidArgument),
    (dict(respond=Reflect(1.5), velocities=np.zeros((1, 3)), dt=1.0), dartcast.InvalidArgument),
    (dict(respond=Reflect(0.5, -1.0), velocities=np.zeros((1, 3)), dt=1.0), dartcast.InvalidArgument),
    (dict(respond={"nowhere": Slide()}, velocities=np.zeros((1, 3)), dt=1.0), dartcast.InvalidArgument),
    (dict(respond={"zmax": 7}, velocities=np.zeros((1, 3)), dt=1.0), TypeError),
    (dict(respond={-1: Slide()}, velocities=np.zeros((1, 3)), dt=1.0), ValueError),
    (dict(respond="slide", velocities=np.zeros((1, 3)), dt=1.0), TypeError),
    (dict(respond=None, velocities=np.zeros((1, 3))), dartcast.InvalidArgument),
    (dict(respond=lambda c, w: None, dt=1.0), dartcast.InvalidArgument),
])
def test_arguments_that_do_not_fit_are_refused(named, error):
    env, parts, _ = scene()
    before = parts.states.tobytes()
    with pytest.raises(error):
        env.advance(parts, parts.positions, **named)
    assert parts.states.tobytes() == before


def test_read_only_arrays_are_not_written():
    env, parts, v = scene()
    v.flags.writeable = False
    with pytest.raises(TypeError, match="writable"):
        env.advance(parts, parts.positions, Reflect(), velocities=v, dt=1.0)
    statuses = np.zeros(1, dtype=np.uint8)
    statuses.flags.writeable = False
    with pytest.raises(TypeError, match="writable"):
        env.advance(parts, parts.positions, Reflect(), velocities=v.copy(), statuses=statuses, dt=1.0)


def test_responses_by_patch_are_read_back():
    env, _, _ = scene()
    r = dartcast.records.WallResponses({None: Slide(), "zmax": Reflect(0.25)}, env.map)
    top = env.map.patch_names.index("zmax")
    assert r.of(top) == dartcast.records.WallResponse(dartcast.records.WallResponseKind.REFLECT, 0.25, 0.0)
    assert r.of(1).kind == dartcast.records.WallResponseKind.SLIDE
    r.set(1, Stick())
    assert r.of(1).kind == dartcast.records.WallResponseKind.STICK and r.of(60000).kind == dartcast.records.WallResponseKind.SLIDE
    with pytest.raises(dartcast.InvalidArgument, match="number"):
        dartcast.records.WallResponses({"zmax": Slide()})
    with pytest.raises(TypeError):
        r.set(1, 5)
    with pytest.raises(dartcast.InvalidArgument):
        r.set(1, Reflect(-1.0))


def test_the_operators_reflect_and_slide():
    env, parts, v = scene()
    report = env.advance(parts, parts.positions + v * DT)
    walls = report.walls_of(0)
    assert np.allclose(dartcast.reflected([1, 0, 2], walls, 0.5, 0.0), [1, 0, -1])
    assert np.allclose(dartcast.slid([1, 0, 2], walls, []), [1, 0, 0])
    assert np.array_equal(dartcast.slid([1, 0, 2], [], []), [1, 0, 2])
    assert np.array_equal(dartcast.reflected([1, 0, 2], [], 0.5, 0.0), [1, 0, 2])
    broken = dartcast.records.WallHit(normal=[np.nan] * 3)
    dartcast.reflected([1, 0, 2], [broken] * 9, 0.5, 0.1)
    dartcast.slid([1, 0, 2], [broken] * 9, [broken] * 3)


def test_stopped_particles_are_held():
    env, parts, v = scene()
    options = dartcast.records.StepOptions(max_contacts=1)
    targets = parts.positions + [[0.0, 0.0, 5.0]]
    v[:] = [[0.0, 0.0, 10.0]]
    report = env.advance(parts, targets, options=options)
    assert len(report.stopped) == 1
    dartcast.records.hold_stopped(report, Reflect(), v, None, DT)
    assert v[0, 2] <= 1e-12
    for velocities, statuses, error in ((np.zeros((0, 3)), None, dartcast.InvalidArgument),
                                     (v, np.zeros(2, dtype=np.uint8), dartcast.InvalidArgument),
                                     (v, np.zeros(1), TypeError)):
        with pytest.raises(error):
            dartcast.records.hold_stopped(report, Slide(), velocities, statuses, DT)
