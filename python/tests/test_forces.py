"""Forces and laws: materials as arrays, laws in NumPy, their mistakes."""
from __future__ import annotations

import dartcast as dc
import numpy as np
import pytest

AIR = dc.records.Fluid(density=1.2, viscosity=1.8e-5)


def drops(*terms: dc.records.Force, **options: object) -> dc.Simulation:
    forces = dc.records.ForceOptions(terms=list(terms), fluid=AIR)
    environment = dc.Environment(dc.generate_box(cells=[3, 3, 3], size=[3.0, 3.0, 3.0]))
    return dc.Simulation(environment, dc.SimulationOptions(dt=0.01, forces=forces, **options))


def test_a_law_in_numpy_moves_particles_as_the_librarys_does() -> None:
    rng = np.random.default_rng(1)
    x, v = rng.uniform(1, 2, (50, 3)), rng.uniform(-1, 1, (50, 3))
    material = np.column_stack([rng.uniform(1e-5, 1e-3, 50), np.full(50, 1000.0), np.zeros(50)])
    library = drops(dc.records.Force.STOKES)
    own = drops(user_data=["age"])
    calls = []

    def law(particles: dc.records.LawParticles, fluid: dc.records.LawSamples, result: dc.records.LawResult) -> None:
        calls.append((len(particles.ids), particles.user_data.shape, fluid.gradients.shape, particles.time))
        result.rates[:] = 18 * AIR.viscosity / (particles.densities * particles.diameters**2)

    own.set_law(law)
    for simulation in (library, own):
        simulation.add(x, v, material=material)
        for _ in range(5):
            simulation.step()
    assert np.array_equal(own.diameters, material[:, 0]) and np.array_equal(own.densities, material[:, 1])
    assert np.allclose(own.positions, library.positions, rtol=0, atol=1e-14)
    assert calls[:2] == [(50, (50, 1), (50, 3, 3), 0.0), (50, (50, 1), (50, 3, 3), 0.005)] and len(calls) == 10


def test_forces_need_materials() -> None:
    simulation = drops(dc.records.Force.PUTNAM)
    with pytest.raises(dc.InvalidArgument, match="give a diameter"):
        simulation.add([[1.0, 1.0, 1.0]], [0, 0, 0])
    with pytest.raises(TypeError):
        simulation.add([[1.0, 1.0, 1.0]], [0, 0, 0], material=[1.0, 2.0])
    simulation.add_random(3, [0, 0, 0], material=dc.records.Material(1e-4, 1000.0))
    assert simulation.densities.tolist() == [1000.0] * 3


def test_an_array_that_a_law_keeps_is_an_error() -> None:
    simulation = drops()
    simulation.add_random(3, [0, 0, 0])
    kept = []
    simulation.set_law(lambda particles, fluid, result: kept.append(particles.velocities))
    with pytest.raises(dc.InvalidArgument, match="kept the array velocities"):
        simulation.step()
    kept.clear()
    simulation.set_law(lambda particles, fluid, result: kept.append(result.rates[1:]))
    with pytest.raises(dc.InvalidArgument, match="kept the array rates"):
        simulation.step()


def test_what_a_law_raises_comes_out_of_the_step() -> None:
    simulation = drops()
    simulation.add_random(3, [0, 0, 0])

    def law(particles: dc.records.LawParticles, fluid: dc.records.LawSamples, result: dc.records.LawResult) -> None:
        particles.velocities[0] = 1.0

    simulation.set_law(law)
    with pytest.raises(ValueError, match="read-only"):
        simulation.step()
    with pytest.raises(TypeError):
        simulation.set_law(3)


def test_random_motion_is_that_of_seed_particle_and_step() -> None:
    places = np.full((2000, 3), 1.5)
    hot = dc.records.Fluid(density=1.2, viscosity=1.8e-5, temperature=300.0)
    forces = dc.records.ForceOptions([dc.records.Force.STOKES, dc.records.Force.BROWNIAN], hot)
    box = dc.generate_box(cells=[3, 3, 3], size=[3.0, 3.0, 3.0])
    runs = []
    for seed in (1, 1, 2):
        thermal = dc.Simulation(dc.Environment(box), dc.SimulationOptions(dt=1e-3, forces=forces, seed=seed))
        thermal.add(places, [0, 0, 0], material=dc.records.Material(1e-6, 1000.0))
        diffusing = dc.Simulation(dc.Environment(box), dc.SimulationOptions(dt=0.1, diffusion=0.01, seed=seed))
        diffusing.add(places, [0, 0, 0])
        for _ in range(5):
            thermal.step(), diffusing.step()
        runs.append((thermal, diffusing))
    for k in (0, 1):
        assert np.array_equal(runs[0][k].positions, runs[1][k].positions)
        assert not np.array_equal(runs[0][k].positions, runs[2][k].positions)
    mass = 1000.0 * np.pi / 6 * 1e-18
    assert abs(np.var(runs[0][0].velocities) * mass / (1.380649e-23 * 300.0) - 1) < 4 * np.sqrt(2 / 6000)
    assert abs(np.var(runs[0][1].positions) / (2 * 0.01 * 0.5) - 1) < 4 * np.sqrt(2 / 6000)


def test_scenes_draw_sizes_and_eddies() -> None:
    scene = dc.load_scene({
        "environment": {"generator": "vessel"},
        "particles": [{"count": 3000, "diameter": {"law": "lognormal", "median": 5e-6, "deviation": 1.5, "max": 1e-5}},
                      {"inlet": "inlet", "mass_rate": 1e-6, "diameter": 5e-6, "density": 1000.0}],
        "motion": {"field": "velocity", "turbulence": {"k": "path_length", "omega": "path_length"}},
    })
    simulation = dc.Simulation(scene)
    for _ in range(3):
        simulation.step()
    sizes = simulation.diameters[:3000]
    assert sizes.max() <= 1e-5 and len(np.unique(sizes)) == 3000
    assert simulation.totals.injected == int(3e-3 * 1e-6 / (1000.0 * np.pi / 6 * 5e-6**3))
    assert simulation.options.user_data[-4:] == ["eddy_x", "eddy_y", "eddy_z", "eddy_left"]
    normal = dc.formats.SizeDistribution("normal", 1.0, 0.1)
    assert normal.law == dc.formats.SizeLaw.NORMAL and normal.min == 0.0
