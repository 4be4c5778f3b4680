#!/usr/bin/env python3
"""Makes the meshes of scenes/validation that are no boxes, of blocks of hexahedra. Planes of symmetry reflect.

validation_meshes.py ball FILE       an eighth of a ball of radius 1 around the origin
validation_meshes.py tube FILE       half of a tube of radius 1 and length 20 along z, and its parabolic velocity
validation_meshes.py flow P CASE     half of a bend, 2 P cells across its core, as a case of OpenFOAM's simpleFoam
validation_meshes.py bend P CASE FILE    that mesh with the velocity of the case, once gmshToFoam and simpleFoam have run
"""
from __future__ import annotations

import itertools
import math
import pathlib
import re
import sys
from typing import Any, Callable

import numpy as np

RADIUS, SPEED, NU = 2.5e-3, 3.0, 1.5e-5  # of the bend: m; m / s, the mean; m^2 / s. Re = 1000
BEND, LEG, TUBE = 5.6, 2.0, 20.0  # in radii: of the bend's axis; before and behind it; of the tube
FACES = ([0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7])


def shells(inside: Any, outside: Any, count: int, growth: float) -> Any:
    """Layers of points from one surface to another; each layer is `growth` times as thick as the one before."""
    t = np.cumsum(np.append(0.0, growth ** np.arange(count)))
    return np.stack([inside + (outside - inside) * s for s in t / t[-1]])


def sewn(blocks: Any) -> tuple[Any, Any]:
    """Points and hexahedra of blocks, which are grids of points."""
    points, cells, first = [], [], 0
    for b in blocks:
        n = first + np.arange(b[..., 0].size).reshape(b.shape[:3])
        steps = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
        c = np.stack([n[i:i - 1 or None, j:j - 1 or None, k:k - 1 or None].ravel() for i, j, k in steps], axis=1)
        p = b.reshape(-1, 3)
        if np.linalg.det(p[c[0, [1, 3, 4]] - first] - p[c[0, 0] - first]) < 0:
            c = c[:, [0, 3, 2, 1, 4, 7, 6, 5]]
        points.append(p)
        cells.append(c)
        first += len(p)
    all_points = np.concatenate(points)
    _, chosen, number = np.unique(np.round(all_points, 9), axis=0, return_index=True, return_inverse=True)
    return all_points[chosen], number.ravel()[np.concatenate(cells)]


def patches(points: Any, cells: Any, name: Callable[[Any], str]) -> dict[str, Any]:
    """The outer faces, by the name of their corners' places."""
    faces = np.concatenate([cells[:, f] for f in FACES])
    _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    outer = faces[np.sort(first[count == 1])]
    names = np.array([name(points[f]) for f in outer])
    flat = np.all(np.abs(points[outer][..., 1]) < 1e-9, axis=1)
    assert np.all(names[flat] == "symmetry"), "a wall lies in the plane of symmetry"
    return {str(one): outer[names == one] for one in np.unique(names)}


def ball(p: int) -> Any:
    grid = np.stack(np.meshgrid(*3 * [np.linspace(0.0, 0.5, p + 1)], indexing="ij"), axis=3)
    grid *= 1.0 - 0.15 * (np.sort(grid, axis=3)[..., 1:2] / 0.5) ** 2  # towards a ball
    sides = [grid[-1], grid[:, -1], grid[:, :, -1]]
    angle = [np.tan(np.linspace(0.0, 0.25 * math.pi, p + 1))] * 2
    a, b = np.meshgrid(*angle, indexing="ij")
    rims = [np.stack(x, axis=2) / np.sqrt(1 + a**2 + b**2)[..., None]
            for x in ((np.ones_like(a), a, b), (a, np.ones_like(a), b), (a, b, np.ones_like(a)))]
    points, cells = sewn([grid, *(shells(s, r, p, 0.9) for s, r in zip(sides, rims))])
    x = points[cells]  # its volume is that of the ball
    volume = sum(np.linalg.det(np.stack([x[:, j] - x[:, 0], x[:, k] - x[:, 0], x[:, 6] - x[:, 0]], axis=1)) / 6
                 for j, k in ((1, 2), (2, 3), (3, 7), (7, 4), (4, 5), (5, 1))).sum()
    points *= (math.pi / 6 / volume) ** (1 / 3)
    return points, cells, patches(points, cells, lambda f: "symmetry" if np.any(np.all(f == 0, axis=0)) else "wall")


def swept(p: int, layers: int, growth: float, along: Any, place: Any) -> tuple[Any, Any]:
    """Half a disc, y >= 0, at each s along a line. A round one has the same area."""
    x, y = np.meshgrid(np.linspace(-0.6, 0.6, 2 * p + 1), np.linspace(0.0, 0.6, p + 1), indexing="ij")
    core = np.stack([x, y], axis=2) * (1.0 - 0.12 * (x * y / 0.36) ** 2)[..., None]
    rim = np.concatenate([core[-1], core[-2::-1, -1], core[0, -2::-1]])
    angle = np.linspace(0.0, math.pi, len(rim))
    round_rim = np.stack([np.cos(angle), np.round(np.sin(angle), 15)], axis=1)  # both its ends are in the plane y = 0
    ring = shells(rim, round_rim, layers, growth)
    scale = math.sqrt(angle[1] / math.sin(angle[1]))
    return sewn([np.stack([place(scale * flat, s) for s in along], axis=2) for flat in (core, ring)])


def tube() -> Any:
    points, cells = swept(3, 6, 0.85, np.linspace(0.0, TUBE, 11),
                          lambda flat, s: np.concatenate([flat, np.full_like(flat[..., :1], s)], axis=-1))
    ends = {0.0: "inlet", TUBE: "outlet"}
    sides = patches(points, cells, lambda f: ends[f[0, 2]] if len(set(f[:, 2])) == 1
                    else "symmetry" if np.all(f[:, 1] == 0) else "wall")
    return points, cells, sides, parabola(points, cells, sides)


def parabola(points: Any, cells: Any, sides: Any) -> Any:
    """Velocities of the mean 1 along z, 0 on walls; their flux is that of simplices of the inlet."""
    w = np.maximum(0.0, 2.0 * (1.0 - (points[:, :2] ** 2).sum(axis=1)))
    for name in sides:
        w[np.unique(sides[name])] *= name in ("inlet", "outlet", "symmetry")
    w[np.unique(sides["wall"] if "wall" in sides else sides["leg"])] = 0.0
    fan = sides["inlet"][:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)
    area = np.linalg.norm(np.cross(points[fan[:, 1]] - points[fan[:, 0]], points[fan[:, 2]] - points[fan[:, 0]]), axis=1)
    w /= (w[fan].mean(axis=1) * area).sum() / area.sum()
    return np.stack([0 * w, 0 * w, w], axis=1)


def along_bend(flat: Any, s: float) -> Any:
    """A leg along z, a bend around the axis x = -BEND, z = 0, and a leg along -x."""
    angle = min(max(s - LEG, 0.0) / BEND, 0.5 * math.pi)
    before, behind = min(s - LEG, 0.0), max(s - LEG - 0.5 * math.pi * BEND, 0.0)
    r = BEND + flat[..., 0]
    return np.stack([r * math.cos(angle) - BEND - behind, flat[..., 1], r * math.sin(angle) + before], axis=-1)


def name_in_bend(f: Any) -> str:
    x, y, z = f.T
    if np.all(y == 0):
        return "symmetry"
    if np.allclose(z, -LEG) or np.allclose(x, -BEND - LEG):
        return "inlet" if np.allclose(z, -LEG) else "outlet"
    return "bend" if z.mean() > 0 and x.mean() > -BEND else "leg"


def bend(p: int) -> Any:
    along = np.linspace(0.0, 2 * LEG + 0.5 * math.pi * BEND, 7 * p + 1)
    points, cells = swept(p, 2 * p, 0.8, along, along_bend)
    return points, cells, patches(points, cells, name_in_bend)


HEAD = "FoamFile {{ version 2.0; format ascii; class {}; object {}; }}\n"
CASE = {
    "system/controlDict": ("dictionary", "application simpleFoam; startFrom startTime; startTime 0; stopAt endTime; endTime "
                           "600; deltaT 1; writeControl timeStep; writeInterval 600; writeFormat ascii; writePrecision 9;"),
    "system/fvSchemes": ("dictionary", "ddtSchemes { default steadyState; } gradSchemes { default Gauss linear; } divSchemes "
                         "{ default none; div(phi,U) bounded Gauss linearUpwind grad(U); div((nuEff*dev2(T(grad(U))))) Gauss "
                         "linear; } laplacianSchemes { default Gauss linear corrected; } interpolationSchemes { default "
                         "linear; } snGradSchemes { default corrected; }"),
    "system/fvSolution": ("dictionary", "solvers { p { solver GAMG; smoother GaussSeidel; tolerance 1e-9; relTol 0.05; } U { "
                          "solver smoothSolver; smoother symGaussSeidel; tolerance 1e-10; relTol 0.05; } } SIMPLE { "
                          "consistent yes; residualControl { p 1e-6; U 1e-7; } } relaxationFactors { equations { U 0.9; } }"),
    "constant/transportProperties": ("dictionary", f"transportModel Newtonian; nu {NU};"),
    "constant/turbulenceProperties": ("dictionary", "simulationType laminar;"),
    "0/p": ("volScalarField", "dimensions [0 2 -2 0 0 0 0]; internalField uniform 0; boundaryField { outlet { type "
            'fixedValue; value uniform 0; } ".*" { type zeroGradient; } }'),
    "0/U": ("volVectorField", "dimensions [0 1 -1 0 0 0 0]; internalField uniform (0 0 0); boundaryField { inlet { type "
            "fixedValue; value nonuniform List<vector> %s; } outlet { type zeroGradient; } symmetry { type slip; } "
            '"bend|leg" { type noSlip; } }'),
}


def write_case(p: int, case: pathlib.Path) -> None:
    """Faces of a patch keep their order in gmshToFoam."""
    points, cells, sides = bend(p)
    speed = parabola(points, cells, sides)[sides["inlet"]].mean(axis=1) * SPEED
    inlet = f"{len(speed)} ({' '.join(f'(0 0 {w:.9g})' for w in speed[:, 2])})"
    for name, (kind, text) in CASE.items():
        (case / name).parent.mkdir(parents=True, exist_ok=True)
        (case / name).write_text(HEAD.format(kind, name.split("/")[-1]) + (text % inlet if name == "0/U" else text))
    elements = [(3, tag, f) for tag, name in enumerate(sides, 1) for f in sides[name]]
    elements += [(5, len(sides) + 1, c) for c in cells]
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(sides) + 1)]
    lines += [f'2 {tag} "{name}"' for tag, name in enumerate(sides, 1)] + [f'3 {len(sides) + 1} "fluid"', "$EndPhysicalNames"]
    lines += ["$Nodes", str(len(points))] + ["%d %.12g %.12g %.12g" % (i, *x) for i, x in enumerate(points * RADIUS, 1)]
    lines += ["$EndNodes", "$Elements", str(len(elements))]
    lines += [f"{i} {kind} 2 {tag} {tag} {' '.join(map(str, c + 1))}" for i, (kind, tag, c) in enumerate(elements, 1)]
    (case / "bend.msh").write_text("\n".join([*lines, "$EndElements", ""]))


def at_points(points: Any, cells: Any, sides: Any, values: Any) -> Any:
    """A linear fit of the cells around each point; 0 on the wall, the parabola at the inlet."""
    centres, around = points[cells].mean(axis=1), [[] for _ in points]
    for c, corners in enumerate(cells):
        for i in corners:
            around[i].append(c)
    u = np.empty_like(points)
    for i, near in enumerate(around):
        if len(near) < 6:  # on one side alone: with their neighbours
            near = sorted(set(itertools.chain.from_iterable(around[k] for c in near for k in cells[c])))
        fit = np.column_stack([np.ones(len(near)), centres[near] - points[i]])
        u[i] = np.linalg.lstsq(fit, values[near], rcond=None)[0][0]
    u[np.unique(sides["symmetry"]), 1] = 0.0
    inlet = np.unique(sides["inlet"])
    u[inlet] = SPEED * parabola(points, cells, sides)[inlet]
    u[np.unique(np.concatenate([sides["bend"], sides["leg"]]))] = 0.0
    return u


def velocity_of(case: pathlib.Path) -> Any:
    last = max((f for f in case.iterdir() if f.name.isdigit()), key=lambda f: int(f.name))
    rows = re.search(r"List<vector>\s*\d+\s*\((.*?)\)\s*;", (last / "U").read_text(), re.DOTALL)
    return np.array(re.findall(r"\((\S+) (\S+) (\S+)\)", rows[1]), dtype=float)


def write(path: pathlib.Path, points: Any, cells: Any, sides: Any, u: Any = None, pulse: bool = False) -> None:
    """A legacy file of VTK. Its cell array `patch` numbers the patches. `pulse`: with what a wall along z needs to pulse."""
    faces = [(tag, f) for tag, name in enumerate(sides, 1) for f in sides[name]]
    words = 9 * len(cells) + 5 * len(faces)
    lines = ["# vtk DataFile Version 3.0", "made by site/validation_meshes.py", "ASCII", "DATASET UNSTRUCTURED_GRID"]
    lines += ["FIELD FieldData 1", f"patch_names 1 {len(sides)} string"]
    lines += [f"{tag}%20{name}" for tag, name in enumerate(sides, 1)]
    lines += [f"POINTS {len(points)} double"] + ["%.6g %.6g %.6g" % tuple(x) for x in points]
    lines += [f"CELLS {len(cells) + len(faces)} {words}"] + ["8 " + " ".join(map(str, c)) for c in cells]
    lines += ["4 " + " ".join(map(str, f)) for _, f in faces]
    lines += [f"CELL_TYPES {len(cells) + len(faces)}"] + ["12"] * len(cells) + ["9"] * len(faces)
    lines += [f"CELL_DATA {len(cells) + len(faces)}", "SCALARS patch int", "LOOKUP_TABLE default"]
    lines += ["0"] * len(cells) + [str(tag) for tag, _ in faces]
    if u is not None:
        lines += [f"POINT_DATA {len(points)}", "VECTORS U double"] + ["%.4g %.4g %.4g" % tuple(x) for x in u]
    if pulse:
        lines += ["VECTORS rest double"] + ["0 0 0"] * len(points)
        lines += ["VECTORS radial double"] + ["%.6g %.6g 0" % tuple(x[:2]) for x in points]
    path.write_text("\n".join([*lines, ""]))


def main(what: str, *rest: str) -> None:
    if what == "ball":
        write(pathlib.Path(rest[0]), *ball(4))
    elif what == "tube":
        write(pathlib.Path(rest[0]), *tube(), pulse=True)
    elif what == "flow":
        write_case(int(rest[0]), pathlib.Path(rest[1]))
    else:
        points, cells, sides = bend(int(rest[0]))
        u = at_points(points, cells, sides, velocity_of(pathlib.Path(rest[1])))
        write(pathlib.Path(rest[2]), points * RADIUS, cells, sides, u)


main(*sys.argv[1:])
