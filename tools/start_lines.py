#!/usr/bin/env python3
"""Writes what a reader of docs/start.md types as files into a folder: start_lines.py FOLDER. tools/try_packages.sh runs them.

Each task of the page is a section, and so a folder: its files, and run.sh with its lines in their order.
"""
import pathlib
import re
import sys

PAGE = pathlib.Path(__file__).resolve().parent.parent / "docs" / "start.md"
BLOCK = re.compile(r"```(\w*)\n(.*?)```", re.DOTALL)
# The sections, and the files that their blocks are; a block without a language is lines for the shell.
TASKS = {
    "Install": ("install", {}),
    "From a surface to deposited particles, without code": ("surface", {"toml": "deposit.toml"}),
    "Your own deformation, in Python": ("deformation", {"python": "deformation.py", "text": "expected.txt"}),
    "A program in C++": ("program", {"cpp": "first.cpp", "cmake": "CMakeLists.txt"}),
}
# Lines that build from the sources: their packages are there already.
BUILD = re.compile(r"^(\./dev|cmake --install|export PATH|pip install)\b.*\n", re.MULTILINE)
PYTHON = "python3 deformation.py | diff - expected.txt\n"


def write_task(folder: pathlib.Path, files: dict[str, str], section: str) -> None:
    folder.mkdir(parents=True)
    lines = "set -e\n"
    for language, text in BLOCK.findall(section):
        if language:
            (folder / files[language]).write_text(text, encoding="utf-8")
        else:
            lines += BUILD.sub("", text)
    if "python" in files:
        lines += PYTHON
    (folder / "run.sh").write_text(lines, encoding="utf-8")


def main() -> None:
    sections = dict(part.partition("\n")[::2] for part in PAGE.read_text(encoding="utf-8").split("\n## ")[1:])
    for title, (folder, files) in TASKS.items():
        write_task(pathlib.Path(sys.argv[1], folder), files, sections[title])


if __name__ == "__main__":
    main()
