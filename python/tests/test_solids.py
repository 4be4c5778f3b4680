"""Bodies, catheters and surfaces: conserved quantities, exact containment, places."""
from __future__ import annotations

import dartcast
import numpy as np
import pytest


def test_a_body_falls_freely() -> None:
    environment = dartcast.Environment(dartcast.generate_box(cells=[4, 4, 4], size=[4.0, 4.0, 4.0]))
    bodies = dartcast.Bodies(environment, dartcast.records.BodiesOptions(dt=1e-2, gravity=[0.0, 0.0, -10.0]))
    points = np.array([[2.0, 2.0, 3.0], [2.2, 2.0, 3.0], [2.0, 2.2, 3.0], [2.0, 2.0, 3.2]])
    assert bodies.add(points, dartcast.BodyOptions(mass=2.0)).body == 0
    for _ in range(20):
        bodies.step()
    fallen = points.mean(axis=0)[2] - bodies.positions.mean(axis=0)[2]
    assert fallen == pytest.approx(0.5 * 10.0 * 0.2**2, rel=1e-6)


def test_samples_of_a_solid_are_inside() -> None:
    barrel = dartcast.generate_barrel()
    samples = dartcast.sample_solid(barrel, dartcast.records.SamplingOptions(spacing=0.1))
    radius = np.hypot(samples.points[:, 0], samples.points[:, 1])
    assert radius.max() < 0.25 + 1e-9 and samples.on_surface > 10


def test_a_catheter_stays_in_the_lumen() -> None:
    environment = dartcast.Environment(dartcast.generate_vessel())
    catheter = dartcast.Catheter(environment, dartcast.CatheterOptions(
        length=0.03, spacing=1e-3, entry=[0.0, -0.006376, -0.026761], direction=[0.0, 0.472, 0.882]))
    for _ in range(20):
        catheter.step(dartcast.CatheterInput(push=5e-4))
    points = catheter.points()
    assert catheter.inserted == pytest.approx(0.01, rel=0.05)
    assert (environment.locate(points)["place"] == dartcast.Place.FREE).all()


def test_places_on_a_surface_keep_their_length() -> None:
    surface = dartcast.topology.Surface(dartcast.generate_barrel())
    locator = dartcast.topology.SurfaceLocator(surface)
    found = locator.nearest(surface, [0.3, 0.01, 0.02])
    assert found.distance == pytest.approx(0.05, abs=0.01)
    assert surface.contains(found.place)


def test_stale_handles_raise() -> None:
    surface = dartcast.topology.Surface(dartcast.generate_barrel())
    with pytest.raises((dartcast.InvalidArgument, IndexError)):
        surface.corners((0xFFFFFF0, 0))


CROSS = np.array([[1.0, 0, 0], [-1.0, 0, 0], [0, 1.0, 0], [0, -1.0, 0], [0, 0, 1.0], [0, 0, -1.0]])


def bodies(**options: object) -> dartcast.Bodies:
    """No body yet, in a large box around the origin."""
    environment = dartcast.Environment(dartcast.generate_box(cells=[2, 2, 2], size=[40.0] * 3, origin=[-20.0] * 3))
    return dartcast.Bodies(environment, dartcast.records.BodiesOptions(**({"dt": 1e-2} | options)))


def test_a_body_has_the_numbers_of_its_points() -> None:
    """Six points of 0.5 kg at a distance of 1 m: inertia 4 * 0.5 = 2 kg m^2 about each axis."""
    own = bodies(gravity=[0.0, 0.0, -10.0])
    turning = dartcast.BodyOptions(mass=3.0, radius=0.1, velocity=[1.0, 2.0, 0.0], angular_velocity=[0.0, 0.0, 0.5])
    assert own.add(CROSS, turning).body == 0 and own.add(CROSS + [5.0, 0, 0], dartcast.BodyOptions(mass=6.0)).body == 1
    assert len(own) == own.size == 2 and [own.id(i) for i in range(2)] == [0, 1]
    assert [own.first_particle(i) for i in range(2)] == [0, 6] and own.particle_count(1) == 6
    assert own.body_of.tolist() == [0] * 6 + [1] * 6
    assert np.allclose(own.masses, [0.5] * 6 + [1.0] * 6) and np.allclose(own.radii, [0.1] * 6 + [0.0] * 6)
    assert np.allclose(own.velocities[0], [1.0, 2.5, 0.0])  # at (1, 0, 0): the turn adds 0.5 along y
    energy = own.energy(0)
    assert energy.kinetic == pytest.approx(0.5 * 3.0 * 5.0 + 0.5 * 2.0 * 0.25)
    assert energy.potential == pytest.approx(3.0 * 10.0 * 20.0) and energy.matching == pytest.approx(0.0, abs=1e-9)
    assert energy.total == pytest.approx(energy.kinetic + energy.potential + energy.matching)
    motion = own.rigid_motion_of(0)
    assert motion.mass == pytest.approx(3.0) and np.allclose(motion.centre, 0.0)
    assert np.allclose(motion.velocity, [1.0, 2.0, 0.0]) and np.allclose(motion.angular_momentum, [0.0, 0.0, 1.0])
    assert motion.kinetic_energy == pytest.approx(energy.kinetic)
    assert np.allclose(motion.velocity_at([0.0, 1.0, 0.0]), [0.5, 2.0, 0.0])
    fit, = own.fits(0)
    assert np.allclose(fit.centre, 0.0) and fit.rotation.w == pytest.approx(1.0)


def test_an_impulse_changes_the_momentum_by_itself() -> None:
    own = bodies()
    own.add(CROSS, dartcast.BodyOptions(mass=3.0, velocity=[1.0, 0.0, 0.0]))
    for _ in range(3):
        own.step()
    solved = own.predicted_state(0)
    assert solved.inverse_mass == pytest.approx(1.0 / 3.0) and np.allclose(solved.velocity, [1.0, 0.0, 0.0])
    solved.velocity = [1.0, 2.0, 0.0]  # 6 N s along y
    own.apply_impulse(0, solved)
    step = own.step()
    assert np.allclose(own.rigid_motion_of(0).velocity, [1.0, 2.0, 0.0], atol=1e-9)
    assert step.input == pytest.approx(0.5 * 3.0 * 4.0, rel=1e-6)


def test_velocities_of_bodies_are_set_between_steps() -> None:
    own = bodies()
    own.add(CROSS, dartcast.BodyOptions(mass=3.0))
    own.velocities = np.full((6, 3), [0.0, 0.0, 2.0])
    own.step()
    assert np.allclose(own.positions.mean(axis=0), [0.0, 0.0, 0.02])
    with pytest.raises((TypeError, dartcast.InvalidArgument)):
        own.velocities = np.zeros((5, 3))


def test_a_checkpoint_of_bodies_goes_on_with_the_same_bits() -> None:
    own = bodies(gravity=[0.0, 0.0, -10.0])
    own.add(CROSS, dartcast.BodyOptions(mass=3.0, angular_velocity=[1.0, 2.0, 3.0]))
    own.step()
    saved, hashes = own.checkpoint(), []
    assert saved.steps == 1 and saved.ids.tolist() == [0] and len(saved.particles) == 6
    assert np.allclose([p.velocity for p in saved.particles], own.velocities)
    for _ in range(2):
        for _ in range(10):
            own.step()
        hashes.append(own.state_hash().hex())
        own.restore(saved)
    assert hashes[0] == hashes[1] and own.steps == 1
    other = bodies()
    with pytest.raises(dartcast.InvalidArgument):
        other.restore(saved)


def test_bodies_refuse_what_they_cannot_hold() -> None:
    own = bodies()
    assert own.add(CROSS + [19.5, 0, 0], dartcast.BodyOptions()).refused.tolist() == [0]
    for options in (dartcast.BodyOptions(mass=0.0), dartcast.BodyOptions(stiffness=1e9), dartcast.BodyOptions(pull=2.0),
                    dartcast.BodyOptions(masses=[1.0]), dartcast.BodyOptions(radius=-1.0)):
        with pytest.raises(dartcast.InvalidArgument):
            own.add(CROSS, options)
    with pytest.raises(dartcast.InvalidArgument):
        own.add(np.zeros((0, 3)), dartcast.BodyOptions())
    assert len(own) == 0
    for i in (0, -1, 10**6):
        with pytest.raises((dartcast.InvalidArgument, IndexError, TypeError, ValueError)):
            own.energy(i)
    with pytest.raises(dartcast.InvalidArgument):
        bodies(dt=0.0)


def tube() -> dartcast.Environment:
    """A straight channel of 50 mm along z, 10 mm wide."""
    return dartcast.Environment(dartcast.generate_box(cells=[3, 3, 10], size=[0.01, 0.01, 0.05],
                                                      origin=[-0.005, -0.005, 0.0]))


def test_contacts_are_the_walls_that_a_catheter_presses_on() -> None:
    catheter = straight(tube(), stiffness=1e-14, direction=[0.5, 0.0, 1.0])
    for _ in range(12):
        catheter.step(dartcast.CatheterInput(push=1e-3))
    contacts, points = catheter.contacts(), catheter.points()
    assert len(contacts) > 0
    for c in contacts:
        place = c["weights"][:c["count"]] @ points[c["vertices"][:c["count"]]]
        assert np.allclose(place, c["point"]) and 0.0 < c["gap"] < 1e-4
        assert np.allclose(c["point"] - c["wall_point"], c["gap"] * c["normal"])


def straight(environment: dartcast.Environment, **options: object) -> dartcast.Catheter:
    return dartcast.Catheter(environment, dartcast.CatheterOptions(
        **({"length": 0.03, "spacing": 1e-3, "entry": [0.0, 0.0, 1e-3], "direction": [0.0, 0.0, 1.0]} | options)))


def test_a_straight_catheter_goes_straight() -> None:
    catheter = straight(tube())
    assert catheter.total_length == pytest.approx(0.03, abs=2e-3) and len(catheter.points()) == 0
    for _ in range(20):
        step = catheter.step(dartcast.CatheterInput(push=1e-3, turn=0.1))
        assert step.pushed == pytest.approx(1e-3) and step.contacts == 0 and step.held == 0
    assert catheter.inserted == pytest.approx(0.02) and catheter.measured_length == pytest.approx(0.02, rel=0.01)
    assert catheter.turned == pytest.approx(2.0)
    points = catheter.points()
    assert np.allclose(points[:, :2], 0.0, atol=1e-9) and points[0, 2] == pytest.approx(0.021, rel=0.01)
    assert np.allclose(points[-1], catheter.entry) and np.allclose(catheter.direction, [0.0, 0.0, 1.0])
    for frame in catheter.frames():
        axes = np.array([frame.tangent, frame.normal, frame.binormal])
        assert np.allclose(axes @ axes.T, np.eye(3), atol=1e-9) and np.linalg.det(axes) == pytest.approx(1.0)
        assert np.allclose(frame.tangent, [0.0, 0.0, 1.0], atol=1e-6)


def test_a_catheter_goes_on_from_a_checkpoint() -> None:
    environment = tube()
    catheter = straight(environment, tip_length=5e-3, tip_curvature=50.0)
    for _ in range(5):
        catheter.step(dartcast.CatheterInput(push=1e-3))
    saved, hashes = catheter.checkpoint(), []
    assert saved.inserted == pytest.approx(catheter.inserted) and len(saved.states) == len(catheter.particles)
    for _ in range(2):
        for _ in range(10):
            catheter.step(dartcast.CatheterInput(push=1e-3, turn=0.3))
        hashes.append(catheter.state_hash().hex())
        catheter.restore(saved)
    assert hashes[0] == hashes[1] and catheter.inserted == pytest.approx(5e-3)
    with pytest.raises(dartcast.InvalidArgument):
        straight(environment, length=0.02).restore(saved)


def test_catheters_refuse_what_is_out_of_range() -> None:
    environment = tube()
    for options in ({"spacing": 0.0}, {"length": -1.0}, {"entry": [1.0, 0.0, 0.0]}, {"direction": [0.0, 0.0, 0.0]},
                    {"tolerance": 0.0}):
        with pytest.raises(dartcast.InvalidArgument):
            straight(environment, **options)
    catheter = straight(environment)
    for given in (dartcast.CatheterInput(push=np.nan),
                  dartcast.CatheterInput(turn=np.inf), dartcast.CatheterInput(load=[np.nan, 0.0, 0.0])):
        with pytest.raises(dartcast.InvalidArgument):
            catheter.step(given)
    environment.move(environment.positions * 1.01)
    environment.move(environment.positions * 1.01)
    with pytest.raises(dartcast.InvalidArgument, match="missed"):
        catheter.step(dartcast.CatheterInput(push=1e-3))


def test_cameras_are_evenly_spaced_along_a_line() -> None:
    points = np.array([[0.0, 0.0, 0.01 * k] for k in range(1, 5)])
    path = dartcast.records.camera_path(tube(), points, dartcast.records.CameraOptions(spacing=2e-3, up=[0.0, 1.0, 0.0]))
    assert path.at_walls == 0 and len(path.cameras) == 16
    for k, camera in enumerate(path.cameras):
        assert np.allclose(camera.position, [0.0, 0.0, 0.01 + 2e-3 * k], atol=1e-9)
        assert np.allclose(camera.direction, [0.0, 0.0, 1.0], atol=1e-6) and np.allclose(camera.up, [0, 1, 0], atol=1e-6)
        assert camera.arc == pytest.approx(2e-3 * k, abs=1e-9)
    for wrong in (points[:1], points + [1.0, 0.0, 0.0]):
        with pytest.raises(dartcast.InvalidArgument):
            dartcast.records.camera_path(tube(), wrong)
    with pytest.raises(dartcast.InvalidArgument, match="max_count|cameras"):
        dartcast.records.camera_path(tube(), points, dartcast.records.CameraOptions(spacing=1e-4, max_count=10))


def test_segments_of_a_catheter_stay_out_of_walls() -> None:
    environment = tube()
    catheter = straight(environment)
    catheter.step(dartcast.CatheterInput(push=1e-2))
    assert catheter.options.edges
    assert catheter.move_with(environment.positions + [1e-3, 0.0, 0.0]) == 1.0
    assert not catheter.step(dartcast.CatheterInput()).stuck
    audit = catheter.audit()
    assert audit.checked == len(catheter.points()) - 1 and audit.failed == 0
    environment.move(environment.positions)
    with pytest.raises(dartcast.InvalidArgument, match="move_with"):
        catheter.step(dartcast.CatheterInput())


def test_the_surface_of_a_body_stays_out_of_walls() -> None:
    mesh = dartcast.generate_box(cells=[4, 4, 4], size=[4.0, 4.0, 4.0])
    environment = dartcast.Environment(mesh)
    bodies = dartcast.Bodies(environment, dartcast.records.BodiesOptions(dt=0.01, gravity=[0.0, 0.0, -9.81]))
    barrel = dartcast.generate_barrel(dartcast.formats.BarrelOptions(radius=0.5, height=1.0))
    barrel.points = barrel.points + [2.0, 2.0, 1.0]
    particles = dartcast.sample_solid(barrel, dartcast.records.SamplingOptions(spacing=0.3)).points
    surface = dartcast.solid_of_surface(barrel)
    added = bodies.add(particles, dartcast.BodyOptions(mass=2.0, damping=10.0, surface=surface))
    assert added.body == 0 and added.surface.refusal == dartcast.records.SolidRefusal.NONE
    contacts = 0
    for _ in range(60):
        assert bodies.move_with(environment.positions) == 1.0
        contacts += len(bodies.step().edges)
    assert contacts > 0 and bodies.audit().failed == 0 and bodies.audit().checked > 0
    assert bodies.surface(0).shape == barrel.points.shape and bodies.surface(0)[:, 2].min() > 0.0
