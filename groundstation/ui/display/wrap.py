"""Texts as lines of a given width. Every character that we draw is one cell wide."""

from __future__ import annotations

import textwrap

from textual.content import Content


def clean(text: str) -> str:
    """Return a text without control characters: one that comes from the link must not reach the terminal."""
    if text.isprintable():
        return text
    return "".join(character if character.isprintable() else "�" for character in text)


def plain(text: str) -> Content:
    """Return a text for a title or a Static as it is: Textual takes a str for markup there, and `[/x]` for a mistake.

    A name from the link in a str would style the screen, or end it with a MarkupError.
    """
    return Content(clean(text))


def wrap(text: str, width: int) -> list[str]:
    """Return the whole text in lines of at most `width` characters, broken between words where possible."""
    text = clean(text)
    if len(text) <= width:
        return [text]
    return textwrap.wrap(text, max(1, width), drop_whitespace=True) or [""]
