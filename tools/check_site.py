#!/usr/bin/env python3
"""Checks a built site: check_site.py HTML. Every link within it leads to a page and a place; nothing comes from elsewhere."""
import pathlib
import re
import sys
import urllib.parse

LINK = re.compile(r'<a\b[^>]*\bhref="([^"]*)"')
LOADED = re.compile(r'<(?:link|script|img)\b[^>]*\b(?:href|src)="([^"]*)"')
PLACE = re.compile(r'\bid="([^"]*)"')
IMPORT = re.compile(r"@import\s+(?:url\()?[\"']?([^\"')]+)")


def pages_of(folder: pathlib.Path) -> dict[pathlib.Path, str]:
    return {path.resolve(): path.read_text(encoding="utf-8") for path in sorted(folder.rglob("*.html"))}


def check_link(page: pathlib.Path, target: str, places: dict[pathlib.Path, set[str]]) -> str:
    """What is wrong with it; empty: nothing."""
    if re.match(r"[a-z]+:", target):
        return ""
    path, _, place = urllib.parse.unquote(target).partition("#")
    file = (page.parent / path).resolve() if path else page
    if not file.exists():
        return f"{page.name}: the link to {target} leads nowhere"
    if place and file in places and place not in places[file]:
        return f"{page.name}: {file.name} has no place {place}"
    return ""


def main() -> int:
    folder = pathlib.Path(sys.argv[1])
    pages = pages_of(folder)
    places = {path: set(PLACE.findall(text)) for path, text in pages.items()}
    found = []
    for path, text in pages.items():
        found += [wrong for target in LINK.findall(text) if (wrong := check_link(path, target, places))]
        found += [f"{path.name} loads {url}" for url in LOADED.findall(text) if re.match(r"(https?:)?//", url)]
    print("\n".join([*sorted(set(found)), f"{len(pages)} pages, {len(set(found))} mistakes"]))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
