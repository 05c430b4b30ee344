"""Find the code blocks of a Markdown document, with the comments before them that say how each is run.

The comments are HTML, which a rendered page does not show, each directly above its block:

    <!-- on: rover -->            it is typed on that machine: a home folder of its own
    <!-- first: COMMANDS -->      what the text around it tells the reader to do before, or has assumed
    <!-- ends: PROGRAM, ... -->   those that stay and whose command begins with this are ended before
    <!-- stays -->                its last command goes on, in this terminal, to the end of the page
    <!-- not run: KIND: WHY -->   it is explained and not run; KIND is a key of KINDS
    <!-- output of: COMMAND -->   the block is what that command, which a block before has run, printed
    <!-- except: TEXT -->         but for lines with this text, which depend on the computer
"""

from __future__ import annotations

import re
from typing import NamedTuple

KINDS = {
    "hardware": "a Raspberry Pi, a radio or an autopilot",
    "root": "changes the computer: packages, groups, services",
    "network": "a package index, the internet, or a second machine with an address of its own",
    "program": "a program that neither Debian nor PyPI has",
    "time": "more than a minute",
}
"""Kind of reason for which a block is not run -> what is missing."""
SHELLS = frozenset({"sh", "bash", "shell", "console"})
"""Languages of blocks that a reader types."""

_FENCE = re.compile(r"^(?P<indent> *)```(?P<language>[\w-]*)\n(?P<text>.*?)^(?P=indent)```$", re.DOTALL | re.MULTILINE)
_COMMENTS = re.compile(r"(?:<!--(?:(?!-->).)*-->\s*)+\Z", re.DOTALL)
_COMMENT = re.compile(r"<!--\s*(on|first|ends|stays|not run|output of|except)\b:?\s*(.*?)\s*-->", re.DOTALL)


class Block(NamedTuple):
    """A fenced block."""

    line: int
    """Of its first line of text, from 1."""
    language: str
    text: str
    """Without its indentation, every line with its end."""
    notes: dict[str, str]
    """Key of a comment before it -> the rest of that comment."""

    @property
    def is_shell(self) -> bool:
        """Return whether a reader types it."""
        return self.language in SHELLS


def find_blocks(text: str) -> list[Block]:
    """Return all fenced blocks of a document, in order."""
    found = []
    for fence in _FENCE.finditer(text):
        before = _COMMENTS.search(text[: fence.start()].rstrip(" "))
        notes = dict(_COMMENT.findall(before[0])) if before else {}
        indent = len(fence["indent"])
        lines = "".join(line[indent:] if line.strip() else line for line in fence["text"].splitlines(keepends=True))
        found.append(Block(text.count("\n", 0, fence.start("text")) + 1, fence["language"], lines, notes))
    return found
