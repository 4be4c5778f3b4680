"""Meshes from and to the package meshio. It is needed for to_meshio() only."""
from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy

from ._core import MeshData
from ._mesh import ORDER

#: Cell data of meshio that gives regions and patches, in the order in which they are looked for.
TAGS = ("region", "gmsh:physical", "medit:ref", "cell_tags")
DIMENSIONS = {"tetra": 3, "hexahedron": 3, "wedge": 3, "pyramid": 3, "triangle": 2, "quad": 2, "polygon": 2, "line": 1}


def _dimension(name: str) -> int | None:
    """The dimension of a block's cells; None: they are left out (vertices, cells of higher order)."""
    if name.startswith("polyhedron"):
        return 3
    return DIMENSIONS.get("polygon" if name.startswith("polygon") else name)


def _tags(mesh: Any) -> list[Any] | None:
    for name in TAGS:
        if name in mesh.cell_data:
            return list(mesh.cell_data[name])
    return None


def _names(field_data: Mapping[str, Any], dimension: int) -> dict[int, str]:
    """Gmsh's names of groups: {name: [tag, dimension]}."""
    return {int(value[0]): name for name, value in field_data.items()
            if len(value) == 2 and int(value[1]) == dimension}


def _patches(blocks: Iterable[tuple[Any, Any]]) -> dict[int, list[Any]]:
    """Faces by tag, from blocks with the tags of their faces. Tag 0 is no patch."""
    patches: dict[int, list[Any]] = {}
    for faces, tags in blocks:
        numbers = numpy.asarray(tags, dtype=numpy.int64)
        for tag in numpy.unique(numbers[numbers != 0]):
            chosen = numpy.flatnonzero(numbers == tag)
            patches.setdefault(int(tag), []).extend(faces[i] for i in chosen)
    return patches


def from_meshio(mesh: Any) -> MeshData:
    """A mesh from a meshio.Mesh, or from anything with its attributes.

    The cells of the highest dimension are the cells; those one dimension below are the faces of patches. Regions and
    patches have the tags of the cell data "region", "gmsh:physical" or "medit:ref", and the names in field_data. Other
    point and cell data are kept where they are numbers. Vertices, and cells of higher order, are left out.

    Raises InvalidArgument where no cells are left. check_and_repair() checks the mesh.
    """
    dimensions = [_dimension(block.type) for block in mesh.cells]
    dimension = max((d for d in dimensions if d is not None), default=0)
    if dimension < 2:
        found = sorted({block.type for block in mesh.cells})
        raise ValueError(f"from_meshio: expected cells such as tetra or triangle; got {', '.join(found) or 'none'}")
    cells = [i for i, d in enumerate(dimensions) if d == dimension]
    faces = [i for i, d in enumerate(dimensions) if d == dimension - 1]
    tags = _tags(mesh)
    points = numpy.zeros((len(mesh.points), 3))
    points[:, :numpy.shape(mesh.points)[1]] = mesh.points
    cell_data = {name: numpy.concatenate([numpy.asarray(values[i]) for i in cells])
                 for name, values in mesh.cell_data.items() if _are_numbers(values[cells[0]])}
    return MeshData(
        points, [(mesh.cells[i].type, mesh.cells[i].data) for i in cells],
        regions=None if tags is None else numpy.concatenate([numpy.asarray(tags[i], dtype=numpy.int64) for i in cells]),
        patches=None if tags is None else _patches((mesh.cells[i].data, tags[i]) for i in faces),
        region_names=_names(mesh.field_data, dimension), patch_names=_names(mesh.field_data, dimension - 1),
        point_data={name: values for name, values in mesh.point_data.items() if _are_numbers(values)},
        cell_data=cell_data)


def _are_numbers(values: Any) -> bool:
    array = numpy.asarray(values)
    return array.dtype.kind in "fiub" and array.ndim in (1, 2)


def _faces_by_size(mesh: MeshData) -> list[tuple[str, Any, Any]]:
    """The faces of patches as blocks: type, corners (n, k), tags."""
    offsets = mesh.patch_offsets.astype(numpy.int64)
    sizes = numpy.diff(offsets)
    blocks = []
    for size in numpy.unique(sizes):
        chosen = numpy.flatnonzero(sizes == size)
        corners = mesh.patch_faces[offsets[chosen][:, None] + numpy.arange(size)]
        name = {2: "line", 3: "triangle", 4: "quad"}.get(int(size), "polygon")
        blocks.append((name, corners.astype(numpy.int64), mesh.patch_tags[chosen]))
    return blocks


def _by_points(name: str, cells: list[Any]) -> dict[int, list[int]]:
    """Polygons or polyhedra by their numbers of points: meshio has a block for each."""
    groups: dict[int, list[int]] = {}
    for i, cell in enumerate(cells):
        points = len(cell) if name == "polygon" else len(numpy.unique(numpy.concatenate(cell)))
        groups.setdefault(points, []).append(i)
    return groups


def to_meshio(mesh: MeshData) -> Any:
    """The mesh as a meshio.Mesh.

    Cells come by type, then the faces of patches. Regions and patches are the cell data "gmsh:physical" and
    "medit:ref", with their names in field_data. Cell data have NaN at the faces of patches. Wedges have the order of
    Gmsh. Raises ModuleNotFoundError where meshio is missing.
    """
    import meshio
    blocks: list[tuple[str, Any]] = []
    numbers = []
    for name, cells in mesh.cells.items():
        chosen = numpy.flatnonzero(mesh.types == ORDER[name])
        if isinstance(cells, numpy.ndarray):
            blocks.append((name, cells.astype(numpy.int64)))
            numbers.append(chosen)
            continue
        for size, group in _by_points(name, cells).items():
            picked = [cells[i] for i in group]
            is_polygon = name == "polygon"
            blocks.append((name, numpy.array(picked, dtype=numpy.int64)) if is_polygon else (f"{name}{size}", picked))
            numbers.append(chosen[group])
    faces = _faces_by_size(mesh)
    regions = mesh.regions if len(mesh.regions) else numpy.zeros(mesh.cell_count, dtype=numpy.int32)
    tags = [regions[chosen] for chosen in numbers] + [tags for _, _, tags in faces]
    data: dict[str, list[Any]] = {"gmsh:physical": tags, "medit:ref": tags} if len(mesh.regions) or faces else {}
    for name, values in mesh.cell_data.items():
        empty = [numpy.full((len(t),) + values.shape[1:], numpy.nan) for _, _, t in faces]
        data.setdefault(name, [values[chosen] for chosen in numbers] + empty)
    names = {name: numpy.array([tag, d]) for d, known in ((mesh.dimension, mesh.region_names),
                                                         (mesh.dimension - 1, mesh.patch_names))
             for tag, name in known.items()}
    blocks += [(name, corners) for name, corners, _ in faces]
    return meshio.Mesh(mesh.points, blocks, point_data=mesh.point_data, cell_data=data, field_data=names)
