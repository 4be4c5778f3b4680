#!/usr/bin/env python3
"""Checks what documents say against what exists: links, ./dev commands, dartcast verbs; and paths of all files."""
import os
import pathlib
import re
import sys

MOST_COLUMNS = 110
MOST_IN_CELL = 120
SKIPPED_FOLDERS = {".git", "build", "__pycache__", ".cache", ".mypy_cache", ".pytest_cache", "node_modules"}
LINK = re.compile(r"\[[^\]]*\]\(([^)\s#]+)(?:#[^)\s]*)?\)")
CODE = re.compile(r"```.*?```|`[^`\n]+`", re.DOTALL)
DEV_COMMAND = re.compile(r"\./dev ([a-z][a-z0-9]*)")
VERB = re.compile(r"(?:^|[\s`/$])(?<!import )dartcast ([a-z]+)\b")
MACHINE_PATH = re.compile(r"(?<![\w.])/(?:home/\w|root/|work/|Users/\w)")


def own_files() -> list[pathlib.Path]:
    found = []
    for folder, folders, names in os.walk("."):
        folders[:] = sorted(f for f in folders if f not in SKIPPED_FOLDERS)
        found += [pathlib.Path(folder, name) for name in sorted(names)]
    return found


def commands_of_dev() -> set[str]:
    """The commands that ./dev takes: the labels of its last case."""
    cases = pathlib.Path("dev").read_text(encoding="utf-8").rsplit("\ncase ", 1)[1]
    labels = re.findall(r"^  ([a-z][a-z0-9 |-]*)\)", cases, re.MULTILINE)
    return {word.strip() for label in labels for word in label.split("|")}


def verbs_of_app() -> set[str]:
    sources = pathlib.Path("apps/dartcast").glob("*.cpp")
    return {verb for p in sources for verb in re.findall(r'add_subcommand\(\s*"([a-z]+)"', p.read_text(encoding="utf-8"))}


def long_lines(path: pathlib.Path, text: str) -> list[str]:
    """Lines that are too long to read, but for addresses and for what a program prints; and cells of tables."""
    found = []
    is_printed = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith("```"):
            is_printed = line == "```text"
        if line.startswith("|"):
            found += [f"{path}:{number}: a cell of over {MOST_IN_CELL} characters" for cell in line.split("|")
                      if len(cell.strip()) > MOST_IN_CELL]
        elif len(line) > MOST_COLUMNS and not is_printed and "](" not in line and "http" not in line:
            found.append(f"{path}:{number}: a line of over {MOST_COLUMNS} columns")
    return found


def check_document(path: pathlib.Path, commands: set[str], verbs: set[str]) -> list[str]:
    text = path.read_text(encoding="utf-8")
    found = long_lines(path, text) if path.parts[0] in ("docs", "site") or path.name == "README.md" else []
    folder = pathlib.Path("docs") if path.parent.name == "site" else path.parent  # the site's own pages are beside those
    for target in LINK.findall(CODE.sub("", text)):
        if not re.match(r"[a-z]+:", target) and not (folder / target).exists():
            found.append(f"{path}: the link to {target} leads nowhere")
    for code in CODE.findall(text):
        found += [f"{path}: ./dev {c} does not exist" for c in DEV_COMMAND.findall(code) if c not in commands]
        found += [f"{path}: dartcast {v} does not exist" for v in VERB.findall(code) if v not in verbs]
    return found


def check_file(path: pathlib.Path) -> list[str]:
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except UnicodeDecodeError:
        return []  # binary
    found = [f"{path}:{i}: a path of somebody's machine" for i, line in enumerate(lines, 1) if MACHINE_PATH.search(line)]
    return found


def main() -> int:
    files = own_files()
    documents = [p for p in files if p.suffix == ".md"]
    commands, verbs = commands_of_dev(), verbs_of_app()
    found = [line for path in documents for line in check_document(path, commands, verbs)]
    found += [line for path in files for line in check_file(path)]
    print("\n".join(found + [f"{len(documents)} documents, {len(files)} files, {len(found)} mistakes"]))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
