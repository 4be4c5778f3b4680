"""Audits and hashes of states."""
from __future__ import annotations

import copy

import dartcast
import numpy as np
import pytest


def scene():
    env = dartcast.Environment(dartcast.generate_box(cells=[2, 2, 2], size=[1.0, 1.0, 1.0]), threads=1)
    return env, env.add_random(100)


def test_an_audit_finds_particles_that_are_not_where_they_say():
    env, parts = scene()
    good = dartcast.audit(env.complex, parts)
    assert (good.checked, good.failed, good.first) == (100, 0, "")
    other = dartcast.Environment(dartcast.generate_box(cells=[1, 1, 1], origin=[5.0, 0, 0]))
    bad = dartcast.audit(other.complex, parts, threads=1)
    assert bad.failed == 100 and bad.first
    good += bad
    assert good.checked == 200 and good.failed == 100 and good.first == bad.first
    with pytest.raises(dartcast.Error):
        dartcast.audit(env.complex, parts, threads=10**6)


def test_equal_sets_have_equal_hashes_in_any_order():
    env, parts = scene()
    v = np.zeros((100, 3))
    a, b = dartcast.records.StateHash(), dartcast.records.StateHash()
    a.add(np.arange(100), parts, v)
    order = np.random.default_rng(1).permutation(100)
    for i in order:
        b.add(int(i), parts[int(i)], v[i])
    assert a == b and a.hex() == b.hex() and len(a.hex()) == 32 and a != dartcast.records.StateHash()
    assert dartcast.records.StateHash(a.words) == a and copy.copy(a) == a and a.hex() in repr(a)
    total = dartcast.records.StateHash()
    total += a
    assert total == a
    b.add(7, parts[7], v[7], fate=1)
    assert a != b and (a == 5) is False
    v[3, 1] = -0.0
    c = dartcast.records.StateHash()
    c.add(np.arange(100), parts, v)
    assert c != a
    with pytest.raises(dartcast.InvalidArgument):
        a.add(np.arange(99), parts, v)
