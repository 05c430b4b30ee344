"""The limits of prose in documents, and where a document is above them.

Counted are words of running text: a code span or the text of a link is what a reader sees, and fenced blocks, comments,
headings and pictures are left out.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import NamedTuple

SENTENCE_WORDS = 25
"""For nine of ten sentences of a page."""
LONGEST_SENTENCE = 40
"""Words; for all."""
PARAGRAPH_WORDS = 80
"""Of a paragraph or an item of a list."""
CELL_CHARACTERS = 120
"""Of a cell of a table as it stands in the file, so that an editor shows it."""

_LEFT_OUT = re.compile(r"^ *```.*?^ *```$|<!--.*?-->|^#.*?$|^ *!\[.*?$", re.DOTALL | re.MULTILINE)
_ITEM = re.compile(r"^ *(?:[-*]|\d+\.) ", re.MULTILINE)
_LINK = re.compile(r"\[([^\]]*)\]\([^)]*\)")
_CODE = re.compile(r"`[^`]*`")
_END = re.compile(r"(?<=[.!?])[)\"*]*\s+(?=[\"(*]*[A-Z0-9\x00])")
_ABBREVIATION = re.compile(r"\b(e\.g|i\.e|etc|vs)\.")


class Block(NamedTuple):
    """A paragraph, an item of a list, or a row of a table."""

    line: int
    """Of its begin, from 1."""
    text: str


def find_faults(document: str) -> list[str]:
    """Return what is above the limits, as "line: what", in the order of the lines; the ninth tenth comes last."""
    faults: list[str] = []
    lengths: list[int] = []
    for line, text in _blocks(document):
        if text.startswith("|"):
            faults += [
                f"{line}: a cell of {len(cell)} characters" for cell in _cells(text) if len(cell) > CELL_CHARACTERS
            ]
            continue
        words = [len(sentence.split()) for sentence in split_sentences(text)]
        lengths += words
        if sum(words) > PARAGRAPH_WORDS:
            faults.append(f"{line}: a paragraph of {sum(words)} words")
        faults += [f"{line}: a sentence of {count} words" for count in words if count > LONGEST_SENTENCE]
    ninth_tenth = sorted(lengths)[len(lengths) * 9 // 10] if lengths else 0
    if ninth_tenth > SENTENCE_WORDS:
        faults.append(f"one sentence in ten has {ninth_tenth} words or more")
    return faults


def split_sentences(text: str) -> list[str]:
    """Return the sentences of a paragraph, a code span as the one word "\\0"."""
    plain = _CODE.sub("\0", _LINK.sub(r"\1", text))
    return [sentence for sentence in _END.split(_ABBREVIATION.sub(r"\1", plain)) if re.search(r"[\w\0]", sentence)]


def _blocks(document: str) -> Iterator[Block]:
    """Yield the prose of a document; what is left out keeps its lines."""
    text = _LEFT_OUT.sub(lambda found: "\n" * found[0].count("\n"), document)
    line, begun, kept = 1, 1, ""
    for each in [*text.splitlines(), ""]:
        is_row, is_item = each.startswith("|"), _ITEM.match(each)
        if kept and (not each.strip() or is_row or is_item or kept.startswith("|")):
            yield Block(begun, kept)
            kept = ""
        if each.strip():
            begun = begun if kept else line
            kept = f"{kept} {_ITEM.sub('', each).strip()}".strip()
        line += 1


def _cells(row: str) -> list[str]:
    return [cell.strip() for cell in re.split(r"(?<!\\)\|", row.strip().strip("|"))]
