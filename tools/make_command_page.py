#!/usr/bin/env python3
"""Writes docs/command.md and the manual page docs/dartcast.1 from what the command prints: make_command_page.py DARTCAST.

With --check it only says whether they are as the command would have them.
"""
import pathlib
import re
import subprocess
import sys
import textwrap

DOCS = pathlib.Path(__file__).resolve().parent.parent / "docs"
STATUS = ("Each verb ends with 0 where all is well, 1 where something is wrong with its input, 2 where it was called in a "
          "wrong way, and 130 after Ctrl-C. Errors go to the standard error stream.")
COMPLETION = "Bash and zsh complete verbs and options of an installed command. For any other, a line turns this on:"
TURN_ON = "source <(dartcast completion bash)"


def printed(*words: str) -> str:
    return subprocess.run(words, capture_output=True, text=True, check=True).stdout


def verbs_of(command: str) -> dict[str, tuple[str, str]]:
    """What each verb is for, and the rest of its help."""
    names = re.findall(r"^  (\w+)  +\S", printed(command, "--help").split("Subcommands:")[1], re.MULTILINE)
    parts = {name: printed(command, name, "--help").strip().partition("\n") for name in names}
    return {name: (first.strip(), rest.strip()) for name, (first, _, rest) in parts.items()}


def page_of(verbs: dict[str, tuple[str, str]]) -> str:
    status = "\n".join(textwrap.wrap(f"`dartcast VERB ...`. {STATUS}", 100))
    parts = [f"# The command\n\n{status}\n\n{COMPLETION}\n\n```\n{TURN_ON}\n```\n\n"
             "`tools/make_command_page.py` has made this page from `dartcast VERB --help`.\n"]
    for verb, (first, rest) in verbs.items():
        parts.append(f"## {verb}\n\n{first}\n\n```text\n{rest}\n```\n")
    return "\n".join(parts)


def roff(text: str) -> str:
    """Plain text as the formatter of manual pages takes it."""
    lines = text.replace("\\", "\\e").replace("-", "\\-").splitlines()
    return "\n".join("\\&" + line if line.startswith((".", "'")) else line for line in lines)


def manual_of(verbs: dict[str, tuple[str, str]], version: str) -> str:
    parts = [f'.TH DARTCAST 1 "" "dartcast {version}" "User Commands"', ".SH NAME",
             "dartcast \\- carries particles through deforming meshes, exactly", ".SH SYNOPSIS", ".B dartcast",
             ".I VERB", "[...]", ".SH DESCRIPTION", roff(STATUS), ".PP", roff(COMPLETION), ".PP", ".nf", roff(TURN_ON), ".fi", ".SH VERBS"]
    for verb, (first, rest) in verbs.items():
        parts += [f".SS {verb}", roff(first), ".PP", ".nf", roff(rest), ".fi"]
    parts += [".SH SEE ALSO", "The scenes in /usr/share/doc/dartcast/examples. A run leaves report.html, which opens in "
              "a browser."]
    return "\n".join(parts) + "\n"


def main() -> int:
    command = sys.argv[1]
    verbs = verbs_of(command)
    made = {"command.md": page_of(verbs), "dartcast.1": manual_of(verbs, printed(command, "--version").split()[-1])}
    if "--check" not in sys.argv:
        for name, text in made.items():
            (DOCS / name).write_text(text, encoding="utf-8")
        return 0
    wrong = [name for name, text in made.items() if (DOCS / name).read_text(encoding="utf-8") != text]
    for name in wrong:
        print(f"docs/{name} is not what the command prints: run tools/make_command_page.py {command}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
