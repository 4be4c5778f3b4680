#!/usr/bin/env python3
"""Checks sizes: no function over 60 lines, no source file over 600."""
import pathlib
import re
import sys

MAX_FUNCTION = 60
MAX_FILE = 600
ROOTS = ("include", "src", "apps", "bench", "examples", "python", "tests", "tools", "cmake")
CPP = {".hpp", ".cpp", ".inl"}
COUNTED = CPP | {".py", ".cmake", ".sh"}
PIECE = re.compile(
    r"//[^\n]*|/\*.*?\*/|R\"\((?:.*?)\)\"|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])*'|^[ \t]*#(?:\\\n|[^\n])*|\w+|[{}()]|\S|\n",
    re.DOTALL | re.MULTILINE)
# What stands between the parameters of a function and its body.
QUALIFIERS = {"const", "noexcept", "override", "final", "mutable"}


def long_functions(text: str) -> list[tuple[int, int]]:
    """First line and length of each block over the limit that follows a parameter list: functions, tests, lambdas."""
    found, opened, line, before = [], [], 1, ""
    for match in PIECE.finditer(text):
        word = match.group()
        if word == "{":
            opened.append((line, before == ")"))
        elif word == "}" and opened:
            first, is_function = opened.pop()
            if is_function and line - first + 1 > MAX_FUNCTION:
                found.append((first, line - first + 1))
        if not word.isspace() and not word.startswith(("//", "/*")) and word not in QUALIFIERS:
            before = word
        line += word.count("\n")
    return found


def main() -> int:
    found = []
    files = [p for root in ROOTS for p in sorted(pathlib.Path(root).rglob("*")) if p.suffix in COUNTED]
    for path in files:
        text = path.read_text(encoding="utf-8")
        lines = text.count("\n")
        if lines > MAX_FILE:
            found.append(f"{path}: {lines} lines; a file has at most {MAX_FILE}")
        if path.suffix in CPP:
            found += [f"{path}:{first}: a function of {length} lines; at most {MAX_FUNCTION}"
                      for first, length in long_functions(text)]
    print("\n".join(found + [f"{len(files)} files, {len(found)} too long"]))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
