"""Formats an exception as one line."""

from __future__ import annotations


def format_error(error: BaseException) -> str:
    """Return the message of an exception on one line, or its type if the message is empty."""
    return " ".join(str(error).split()) or type(error).__name__
