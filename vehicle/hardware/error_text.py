"""Exceptions in words: anybody's driver may raise anything, and whoever reads of it reads one line."""

from __future__ import annotations


def format_error(error: BaseException) -> str:
    """What it says, or its type where it says nothing."""
    return " ".join(str(error).split()) or type(error).__name__
