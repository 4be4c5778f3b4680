#!/usr/bin/env python3
"""Checks the English of documents, of comments in C++ and of names of tests: banned words and phrases
(tools/banned_words.txt), how sentences start, and how long they are in public headers and in documents for users.

Prose is read paragraph by paragraph, so that a phrase is found across the end of a line. Code in documents is left out,
but for names that are no longer in use.
"""
import dataclasses
import pathlib
import re
import sys

DOCUMENTS = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md", "docs/**/*.md", "site/*.md"]
SOURCES = ["include", "src", "apps", "bench", "examples", "python", "tests"]
SUFFIXES = {".cpp", ".hpp", ".inl"}

COMMENT = re.compile(r'"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'|//[/!]?<?(?P<text>[^\n]*)')
CODE_BLOCK = re.compile(r"^```.*?^```", re.DOTALL | re.MULTILINE)
CODE_SPAN = re.compile(r"`[^`\n]+`")
TEST_NAME = re.compile(r"\bTEST(?:_F|_P)?\(\w+, (\w+)\)")
# What opens a sentence in the wrong way. A question may start with "What" or "Who".
OPENING = re.compile(r"(?:(?<=^)|(?<=[.!?:;] )|(?<=\| ))(Of|What|Who|That)\b(?P<rest>[^.!?]*)(?P<end>[.!?]?)")
SENTENCE_END = re.compile(r"(?<=[.!?:;]) ")
MOST_WORDS = 25  # of a sentence, without what stands in parentheses
# Where sentences have at most so many words: the contract, and what users read first.
SHORT = re.compile(r"include/.*|README\.md|docs/(start|guide|scene|python|howto|questions)\.md|docs/howto/.*")
REMEDIES = {
    "Of": 'name the subject first: "The cells in a pool.", not "Of the cells in a pool."',
    "What": "name the thing: which value, which step, which rule",
    "Who": "name the thing: the particle, the caller",
    "That": 'put a noun before "that": "The fact that ...", "The rule that ..."',
}


@dataclasses.dataclass
class Ban:
    pattern: re.Pattern[str]
    remedy: str
    is_name: bool  # an identifier: matched in code spans, too


@dataclasses.dataclass
class Paragraph:
    path: pathlib.Path
    lines: list[tuple[int, str]]  # number and text of each line

    def text(self) -> str:
        return " ".join(text for _, text in self.lines)

    def line_of(self, offset: int) -> int:
        for number, text in self.lines:
            offset -= len(text) + 1
            if offset < 0:
                return number
        return self.lines[-1][0]


def read_bans(path: pathlib.Path) -> list[Ban]:
    bans = []
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        if not line.strip() or line.startswith("#"):
            continue
        pattern, separator, remedy = line.partition(" # ")
        if not separator:
            sys.exit(f"{path}:{number}: no remedy; write PATTERN  # REMEDY")
        is_name = pattern.startswith("=")
        pattern = pattern.lstrip("=").strip()
        bans.append(Ban(re.compile(pattern, 0 if is_name else re.IGNORECASE), remedy.strip(), is_name))
    return bans


def grouped(path: pathlib.Path, lines: list[tuple[int, str]], starts_alone: re.Pattern[str]) -> list[Paragraph]:
    """Lines that follow each other are one paragraph; one that starts an item or a table row begins another."""
    found: list[Paragraph] = []
    before = -1
    for number, text in lines:
        if not text:
            before = -1
            continue
        if number != before + 1 or starts_alone.match(text):
            found.append(Paragraph(path, []))
        found[-1].lines.append((number, text))
        before = number
    return found


def paragraphs_of_document(path: pathlib.Path) -> list[Paragraph]:
    text = path.read_text(encoding="utf-8")
    if path.name == "CHANGELOG.md":  # its newest section; older ones stay as they were published
        sections = [m.start() for m in re.finditer(r"^## ", text, re.MULTILINE)]
        text = text[: sections[1]] if len(sections) > 1 else text
    text = CODE_BLOCK.sub(lambda m: "\n" * m.group().count("\n"), text)
    lines = [(i, line.strip()) for i, line in enumerate(text.splitlines(), 1)]
    return grouped(path, lines, re.compile(r"[-*|#]|\d+\. "))


def paragraphs_of_source(path: pathlib.Path) -> list[Paragraph]:
    lines = []
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        for match in COMMENT.finditer(line):
            text = (match.group("text") or "").strip()
            if text and not text.startswith("NOLINT"):
                alone = not line[: match.start()].strip()
                lines.append((number, text if alone else f"\0{text}"))
    found = grouped(path, lines, re.compile(r"\0|- "))  # a comment behind code stands alone
    for paragraph in found:
        paragraph.lines = [(number, text.lstrip("\0")) for number, text in paragraph.lines]
    return found


def names_of_tests(path: pathlib.Path) -> list[Paragraph]:
    """The name of each test as words. A name may start with any of them: it goes on what the suite's name begins."""
    lines = enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
    names = [(number, match.group(1)) for number, line in lines for match in TEST_NAME.finditer(line)]
    return [Paragraph(path, [(number, "... " + re.sub(r"(?<=[a-z0-9])(?=[A-Z])", " ", name).lower())]) for number, name in names]


def long_sentences(paragraph: Paragraph, whole: str) -> list[str]:
    """A link counts by its text, and each cell of a table is a text of its own."""
    shown = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", whole)
    found = []
    for sentence in SENTENCE_END.split(re.sub(r"\([^)]*\)", "", shown)):
        for part in re.split(r"(?<!\\)\|", sentence) if whole.startswith("|") else [sentence]:
            words = [word for word in part.split() if re.search(r"\w", word)]
            if len(words) > MOST_WORDS:
                start = " ".join(words[:6])
                found.append(f'{paragraph.path}:{paragraph.lines[0][0]}: "{start} ...": {len(words)} words: make it two')
    return found


def findings_of(paragraph: Paragraph, bans: list[Ban]) -> list[str]:
    whole = paragraph.text()
    prose = CODE_SPAN.sub(lambda m: "`" + "_" * (len(m.group()) - 2) + "`", whole)
    where = lambda match: f"{paragraph.path}:{paragraph.line_of(match.start())}"
    found = []
    for ban in bans:
        text = whole if ban.is_name and paragraph.path.name != "CHANGELOG.md" else prose
        found += [f'{where(m)}: "{m.group()}": {ban.remedy}' for m in ban.pattern.finditer(text)]
    for match in OPENING.finditer(prose):
        if match.group("end") != "?":
            found.append(f'{where(match)}: a sentence starts with "{match.group(1)}": {REMEDIES[match.group(1)]}')
    if SHORT.fullmatch(str(paragraph.path)) and "-------" not in whole:  # no line of a table
        found += long_sentences(paragraph, whole)
    return found


def main() -> int:
    bans = read_bans(pathlib.Path("tools/banned_words.txt"))
    documents = [path for pattern in DOCUMENTS for path in sorted(pathlib.Path().glob(pattern))]
    sources = [p for root in SOURCES for p in sorted(pathlib.Path(root).rglob("*")) if p.suffix in SUFFIXES]
    paragraphs = [p for path in documents for p in paragraphs_of_document(path)]
    paragraphs += [p for path in sources for p in paragraphs_of_source(path)]
    paragraphs += [p for path in sources if path.parts[0] == "tests" for p in names_of_tests(path)]
    found = [line for paragraph in paragraphs for line in findings_of(paragraph, bans)]
    print("\n".join(found))
    print(f"{len(documents)} documents, {len(sources)} sources, {len(found)} mistakes")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
