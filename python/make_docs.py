#!/usr/bin/env python3
"""Writes the table of docstrings (docs.inl) from the comments of the public headers. Usage: make_docs.py HEADERS OUT."""
import collections
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tools"))

import read_headers  # noqa: E402

# C++ words of the headers, and what Python says.
WORDS = [(r"\bThrows\b", "Raises"), (r"\bthrows\b", "raises"), (r"(\w)::(?=\w)", r"\1."), (r"\bnull\b", "None"),
         (r"\bstd\.", ""), (r"\bdartcast/(\w+)\.hpp", r"\1.hpp")]


BLANK = "\n\n"


def python_text(text: str) -> str:
    """A comment in the words of Python."""
    for pattern, words in WORDS:
        text = re.sub(pattern, words, text)
    return text


def quoted(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n") + '"'


def main() -> int:
    headers, out = map(pathlib.Path, sys.argv[1:3])
    texts: dict[str, list[str]] = collections.defaultdict(list)
    for name in read_headers.read_headers(headers):
        found = texts[name.name]
        if name.doc and name.doc not in found:
            found.append(name.doc)
    lines = [f"Entry{{{quoted(name)}, {quoted(python_text(BLANK.join(texts[name])))}}},\n" for name in sorted(texts)]
    content = "".join(lines)
    if not out.exists() or out.read_text(encoding="utf-8") != content:
        out.write_text(content, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
