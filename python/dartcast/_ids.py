"""Numbers of things. At run time cells, vertices and patches are plain integers; None stands for one that is not there."""
from typing import NamedTuple, NewType

Vertex = NewType("Vertex", int)
Cell = NewType("Cell", int)
Patch = NewType("Patch", int)

#: Stands for an invalid number in arrays.
NONE = 0xFFFFFFFF


class Dart(NamedTuple):
    """A dart: an oriented edge of a face of a cell, by its number in the cell's shape."""

    cell: Cell
    number: int


class CellFace(NamedTuple):
    """A face of a cell, by its number in the cell's shape. Two cells that share a face each have one of these."""

    cell: Cell
    face: int


class SimplexId(NamedTuple):
    """Names an implicit simplex: a cell and the number of one of its shape's simplices."""

    cell: Cell
    simplex: int


class CellHandle(NamedTuple):
    """A cell at this moment. An edit that replaces the cell makes the handle stale."""

    cell: Cell
    version: int
