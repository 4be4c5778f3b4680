#!/usr/bin/env python3
"""Checks who includes whom: each room of src/ uses only rooms before it, and each dependency stays in its place.

Also holds the public surface: which headers are installed, their number, and their length.
"""
import pathlib
import re
import sys

# The rooms in order: one may include those before it. CMakeLists.txt makes one library of each line.
LIBRARIES = {
    "core": ["base", "predicates", "mesh", "generators", "topology", "complex", "editing", "surface", "parts", "tracking",
             "tracking/batch", "response", "environment"],
    "simulation": ["dynamics", "spheres", "solids", "bodies", "catheter", "simulation"],
    "mpi": ["distributed"],
    "io": ["formats", "formats/vtk", "formats/openfoam", "meshing", "scene", "report", "output"],
}
ROOMS = [room for rooms in LIBRARIES.values() for room in rooms]
# Rooms side by side. Readers of VTK's formats are reached through formats/vtk.hpp, those of OpenFOAM's cases through
# formats/openfoam.hpp.
DENIED = {("tracking", "surface"), ("tracking/batch", "surface"), ("spheres", "surface"),
          ("formats/openfoam", "formats/vtk")} | {
    (room, part) for room in ("meshing", "scene", "report", "output") for part in ("formats/vtk", "formats/openfoam")} | {
    # MPI stands beside all that is above core: what shares a run knows ranks alone.
    *((room, "distributed") for room in LIBRARIES["io"]), *(("distributed", room) for room in LIBRARIES["simulation"])}

# Public headers by the room that implements them.
PUBLIC = {
    "base": "error ids ranks threads vec3",
    "predicates": "predicates",
    "mesh": "mesh_data mesh_check mesh_selection decompose",
    "generators": "generators",
    "topology": "cell_shape storage combinatorial_map map_edits",
    "complex": "cell_complex complex_edit validity walls",
    "editing": "remeshing cutting",
    "surface": "surface",
    "parts": "mesh_part",
    "tracking": "cell_tally particle_state contact step step_replay",
    "response": "response",
    "environment": "environment audit shared_environment",
    "distributed": "mpi_ranks",
    "dynamics": "dynamics",
    "spheres": "spheres",
    "solids": "solids",
    "bodies": "bodies",
    "catheter": "catheter",
    "simulation": "simulation plan deformation vector_field forces events scene statistics",
    "formats": "mesh_files",
    "scene": "scene_file",
    "report": "report",
    "output": "run trajectory statistics_files replay",
}
ROOM_OF = {f"dartcast/{name}.hpp": room for room, names in PUBLIC.items() for name in names.split()}
EVERYTHING = "dartcast/dartcast.hpp"  # includes all others, but those of libraries that a build may be without
OPTIONAL = {"dartcast/mpi_ranks.hpp"}
MOST_HEADERS = 54
MOST_LINES = 400

# Third-party headers, and the rooms that may include them; never in public headers, for users need only our own.
THIRD_PARTY = [
    (re.compile(r"^vtk[A-Z]"), set()),
    (re.compile(r"^expat\.h"), {"formats"}),
    (re.compile(r"^hdf5\.h"), {"output"}),
    (re.compile(r"^lz4\.h"), {"formats", "formats/vtk"}),
    (re.compile(r"^zlib\.h"), {"formats", "formats/vtk", "formats/openfoam", "report"}),
    (re.compile(r"^mpi\.h"), {"distributed"}),
    (re.compile(r"^(tbb|oneapi)/"), {"base"}),
    (re.compile(r"^(Eigen|boost|fmt)/"), set(ROOMS)),
    (re.compile(r"^nlohmann/"), {"report", "output"}),
    (re.compile(r"^toml\+\+/"), {"scene"}),
]
# Competitors' headers, and the one folder that may include them.
COMPETITORS = re.compile(r"^(Bullet|LinearMath/|bt[A-Z]|embree)")
# Code that must stay independent of the predicates of tracking, so that it can check them.
INDEPENDENT = re.compile(r"(^tests/oracle/|/audit[a-z_]*\.[ch]pp$)")
PREDICATES = re.compile(r"^(dartcast/predicates\.hpp|predicates/)")
# The parts of a simulation belong to its room. All others see them through simulation/simulation_view.hpp.
PARTS = "simulation/simulation_parts.hpp"

STANDARD = re.compile(r"^([a-z_]+|sys/[a-z]+\.h|(fcntl|unistd|emmintrin|immintrin|regex)\.h)$")
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.MULTILINE)
SUFFIXES = {".cpp", ".hpp", ".inl"}


def room_of(header: str) -> str | None:
    """The room of one of our headers, as it is included; none where there is no such file."""
    if header in ROOM_OF:
        return ROOM_OF[header] if pathlib.Path("include", header).is_file() else None
    return pathlib.Path(header).parent.as_posix() if pathlib.Path("src", header).is_file() else None


def allowed(header: str, room: str, public: bool) -> bool:
    """Whether a file of a room may include a header."""
    if header.endswith((".hpp", ".inl")) and "/" in header and not any(p.match(header) for p, _ in THIRD_PARTY):
        target = room_of(header)
        if target is None or (public and not header.startswith("dartcast/")):
            return False
        return ROOMS.index(target) <= ROOMS.index(room) and (room, target) not in DENIED
    for pattern, rooms in THIRD_PARTY:
        if pattern.match(header):
            return room in rooms and not public
    return STANDARD.match(header) is not None


def problems_of(path: pathlib.Path) -> list[str]:
    """What is wrong with the includes of one file."""
    name = path.as_posix()
    includes = INCLUDE.findall(path.read_text(encoding="utf-8"))
    found = [f"{name}: includes {h}, which it is there to check"
             for h in includes if INDEPENDENT.search(name) and PREDICATES.match(h)]
    if PARTS in includes and not name.startswith("src/simulation/"):
        found.append(f"{name}: includes {PARTS}; include simulation/simulation_view.hpp instead")
    if not name.startswith("bench/"):
        found += [f"{name}: includes {h}, which only bench/ may" for h in includes if COMPETITORS.match(h)]
    if name.startswith("examples/"):
        found += [f"{name}: includes {h}, which is not public" for h in includes if "/" in h and h not in ROOM_OF and h != EVERYTHING]
    if name == f"include/{EVERYTHING}":
        return found + [f"{name}: does not include {h}" for h in sorted(set(ROOM_OF) - OPTIONAL - set(includes))]
    public = name.startswith("include/")
    if not public and not name.startswith("src/"):
        return found
    room = ROOM_OF.get(name[len("include/"):]) if public else path.parent.relative_to("src").as_posix()
    if room not in ROOMS:
        return found + [f"{name}: is in no room; tools/check_includes.py lists them"]
    return found + [f"{name}: must not include {h}" for h in includes if not allowed(h, room, public)]


def problems_of_surface() -> list[str]:
    """Whether the public headers are those listed, few and short, each with something of its own."""
    headers = sorted(pathlib.Path("include/dartcast").glob("*.hpp"))
    found = [] if len(headers) <= MOST_HEADERS else [f"include/dartcast: {len(headers)} headers; at most {MOST_HEADERS}"]
    for path in headers:
        text = path.read_text(encoding="utf-8")
        lines = text.splitlines()
        if len(lines) > MOST_LINES:
            found.append(f"{path}: {len(lines)} lines; at most {MOST_LINES}")
        code = [line for line in lines if not re.match(r"\s*(//|#|$)", line)]
        if not code and path.as_posix() != f"include/{EVERYTHING}":
            found.append(f"{path}: only includes other headers")
    missing = {f"include/{h}" for h in ROOM_OF} - {p.as_posix() for p in headers}
    return found + [f"{h}: is listed in tools/check_includes.py but does not exist" for h in sorted(missing)]


def main() -> int:
    roots = ("include", "src", "apps", "bench", "examples", "tests")
    files = [p for root in roots for p in sorted(pathlib.Path(root).rglob("*")) if p.suffix in SUFFIXES]
    found = [line for path in files for line in problems_of(path)] + problems_of_surface()
    print("\n".join(found + [f"{len(files)} files, {len(found)} mistakes"]))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
