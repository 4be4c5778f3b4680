"""Trajectories: points, tables, drawings."""
from __future__ import annotations

import csv
import io

import dartcast
import numpy as np
import pytest


def scene():
    env = dartcast.Environment(dartcast.generate_rectangle(cells=[4, 4], size=[1.0, 1.0]), threads=1)
    parts, _ = env.add(np.array([[0.1, 0.15, 0.0]]))
    targets = np.array([[0.8, 0.85, 0.0], [1.4, 0.85, 0.0]])
    return env, parts, env.trace(parts, 0, targets)


def test_the_points_of_a_way_are_in_the_order_of_time():
    env, parts, traces = scene()
    points = dartcast.formats.trajectory_points(traces)
    marks = [p.mark for p in points]
    assert marks[0] == dartcast.formats.TrajectoryMark.START and marks[-1] == dartcast.formats.TrajectoryMark.END
    assert marks.count(dartcast.formats.TrajectoryMark.CROSSING) == sum(len(t.crossings) for t in traces) > 4
    assert marks.count(dartcast.formats.TrajectoryMark.CONTACT) == 1
    assert all((a.step, a.time) <= (b.step, b.time) for a, b in zip(points, points[1:]))
    assert np.allclose(points[-1].point, [1.0, 0.85, 0.0])


def test_a_table_has_a_row_for_each_point():
    env, parts, traces = scene()
    rows = list(csv.DictReader(io.StringIO(dartcast.formats.trajectory_csv(env.map, traces))))
    points = dartcast.formats.trajectory_points(traces)
    assert len(rows) == len(points) and rows[0]["event"] == "start"
    assert [float(r["x"]) for r in rows] == [p.point[0] for p in points]


def test_a_drawing_is_svg():
    env, parts, traces = scene()
    assert dartcast.formats.trajectory_svg(env.complex, traces).startswith("<svg")
    with pytest.raises(dartcast.InvalidArgument):
        dartcast.formats.trajectory_svg(env.complex, [])
    other = dartcast.Environment(dartcast.generate_rectangle(cells=[1, 1]))
    with pytest.raises(dartcast.InvalidArgument, match="another map"):
        dartcast.formats.trajectory_svg(other.complex, traces)
    with pytest.raises(dartcast.InvalidArgument, match="another map"):
        dartcast.formats.trajectory_csv(other.map, traces)
