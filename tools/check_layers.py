#!/usr/bin/env python3
"""Checks who includes whom: a folder includes only folders to its left, and each dependency stays in its place."""
import pathlib
import re
import sys

LAYERS = ["base", "exact", "mesh", "map", "geometry", "remesh", "surgery", "walk", "environment", "surface",
          "spheres", "response", "bodies", "simulation", "io"]

# Third-party headers, and the folders of src/dartcast that may include them: in .cpp files and in headers that are not
# installed, for whoever uses the library needs only its own headers.
THIRD_PARTY = [
    (re.compile(r"^(vtk|vtk-)"), {"io"}),
    (re.compile(r"^(tbb|oneapi)/"), {"base"}),
    (re.compile(r"^Eigen/"), set(LAYERS)),
    (re.compile(r"^boost/"), set(LAYERS)),
    (re.compile(r"^fmt/"), set(LAYERS)),
    (re.compile(r"^nlohmann/"), {"simulation", "io"}),
    (re.compile(r"^toml\+\+/"), {"simulation", "io"}),
]
# Competitors' headers, and the one folder that may include them.
COMPETITORS = re.compile(r"^(Bullet|LinearMath/|bt[A-Z]|embree)")
# Code that must stay independent of the walk's predicates, so that it can judge them.
INDEPENDENT = re.compile(r"(^tests/oracle/|/audit[a-z_]*\.[ch]pp$)")
PREDICATES = re.compile(r"^dartcast/exact/(?!vec3\.hpp)")

STANDARD = re.compile(r"^([a-z_]+|sys/[a-z]+\.h|(fcntl|unistd|immintrin)\.h)$")

# Headers that are not installed, by the list in CMakeLists.txt.
PRIVATE = set(re.search(r"set\(private_headers ([^)]*)\)", pathlib.Path("CMakeLists.txt").read_text()).group(1).split())

INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.MULTILINE)


def allowed(header: str, folder: str, installed: bool) -> bool:
    """Whether a file of a folder of src/dartcast may include a header."""
    if header.startswith("dartcast/"):
        target = header.split("/")[1]
        file = pathlib.Path("src", header)
        if installed and file.as_posix() in PRIVATE:
            return False
        return target in LAYERS[: LAYERS.index(folder) + 1] and file.is_file()
    for pattern, folders in THIRD_PARTY:
        if pattern.match(header):
            return folder in folders and not installed
    return STANDARD.match(header) is not None


def problems_of(path: pathlib.Path) -> list[str]:
    """What is wrong with the includes of one file under src/dartcast, apps, bench, examples or tests."""
    name = path.as_posix()
    parts = path.parts
    folder = parts[2] if parts[0] == "src" else None
    installed = path.suffix == ".hpp" and name not in PRIVATE
    found = []
    if folder is not None and folder not in LAYERS:
        return [f"{name}: '{folder}' is no layer; tools/check_layers.py lists them"]
    for header in INCLUDE.findall(path.read_text(encoding="utf-8")):
        if INDEPENDENT.search(name) and PREDICATES.match(header):
            found.append(f"{name}: includes {header}, which it is there to judge")
        if parts[0] != "bench" and COMPETITORS.match(header):
            found.append(f"{name}: includes {header}, which only bench/ may")
        if folder is not None and not allowed(header, folder, installed):
            found.append(f"{name}: must not include {header}")
    return found


def main() -> int:
    files = [p for root in ("src", "apps", "bench", "examples", "tests") for p in sorted(pathlib.Path(root).rglob("*.[ch]pp"))]
    found = [line for path in files for line in problems_of(path)]
    print("\n".join(found + [f"{len(files)} files, {len(found)} wrong includes"]))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
