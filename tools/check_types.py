#!/usr/bin/env python3
"""Checks that one name means one type: no two types of src/ and include/ at namespace scope share a name."""
import collections
import pathlib
import re
import sys

TOKEN = re.compile(
    r"//[^\n]*|/\*.*?\*/|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])*'|^[ \t]*#(?:\\\n|[^\n])*|[A-Za-z_]\w*|::|[{}();<>=:,\[\]]|\n",
    re.DOTALL | re.MULTILINE)
KEYWORDS = {"class", "struct", "union", "enum"}
# Between the keyword and the name.
SKIPPED = {"alignas", "final"}


def tokens_of(text: str) -> list[tuple[str, int]]:
    """Words and brackets, each with its line; comments, strings and preprocessor lines left out."""
    found, line = [], 1
    for match in TOKEN.finditer(text):
        word = match.group()
        if re.match(r"[A-Za-z_{}();<>=:,\[\]]", word):
            found.append((word, line))
        line += word.count("\n")
    return found


def end_of_brackets(tokens: list[tuple[str, int]], i: int, opening: str, closing: str) -> int:
    """The index after the bracket that closes the one at i."""
    depth = 0
    while i < len(tokens):
        depth += (tokens[i][0] == opening) - (tokens[i][0] == closing)
        i += 1
        if depth == 0:
            break
    return i


def declared(tokens: list[tuple[str, int]], i: int) -> tuple[str, int] | None:
    """The name and line of the type that the keyword at i defines; none for a declaration, a specialization, a use."""
    i += 1
    if tokens[i][0] in ("class", "struct"):
        i += 1  # enum class
    while True:
        if tokens[i][0] == "[":
            i = end_of_brackets(tokens, i, "[", "]")
        elif tokens[i][0] == "alignas":
            i = end_of_brackets(tokens, i + 1, "(", ")")
        else:
            break
    name = tokens[i]
    after = tokens[i + 1][0] if i + 1 < len(tokens) else ";"
    if not re.match(r"[A-Za-z_]", name[0]) or after not in ("{", ":", "final"):
        return None
    return name


def types_of(text: str) -> list[tuple[str, int]]:
    """Names and lines of the types that a file defines outside of other types and functions."""
    tokens = tokens_of(text)
    found, i = [], 0
    while i < len(tokens):
        word = tokens[i][0]
        if word == "namespace":
            while tokens[i][0] not in ("{", ";"):
                i += 1
        elif word == "template" and tokens[i + 1][0] == "<":
            i = end_of_brackets(tokens, i + 1, "<", ">") - 1
        elif word == "using" and tokens[i + 2][0] == "=":
            found.append(tokens[i + 1])
        elif word in KEYWORDS:
            name = declared(tokens, i)
            if name is not None:
                found.append(name)
            while tokens[i][0] not in ("{", ";", "("):
                i += 1
            continue
        elif word == "{":  # of a type, a function or a value
            i = end_of_brackets(tokens, i, "{", "}") - 1
        i += 1
    return found


def main() -> int:
    places = collections.defaultdict(list)
    for root in ("include", "src"):
        for path in sorted(pathlib.Path(root).rglob("*")):
            if path.suffix in {".hpp", ".cpp", ".inl"}:
                for name, line in types_of(path.read_text(encoding="utf-8")):
                    places[name].append(f"{path}:{line}")
    twice = {name: where for name, where in places.items() if len(where) > 1}
    for name, where in sorted(twice.items()):
        print(f"{name}: {', '.join(where)}")
    print(f"{len(places)} types, {len(twice)} names of more than one")
    return 1 if twice else 0


if __name__ == "__main__":
    sys.exit(main())
