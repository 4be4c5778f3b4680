"""The types of the extension module. One section for each public header, in the order of src/bind.hpp.

Docstrings are those of the headers, at run time. `Points` is float64 (n, 3), C-contiguous.
"""
from __future__ import annotations

import enum
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from types import TracebackType
from typing import Any, ClassVar, Literal, Union, overload

import numpy
import numpy.typing

from ._ids import Cell, CellFace, CellHandle, Dart, Patch, SimplexId, Vertex

__version__: str

Points = numpy.typing.NDArray[numpy.float64]
Floats = numpy.typing.NDArray[numpy.float64]
Integers = numpy.typing.NDArray[numpy.integer[Any]]
Marks = Union[numpy.typing.NDArray[numpy.bool_], numpy.typing.NDArray[numpy.uint8]]
Records = numpy.typing.NDArray[numpy.void]
Vector = Union[Sequence[float], Floats]
Path = Union[str, os.PathLike[str]]

# --- environment.hpp

# --- end of environment.hpp

# --- errors.hpp

# --- end of errors.hpp

# --- ids.hpp

# --- end of ids.hpp

# --- mesh_data.hpp

# --- end of mesh_data.hpp

# --- mesh_check.hpp

# --- end of mesh_check.hpp

# --- mesh_files.hpp

# --- end of mesh_files.hpp

# --- mesh_selection.hpp

# --- end of mesh_selection.hpp

# --- decompose.hpp

# --- end of decompose.hpp

# --- generators.hpp

# --- end of generators.hpp

# --- predicates.hpp

# --- end of predicates.hpp

# --- cell_shape.hpp

# --- end of cell_shape.hpp

# --- combinatorial_map.hpp

# --- end of combinatorial_map.hpp

# --- map_edits.hpp

# --- end of map_edits.hpp

# --- cell_complex.hpp

# --- end of cell_complex.hpp

# --- complex_edit.hpp

# --- end of complex_edit.hpp

# --- cutting.hpp

# --- end of cutting.hpp

# --- remeshing.hpp

# --- end of remeshing.hpp

# --- validity.hpp

# --- end of validity.hpp

# --- threads.hpp

# --- end of threads.hpp

# --- particle_state.hpp

# --- end of particle_state.hpp

# --- contact.hpp

# --- end of contact.hpp

# --- step.hpp

# --- end of step.hpp

# --- response.hpp

# --- end of response.hpp

# --- environment.hpp

# --- end of environment.hpp

# --- audit.hpp

# --- end of audit.hpp

# --- spheres.hpp

# --- end of spheres.hpp

# --- dynamics.hpp

# --- end of dynamics.hpp

# --- trajectory.hpp

# --- end of trajectory.hpp

# --- deformation.hpp

# --- end of deformation.hpp

# --- vector_field.hpp

# --- end of vector_field.hpp

# --- surface.hpp

# --- end of surface.hpp

# --- bodies.hpp

# --- end of bodies.hpp

# --- catheter.hpp

# --- end of catheter.hpp

# --- simulation.hpp

# --- end of simulation.hpp

# --- events.hpp

# --- end of events.hpp

# --- scene.hpp

# --- end of scene.hpp

# --- run.hpp

# --- end of run.hpp

