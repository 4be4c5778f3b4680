#!/usr/bin/env python3
"""Writes docs/command.md from what the command itself prints: make_command_page.py DARTCAST [--check].

With --check it only says whether the page is as the command would have it.
"""
import pathlib
import re
import subprocess
import sys

PAGE = pathlib.Path(__file__).resolve().parent.parent / "docs" / "command.md"
HEAD = """# The command

`dartcast VERB ...`. Each verb ends with 0 where all is well, 1 where something is wrong with its input, 2 where
it was called in a wrong way, and 130 after Ctrl-C. Errors go to the standard error stream.

`tools/make_command_page.py` has made this page from `dartcast VERB --help`.
"""


def printed(*words: str) -> str:
    return subprocess.run(words, capture_output=True, text=True, check=True).stdout


def page_of(command: str) -> str:
    verbs = re.findall(r"^  (\w+)  +\S", printed(command, "--help").split("Subcommands:")[1], re.MULTILINE)
    parts = [HEAD]
    for verb in verbs:
        first, _, rest = printed(command, verb, "--help").strip().partition("\n")
        parts.append(f"## {verb}\n\n{first.strip()}\n\n```text\n{rest.strip()}\n```\n")
    return "\n".join(parts)


def main() -> int:
    text = page_of(sys.argv[1])
    if "--check" not in sys.argv:
        PAGE.write_text(text, encoding="utf-8")
        return 0
    if PAGE.read_text(encoding="utf-8") == text:
        return 0
    print(f"{PAGE.name} is not what the command prints: run tools/make_command_page.py {sys.argv[1]}")
    return 1


if __name__ == "__main__":
    sys.exit(main())
