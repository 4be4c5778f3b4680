"""Pictures by matplotlib: of a run, of particles among their walls."""
from __future__ import annotations

import io
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Optional

import numpy
import numpy.typing

from ._core import InvalidArgument, MeshData
from ._mesh import ORDER

if TYPE_CHECKING:
    from ._results import Run

Numbers = numpy.typing.NDArray[Any]
#: The faces of cells by the numbers of their corners; in the plane the edges.
FACES = {
    "tetra": [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]],
    "hexahedron": [[0, 1, 2, 3], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]],
    "wedge": [[0, 1, 2], [3, 4, 5], [0, 1, 4, 3], [1, 2, 5, 4], [2, 0, 3, 5]],
    "pyramid": [[0, 1, 2, 3], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
    "triangle": [[0, 1], [1, 2], [2, 0]], "quad": [[0, 1], [1, 2], [2, 3], [3, 0]],
}
#: In a picture.
MAX_PATHS, MAX_WALLS, MAX_CELLS = 200, 20000, 300000


def walls_of(mesh: MeshData) -> Iterator[Numbers]:
    """The corners of the walls of free cells: an array (n, k) for each number of corners k."""
    blocks: dict[int, list[Any]] = {}
    for name, cells in mesh.cells.items():
        chosen = mesh.types == ORDER[name]
        free = mesh.free[chosen] > 0 if len(mesh.free) else numpy.ones(chosen.sum(), dtype=bool)
        for face in FACES.get(name, []):
            blocks.setdefault(len(face), []).append(cells[free][:, face])
        for cell in () if name in FACES else (c for c, is_free in zip(cells, free) if is_free):
            for corners in cell if name == "polyhedron" else zip(cell, numpy.roll(cell, -1)):
                blocks.setdefault(len(corners), []).append(numpy.array(corners)[None])
    for found in blocks.values():
        faces = numpy.concatenate(found)
        _, first, count = numpy.unique(numpy.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
        yield faces[first[count == 1]]


def _draw_walls(axes: Any, mesh: MeshData) -> tuple[int, int]:
    """Draws the walls as shadows along the shortest side of the mesh. Returns the two other sides."""
    import matplotlib.collections
    extent = numpy.ptp(mesh.points, axis=0)
    across, along = sorted(numpy.argsort(extent, kind="stable")[1:].tolist(), key=lambda k: float(extent[k]))
    for walls in walls_of(mesh):
        shown = mesh.points[walls[::len(walls) // MAX_WALLS + 1]][:, :, [along, across]]
        axes.add_collection(matplotlib.collections.PolyCollection(
            shown, facecolors=(0.45, 0.5, 0.6, 0.06), edgecolors=(0.45, 0.5, 0.6, 0.12 if walls.shape[1] > 2 else 1.0),
            linewidths=0.3 if walls.shape[1] > 2 else 1.0))
    axes.set(xlabel=f"{'xyz'[along]} [m]", ylabel=f"{'xyz'[across]} [m]", aspect="equal")
    axes.autoscale_view()
    return along, across


def _draw_particles(axes: Any, mesh: MeshData, positions: Numbers, velocities: Numbers) -> None:
    along, across = _draw_walls(axes, mesh)
    drawn = axes.scatter(positions[:, along], positions[:, across], s=4, c=numpy.linalg.norm(velocities, axis=1),
                         cmap="viridis", linewidths=0)
    axes.figure.colorbar(drawn, ax=axes, label="speed [m/s]")


def picture(mesh: MeshData, positions: Numbers, velocities: Numbers) -> Optional[bytes]:
    """Particles among the walls, coloured by their speed, as the bytes of a PNG; None where matplotlib is missing, or the
    mesh is large."""
    if mesh.cell_count > MAX_CELLS:
        return None
    try:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    except ImportError:
        return None
    figure = Figure(figsize=(7, 3.5), layout="constrained")
    _draw_particles(figure.add_subplot(), mesh, positions, velocities)
    written = io.BytesIO()
    FigureCanvasAgg(figure).print_png(written)
    return written.getvalue()


def _deposition(run: Run, axes: Any) -> None:
    table = run.table("deposition")
    table = table[table["deposited"] + table["escaped"] > 0]
    axes.bar(table["patch"], table["deposited"], label="deposited")
    axes.bar(table["patch"], table["escaped"], bottom=table["deposited"], label="escaped")
    axes.set(ylabel="particles")
    axes.legend()


def _residence(run: Run, axes: Any) -> None:
    found = run.summary.get("statistics", {}).get("residence_time")
    if found is None:
        raise InvalidArgument(f"{run.folder}: the run has no residence times: set residence = true in [statistics]")
    for fate in ("escaped", "absorbed"):
        for patch, times in found[fate].items():
            axes.stairs(times["histogram"], times["bin"] * numpy.arange(len(times["histogram"]) + 1), fill=True, alpha=0.6,
                        label=f"{fate}, {patch or 'no patch'}: {times['count']:,}")
    axes.set(xlabel="residence time [s]", ylabel="particles")
    if axes.get_legend_handles_labels()[0]:
        axes.legend()


def _penetration(run: Run, axes: Any) -> None:
    stats = run.stats
    sums = {name: numpy.cumsum(stats[name]) for name in ("escaped", "absorbed")}
    alive = stats["alive"]
    total = numpy.maximum(sums["escaped"] + sums["absorbed"] + alive, 1)
    axes.stackplot(stats["time"], sums["escaped"] / total, sums["absorbed"] / total, alive / total,
                   labels=["escaped (penetration)", "absorbed", "in the scene"], alpha=0.8)
    axes.set(xlabel="time [s]", ylabel="share of all particles", ylim=(0, 1))
    axes.legend()


def _energy(run: Run, axes: Any) -> None:
    unit = run.summary.get("energy_unit", "J/kg")
    for name in ("kinetic", "potential"):
        axes.plot(run.stats["time"], run.stats[f"{name}_energy"], label=name)
    axes.set(xlabel="time [s]", ylabel=f"energy [{unit}]")
    axes.legend()


def _paths(run: Run, axes: Any) -> None:
    along, across = _draw_walls(axes, run[-1].mesh)
    paths = run.paths()
    for identity in list(paths)[::len(paths) // MAX_PATHS + 1]:
        axes.plot(paths[identity][:, along], paths[identity][:, across], linewidth=0.8)


def _particles(run: Run, axes: Any) -> None:
    _draw_particles(axes, run[-1].mesh, run[-1].positions, run[-1].arrays["velocity"])


KINDS = {"deposition": _deposition, "residence": _residence, "penetration": _penetration, "energy": _energy,
         "paths": _paths, "particles": _particles}


def plot(run: Run, what: str, axes: Any) -> Any:
    """See Run.plot()."""
    if what not in KINDS:
        raise InvalidArgument(f"plot: there is no '{what}': there are {', '.join(KINDS)}")
    if axes is None:
        import matplotlib.pyplot
        axes = matplotlib.pyplot.subplots(layout="constrained")[1]
    KINDS[what](run, axes)
    axes.set_title(what)
    return axes
