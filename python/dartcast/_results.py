"""The results of a run, read from its folder when they are asked for."""
from __future__ import annotations

import csv
import functools
import json
import operator
import os
import pathlib
import xml.etree.ElementTree as ElementTree
import zlib
from collections.abc import Iterator, Mapping
from typing import Any, Union, overload

import numpy
import numpy.typing

from ._core import InvalidArgument, MeshData, read_mesh
from ._mesh import WEDGE

Records = numpy.typing.NDArray[numpy.void]
Arrays = dict[str, numpy.typing.NDArray[Any]]
Path = Union[str, "os.PathLike[str]"]

#: The type of a cell in VTK by its CellType.
_VTK_TYPES = numpy.array([10, 12, 13, 14, 42, 5, 9, 7], dtype=numpy.uint8)
#: Columns of tables that are whole numbers.
_WHOLE = {"step", "id", "cell", "alive", "injected", "absorbed", "escaped", "held", "contacts", "in_opened", "deposited",
          "forward", "backward", "direction"}


def _records(columns: Mapping[str, Any], size: int) -> Records:
    """A structured array with these columns."""
    made = numpy.zeros(size, dtype=[(name, numpy.asarray(values).dtype) for name, values in columns.items()])
    for name, values in columns.items():
        made[name] = values
    return made


def flat(records: Records) -> Records:
    """Records as a flat structured array, which pandas.DataFrame() takes: a column for each number of a row.

    The columns of a vector `point` are point_x, point_y and point_z; those of other arrays have numbers: weights_0.
    """
    columns: dict[str, Any] = {}
    for name in records.dtype.names or ():
        values: Any = records[name]
        if values.dtype.names:
            inner = flat(values)
            columns.update({f"{name}_{part}": inner[part] for part in inner.dtype.names or ()})
            continue
        for index in numpy.ndindex(values.shape[1:]):
            parts = [*map(str, index[:-1]), "xyz"[index[-1]] if values.shape[-1] == 3 and values.dtype.kind == "f"
                     else str(index[-1])] if index else []
            columns["_".join([name, *parts])] = values[(slice(None), *index)]
    return _records(columns, len(records))


def _column(name: str, values: tuple[str, ...]) -> numpy.typing.NDArray[Any]:
    """A column of a table: numbers, NaN where there is none, or texts."""
    try:
        numbers = numpy.array([value or "nan" for value in values]).astype(numpy.float64)
    except ValueError:
        return numpy.array(values)
    return numbers.astype(numpy.int64) if name in _WHOLE else numbers


def _read_table(path: pathlib.Path) -> Records:
    with path.open(newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    columns = zip(*rows) if rows else ((),) * len(header)
    return _records({name: _column(name, values) for name, values in zip(header, columns)}, len(rows))


def _block(data: bytes, at: int, compressor: str, order: str) -> bytes:
    """The bytes of an appended array of VTK."""
    def numbers(first: int, count: int) -> list[int]:
        return [int(n) for n in numpy.frombuffer(data, order + "u8", count, first)]

    count = numbers(at, 1)[0]
    if not compressor:
        return data[at + 8:at + 8 + count]
    size, last = numbers(at + 8, 2)
    unpack: Any = zlib.decompress
    if compressor == "vtkLZ4DataCompressor":
        import lz4.block
        unpack = functools.partial(lz4.block.decompress, uncompressed_size=max(size, last))
    at, packed = at + 8 * (3 + count), numbers(at + 24, count)
    ends = at + numpy.cumsum([0, *packed])
    return b"".join(unpack(data[a:b]) for a, b in zip(ends, ends[1:]))


def _read_vtp(path: pathlib.Path) -> dict[str, Arrays]:
    """The arrays of a .vtp that dartcast wrote, by section. Those of a .pvtp are joined."""
    data = path.read_bytes()
    if path.suffix == ".pvtp":
        pieces = [_read_vtp(path.parent / piece.get("Source", "")) for piece in ElementTree.fromstring(data).iter("Piece")]
        return {section: {name: numpy.concatenate([piece[section][name] for piece in pieces]) for name in arrays}
                for section, arrays in pieces[0].items() if section in ("Points", "PointData")}
    header, _, appended = data.partition(b'<AppendedData encoding="raw">')
    root = ElementTree.fromstring(header + b"</VTKFile>")
    order = "<" if root.get("byte_order") == "LittleEndian" else ">"
    first = len(data) - len(appended) + appended.index(b"_") + 1
    sections: dict[str, Arrays] = {}
    for section in root.iter():
        for array in section.findall("DataArray"):
            kind, bits = array.get("type", "").rstrip("0123456789"), int(array.get("type", "")[-2:].lstrip("nt"))
            dtype = numpy.dtype(f"{order}{ {'Int': 'i', 'UInt': 'u', 'Float': 'f'}[kind]}{bits // 8}")
            block = _block(data, first + int(array.get("offset", 0)), root.get("compressor", ""), order)
            values = numpy.frombuffer(block, dtype)
            components = int(array.get("NumberOfComponents", 1))
            sections.setdefault(section.tag, {})[array.get("Name", "")] = \
                values.reshape(-1, components) if components > 1 else values
    return sections


def _read_pvd(path: pathlib.Path) -> list[tuple[float, pathlib.Path]]:
    if not path.exists():
        return []
    sets = ElementTree.parse(path).getroot().iter("DataSet")
    return [(float(one.get("timestep", 0)), path.parent / one.get("file", "")) for one in sets]


class Frame:
    """The particles of a run at one time. Its file is read when the first array is asked for.

    `arrays` has all arrays of the particles by name (docs/scene.md, "Arrays of the particles").
    """

    def __init__(self, run: Run, number: int) -> None:
        self.run, self.number = run, number
        self.time, self.file = run._frames[number]

    @functools.cached_property
    def _data(self) -> dict[str, Arrays]:
        return _read_vtp(self.file)

    @property
    def step(self) -> int:
        """Steps done."""
        return int(self.file.name.split(".")[0].rpartition("_")[2])

    @property
    def positions(self) -> numpy.typing.NDArray[numpy.float64]:
        """float64 (n, 3)."""
        return self._data["Points"]["Points"]

    @property
    def arrays(self) -> Arrays:
        """The arrays of the particles: id, velocity, radius, cell, kind, held, contacts, and the numbers of the user."""
        return self._data["PointData"]

    @property
    def mesh(self) -> MeshData:
        """The environment at this time."""
        files = self.run._environment
        if not files:
            raise InvalidArgument(f"{self.run.folder}: there is no environment.pvd: is this the folder of a run?")
        return read_mesh(files[min(self.number, len(files) - 1)][1]).mesh

    def __len__(self) -> int:
        return len(self.positions)

    def __repr__(self) -> str:
        return f"<dartcast.Frame: step {self.step}, t = {self.time:g} s, {len(self):,} particles>"

    def to_meshio(self) -> Any:
        """The particles as a meshio.Mesh of vertices. to_meshio(frame.mesh) is the environment."""
        import meshio
        return meshio.Mesh(self.positions, [("vertex", numpy.arange(len(self))[:, None])], point_data=self.arrays)

    def to_pyvista(self) -> Any:
        """A pyvista.MultiBlock: `particles` and `environment`."""
        import pyvista
        particles = pyvista.PolyData(self.positions)
        particles.point_data.update(self.arrays)
        mesh = self.mesh
        offsets, words = mesh.offsets.astype(numpy.int64), mesh.connectivity.astype(numpy.int64)
        wedges = offsets[:-1][mesh.types == 2]
        words[wedges[:, None] + numpy.arange(6)] = words[wedges[:, None] + WEDGE]
        cells = numpy.insert(words, offsets[:-1], numpy.diff(offsets))
        environment = pyvista.UnstructuredGrid(cells, _VTK_TYPES[mesh.types], mesh.points)
        environment.point_data.update(mesh.point_data)
        environment.cell_data.update(mesh.cell_data)
        return pyvista.MultiBlock({"environment": environment, "particles": particles})


class Run:
    """The results of a run: `run[-1]` is its last frame, and a loop goes through all frames. read_run() makes one.

    Nothing is read before it is asked for. Tables are flat structured arrays, which pandas.DataFrame() takes.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = pathlib.Path(folder)
        if not (self.folder / "scene.toml").exists() and not (self.folder / "stats.csv").exists():
            raise InvalidArgument(f"{self.folder}: this is no folder of a run: run(scene, out) writes one")
        self._frames = _read_pvd(self.folder / "particles.pvd")
        self._environment = _read_pvd(self.folder / "environment.pvd")

    @functools.cached_property
    def summary(self) -> dict[str, Any]:
        """The numbers at the end: summary.json. Raises InvalidArgument while the run goes on."""
        return dict(json.loads(self._file("summary.json").read_text(encoding="utf-8")))

    @functools.cached_property
    def stats(self) -> Records:
        """A row for each step: stats.csv."""
        return self.table("stats")

    @functools.cached_property
    def contacts(self) -> Records:
        """A row for each contact: contacts.csv, which a scene with contacts = true in [output] writes."""
        return self.table("contacts")

    def table(self, name: str) -> Records:
        """A table of the folder: "deposition", "planes", "crossings", "bodies", "catheters", "solids" and others."""
        return _read_table(self._file(f"{name}.csv"))

    def _file(self, name: str) -> pathlib.Path:
        path = self.folder / name
        if not path.exists():
            raise InvalidArgument(f"{self.folder}: the run has no {name}: docs/scene.md says what a scene must ask for")
        return path

    @property
    def times(self) -> numpy.typing.NDArray[numpy.float64]:
        """The times of the frames, s."""
        return numpy.array([time for time, _ in self._frames])

    def __len__(self) -> int:
        return len(self._frames)

    @overload
    def __getitem__(self, i: int) -> Frame: ...
    @overload
    def __getitem__(self, i: slice) -> list[Frame]: ...

    def __getitem__(self, i: Union[int, slice]) -> Union[Frame, list[Frame]]:
        if isinstance(i, slice):
            return [Frame(self, k) for k in range(*i.indices(len(self)))]
        number = operator.index(i)
        if not -len(self) <= number < len(self):
            raise IndexError(f"there is no frame {number}: there are {len(self)}")
        return Frame(self, number % len(self))

    def __iter__(self) -> Iterator[Frame]:
        return (Frame(self, k) for k in range(len(self)))

    def paths(self) -> dict[int, numpy.typing.NDArray[numpy.float64]]:
        """The path of each particle by its id, float64 (n, 3): of pathlines.vtp, else from frame to frame."""
        file = self.folder / "pathlines.vtp"
        if file.exists():
            data = _read_vtp(file)
            ends = data["Lines"]["offsets"]
            order = numpy.split(data["Points"]["Points"][data["Lines"]["connectivity"]], ends[:-1])
            return dict(zip(data["CellData"]["id"].tolist(), order))
        found: dict[int, list[Any]] = {}
        for frame in self:
            for identity, x in zip(frame.arrays["id"].tolist(), frame.positions):
                found.setdefault(identity, []).append(x)
        return {identity: numpy.array(points) for identity, points in sorted(found.items())}

    def to_xarray(self) -> Any:
        """An xarray.Dataset of all frames by `time`, `particle` (its id) and `axis`. NaN, or 0 in whole numbers: it is
        not in the scene."""
        import xarray
        ids = numpy.unique(numpy.concatenate([[], *(frame.arrays["id"] for frame in self)])).astype(numpy.int64)
        filled: dict[str, tuple[tuple[str, ...], Any]] = {}
        for k, frame in enumerate(self):
            rows = numpy.searchsorted(ids, frame.arrays["id"])
            for name, values in {"position": frame.positions, **frame.arrays}.items():
                dims = ("time", "particle", "axis")[:values.ndim + 1]
                empty = numpy.nan if values.dtype.kind == "f" else 0
                made = filled.setdefault(name, (dims, numpy.full((len(self), len(ids), *values.shape[1:]), empty,
                                                                 values.dtype.newbyteorder("="))))
                made[1][k, rows] = values
        filled.pop("id", None)
        return xarray.Dataset(filled, {"time": self.times, "particle": ids, "axis": ["x", "y", "z"]},
                              {"folder": str(self.folder)})

    def plot(self, what: str = "paths", axes: Any = None) -> Any:
        """Draws by matplotlib "deposition", "residence", "penetration", "energy", "paths" or "particles". Returns the axes.

        deposition: particles that ended at each patch. residence: times in the scene of those that left it, with
        residence = true in [statistics]. penetration: the shares of all particles that have escaped, that were
        absorbed, and that are in the scene, by time. energy: of all particles, by time. paths: of 200 particles, and
        particles: at the end, by speed; both over the walls, along the two longest sides of the scene. axes: of matplotlib; None: in a new figure.
        """
        from . import _plots
        return _plots.plot(self, what, axes)


def read_run(folder: Path) -> Run:
    """The results in the folder of a run, while it goes on or when it has ended. See Run.

    Raises InvalidArgument where the folder is none of a run.
    """
    return Run(folder)
