#!/usr/bin/env python3
"""Draws the figures of docs/concepts with dartcast itself: figures.py FOLDER [NAME]...

Each function draws one figure and asks the library for all that is in it: darts, simplices, crossings, contacts.
"""
from __future__ import annotations

import pathlib
import sys
from typing import Any

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # noqa: E402

import dartcast as dc  # noqa: E402

INK, PATH, WALL, FREE, HOT = "0.25", "#0072b2", "#b8b8b8", "#eef4f8", "#d55e00"
KIND_COLOURS = {dc.Kind.VERTEX: "#d55e00", dc.Kind.EDGE: "#009e73", dc.Kind.FACE: "#0072b2"}


def polygon(environment: Any, cell: int) -> Any:
    """The corners of a cell of the plane."""
    return environment.positions[np.asarray(environment.map.view(cell).vertices), :2]


def fill_cells(axis: Any, environment: Any, positions: Any = None) -> None:
    places = environment.positions if positions is None else positions
    for cell in environment.map.cells():
        view = environment.map.view(cell)
        corners = places[np.asarray(view.vertices), :2]
        axis.fill(*corners.T, facecolor=FREE if view.is_free else WALL, edgecolor="0.6", linewidth=0.8)


def bare(axis: Any, **limits: Any) -> None:
    axis.set(aspect="equal", **limits)
    axis.axis("off")


def arrow(axis: Any, a: Any, b: Any, colour: str, width: float = 1.2, style: str = "-|>", bend: float = 0.0) -> None:
    axis.annotate("", b, a, arrowprops={"arrowstyle": style, "color": colour, "linewidth": width, "shrinkA": 0, "shrinkB": 0,
                                        "connectionstyle": f"arc3,rad={bend}", "mutation_scale": 9})


def draw_map(figure: Any) -> None:
    """Three cells of the plane with their darts; phi1 and phi2 of one of them."""
    axis = figure.subplots()
    environment = dc.Environment(planar_mesh())
    fill_cells(axis, environment)
    darts = {}
    for cell in environment.map.cells():
        corners = polygon(environment, cell)
        inner = corners + 0.13 * (corners.mean(axis=0) - corners)
        for number in range(len(corners)):
            ends = inner[number], inner[(number + 1) % len(corners)]
            a, b = ends[0] + 0.08 * (ends[1] - ends[0]), ends[1] - 0.08 * (ends[1] - ends[0])
            darts[(int(cell), number)] = (a, b)
            arrow(axis, a, b, INK)
    chosen = next(d for d in darts if environment.map.phi2(d) is not None)
    arrow(axis, *darts[chosen], HOT, 2.2)
    for name, dart, shift in (("d", chosen, (0.0, 0.0)), ("phi1(d)", environment.map.phi1(chosen), (0.0, 0.0)),
                              ("phi2(d)", environment.map.phi2(chosen), (0.0, 0.0))):
        a, b = darts[(int(dart[0]), int(dart[1]))]
        middle = 0.5 * (a + b) + shift
        inwards = polygon(environment, int(dart[0])).mean(axis=0) - middle
        axis.text(*(middle + 0.3 * inwards), name, ha="center", va="center", color=HOT, fontsize=9)
        if name != "d":
            arrow(axis, a, b, PATH, 2.0)
    bare(axis)


def planar_mesh() -> Any:
    """Two quadrilaterals and a pentagon."""
    points = np.array([[0, 0], [2, -0.3], [4.3, 0.2], [4.6, 2.1], [3.2, 3.3], [1.9, 2.0], [-0.2, 2.2], [0.9, 3.6]], float)
    cells = [("polygon", [cell]) for cell in ([0, 1, 5, 6], [1, 2, 3, 4, 5], [6, 5, 4, 7])]
    return dc.MeshData(np.column_stack([points, np.zeros(len(points))]), cells)


def draw_simplices(figure: Any) -> None:
    """The pulling triangulation of a hexahedron: fans of its faces, and its tetrahedra pulled apart."""
    environment = dc.Environment(dc.generate_box(cells=[1, 1, 1]))
    shape = environment.map.shape(environment.map.cells()[0])
    places = environment.positions[np.asarray(environment.map.view(environment.map.cells()[0]).vertices)]
    left, right = (figure.add_subplot(1, 2, k, projection="3d") for k in (1, 2))
    for face in range(shape.face_count):
        for t in range(shape.triangle_count(face)):
            corners = places[list(shape.triangle(face, t))]
            left.plot(*np.vstack([corners, corners[:1]]).T, color=INK, linewidth=0.9)
    left.set_title("fans of the faces", fontsize=9)
    for k, simplex in enumerate(shape.simplices):
        corners = places[list(simplex["vertex"])]
        corners = corners + 0.45 * (corners.mean(axis=0) - places.mean(axis=0))
        faces = [corners[[i for i in range(4) if i != j]] for j in range(4)]
        right.add_collection3d(Poly3DCollection(faces, facecolor=plt.cm.viridis(k / 6), edgecolor=INK, alpha=0.55, linewidth=0.7))
    right.set_title(f"its {len(shape.simplices)} tetrahedra, pulled apart", fontsize=9)
    for axis in (left, right):
        axis.set(xlim=(-0.2, 1.2), ylim=(-0.2, 1.2), zlim=(-0.2, 1.2))
        axis.set_box_aspect((1, 1, 1))
        axis.view_init(22, -62)
        axis.set_axis_off()


def draw_walk(figure: Any) -> None:
    """A walk from cell to cell, with the particle's kind at each crossing."""
    axis = figure.subplots()
    mesh = dc.generate_rectangle(cells=[7, 4], size=[7.0, 4.0], jitter=0.45, seed=5)
    environment = dc.Environment(mesh)
    particles = dc.Particles()
    start, target = np.array([0.45, 0.6, 0.0]), np.array([6.6, 3.3, 0.0])
    environment.add(particles, start[None])
    trace = environment.trace(particles, 0, target[None])[0]
    fill_cells(axis, environment)
    passed = [int(trace.before.cell)] + [int(c.to) for c in trace.crossings]
    for cell in passed:
        axis.fill(*polygon(environment, cell).T, facecolor="#cfe3f1", edgecolor="0.5", linewidth=0.8)
        corners = polygon(environment, cell)
        for simplex in environment.map.shape(cell).simplices:
            axis.plot(*corners[list(simplex["vertex"])[:3]][[0, 1, 2, 0]].T, color="white", linewidth=0.8)
    arrow(axis, start[:2], target[:2], PATH, 1.8)
    for crossing in trace.crossings:
        axis.plot(*crossing.point[:2], "o", color=KIND_COLOURS[crossing.kind], markersize=5)
    axis.plot(*start[:2], "o", color=INK)
    axis.text(*(start[:2] + [0.0, -0.3]), "p", ha="center")
    axis.text(*(target[:2] + [0.1, 0.12]), "q")
    bare(axis)


def sweeping() -> Any:
    """A room whose right wall moves to the left, over a particle at rest."""
    mesh = dc.generate_rectangle(cells=[4, 2], size=[4.0, 2.0])
    mesh.free = np.array([1, 1, 1, 0] * 2, dtype=np.uint8)
    environment = dc.Environment(mesh)
    particles = dc.Particles()
    environment.add(particles, np.array([[2.7, 1.1, 0.0]]))
    return environment, particles


def draw_moving_wall(figure: Any) -> None:
    """A wall that sweeps over a particle at rest takes it along."""
    environment, particles = sweeping()
    before = environment.positions.copy()
    rest = particles.positions[0].copy()
    after = before.copy()
    after[before[:, 0] == 3.0, 0] = 2.2
    after[before[:, 0] == 2.0, 0] = 1.4
    left, right = figure.subplots(1, 2, sharey=True)
    fill_cells(left, environment, before)
    left.plot(*rest[:2], "o", color=PATH)
    left.set_title("before: the particle rests", fontsize=9)
    for x, y in before[before[:, 0] == 3.0, :2]:
        arrow(left, (x, y), (2.2, y), HOT)
    environment.move(after)
    report = environment.advance(particles, rest[None])
    fill_cells(right, environment, after)
    x = particles.positions[0]
    contact = report.contacts[0]
    arrow(right, rest[:2], x[:2], PATH, 1.5)
    right.plot(*rest[:2], "o", markerfacecolor="none", color=PATH)
    right.plot(*x[:2], "o", color=PATH)
    right.set_title(f"after: met at t = {contact['time_of_impact']:.2f}, carried to x = {x[0]:.2f}", fontsize=9)
    for axis in (left, right):
        bare(axis)


def draw_cut(figure: Any) -> None:
    """An edge is opened under a particle: its next walk ends there."""
    left, right = figure.subplots(1, 2, sharey=True)
    for axis, opens in ((left, False), (right, True)):
        environment = dc.Environment(dc.generate_rectangle(cells=[5, 3], size=[5.0, 3.0]))
        particles = dc.Particles()
        environment.add(particles, np.array([[1.5, 1.5, 0.0]]))
        if opens:
            edge = middle_edge(environment)
            environment.edit(lambda edit: dc.topology.unsew(edit.topology, edge))
            environment.update_after_edit(particles)
        report = environment.advance(particles, np.array([[4.6, 1.7, 0.0]]))
        fill_cells(axis, environment)
        if opens:
            axis.plot([3, 3], [1, 2], color=HOT, linewidth=2.5)
        arrow(axis, (1.5, 1.5), particles.positions[0][:2], PATH, 1.6)
        stops = f"stops at x = {particles.positions[0][0]:.1f}" if len(report.contacts) else "arrives"
        axis.set_title(("after unsew(): it " if opens else "before: the particle ") + stops, fontsize=9)
        bare(axis)


def middle_edge(environment: Any) -> Any:
    """The edge between the cells to the left and to the right of x = 3, in the middle row."""
    cell = environment.locate([2.5, 1.5, 0.0]).simplex.cell
    others = {number: environment.map.phi2((cell, number)) for number in range(4)}
    return next((cell, number) for number, other in others.items() if other and polygon(environment, other.cell)[:, 0].mean() > 3.0)


def draw_edges(figure: Any) -> None:
    """An edge of a solid meets an edge of a wall; particles at its ends alone would not."""
    mesh = dc.generate_box(cells=[5, 3, 4], size=[5.0, 3.0, 4.0])
    free = np.ones(mesh.cell_count, dtype=np.uint8)
    free[[2 + 5 * y for y in range(3)]] = 0
    mesh.free = free
    line = np.array([[1.2, 1.5, 2.2], [3.9, 1.5, 1.7]])
    fall = np.array([0.0, 0.0, -1.4])
    solids = dc.SolidSet(dc.Environment(mesh))
    solids.add(dc.solid_of_polyline(line))
    step = solids.advance(solids.positions + fall, dc.SolidStepOptions(rounds=0))
    ends, corners = dc.Environment(mesh), dc.Particles()
    ends.add(corners, line)
    ends.advance(corners, line + fall)
    axes = figure.subplots(1, 2, sharey=True)
    for axis, title, after in zip(axes, ("its two ends as particles", "the edge as a solid"), (corners.positions, solids.positions)):
        axis.fill([0, 2, 2, 3, 3, 5, 5, 0], [0, 0, 1, 1, 0, 0, -0.2, -0.2], color=WALL)
        axis.plot(line[:, 0], line[:, 2], "o--", color="0.6", linewidth=1)
        axis.plot(after[:, 0], after[:, 2], "o-", color=PATH)
        axis.set_title(title, fontsize=9)
        bare(axis, xlim=(0, 5), ylim=(-0.2, 2.6))
    point = np.asarray(step.contacts[0]["point"])
    axes[1].plot(point[0], point[2], "o", color=HOT)
    axes[1].text(point[0] + 0.15, point[2] + 0.25, f"t = {step.contacts[0]['time_of_impact']:.2f}", color=HOT, fontsize=9)


def draw_steps(figure: Any) -> None:
    """The stages of a step: blue ones are run, and in orange ones it waits for others."""
    axis = figure.subplots()
    stages = {"start": (0, 0), "carry": (2, 0), "walk": (4, 0), "done": (6.4, 0), "contact": (4, 1.2), "on_way": (4, -1.4),
              "in_batch": (0, -1.4)}
    for name, (x, y) in stages.items():
        waits = name in ("contact", "on_way", "in_batch")
        axis.text(x, y, name, ha="center", va="center", fontsize=10,
                  bbox={"boxstyle": "round,pad=0.5", "facecolor": "#fbeee4" if waits else FREE, "edgecolor": HOT if waits else PATH})
    ways = [((0.38, 0), (1.58, 0), 0, "vertices moved", (0.97, 0.16)), ((0.1, 0.25), (3.75, 0.25), -0.25, "nothing moved", (1.8, 0.95)),
            ((2.4, 0), (3.63, 0), 0, "", (0, 0)), ((3.6, -0.2), (2.45, -0.2), -0.3, "next slice", (2.75, -0.55)),
            ((4.37, 0), (6.0, 0), 0, "at the target", (5.2, 0.16)), ((3.85, 0.32), (3.85, 0.87), 0, "wall", (3.5, 0.6)),
            ((4.15, 0.87), (4.15, 0.32), 0, "answer", (4.65, 0.6)), ((3.85, -0.32), (3.85, -1.07), 0, "", (0, 0)),
            ((4.15, -1.07), (4.15, -0.32), 0, "another rank goes on", (5.15, -0.75)),
            ((0, -0.32), (0, -1.07), 0, "a batch begins", (0.75, -0.75)), ((0.6, -1.4), (3.72, -0.28), 0.2, "", (0, 0))]
    for a, b, bend, words, at in ways:
        arrow(axis, a, b, INK, bend=bend)
        axis.text(*at, words, ha="center", va="center", fontsize=8, color="0.4")
    bare(axis, xlim=(-0.8, 7), ylim=(-1.8, 1.6))


FIGURES = {"map": (draw_map, (4.6, 3.6)), "simplices": (draw_simplices, (6.4, 3.2)), "walk": (draw_walk, (6.4, 3.7)),
           "moving_wall": (draw_moving_wall, (7.2, 2.3)), "cut": (draw_cut, (7.2, 2.6)), "edges": (draw_edges, (7.2, 2.6)),
           "steps": (draw_steps, (7.2, 3.2))}


def main() -> int:
    folder = pathlib.Path(sys.argv[1])
    plt.rcParams.update({"svg.hashsalt": "dartcast", "svg.fonttype": "none", "font.family": "sans-serif"})
    for name in sys.argv[2:] or FIGURES:
        draw, size = FIGURES[name]
        figure = plt.figure(figsize=size)
        draw(figure)
        figure.savefig(folder / f"{name}.svg", bbox_inches="tight", pad_inches=0.05, metadata={"Date": None})
        plt.close(figure)
    return 0


if __name__ == "__main__":
    sys.exit(main())
