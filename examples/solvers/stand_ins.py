"""Stand-ins for three solvers: each has the few calls of it that the loops beside this file make.

They compute nothing. Their points follow a formula, so that a loop has something to follow where the solver is missing.
"""
from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

import dartcast as dc


class Node:
    """As Sofa.Core.Node: its objects are attributes by their names."""

    def __init__(self, name: str) -> None:
        self.name, self.time = name, 0.0

    def addChild(self, name: str) -> Node:  # noqa: N802: SOFA's name
        setattr(self, name, Node(name))
        return getattr(self, name)  # type: ignore[no-any-return]

    def addObject(self, kind: str, name: str = "", position: Any = None, **_: Any) -> None:  # noqa: N802
        if position is not None:
            self.rest = np.array(position, dtype=float)
            setattr(self, name, SimpleNamespace(position=SimpleNamespace(array=self.positions)))

    def positions(self) -> Any:
        """The block sways, and its foot stays."""
        return self.rest + 0.2 * np.sin(8.0 * self.time) * np.outer(self.rest[:, 2] ** 2, [1.0, 0.0, 0.0])


def animate(root: Node, dt: float) -> None:
    """One time step of all that is below the root."""
    for node in (n for n in vars(root).values() if isinstance(n, Node)):
        node.time += dt


Sofa = SimpleNamespace(Core=SimpleNamespace(Node=Node), Simulation=SimpleNamespace(init=lambda root: None, animate=animate))


class BlenderObject:
    """As an object of bpy with a mesh of 40 x 40 squares that waves, and is evaluated at the frame of the scene."""

    def __init__(self) -> None:
        mesh = dc.generate_rectangle(cells=[40, 40], size=[4.0, 4.0], type="quadrilateral")
        self.rest, self.vertices, self.frame = mesh.points, self, 1
        self.polygons = [SimpleNamespace(vertices=corners) for corners in mesh.cells["quad"]]
        self.evaluated_get = lambda depsgraph: self
        self.to_mesh = lambda: self
        self.to_mesh_clear = lambda: None

    def __len__(self) -> int:
        return len(self.rest)

    def foreach_get(self, name: str, values: Any) -> None:
        x = self.rest.copy()
        x[:, 2] = 0.3 * np.sin(2.0 * x[:, 0] + 0.1 * self.frame)
        values[:] = x.ravel()

    def frame_set(self, frame: int) -> None:
        self.frame = frame


skin = BlenderObject()
bpy = SimpleNamespace(data=SimpleNamespace(objects={"Skin": skin}), context=SimpleNamespace(
    scene=skin, evaluated_depsgraph_get=lambda: None))


class Space:
    """As a space of functions of dolfinx: vectors at the points of a box of tetrahedra."""

    def __init__(self, domain: Any, element: Any) -> None:
        self.tabulate_dof_coordinates = lambda: domain.points
        self.dofmap = SimpleNamespace(list=domain.cells["tetra"])


class Function:
    """As a function of dolfinx: its values stand in one array."""

    def __init__(self, space: Space) -> None:
        self.points = space.tabulate_dof_coordinates()
        self.x = SimpleNamespace(array=np.zeros(self.points.size))

    def interpolate(self, formula: Any) -> None:
        self.x.array[:] = formula(self.points.T).T.ravel()


def create_box(communicator: Any, corners: Any, cells: list[int]) -> dc.MeshData:
    """A mesh of tetrahedra."""
    return dc.generate_box(cells=cells, size=corners[1], type="tetrahedron")


MPI = SimpleNamespace(COMM_WORLD=None)
mesh = SimpleNamespace(create_box=create_box)
fem = SimpleNamespace(functionspace=Space, Function=Function)
