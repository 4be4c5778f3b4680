"""The exceptions: each class raised once, with its bases and a text that says what to do."""
from __future__ import annotations

import dartcast
import numpy as np
import pytest


def test_bases() -> None:
    assert dartcast.Error.__bases__ == (Exception,)
    assert dartcast.InvalidArgument.__bases__ == (dartcast.Error, ValueError)
    for kind in (dartcast.InvalidMesh, dartcast.EditRefused, dartcast.records.InternalError, dartcast.InUse):
        assert kind.__bases__ == (dartcast.Error,), kind


def test_an_invalid_argument_is_a_value_error() -> None:
    with pytest.raises(ValueError, match="frames; give at most"):
        dartcast.formats.write_report("none", dartcast.formats.ReportOptions(frames=70_000))


def test_a_mesh_with_a_flat_cell_is_invalid() -> None:
    flat = dartcast.MeshData(np.zeros((4, 3)), {"tetra": np.array([[0, 1, 2, 3]])})
    with pytest.raises(dartcast.InvalidMesh, match="cells without volume"):
        dartcast.Environment(flat)


def test_a_file_that_is_not_there_is_an_error() -> None:
    with pytest.raises(dartcast.Error, match="none.toml"):
        dartcast.formats.read_scene("none.toml")


def test_an_edit_that_is_refused_leaves_the_environment() -> None:
    environment = dartcast.Environment(dartcast.generate_box())
    before = environment.edit_count

    def inside_out(edit: dartcast.topology.ComplexEdit) -> None:
        raise dartcast.EditRefused("by its function")

    with pytest.raises(dartcast.EditRefused, match="by its function"):
        environment.edit(inside_out)
    assert environment.edit_count == before and environment.validity().valid


def test_an_environment_in_use_says_so() -> None:
    environment = dartcast.Environment(dartcast.generate_box())

    def reads(edit: dartcast.topology.ComplexEdit) -> None:
        environment.validity()

    with pytest.raises(dartcast.InUse, match="in use"):
        environment.edit(reads)
