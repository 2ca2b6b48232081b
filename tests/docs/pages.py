"""The pages of the documentation as a reader meets them: blocks of code, and commands to type."""

import shlex
from pathlib import Path
from typing import NamedTuple

from markdown_it import MarkdownIt

ROOT = Path(__file__).resolve().parents[2]
PAGES = sorted(
    path.relative_to(ROOT).as_posix()
    for path in (*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md"))
    if path.name != "CHANGELOG.md" and "_build" not in path.parts
)
SHELL = ("bash", "console", "")
OURS = ("tipoff", "make")  # an indented block, which has no language, holds commands of these
PROMPT = "$ "


class Block(NamedTuple):
    """A block of code: its page, its language (empty where it is indented), its text."""

    page: str
    language: str
    text: str


def blocks(page: str) -> list[Block]:
    """Every block of code of a page, in order."""
    tokens = MarkdownIt().parse((ROOT / page).read_text(encoding="utf-8"))
    return [
        Block(page, token.info.strip(), token.content)
        for token in tokens
        if token.type in ("fence", "code_block")
    ]


def of_language(page: str, language: str) -> list[str]:
    """The text of every block of a page in a language."""
    return [block.text for block in blocks(page) if block.language == language]


def commands(page: str) -> list[list[str]]:
    """Words of every command line of a page, without comments and prompts."""
    found = []
    for block in blocks(page):
        if block.language not in SHELL:
            continue
        lines = block.text.replace("\\\n", " ").splitlines()
        if block.language == "console":
            lines = [line.removeprefix(PROMPT) for line in lines if line.startswith(PROMPT)]
        words = [_words(line) for line in lines]
        found += [line for line in words if line and (block.language or line[0] in OURS)]
    return found


def smaller(python: str) -> str:
    """The same program on the small scene, with coarse elements and few cases."""
    for large, small in (
        ('"reference"', '"tiny"'),
        ("count=1000", "count=8"),
        ("2e-3", "8e-3"),
    ):
        python = python.replace(large, small)
    return python


def _words(line: str) -> list[str]:
    try:
        return shlex.split(line, comments=True)
    except ValueError:  # an indented block that is no command
        return []


def tipoff(page: str) -> list[list[str]]:
    """Arguments of every command ``tipoff`` of a page; what goes into a file is left out."""
    found = [words[1:] for words in commands(page) if words[0] == "tipoff"]
    return [words[: words.index(">")] if ">" in words else words for words in found]
