#!/usr/bin/env python3
"""Puts together the pages of the site: make_site.py OUT. Sphinx then builds it (site/conf.py).

Phases: the documents of docs/ as they are, with links to files outside of it led to pages of the site; README's pictures;
pages with the examples; the reference of C++ from Doxygen's XML, a page for each public header; that of Python, from the
stubs and the comments of the headers.
"""
from __future__ import annotations

import ast
import os
import pathlib
import re
import shutil
import sys

import check_includes
import make_bindings
import read_headers

ROOT = pathlib.Path(__file__).resolve().parent.parent


LINK = re.compile(r"(!?\[[^\]]*\])\(([^)\s#]+)((?:#[^)\s]*)?)\)")
LINK_AROUND_PICTURE = re.compile(r"(\)\])\(([^)#\s]+)((?:#[^)]*)?)\)")  # its end
SECTION = re.compile(r"# --- (\w+\.hpp)\n(.*?)# --- end of ", re.DOTALL)
PROJECT_PAGES = {"README.md": "readme.md", "CONTRIBUTING.md": "contributing.md", "CHANGELOG.md": "changelog.md"}


def example_pages() -> dict[pathlib.Path, str]:
    """The sources of the examples, and the heading of each on its page."""
    sources = [*sorted((ROOT / "examples").glob("*.cpp")), *sorted((ROOT / "examples").glob("degenerate/*.cpp"))]
    found = {path: "examples.md" for path in sources}
    found |= {path: "examples_python.md" for path in sorted((ROOT / "examples" / "python").glob("*.py"))}
    found |= {path: "examples_scenes.md" for path in sorted((ROOT / "scenes").glob("*.toml"))}
    return found


def anchor(name: str) -> str:
    """As MyST makes it of a heading."""
    return re.sub(r"[^\w-]", "", name.lower().replace(" ", "-"))


def led_to_pages(text: str, origin: pathlib.Path, place: pathlib.PurePosixPath, examples: dict[pathlib.Path, str]) -> str:
    """Links that leave docs/ lead to pages of the site. `place`: of the page in the site."""
    up = "../" * (len(place.parts) - 1)

    def led(match: re.Match[str]) -> str:
        label, target, rest = match.groups()
        if re.match(r"[a-z]+:", target):
            return match.group()
        path = pathlib.Path(os.path.normpath(origin.parent / target))
        if path in examples:
            return f"{label}({up}{examples[path]}#{anchor(path.name)})"
        if path.is_relative_to(ROOT / "docs") and path.is_file():
            return f"{label}({up}{path.relative_to(ROOT / 'docs').as_posix()}{rest})"
        if path.parent == ROOT and path.name in PROJECT_PAGES:
            return f"{label}({up}{PROJECT_PAGES[path.name]}{rest})"
        if path == ROOT / "examples" / "python":
            return f"{label}({up}examples_python.md)"
        return f"{label.strip('![]')} (`{path.relative_to(ROOT).as_posix()}`)"

    code = re.split(r"(```.*?```)", text, flags=re.DOTALL)
    return "".join(part if i % 2 else LINK_AROUND_PICTURE.sub(led, LINK.sub(led, part)) for i, part in enumerate(code))


def copy_documents(out: pathlib.Path, examples: dict[pathlib.Path, str]) -> None:
    for path in sorted((ROOT / "docs").rglob("*")):
        place = out / path.relative_to(ROOT / "docs")
        if path.is_dir():
            place.mkdir(parents=True, exist_ok=True)
        elif path.suffix == ".md":
            name = pathlib.PurePosixPath(path.relative_to(ROOT / "docs").as_posix())
            place.write_text(led_to_pages(path.read_text(encoding="utf-8"), path, name, examples), encoding="utf-8")
        else:
            shutil.copy(path, place)
    for name, page in PROJECT_PAGES.items():
        text = (ROOT / name).read_text(encoding="utf-8")
        (out / page).write_text(led_to_pages(text, ROOT / name, pathlib.PurePosixPath(page), examples), encoding="utf-8")


def link_to_live_scenes(out: pathlib.Path) -> None:
    """./dev docs makes the page, if the command and the engine for browsers are built."""
    if all((ROOT / "build" / name).exists() for name in ("wasm/package/dartcast.wasm", "release/bin/dartcast")):
        with (out / "live.md").open("a", encoding="utf-8") as page:
            page.write('\nThe page itself is here: <a href="live_scenes.html">live scenes</a>.\n')


def list_decisions(out: pathlib.Path) -> None:
    names = sorted(p.stem for p in (out / "decisions").glob("[0-9]*.md"))
    with (out / "decisions" / "README.md").open("a", encoding="utf-8") as page:
        page.write("\n```{toctree}\n:hidden:\n\n" + "\n".join(names) + "\n```\n")


def write_examples(out: pathlib.Path, examples: dict[pathlib.Path, str]) -> None:
    titles = {"examples.md": ("Examples in C++", "cpp"), "examples_python.md": ("Examples in Python", "python"),
              "examples_scenes.md": ("Scenes", "toml")}
    for page, (title, language) in titles.items():
        parts = [f"# {title}\n\nEach is run by the tests.\n"]
        for path in (p for p, at in examples.items() if at == page):
            parts.append(f"## {path.name}\n\n```{language}\n{path.read_text(encoding='utf-8').rstrip()}\n```\n")
        (out / page).write_text("\n".join(parts), encoding="utf-8")


def heading_of(header: pathlib.Path) -> str:
    """The first sentence of a header's comment."""
    lines = []
    for line in header.read_text(encoding="utf-8").splitlines():
        if not line.startswith("//"):
            break
        lines.append(line[2:].strip())
    return " ".join(lines).partition(". ")[0].rstrip(".")


def write_cpp(out: pathlib.Path) -> None:
    """A page for each part of the library, with its headers."""
    folder = out / "cpp"
    folder.mkdir()
    rows = []
    for room, names in check_includes.PUBLIC.items():
        page = [f"# {room} (C++)", ""]
        for name in names.split():
            title = heading_of(ROOT / "include" / "dartcast" / f"{name}.hpp")
            rows.append(f"| [dartcast/{name}.hpp]({room}.md#{anchor(f'dartcast/{name}.hpp')}) | {title} |")
            page += [f"## dartcast/{name}.hpp", "", f"{title}.", "", "```{eval-rst}", f".. doxygenfile:: {name}.hpp",
                     "   :project: dartcast", "```", ""]
        (folder / f"{room}.md").write_text("\n".join(page), encoding="utf-8")
    toc = "\n".join(check_includes.PUBLIC)
    (folder / "index.md").write_text(
        "# C++\n\n`#include \"dartcast/dartcast.hpp\"` includes all of these. Link `dartcast::dartcast`; the libraries "
        "`dartcast::core`, `dartcast::simulation` and `dartcast::io` are its parts.\n\n| header | subject |\n|---|---|\n"
        + "\n".join(rows) + f"\n\n```{{toctree}}\n:hidden:\n\n{toc}\n```\n", encoding="utf-8")


def without_aliases(stub: str) -> str:
    """With what the short private names of types stand for in their place: a reader does not know them."""
    for name, meaning in re.findall(r"^(_\w+) = (.{1,80})$", stub, re.MULTILINE):
        stub = re.sub(rf"(?<![\w.]){name}\b(?! =)", lambda _, text=meaning: text, stub)
    return stub


class PythonPages:
    """The reference of Python: signatures of the stubs, and comments of the headers."""

    def __init__(self) -> None:
        self.docs: dict[str, str] = {}
        for name in read_headers.read_headers(ROOT / "include" / "dartcast"):
            if name.doc:
                self.docs.setdefault(name.name.replace("::", "."), make_bindings.python_text(name.doc))

    def text_of(self, name: str, indent: str) -> list[str]:
        doc = self.docs.get(name, "")
        escaped = re.sub(r"([*_|\\])", r"\\\1", re.sub(r"`([^`]*)`", r"``\1``", doc))
        lines = []
        in_list = False
        for line in (line.strip() for line in escaped.splitlines()):
            is_item = line.startswith("- ")
            if is_item and not in_list:
                lines.append("")
            in_list = is_item or (in_list and line != "")
            lines.append(f"{indent}{'  ' if in_list and not is_item else ''}{line}".rstrip())
        return [*lines, ""]

    def function(self, node: ast.FunctionDef, prefix: str, indent: str) -> list[str]:
        names = [ast.unparse(d) for d in node.decorator_list]
        full = f"{prefix}{node.name}"
        if "property" in names:
            kind = f".. py:attribute:: {full}"
            about = [f"{indent}   :type: {ast.unparse(node.returns)}"] if node.returns else []
        else:
            node.args.args = [a for a in node.args.args if a.arg not in ("self", "cls")]
            static = "staticmethod" in names or "classmethod" in names
            directive = ("py:staticmethod" if static else "py:method") if prefix else "py:function"
            returns = f" -> {ast.unparse(node.returns)}" if node.returns and node.name != "__init__" else ""
            kind = f".. {directive}:: {full}({ast.unparse(node.args)}){returns}"
            about = [f"{indent}   :noindex:"] if "overload" in names else []
        return [indent + kind, *about, "", *self.text_of(full, indent + "   ")]

    def class_of(self, node: ast.ClassDef) -> list[str]:
        lines = [f".. py:class:: {node.name}", "", *self.text_of(node.name, "   ")]
        setters = re.compile(r"\.(setter|deleter)$")
        for part in node.body:
            if isinstance(part, ast.FunctionDef):
                if part.name.startswith("__") and part.name != "__init__":
                    continue
                if any(setters.search(ast.unparse(d)) for d in part.decorator_list):
                    continue
                lines += self.function(part, node.name + ".", "   ")
            elif isinstance(part, ast.Assign):
                lines += [f"   .. py:attribute:: {node.name}.{ast.unparse(part.targets[0])}", ""]
        return lines

    def page(self, section: str) -> list[str]:
        lines = []
        for node in ast.parse(section).body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                lines += self.class_of(node)
            elif isinstance(node, ast.FunctionDef) and not node.name.startswith("_"):
                lines += self.function(node, "", "")
        return lines

    def write(self, out: pathlib.Path) -> None:
        folder = out / "py"
        folder.mkdir()
        stub = without_aliases((ROOT / "python" / "dartcast" / "_core.pyi").read_text(encoding="utf-8"))
        names = []
        for header, section in SECTION.findall(stub):
            path = ROOT / "include" / "dartcast" / header
            title = heading_of(path)
            name = header.removesuffix(".hpp")
            names.append((name, title))
            page = [f"# {name} (Python)", "", f"{title}.", "", "```{eval-rst}", *self.page(section), "```", ""]
            (folder / f"{name}.md").write_text("\n".join(page), encoding="utf-8")
        rows = "\n".join(f"| [{name}]({name}.md) | {title} |" for name, title in names)
        toc = "\n".join(name for name, _ in names)
        (folder / "index.md").write_text(
            "# Python\n\nThe names are in the module `dartcast`, or in `dartcast.topology`, `.predicates`, `.formats` or `.records`. The parts are those of the C++ headers. "
            "[A tour](../python.md) shows how they are used.\n\n| part | subject |\n|---|---|\n"
            f"{rows}\n\n```{{toctree}}\n:hidden:\n\n{toc}\n```\n", encoding="utf-8")


def main() -> int:
    out = pathlib.Path(sys.argv[1])
    shutil.rmtree(out, ignore_errors=True)
    shutil.copytree(ROOT / "site", out, ignore=shutil.ignore_patterns("Doxyfile"))
    examples = example_pages()
    copy_documents(out, examples)
    link_to_live_scenes(out)
    list_decisions(out)
    write_examples(out, examples)
    write_cpp(out)
    PythonPages().write(out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
