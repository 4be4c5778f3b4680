"""MeshData from arrays with the names and shapes of meshio, and back."""
from __future__ import annotations

import operator
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy

from . import _core as module
from ._core import InvalidArgument, MeshData

_core: Any = module  # with names that are no user's

#: The types of cells by CellType, and their corners; 0: any number.
CORNERS = {"tetra": 4, "hexahedron": 8, "wedge": 6, "pyramid": 5, "polyhedron": 0, "triangle": 3, "quad": 4, "polygon": 0}
ORDER = {name: i for i, name in enumerate(CORNERS)}
#: From the order of Gmsh to that of VTK, and back.
WEDGE = numpy.array([0, 2, 1, 3, 5, 4])

Array = Any


def _type_of(name: str) -> str:
    """meshio adds the number of points to the names of polyhedra and polygons: "polyhedron10"."""
    plain = name.rstrip("0123456789")
    if plain in CORNERS and CORNERS[plain] == 0:
        return plain
    names = dict(zip(_core.CELL_TYPE_NAMES, CORNERS))
    if name not in CORNERS and name not in names:
        raise InvalidArgument(f"cells: '{name}' is no type of cells here: the types are {', '.join(CORNERS)}")
    return names.get(name, name)


def _items(x: Any, name: str) -> list[tuple[Any, Any]]:
    """The pairs of a dict, or of a list of pairs, as meshio has them."""
    pairs = x.items() if isinstance(x, Mapping) else x
    if isinstance(x, (numpy.ndarray, str)) or not isinstance(pairs, Iterable):
        raise TypeError(f"{name}: expected a dict by name, or a list of pairs (name, values); got a {type(x).__name__}")
    found = list(pairs)
    for item in found:
        if not isinstance(item, Sequence) or len(item) != 2:
            raise TypeError(f"{name}: expected pairs (name, values); got {item!r}")
    return [(key, value) for key, value in found]


def _flat(parts: Iterable[Array]) -> tuple[Array, Array]:
    """Lists of corners one behind the other, and their lengths."""
    found = list(parts)
    joined = numpy.concatenate(found) if found else numpy.empty(0, dtype=numpy.uint32)
    return joined, numpy.array([len(part) for part in found], dtype=numpy.int64)


def _rows(x: Any, name: str, corners: int, points: int) -> tuple[Array, Array]:
    numbers = _core._corners(x, name, corners, points)
    return numbers, numpy.full(len(numbers) // corners, corners)


def _polyhedron(cell: Any, name: str, points: int) -> Array:
    """The number of faces, then for each the number of corners and the corners."""
    if not isinstance(cell, (Sequence, numpy.ndarray)):
        raise TypeError(f"{name}: expected a list of faces for each cell")
    faces = [_core._corners(face, name, 0, points) for face in cell]
    return _flat([[len(faces)], *(part for face in faces for part in ([len(face)], face))])[0]


def _block(name: str, cells: Any, points: Array) -> tuple[Array, Array]:
    """The connectivity of a block, and its length for each cell."""
    kind, text = _type_of(name), f"cells['{name}']"
    if CORNERS[kind]:
        words, sizes = _rows(cells, text, CORNERS[kind], len(points))
        if kind == "wedge" and len(words):  # passed on as files have them: most as in Gmsh. The volume decides
            rows = words.reshape(-1, 6)
            turned = _core.orient3d(*(points[rows[:, i]] for i in range(4))) < 0
            rows[turned] = rows[turned][:, WEDGE]
        return words, sizes
    if not isinstance(cells, Iterable):
        raise TypeError(f"{text}: expected a list of cells")
    if kind == "polygon":
        return _flat(_core._corners(cell, text, 0, len(points)) for cell in cells)
    return _flat(_polyhedron(cell, text, len(points)) for cell in cells)


def _expect_count(values: Any, count: int, name: str, of: str = "cell") -> None:
    if len(values) != count:
        raise InvalidArgument(f"{name}: expected {count} values, one for each {of}; got {len(values)}")


def _joined(x: Any, counts: list[tuple[str, int]], name: str) -> Any:
    """Values of cells as one array: a flat one as it is, one by block in the order of the blocks."""
    if not isinstance(x, Mapping):
        return x
    for block, count in counts:
        if block not in x:
            raise InvalidArgument(f"{name}: there are no values for the cells '{block}'")
        _expect_count(x[block], count, f"{name}['{block}']")
    if len(x) != len(counts):
        raise InvalidArgument(f"{name}: it names cells that the mesh has not")
    return numpy.concatenate([x[block] for block, _ in counts]) if counts else []


def _faces(faces: Any, name: str, points: int) -> tuple[Array, Array]:
    """Faces of a patch: from one array (n, corners), from blocks, or from a list of faces."""
    if isinstance(faces, numpy.ndarray) and faces.ndim == 2:
        return _rows(faces, name, max(1, faces.shape[1]), points)
    if isinstance(faces, Mapping):
        return _stacked([_faces(block, name, points) for block in faces.values()])
    if not isinstance(faces, Sequence):
        raise TypeError(f"{name}: expected faces as an array (n, corners), or as a list")
    return _flat(_core._corners(face, name, 0, points) for face in faces)


def _tag_of(key: Any, names: dict[int, str], keys: list[Any]) -> int:
    """A patch is named by its tag, or by its name: then it has the tag of that name, or the next one."""
    if not isinstance(key, str):
        try:
            return operator.index(key)
        except TypeError:
            raise TypeError(f"patches: expected a name or a tag, which is a whole number; got {key!r}") from None
    known = {name: tag for tag, name in reversed(names.items())}
    if key not in known:
        known[key] = next(tag for tag in range(1, 2 + len(names) + len(keys)) if tag not in names and tag not in keys)
        names[known[key]] = key
    return known[key]


def _stacked(blocks: list[tuple[Array, Array]]) -> tuple[Array, Array]:
    return _flat(words for words, _ in blocks)[0], _flat(sizes for _, sizes in blocks)[0]


_made = MeshData.__init__


def __init__(self: Any, points: Any = None, cells: Any = None, *, regions: Any = None, patches: Any = None,  # noqa: N807
             region_names: Any = None, patch_names: Any = None, free: Any = None, point_data: Any = None,
             cell_data: Any = None) -> None:
    """__init__(self, points: Points | None = None, cells: Mapping[str, Any] | Sequence[tuple[str, Any]] | None = None, *, regions: Any | None = None, patches: Mapping[Any, Any] | Sequence[tuple[Any, Any]] | None = None, region_names: Mapping[int, str] | None = None, patch_names: Mapping[int, str] | None = None, free: Any | None = None, point_data: Mapping[str, Any] | None = None, cell_data: Mapping[str, Any] | None = None) -> None

    A mesh from arrays.

    points: float64 (n, 3). cells: by the names of meshio's types, as a dict or a list of pairs: "tetra", "hexahedron",
    "wedge", "pyramid", "triangle" and "quad" are arrays (n, corners) of any integer dtype; "polyhedron" is a list of
    cells, each a list of faces; "polygon" is a list of cells, each a list of corners. A wedge may have the order of
    Gmsh or that of VTK: the one with a positive volume is taken.

    regions, free, and each array of cell_data: one value per cell, in the order of the cells, or a dict by type.
    region_names, patch_names: {tag: name}. patches: {name or tag: faces}, where faces are an array (n, corners), a dict
    of these by type, or a list of faces. A patch that is given by a name gets the next tag. point_data: {name: (n,) or
    (n, components)}.

    Raises TypeError for another dtype or shape, and InvalidArgument where a size does not match or a number is no
    point. check_and_repair() checks the rest.
    """
    _made(self)
    if points is not None:
        self.points = points
    x, blocks, types, counts = self.points, [], [], []
    for name, block in _items({} if cells is None else cells, "cells"):
        if not isinstance(name, str):
            raise TypeError('cells: expected the name of a type, as "tetra"')
        blocks.append(_block(name, block, x))
        counts.append((name, len(blocks[-1][1])))
        types.append(numpy.full(counts[-1][1], ORDER[_type_of(name)]))
    self.connectivity, sizes = _stacked(blocks)
    self.types, self.offsets = _flat(types)[0], numpy.cumsum([0, *sizes])
    self.region_names = region_names or {}
    if regions is not None:
        self.regions = _joined(regions, counts, "regions")
        _expect_count(self.regions, len(sizes), "regions")
    if free is not None:
        self.free = numpy.ascontiguousarray(_joined(free, counts, "free"))
        _expect_count(self.free, len(sizes), "free")
    self.point_data = dict(point_data or {})
    self.cell_data = {name: _joined(values, counts, f"cell_data['{name}']") for name, values in (cell_data or {}).items()}
    items = _items({} if patches is None else patches, "patches")
    names: dict[int, str] = dict(patch_names or {})
    self.patch_names = names
    blocks = [_faces(faces, f"patches[{key!r}]", len(x)) for key, faces in items]
    tags = [_tag_of(key, names, [k for k, _ in items]) for key, _ in items]
    self.patch_faces, sizes = _stacked(blocks)
    self.patch_names, self.patch_offsets = names, numpy.cumsum([0, *sizes])
    self.patch_tags = numpy.repeat(tags, [len(block[1]) for block in blocks]) if tags else []


def cells(self: Any) -> dict[str, Any]:
    """cells(self) -> dict

    The cells by type, as the constructor takes them. Raises InvalidArgument where the mesh's arrays contradict each other.
    """
    _core._check_arrays(self)
    types, words, offsets = self.types, self.connectivity, self.offsets.astype(numpy.int64)
    found: dict[str, Any] = {}
    for name, corners in CORNERS.items():
        chosen = numpy.flatnonzero(types == ORDER[name])
        if corners and len(chosen):
            found[name] = words[offsets[chosen][:, None] + numpy.arange(corners)]
        elif len(chosen):
            parts = [words[offsets[c]:offsets[c + 1]] for c in chosen]
            found[name] = parts if name == "polygon" else [faces_of_words(part) for part in parts]
    return found


def faces_of_words(words: Array) -> list[Array]:
    """The faces of a polyhedron from its connectivity."""
    faces, at = [], 1
    while at < len(words):
        faces.append(words[at + 1:at + 1 + words[at]])
        at += 1 + int(words[at])
    return faces


def _restored(cls: type, values: dict[str, Any]) -> Any:
    made = cls()
    for name, value in values.items():
        setattr(made, name, value)
    return made


def __reduce__(self: Any) -> Any:  # noqa: N807
    return _restored, (type(self), {name: getattr(self, name) for name, value in vars(MeshData).items()
                                    if isinstance(value, property) and value.fset})


setattr(MeshData, "__init__", __init__)
setattr(MeshData, "__reduce__", __reduce__)
setattr(MeshData, "cells", property(cells))
