#!/usr/bin/env python3
"""Reads the public headers: every name a user sees, with the comment that documents it.

The Python package takes its docstrings from here, and its tests compare the names with those of Python. Phases: the text
becomes tokens (comments kept), then scopes are followed, and each declaration gets the comment before or behind it.
"""
from __future__ import annotations

import dataclasses
import pathlib
import re
import sys

TOKEN = re.compile(
    r"(?P<behind>///<[^\n]*)|(?P<doc>///[^\n]*)|(?P<comment>//[^\n]*)|(?P<macro>^[ \t]*#(?:\\\n|[^\n])*)"
    r"|(?P<text>\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])*')|(?P<word>\w[\w.']*|::|\S)|(?P<line>\n)", re.MULTILINE)
TYPE = re.compile(r"(?:template <.*> )?(class|struct|enum class|enum)\b(?: \[ \[ .*? \] \])* (\w+)")
SKIPPED = ("friend ", "static_assert ", "extern ", "using namespace ", "typedef ")


@dataclasses.dataclass
class Name:
    """A public name: `Environment::advance`, without the namespace dartcast."""
    name: str
    kind: str  # class, enum, value, function, member, constant, alias
    doc: str
    header: str
    line: int
    declaration: str


class Reader:
    """One header. `names` holds what was found, in order."""

    def __init__(self, path: pathlib.Path) -> None:
        self.header = path.name
        self.names: list[Name] = []
        self.tokens: list[tuple[str, str, int]] = []
        line = 1
        for match in TOKEN.finditer(path.read_text(encoding="utf-8")):
            kind = match.lastgroup or ""
            if kind not in ("comment", "macro", "line"):
                self.tokens.append((kind, match.group(), line))
            line += match.group().count("\n")
        self.at = 0

    def read(self) -> list[Name]:
        while self.at < len(self.tokens):
            self.scope("", "class")
        return self.names

    def scope(self, prefix: str, kind: str) -> None:
        """Reads declarations up to the bracket that closes the scope."""
        public = kind != "private"
        doc: list[str] = []
        declaration: list[str] = []
        before = len(self.names)
        while self.at < len(self.tokens):
            token, text, line = self.tokens[self.at]
            self.at += 1
            if token == "doc":
                doc.append(text[4:])
            elif token == "behind":
                self.behind(before, text, line)
            elif text == "}":
                return
            elif text == ":" and declaration in (["public"], ["private"], ["protected"]):
                public = declaration == ["public"]
                declaration, doc = [], []
            elif text == "{" and declaration.count("(") > declaration.count(")"):  # a default argument
                self.skip_block()
                declaration.append("{}")
            elif text in "{;" and token == "word":
                before = len(self.names)
                self.finish(prefix, kind, " ".join(declaration), text, "\n".join(doc), line, public)
                declaration, doc = [], []
            else:
                declaration.append(text)

    def finish(self, prefix: str, kind: str, text: str, end: str, doc: str, line: int, public: bool) -> None:
        """A declaration that ends with `;`, or goes on with `{`."""
        if end == "{" and re.match(r"namespace\b|extern\b", text):
            if text == "namespace dartcast":
                return self.scope("", "class")
            return self.skip_block()
        opened = TYPE.match(text)
        if end == "{" and opened and "(" not in re.sub(r"\[ \[.*?\] \]|alignas \(.*?\)", "", text):
            what, name = opened.groups()
            # A specialization of another namespace's template is none of ours.
            hidden = not public or text[opened.end():].startswith(" ::")
            self.add(prefix + name, "enum" if what.startswith("enum") else "class", doc, line, text, not hidden)
            if what.startswith("enum"):
                return self.enum_values(prefix + name + "::", not hidden)
            return self.scope(prefix + name + "::", "private" if what == "class" else "class") if not hidden \
                else self.skip_block()
        if end == "{":
            self.skip_block()
            is_value = "(" not in text or re.search(r"= (?!default|delete)", text.rsplit(")", 1)[-1])
            if is_value:
                while self.tokens[self.at][1] != ";":
                    self.at += 1
            if self.at < len(self.tokens) and self.tokens[self.at][1] == ";":
                self.at += 1
        if public and text and not text.startswith(SKIPPED) and not text.endswith("= delete"):
            self.declare(prefix, text, doc, line)

    def declare(self, prefix: str, text: str, doc: str, line: int) -> None:
        """A function, a variable or an alias. Several variables may share one declaration."""
        text = re.sub(r"^(\[ \[.*?\] \] )+|^template < .*? > (?=\w)", "", text)
        text = re.sub(r"^(\[ \[.*?\] \] )+", "", text)
        alias = re.match(r"using (\w+) =", text)
        if alias:
            return self.add(prefix + alias.group(1), "alias", doc, line, text)
        if text.startswith("using "):
            return None  # a name of a base
        if TYPE.match(text):
            return None  # declared here, defined elsewhere
        plain = re.sub(r"\[ \[.*?\] \] ", "", text)
        function = re.match(r"[^(=]*?(~? ?\w+|operator .*?) \(", plain)
        if function and not re.match(r"[^(]*<[^>]*$", plain[:function.start(1)]):
            return self.add(prefix + function.group(1).replace(" ", ""), "function", doc, line, text)
        for part in self.split(plain):
            name = re.match(r".*?(\w+)(?: \[.*\])?(?: =.*)?$", part)
            if name:
                constant = "constexpr" in plain or (not prefix and "const" in plain)
                self.add(prefix + name.group(1), "constant" if constant else "member", doc, line, text)
        return None

    @staticmethod
    def split(text: str) -> list[str]:
        """The variables of one declaration: parts between commas that are in no brackets."""
        parts, depth = [""], 0
        for word in text.split():
            depth += (word in "([{<") - (word in ")]}>")
            if word == "," and depth == 0:
                parts.append("")
            else:
                parts[-1] += f" {word}"
        return [p.split(" = ")[0].strip() for p in parts]

    def enum_values(self, prefix: str, public: bool) -> None:
        doc: list[str] = []
        expects = True
        while self.at < len(self.tokens):
            token, text, line = self.tokens[self.at]
            self.at += 1
            if token == "doc":
                doc.append(text[4:])
            elif token == "behind":
                self.behind(len(self.names) - 1, text, line)
            elif text == "}":
                return
            elif text == ",":
                expects = True
            elif expects:
                self.add(prefix + text, "value", "\n".join(doc), line, text, public)
                expects, doc = False, []

    def behind(self, first: int, text: str, line: int) -> None:
        """A comment behind a declaration belongs to what was declared last; its further lines follow."""
        lines = [text[5:]]
        while self.at < len(self.tokens) and self.tokens[self.at][0] == "behind":
            lines.append(self.tokens[self.at][1][5:])
            self.at += 1
        for name in self.names[max(first, 0):] or self.names[-1:]:
            name.doc = (name.doc + "\n" if name.doc else "") + "\n".join(lines).strip()

    def skip_block(self) -> None:
        depth = 1
        while depth and self.at < len(self.tokens):
            text = self.tokens[self.at][1]
            depth += (text == "{") - (text == "}")
            self.at += 1

    def add(self, name: str, kind: str, doc: str, line: int, text: str, public: bool = True) -> None:
        if public:
            self.names.append(Name(name, kind, doc.strip(), self.header, line, text))


def read_headers(folder: pathlib.Path) -> list[Name]:
    """All public names of the headers in a folder."""
    return [name for path in sorted(folder.glob("*.hpp")) for name in Reader(path).read()]


def main() -> int:
    for name in read_headers(pathlib.Path(__file__).parent.parent / "include" / "dartcast"):
        print(f"{name.header}:{name.line}: {name.kind} {name.name}: {name.doc[:60]!r}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
