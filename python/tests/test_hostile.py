"""Calls that once crashed or hung: each runs in a process of its own, with a limit of time."""
from __future__ import annotations

import pathlib
import subprocess
import sys
import textwrap

import pytest

CASES = {
    # Memory ends in the numbers of the user, when ids and velocities are there: they are undone, too.
    "more numbers of the user than memory": """
        import resource
        import dartcast as d
        options = d.SimulationOptions(user_data=[f"number {i}" for i in range(2000)])
        simulation = d.Simulation(d.Environment(d.generate_bar()), options)
        simulation.add_random(10, [0.0, 0.0, 0.0])
        hash = simulation.state_hash()
        resource.setrlimit(resource.RLIMIT_AS, (1 << 30, 1 << 30))
        try: simulation.add_random(200_000, [0.0, 0.0, 0.0])
        except MemoryError: pass
        else: raise AssertionError("not refused")
        assert len(simulation.particles) == len(simulation.ids) == len(simulation.velocities) == 10
        assert simulation.state_hash() == hash and simulation.totals.start == 10
        simulation.add_random(1, [0.0, 0.0, 0.0]); assert simulation.ids.tolist() == list(range(11))
        simulation.step(); assert simulation.audit().failed == 0
    """,
    # Memory ends in the middle of an addition: all of it is undone.
    "more particles than memory": """
        import resource
        import dartcast as d
        environment = d.Environment(d.generate_bar()); simulation = d.Simulation(environment)
        simulation.add_random(10, [0.0, 0.0, 0.0])
        hash = simulation.state_hash()
        resource.setrlimit(resource.RLIMIT_AS, (1 << 30, 1 << 30))
        for call in (lambda: simulation.add_random(2**31, [0.0, 0.0, 0.0]), lambda: d.Environment(d.generate_bar()).add_random(2**31)):
            try: call()
            except MemoryError: continue
            raise AssertionError("not refused")
        assert len(simulation.particles) == 10 and simulation.state_hash() == hash
        simulation.step(); assert simulation.audit().failed == 0
    """,
    # Lists by patch without names, and an empty one.
    "summaries of any content": """
        import dartcast as d
        d.formats.summary_json(d.formats.Summary()); d.formats.summary_text(d.formats.Summary()); d.formats.histogram_text(d.formats.Summary())
        wrong = d.formats.Summary(totals=d.records.SimulationTotals(contacts_by_patch=[0, 1, 2]))
        planes = d.formats.Summary(statistics=d.formats.StatisticsSummary(planes=[d.records.PlaneTotals()]))
        for call in (d.formats.summary_json, d.formats.summary_text):
            for summary in (wrong, planes):
                try: call(summary)
                except d.InvalidArgument: continue
                raise AssertionError("not refused")
    """,
    # An environment that a function of after_edit keeps is read after the simulation has ended.
    "an environment kept from after_edit": """
        import gc
        import dartcast as d
        environment = d.Environment(d.generate_bar()); simulation = d.Simulation(environment); kept = []
        simulation.set_after_edit(lambda e: kept.append((e, e.map, e.complex)))
        simulation.edit(lambda e: e.topology.set_free(int(e.map.cells()[0]), True))
        simulation.set_after_edit(None); del simulation, environment; gc.collect()
        e, map_, complex_ = kept[0]
        for call in (lambda: e.threads, lambda: e.edit_count, lambda: e.last_edit, lambda: e.map, lambda: e.complex,
                     lambda: e.positions, lambda: e.locate([1.0, 1.0, 1.0]), lambda: e.validity(),
                     lambda: map_.cell_count(), lambda: complex_.bytes()):
            try: call()
            except d.InUse: continue
            raise AssertionError("not refused")
    """,
    # Python makes such objects for pickles and copies, and a subclass has one until its __init__() calls that of its base.
    "objects whose constructor has not run": """
        import calls
        import dartcast as d
        without_members = ["Slide", "Stick", "Absorb", "Escape"]
        for name, cls in calls.classes().items():
            made = cls.__new__(cls)
            uses = [lambda m=m: getattr(made, m) for m in vars(cls) if isinstance(vars(cls)[m], property)]
            uses += [lambda m=m: getattr(made, m)() for m, f in vars(cls).items()
                     if callable(f) and m not in calls.BY_PYTHON and not isinstance(f, (type, staticmethod))]
            uses += [lambda m=m: getattr(made, m)(made) for m in ("__eq__", "__deepcopy__") if m in vars(cls)]
            if calls.is_record(cls): uses += [lambda: cls() == made]
            for use in uses:
                try: use()
                except TypeError: continue
                assert name in without_members, f"{name}: not refused"
        new = lambda cls: cls.__new__(cls)
        for use in (lambda: d.records.WallResponses(new(d.Slide)), lambda: d.Environment(new(d.MeshData)),
                    lambda: d.audit(new(d.topology.CellComplex), new(d.Particles))):
            try: use()
            except TypeError: continue
            raise AssertionError("not refused")
        class Early(d.Particles):
            def __init__(self): len(self)
        for use in (Early, d.Particles.__base__, type("Mine", (d.Particles.__base__,), {})):
            try: use()
            except TypeError: continue
            raise AssertionError("not refused")
    """,
    # Protocols 0 and 1 ask the class's base for its state.
    "pickles of every protocol": """
        import copyreg, pickle
        import calls
        import dartcast as d
        mesh = d.generate_bar(); environment = d.Environment(mesh)
        objects = [mesh, environment, environment.map, environment.complex, environment.add_random(3), d.SphereStepper(),
                   d.Simulation(environment)] + [cls() for cls in calls.classes().values() if calls.is_record(cls)]
        objects += [cls.__new__(cls) for cls in calls.classes().values()]
        refused = 0
        for one in objects:
            for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
                try: again = pickle.loads(pickle.dumps(one, protocol))
                except TypeError: refused += 1; continue
                assert type(again) is type(one)
                same = lambda x: len(x) if isinstance(x, d.Particles) else len(x.points)
                if isinstance(one, (d.Particles, d.MeshData)): assert same(again) == same(one)
                else: assert again == one or pickle.dumps(again) == pickle.dumps(one)
            for reduce in (lambda: one.__reduce__(), lambda: one.__reduce_ex__(1), lambda: copyreg._reduce_ex(one, 0)):
                try: reduce()
                except TypeError: pass
        assert 500 < refused < 2000, refused
    """,
    # The former deformation's thread waits for Python's lock while the call waits for the thread.
    "a deformation with a reader is replaced": """
        import time
        import dartcast as d, numpy as np
        environment = d.Environment(d.generate_bar()); rest = np.array(environment.positions)
        def reader(k): time.sleep(0.02); return rest + 1e-3 * k
        def make(): return d.Deformation([d.DeformationStep(kind="frames", times=np.arange(30.0), reader=reader)], rest)
        simulation = d.Simulation(environment, d.SimulationOptions(dt=0.5))
        for _ in range(3): simulation.set_deformation(make()); simulation.step()
        del simulation
    """,
}


@pytest.mark.parametrize("name", CASES)
def test_it_ends_well(name: str) -> None:
    done = subprocess.run([sys.executable, "-c", textwrap.dedent(CASES[name])], capture_output=True, text=True,
                          check=False, timeout=60, cwd=pathlib.Path(__file__).parent)
    assert done.returncode == 0, done.stderr
