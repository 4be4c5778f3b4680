"""Steps of particles: contacts, answers by functions and by the library, threads, exceptions."""
from __future__ import annotations

import threading

import dartcast
import numpy as np
import pytest

UP = np.array([0.0, 0.0, 1.0])


def scene(count=50, threads=1, n=3):
    env = dartcast.Environment(dartcast.generate_box(cells=[n, n, n], size=[1.0, 1.0, 1.0]), threads=threads)
    return env, env.add_random(count, seed=5)


def push(parts, scale=1.0):
    v = np.random.default_rng(2).normal(0, 1, (len(parts), 3)) * scale
    return v, parts.positions + v


def mirrored(d, n, restitution=1.0):
    return d - (1 + restitution) * np.minimum(0, np.sum(d * n, axis=1, keepdims=True)) * n


def test_a_particle_reaches_its_target():
    env, parts = scene()
    x = parts.positions
    report = env.advance(parts, 0.5 * x + 0.25)
    assert np.array_equal(parts.positions, 0.5 * x + 0.25)
    assert len(report.contacts) == len(report.walls) == len(report.held) == len(report.stopped) == 0
    assert report.counters.particle_steps == 50 and list(report.counters.contacts) == [0, 0, 0]


def test_without_an_answer_a_particle_stops_at_the_wall():
    env, _ = scene()
    parts, _ = env.add(np.array([[0.2, 0.3, 0.5], [0.5, 0.5, 0.9]]))
    report = env.advance(parts, np.array([[0.2, 0.3, 0.6], [0.5, 0.5, 1.3]]))
    c = report.contacts
    assert c["particle"].tolist() == [1] and np.isclose(c["time_of_impact"][0], 0.25)
    assert np.allclose(c["point"][0], [0.5, 0.5, 1.0]) and np.allclose(c["normal"][0], -UP)
    assert np.allclose(c["unused"][0], [0, 0, 0.3]) and np.array_equal(c["wall_displacement"][0], [0, 0, 0])
    assert np.allclose(c["displacement"][0], [0, 0, 0.4])
    assert env.map.patch_names[c["patch"][0]] == "zmax" and c["kind"][0] == dartcast.Kind.FACE
    assert report.stopped["particle"].tolist() == [1] and np.allclose(report.stopped["unused"], [[0, 0, 0.3]])
    wall = report.walls[c["first_wall"][0]]
    assert wall["patch"] == c["patch"][0] and wall["cell"] == c["cell"][0]
    assert report.walls_of(0)[0].face == (wall["cell"], wall["face"]) and report.earlier_walls_of(0) == []
    assert parts.touching_counts.tolist() == [0, 1] and parts[1].touching[0] == (wall["cell"], wall["face"])
    assert not np.shares_memory(report.contacts, report.contacts)
    with pytest.raises(IndexError):
        report.walls_of(1)


def test_contacts_in_rounds_are_those_one_by_one():
    results = []
    for per_contact in (False, True):
        env, parts = scene(threads=2)

        def rounds(contacts, walls):
            return mirrored(contacts["unused"], contacts["normal"])

        def single(contact, walls, earlier):
            assert all(isinstance(w, dartcast.records.WallHit) for w in walls + earlier)
            d, n = contact.unused, walls[0].normal
            return mirrored(d[None], n[None])[0]

        _, targets = push(parts)
        report = env.advance(parts, targets, single if per_contact else rounds, per_contact=per_contact)
        assert len(report.contacts) > 50 and dartcast.audit(env.complex, parts).failed == 0
        results.append((parts.states.tobytes(), report.contacts.tobytes(), report.walls.tobytes()))
    assert results[0] == results[1]


def test_a_round_has_one_contact_of_each_particle():
    env, parts = scene()
    rounds = []

    def respond(contacts, walls):
        assert len(np.unique(contacts["particle"])) == len(contacts)
        assert len(walls) >= len(contacts) and np.allclose(walls["normal"][contacts["first_wall"]], contacts["normal"])
        rounds.append(contacts)
        return mirrored(contacts["unused"], contacts["normal"])

    report = env.advance(parts, push(parts)[1], respond, options=dartcast.records.StepOptions(max_contacts=4))
    # The contact after the last one allowed is reported, but not asked about.
    asked = sum(map(len, rounds))
    assert 1 < len(rounds) <= 4 and asked + report.counters.unfinished == len(report.contacts)


def test_none_and_zeros_let_particles_stay_at_the_wall():
    states = []
    for answer in (lambda c, w: None, lambda c, w: np.zeros((len(c), 3))):
        env, parts = scene()
        report = env.advance(parts, push(parts)[1], answer)
        assert len(report.stopped) == 0 and len(report.contacts) > 10
        x = parts.positions[report.contacts["particle"]]
        assert np.allclose(x, report.contacts["point"])
        states.append(parts.states.tobytes())
    assert states[0] == states[1]


def test_a_motion_along_the_wall_is_not_turned_into_it():
    for answer in (lambda c, w: (c["unused"] * [1, 1, 0], np.ones(len(c), dtype=bool)),
                   lambda c, w, e: dartcast.records.AfterContact([*c.unused[:2], 0.0], True)):
        env, _ = scene()
        parts, _ = env.add(np.array([[0.2, 0.2, 0.9]]))
        single = answer.__code__.co_argcount == 3
        report = env.advance(parts, np.array([[0.6, 0.7, 1.3]]), answer, per_contact=single)
        assert len(report.contacts) >= 1 and np.allclose(parts.positions, [[0.6, 0.7, 1.0]])


def test_answers_in_any_array_are_taken():
    env, parts = scene()
    env.advance(parts, push(parts, 0.3)[1], lambda c, w: np.asfortranarray(0.0 * c["unused"]))
    env.advance(parts, push(parts, 0.3)[1], lambda c, w: np.zeros((len(c), 3), dtype=np.float32).tolist())


@pytest.mark.parametrize("answer, error", [
    (lambda c, w: np.zeros((len(c) + 1, 3)), TypeError),
    (lambda c, w: np.zeros((len(c), 2)), TypeError),
    (lambda c, w: np.zeros((len(c), 3), dtype=np.complex64), TypeError),
    (lambda c, w: "far", TypeError),
    (lambda c, w: (np.zeros((len(c), 3)), np.zeros(len(c))), TypeError),
    (lambda c, w: (np.zeros((len(c), 3)), np.zeros(len(c) + 1, dtype=bool)), TypeError),
    (lambda c, w: np.full((len(c), 3), np.nan), dartcast.InvalidArgument),
    (lambda c: None, TypeError),
    (lambda c, w: 1 / 0, ZeroDivisionError),
])
def test_what_a_function_raises_comes_out_and_nothing_has_changed(answer, error):
    env, parts = scene(threads=2)
    before = parts.states.tobytes()
    with pytest.raises(error):
        env.advance(parts, push(parts)[1], answer)
    assert parts.states.tobytes() == before
    env.advance(parts, parts.positions)


def test_what_a_function_of_single_contacts_raises_comes_out():
    class Mine(Exception):
        pass

    def fails(contact, walls, earlier):
        raise Mine("here")

    env, parts = scene(500, threads=2)
    before = parts.states.tobytes()
    for answer, error in ((fails, Mine), (lambda c, w, e: "far", TypeError), (lambda c, w, e: [np.inf, 0, 0], ValueError)):
        with pytest.raises(error):
            env.advance(parts, push(parts)[1], answer, per_contact=True)
        assert parts.states.tobytes() == before


def test_a_response_cannot_enter_the_environment():
    env, parts = scene()
    caught = []

    def respond(contacts, walls):
        for call in (lambda: env.advance(parts, parts.positions), lambda: env.positions, lambda: len(parts)):
            with pytest.raises(dartcast.InUse):
                call()
            caught.append(1)

    env.advance(parts, push(parts)[1], respond)
    assert len(caught) >= 3


def test_targets_changed_by_a_response_have_no_effect():
    results = []
    for hostile in (False, True):
        env, parts = scene()
        targets = push(parts)[1]

        def respond(contacts, walls):
            if hostile:
                targets[:] = np.nan
            return mirrored(contacts["unused"], contacts["normal"])

        env.advance(parts, targets, respond)
        results.append(parts.states.tobytes())
    assert results[0] == results[1]


def test_contacts_given_to_a_response_outlive_it():
    env, parts = scene()
    kept = []
    report = env.advance(parts, push(parts)[1], lambda c, w: kept.append((c, w)))
    assert np.array_equal(kept[0][0]["point"], report.contacts["point"][report.contacts["earlier"] == 0])


def test_a_second_thread_gets_in_use():
    env, parts = scene(threads=1)
    others = env.add_random(10)
    inside, leave = threading.Event(), threading.Event()
    errors = []

    def respond(contacts, walls):
        inside.set()
        assert leave.wait(20)

    def other():
        assert inside.wait(20)
        try:
            env.advance(others, others.positions)
        except dartcast.InUse as e:
            errors.append(str(e))
        leave.set()

    thread = threading.Thread(target=other)
    thread.start()
    env.advance(parts, push(parts)[1], respond)
    thread.join()
    assert len(errors) == 1 and "the environment is in use" in errors[0]
    env.advance(others, others.positions)


def test_threads_that_share_an_environment_never_break_it():
    env, _ = scene()
    sets = [env.add_random(300, seed=s) for s in (1, 2)]
    refused = [0, 0]

    def run(i):
        for _ in range(100):
            try:
                env.advance(sets[i], push(sets[i], 0.1)[1])
            except dartcast.InUse:
                refused[i] += 1

    threads = [threading.Thread(target=run, args=(i,)) for i in (0, 1)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    assert all(dartcast.audit(env.complex, s).failed == 0 for s in sets) and sum(refused) < 200


@pytest.mark.parametrize("targets, error", [
    (np.zeros((50, 3), dtype=np.complex64), TypeError),
    (np.zeros((50, 2)), TypeError),
    (np.zeros(150), TypeError),
    (np.zeros((3, 50)), TypeError),
    (None, TypeError),
    (np.zeros((49, 3)), dartcast.InvalidArgument),
    (np.full((50, 3), np.nan), dartcast.InvalidArgument),
    (np.full((50, 3), 1e300), dartcast.InvalidArgument),
])
def test_targets_that_do_not_fit_are_refused(targets, error):
    env, parts = scene()
    before = parts.states.tobytes()
    with pytest.raises(error, match="targets|expected|particles|range|finite"):
        env.advance(parts, targets)
    assert parts.states.tobytes() == before


def test_the_message_says_what_was_expected_what_came_and_what_to_do():
    env, parts = scene()
    with pytest.raises(TypeError) as e:
        env.advance(parts, np.zeros((3, 50), dtype=np.float32))
    text = str(e.value)
    assert "targets: expected float64 (n, 3), C-contiguous; got float32 (3, 50). Convert it by x.T" in text


def test_options_out_of_range_are_refused():
    env, parts = scene()
    for bad in (dict(max_contacts=0), dict(tolerance=0.0), dict(tolerance=np.nan), dict(max_slices=0)):
        options = dartcast.records.StepOptions(**bad)
        for call in (lambda: env.advance(parts, parts.positions, options=options), options.check,
                     lambda: env.check_advance(parts, options, "mine")):
            with pytest.raises(dartcast.InvalidArgument):
                call()
    env.check_advance(parts)


def test_a_trace_is_the_way_of_the_step():
    env, parts = scene()
    targets = push(parts)[1]
    traces = env.trace(parts, 7, targets[7:8])
    before = parts.states
    env.advance(parts, targets)
    t = traces[0]
    assert np.array_equal(t.before.position, before["position"][7]) and t.after == parts[7]
    cells = [t.before.cell] + [c.to for c in t.crossings]
    assert [c.from_ for c in t.crossings] == cells[:-1] and t.result.stopped == (len(t.contacts) > 0)
    assert t.start.kind in list(dartcast.Kind) and t.end.kind in list(dartcast.Kind)
    with pytest.raises(dartcast.InvalidArgument):
        env.trace(parts, 50, targets)
    with pytest.raises(dartcast.InvalidArgument, match="per_contact"):
        env.trace(parts, 0, targets, lambda c, w: None)
