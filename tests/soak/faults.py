#!/usr/bin/env python3
"""Plants faults in a copy of the sources, one after another, and says how long dartcast-soak takes to find each.

    tests/soak/faults.py FOLDER [NAME...]     FOLDER: for the copy and its build; NAME: of a fault; none: all
    tests/soak/faults.py --check              whether the text of each fault is in the sources once

A fault that is not found within ten minutes fails. The build is that of the preset release.
"""
import pathlib
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
MINUTES = 10

# Name: file, text, the text in its place.
FAULTS = {
    # A walk kept the face that it entered a cell by in 3 bits, whatever the cell: steps beside polyhedra of nine faces
    # ended at wrong walls, or never.
    "face in 3 bits": ("src/tracking/batch/batch_cell_walks.inl", ".entry(walk.face, walk.triangle);",
                       ".entry(static_cast<std::uint16_t>(walk.face % 8), "
                       "static_cast<std::uint16_t>((walk.triangle + walk.face / 8) % 2));"),
    "batch: a filter without its bound": ("src/tracking/batch/batch_simplex.inl",
                                          "((value[0] > bound) & (value[1] > bound)) &",
                                          "((value[0] > -bound) & (value[1] > bound)) &"),
    "batch: -0 is not flushed": ("src/tracking/batch/batch_kernel.inl",
                                 "(bits_as<Mask4>(numbers) == splat_bits(0))", "(m == 0.0)"),
    "contacts: rounded places": ("src/tracking/step_run.hpp",
                                 "    if (w.at_end) return state_.put(w.simplex, contact.point);",
                                 "    return state_.put(w.at_end ? w.simplex : w.wall_simplex, contact.point);"),
    "contacts: a call that throws keeps what it did": ("src/environment/environment.cpp",
                                                       "answer && !detail::is_library_response(answer);",
                                                       "answer && false;"),
    "edits: particles stay in blocked cells": ("src/environment/update_after_edit.cpp",
                                               "if (!map().is_free(at.cell)) return orphan(i, Place::blocked, at);",
                                               ""),
    "edits: a refused edit loses free numbers": ("src/topology/transaction.cpp",
                                                 "      map_.cells_at_[v.value] = CombinatorialMap::vacant_vertex;\n"
                                                 "      map_.vacant_vertices_.push_back(v);\n    }\n  }\n  merged_",
                                                 "      map_.cells_at_[v.value] = CombinatorialMap::vacant_vertex;\n"
                                                 "    }\n  }\n  merged_"),
    "solids: edges are not asked": ("src/solids/element_touches.cpp", "  ask_sides(walls, e, motion, touches);\n", ""),
    "simultaneous: walls stand still": ("src/spheres/simultaneous_step.cpp",
                                        "pair.to[k + 1] = flushed(wall.to[k]);",
                                        "pair.to[k + 1] = flushed(wall.from[k]);"),
    "spheres: walls out of reach": ("src/spheres/sphere_way.cpp", "(sphere_.radius + slack_ + fastest) * (1.0 + 0x1p-20)",
                                    "(sphere_.radius + slack_ + 0.5 * fastest)"),
    "checkpoint: without velocities": ("src/simulation/particle_system_checkpoint.cpp",
                                       "  set_.table = std::move(table);\n",
                                       "  set_.table = std::move(table);\n  for (Vec3& v : set_.velocities()) v = {};\n"),
    "periodic: notes of a face at a stop behind it": ("src/tracking/step_state.hpp", " && crossing_count == 0", ""),
    "periodic: a start on an edge among walls": ("src/tracking/periodic_passage.cpp", "if (!w.at_start) return partner;",
                                                 "if (!w.at_start || partner != nullptr) return partner;"),
    "solids: a first vertex stands for all": ("src/solids/solid_pairs.cpp",
                                              "overlap(widened(ways[s], margin), ways[other])",
                                              "overlap(way_of(from[first_vertex[s]], to[first_vertex[s]]), ways[other])"),
    "diffusion: no drift": ("src/simulation/aiming.cpp", " + d.gradient * segment.dt;", ";"),
    "replays: without walls between free cells": ("src/tracking/cells_around.cpp",
                                                  "copy.mesh().add_patch_face(corners, parts_free ? wall : cut);",
                                                  "if (!parts_free) copy.mesh().add_patch_face(corners, cut);"),
    "ranks: walls where they were": ("src/tracking/batch/travelling_step.cpp",
                                     "wall.now[i] = complex_.positions()[v];",
                                     "wall.now[i] = complex_.previous_positions()[v];"),
}


def run(*command: str, cwd: pathlib.Path, quiet: bool = True) -> int:
    return subprocess.run(command, cwd=cwd, stdout=subprocess.DEVNULL if quiet else None, check=False).returncode


def build(copy: pathlib.Path) -> None:
    if run("cmake", "--build", "build/release", "--target", "dartcast_soak", cwd=copy) != 0:
        sys.exit(f"{copy}: the build failed")


def check() -> int:
    counts = {name: (ROOT / file).read_text().count(old) for name, (file, old, _) in FAULTS.items()}
    for name, count in counts.items():
        if count != 1:
            print(f"{FAULTS[name][0]}: the text of '{name}' is there {count} times: write the fault anew")
    return 0 if all(count == 1 for count in counts.values()) else 1


def main() -> int:
    if sys.argv[1:] == ["--check"]:
        return check()
    copy = pathlib.Path(sys.argv[1]).resolve()
    names = sys.argv[2:] or list(FAULTS)
    if not copy.exists() and run("git", "clone", "-q", str(ROOT), str(copy), cwd=ROOT) != 0:
        return 2
    if check() != 0:
        return 2
    run("cmake", "--preset", "release", "-DDARTCAST_TESTS=ON", cwd=copy)
    missed = 0
    for name in names:
        file, old, new = FAULTS[name]
        path = copy / file
        text = path.read_text()
        path.write_text(text.replace(old, new))
        try:
            build(copy)
            start = time.monotonic()
            found = run("build/release/bin/dartcast-soak", str(MINUTES), "--as-found", "--limit", "60", cwd=copy) == 1
            print(f"{name}: {'found' if found else 'NOT found'} in {(time.monotonic() - start) / 60:.1f} min", flush=True)
            missed += not found
        finally:
            path.write_text(text)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
