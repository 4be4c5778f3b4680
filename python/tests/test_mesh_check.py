"""Reports on meshes, and their repairs."""
from __future__ import annotations

import dartcast
import numpy as np
import pytest


def test_a_good_mesh_is_accepted():
    report = dartcast.check_and_repair(dartcast.generate_box(cells=[2, 3, 4], size=[1.0, 1.0, 1.0]))
    assert report.valid and report.verdict is dartcast.formats.Verdict.ACCEPT
    assert report.cells == {"hexahedron": 24} and report.points == 3 * 4 * 5 and report.parts == 1


def test_an_inverted_cell_is_turned_and_reported():
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    mesh = dartcast.MeshData(points, {"tetra": [[0, 2, 1, 3]]})
    report = dartcast.check_and_repair(mesh)
    assert report.verdict is dartcast.formats.Verdict.REPAIR
    assert [(f.kind, f.count, f.first.tolist()) for f in report.repairs] == [("orientation", 1, [0])]
    corners = points[mesh.cells["tetra"][0]]
    assert np.linalg.det(corners[1:] - corners[0]) > 0


def test_points_without_cells_are_dropped():
    points = np.array([[9, 9, 9], [0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    mesh = dartcast.MeshData(points, {"tetra": [[1, 2, 3, 4]]}, point_data={"t": np.arange(5.0)})
    assert [f.kind for f in dartcast.check_and_repair(mesh).repairs] == ["unused_points"]
    assert np.array_equal(mesh.points, points[1:]) and np.array_equal(mesh.point_data["t"], [1, 2, 3, 4])


def test_defects_name_their_cells():
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], dtype=float)
    report = dartcast.check_and_repair(dartcast.MeshData(points, {"tetra": [[0, 1, 2, 3]]}))
    assert not report.valid and report.verdict is dartcast.formats.Verdict.REFUSE
    assert report.defects[0].kind == "flat" and report.defects[0].first.tolist() == [0]


def test_verdicts_have_names():
    assert [dartcast.formats.verdict_name(v) for v in dartcast.formats.Verdict] == ["accept", "repair", "warn", "refuse"]


def test_a_finding_counts_and_keeps_the_first_places():
    finding = dartcast.formats.Finding(kind="flat")
    for place in range(12):
        finding.add(place)
    assert finding.count == 12 and finding.first.tolist() == list(range(10))


def test_another_object_is_refused():
    with pytest.raises(TypeError):
        dartcast.check_and_repair(np.zeros((3, 3)))
