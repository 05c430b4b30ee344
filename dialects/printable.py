"""Texts of vehicles and files without what could drive a terminal. A module of its own: it needs no message."""

from __future__ import annotations


def printable(text: str) -> str:
    """Return `text` with every unprintable character replaced by U+FFFD."""
    if text.isprintable():
        return text
    return "".join(character if character.isprintable() else "\N{REPLACEMENT CHARACTER}" for character in text)
