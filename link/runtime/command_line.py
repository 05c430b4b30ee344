"""What the command lines of all programs have in common: a mistake is one line, and an empty word is a mistake."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from itertools import pairwise
from typing import NoReturn

from link.runtime import journald

USAGE_ERROR = 2
"""Exit code of a user's mistake."""
EMPTY_VALUE = "has nothing behind it: give it a value, or leave it out"


class CommandLineParser(argparse.ArgumentParser):
    """Says a mistake in one line."""

    def error(self, message: str) -> NoReturn:
        """Leave with exit code 2. What the user wrote may hold line breaks; the line does not."""
        self.exit(USAGE_ERROR, f"{self.prog}: {' '.join(message.split())} ({self.prog} --help shows how)\n")

    def exit(self, status: int = 0, message: str | None = None) -> NoReturn:
        """Leave; in the journal a complaint is marked as one."""
        if message and status:
            message = journald.priority_prefix(journald.ERROR) + message
        super().exit(status, message)

    def reject_empty(self, words: Sequence[str]) -> list[str]:
        """The words, none of which is empty: that is most often a variable of a script that nobody has set, and as the
        name of a folder it would mean that nothing is kept.
        """
        for before, word in pairwise(["", *words]):
            option, given, value = word.partition("=")
            if not word:
                self.error(
                    f"{before} {EMPTY_VALUE}" if before.startswith("-") else "an argument is empty: leave it out"
                )
            if given and option.startswith("-") and value in ("", "--"):  # argparse takes -- for a sign of its own
                self.error(f"{option} {EMPTY_VALUE}")
        return list(words)
