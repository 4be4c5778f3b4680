"""dartcast: exact continuous collision detection of particles and solids in deformable environments.

Arrays of points are float64 of shape (n, 3), C-contiguous; they are taken without a copy, and others are refused.
Results are fresh arrays. Arrays that are attributes are read-only copies.
"""
from ._core import *
from ._core import __version__ as __version__
from ._meshio import from_meshio as from_meshio
from ._meshio import to_meshio as to_meshio
from ._ids import NONE as NONE
from ._ids import Cell as Cell
from ._ids import CellFace as CellFace
from ._ids import CellHandle as CellHandle
from ._ids import Dart as Dart
from ._ids import Patch as Patch
from ._ids import SimplexId as SimplexId
from ._ids import Vertex as Vertex
from ._ranks import Ranks as Ranks
from ._ranks import mpi_ranks as mpi_ranks
from ._run import load_scene as load_scene
from ._run import run as run
from ._run import scene_text as scene_text
