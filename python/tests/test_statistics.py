"""Statistics with answers known by hand: residence times, planes, hits written to a file, pathlines."""
from __future__ import annotations

import pathlib
import re
import struct

import dartcast
import numpy as np
import pytest


def channel(**responses: object) -> dartcast.Simulation:
    """A box from 0 to 4 along x; its walls are patches xmin, xmax, ... One step takes 0.25 s."""
    environment = dartcast.Environment(dartcast.generate_box(cells=[4, 1, 1], size=[4.0, 1.0, 1.0]))
    return dartcast.Simulation(environment, dartcast.SimulationOptions(dt=0.25, patch_responses=responses))


def patch_number(simulation: dartcast.Simulation, name: str) -> int:
    found = simulation.environment.map.patch(name)
    assert found is not None
    return int(found)


def test_residence_times_are_those_to_the_wall() -> None:
    """Velocity 1 from x = 0.5, 1.5 and 3.25: the wall x = 4 is reached after 3.5, 2.5 and 0.75 s."""
    simulation = channel(xmax=dartcast.Escape(), xmin=dartcast.Absorb())
    simulation.set_statistics(dartcast.StatisticsOptions(residence=True))
    simulation.add(np.array([[0.5, 0.5, 0.5], [1.5, 0.25, 0.5], [3.25, 0.5, 0.25]]), [1.0, 0.0, 0.0])
    simulation.add(np.array([[1.5, 0.5, 0.5]]), [-2.0, 0.0, 0.0])  # absorbed after 0.75 s
    while len(simulation.particles):
        simulation.step()
    left = simulation.statistics.left
    escaped, absorbed = left[patch_number(simulation, "xmax")].escaped, left[patch_number(simulation, "xmin")].absorbed
    assert escaped.count == 3 and escaped.sum == pytest.approx(6.75) and escaped.mean() == pytest.approx(2.25)
    assert escaped.least == pytest.approx(0.75) and escaped.most == pytest.approx(3.5)
    assert sum(escaped.bins) == 3 and len(escaped.bins) == dartcast.records.ResidenceTimes.BIN_COUNT
    for seconds in (0.75, 2.5, 3.5):
        assert escaped.bins[int(seconds / escaped.bin)] >= 1
    assert absorbed.count == 1 and absorbed.sum == pytest.approx(0.75)
    assert simulation.totals.escaped == 3 and simulation.totals.absorbed == 1


def test_passages_have_times_and_ages() -> None:
    simulation = channel(xmax=dartcast.Escape())
    plane = dartcast.records.SectionPlane("half", [2.0, 0.0, 0.0], [1.0, 0.0, 0.0])
    disc = dartcast.records.SectionPlane("disc", [2.0, 0.0, 0.0], [-3.0, 0.0, 0.0], 0.5)
    simulation.set_statistics(dartcast.StatisticsOptions(planes=[plane, disc]))
    for _ in range(2):
        simulation.step()  # particles of a later start have later times, not greater ages
    simulation.add(np.array([[1.25, 0.25, 0.25], [0.125, 0.75, 0.75]]), [1.0, 0.0, 0.0])
    found = []
    for _ in range(16):
        simulation.step()
        found.append(simulation.statistics.passages.copy())
    rows = np.concatenate(found)
    assert rows["plane"].tolist() == [0, 1, 0] and rows["id"].tolist() == [0, 0, 1]
    assert rows["forward"].tolist() == [True, False, True]  # the disc points to -x; particle 1 passes beside it
    assert np.allclose(rows["time"], [1.25, 1.25, 2.375]) and np.allclose(rows["age"], [0.75, 0.75, 1.875])
    totals = simulation.statistics.planes
    assert [t.forward.count for t in totals] == [2, 0] and [t.backward.count for t in totals] == [0, 1]
    assert totals[0].forward.sum == pytest.approx(2.625)


TYPES = {"Int64": "<i8", "UInt64": "<u8", "Int32": "<i4", "UInt32": "<u4", "Float64": "<f8", "UInt8": "<u1"}


def arrays_of(file: pathlib.Path) -> dict[str, np.ndarray]:
    """The arrays of a .vtp with raw appended data: each has its number of bytes, then its values."""
    data = file.read_bytes()
    header, raw = data.split(b'<AppendedData encoding="raw">', 1)
    raw = raw[raw.index(b"_") + 1:]
    found = {}
    for text in re.findall(rb"<DataArray [^>]*>", header):
        named = dict(re.findall(r'(\w+)="([^"]*)"', text.decode()))
        start = int(named["offset"])
        size, = struct.unpack_from("<Q", raw, start)
        found[named["Name"]] = np.frombuffer(raw[start + 8:start + 8 + size], TYPES[named["type"]])
    return found


def test_written_hits_are_those_counted(tmp_path: pathlib.Path) -> None:
    simulation = channel(xmax=dartcast.Reflect(), xmin=dartcast.Reflect())
    simulation.set_statistics(dartcast.StatisticsOptions(hits=True))
    simulation.add(np.array([[3.0, 0.5, 0.5]]), [2.0, 0.0, 0.0])  # meets x = 4 and x = 0 every 4 m: 8 contacts in 32 m
    for _ in range(64):
        simulation.step()
    hits, xmin, xmax = simulation.statistics.hits, patch_number(simulation, "xmin"), patch_number(simulation, "xmax")
    by_patch = hits.by_patch(simulation.environment)
    assert by_patch[xmax] == by_patch[xmin] == 4 and by_patch.sum() == 8
    file = tmp_path / "hits.vtp"
    dartcast.formats.write_wall_hits(simulation.environment, hits, file)
    written = arrays_of(file)
    assert len(written["hits"]) == 18 and written["hits"].sum() == 8  # 2 ends, 4 sides of 4 cells
    assert {patch: written["hits"][written["patch"] == patch].sum() for patch in (xmin, xmax)} == {xmin: 4, xmax: 4}
    assert np.array_equal(written["hits_per_area"], written["hits"].astype(float))  # each face has 1 m^2
    assert sorted(written["cell"][written["hits"] > 0].tolist()) == [0, 3]
    with pytest.raises(dartcast.InvalidArgument, match=r"\.vtp"):
        dartcast.formats.write_wall_hits(simulation.environment, hits, tmp_path / "hits.vtu")
    with pytest.raises(dartcast.Error):
        dartcast.formats.write_wall_hits(simulation.environment, hits, tmp_path / "none" / "hits.vtp")


def test_hits_follow_an_edit_and_are_restored() -> None:
    simulation = channel(xmax=dartcast.Reflect(), xmin=dartcast.Reflect())
    simulation.set_statistics(dartcast.StatisticsOptions(hits=True))
    simulation.add(np.array([[3.0, 0.5, 0.5]]), [2.0, 0.0, 0.0])
    for _ in range(16):
        simulation.step()
    cell = int(simulation.statistics.hits.faces()["cell"][-1])
    before = simulation.statistics.hits.by_patch(simulation.environment)
    simulation.edit(lambda edit: dartcast.topology.subdivide(edit, cell))
    hits = simulation.statistics.hits
    assert np.array_equal(hits.by_patch(simulation.environment), before)
    assert hits.ended_by_patch().sum() + hits.faces()["hits"].sum() == before.sum() == 2
    copy = dartcast.WallHits()
    copy.restore(simulation.environment, hits.faces(), hits.ended_by_patch())
    assert np.array_equal(copy.faces(), hits.faces()) and copy.of((cell, 0)) == 0


def test_pathlines_have_contacts_and_are_written(tmp_path: pathlib.Path) -> None:
    simulation = channel(xmax=dartcast.Reflect())
    simulation.set_statistics(dartcast.StatisticsOptions(pathlines_of=[1]))
    simulation.add(np.array([[1.0, 0.5, 0.5], [3.75, 0.5, 0.5]]), [2.0, 0.0, 0.0])
    points = []
    for _ in range(2):
        simulation.step()
        points.append(simulation.statistics.path_points.copy())
    rows = np.concatenate(points)
    assert set(rows["id"].tolist()) == {1}
    assert np.allclose(rows["position"][:, 0], [3.75, 4.0, 3.75, 3.25]) and rows["contact"].tolist() == [0, 1, 0, 0]
    assert np.allclose(rows["time"], [0.0, 0.125, 0.25, 0.5])
    dartcast.formats.write_pathlines(rows, tmp_path / "way.vtp")
    written = arrays_of(tmp_path / "way.vtp")
    assert np.array_equal(written["Points"].reshape(-1, 3), rows["position"])
    assert np.array_equal(written["contact"], rows["contact"]) and np.array_equal(written["time"], rows["time"])


def test_options_out_of_range_are_refused() -> None:
    simulation = channel()
    plane = dartcast.records.SectionPlane("half", [2.0, 0.0, 0.0], [1.0, 0.0, 0.0])
    for planes in ([plane, plane], [dartcast.records.SectionPlane("a b", [0.0, 0.0, 0.0], [1.0, 0.0, 0.0])],
                   [dartcast.records.SectionPlane("p", [0.0, 0.0, 0.0], [0.0, 0.0, 0.0])],
                   [dartcast.records.SectionPlane("p", [np.nan, 0.0, 0.0], [1.0, 0.0, 0.0])],
                   [dartcast.records.SectionPlane("p", [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], -1.0)]):
        with pytest.raises(dartcast.InvalidArgument):
            simulation.set_statistics(dartcast.StatisticsOptions(planes=planes))
    assert not simulation.statistics_options.any()
    with pytest.raises(dartcast.InvalidArgument):
        dartcast.records.find_crossings([plane], np.zeros((3, 3)), np.zeros((2, 3)))
