"""Command line parser of all programs: an error is one line, and an empty argument is an error."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from itertools import pairwise
from typing import NoReturn

from link.runtime import journald

USAGE_ERROR = 2
"""Exit code of a usage error."""
EMPTY_VALUE = "has nothing behind it: give it a value, or leave it out"


class CommandLineParser(argparse.ArgumentParser):
    """Reports an error in one line."""

    def error(self, message: str) -> NoReturn:
        """Exit with code 2. User input may contain line breaks; the printed line does not."""
        self.exit(USAGE_ERROR, f"{self.prog}: {' '.join(message.split())} ({self.prog} --help shows how)\n")

    def exit(self, status: int = 0, message: str | None = None) -> NoReturn:
        """Exit; in the journal the message is marked as an error."""
        if message and status:
            message = journald.priority_prefix(journald.ERROR) + message
        super().exit(status, message)

    def reject_empty(self, arguments: Sequence[str]) -> list[str]:
        """Return the arguments; exit if one of them is empty.

        An empty argument is most often an unset variable of a script, and as the name of a folder it would mean that
        nothing is saved.
        """
        for before, argument in pairwise(["", *arguments]):
            option, given, value = argument.partition("=")
            if not argument:
                self.error(
                    f"{before} {EMPTY_VALUE}" if before.startswith("-") else "an argument is empty: leave it out"
                )
            if given and option.startswith("-") and value in ("", "--"):  # argparse gives -- a meaning of its own
                self.error(f"{option} {EMPTY_VALUE}")
        return list(arguments)
