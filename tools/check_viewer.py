#!/usr/bin/env python3
"""Checks that viewer/viewer.min.js was built from the sources beside it.

Its first line names the SHA-256 of the sources. Where esbuild is installed (npm ci in viewer/) the bundle is built
again, too, and compared byte by byte.
"""
import hashlib
import pathlib
import re
import subprocess
import sys
import tempfile

VIEWER = pathlib.Path("viewer")


def hash_of_sources() -> str:
    """As viewer/build.mjs computes it."""
    names = ["build.mjs", "package-lock.json", "package.json"] + [f"src/{p.name}" for p in sorted((VIEWER / "src").iterdir())]
    digest = hashlib.sha256()
    for name in names:
        digest.update(f"{name}\n".encode())
        digest.update((VIEWER / name).read_bytes())
    return digest.hexdigest()


def mistakes() -> list[str]:
    bundle = (VIEWER / "viewer.min.js").read_text(encoding="utf-8")
    found = []
    named = re.match(r"/\* dartcast viewer, sources SHA-256 ([0-9a-f]{64}) \*/\n", bundle)
    if named is None or named.group(1) != hash_of_sources():
        found.append("viewer/viewer.min.js is older than its sources: run npm ci and npm run build in viewer/")
    if "</script" in bundle:
        found.append('viewer/viewer.min.js holds "</script", which would end it in a page')
    if "SPDX-License-Identifier: MIT" not in bundle and "@license" not in bundle:
        found.append("viewer/viewer.min.js has lost the licence of three.js")
    if not found and (VIEWER / "node_modules" / "esbuild").exists():
        with tempfile.TemporaryDirectory() as folder:
            built = pathlib.Path(folder) / "viewer.min.js"
            subprocess.run(["node", "build.mjs", str(built)], cwd=VIEWER, check=True)
            if built.read_text(encoding="utf-8") != bundle:
                found.append("viewer/viewer.min.js differs from what its sources make: run npm run build in viewer/")
    return found


def main() -> int:
    found = mistakes()
    for mistake in found:
        print(mistake)
    print(f"the viewer's bundle, {len(found)} mistakes")
    return int(bool(found))


if __name__ == "__main__":
    sys.exit(main())
