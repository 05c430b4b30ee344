"""Command line parser of all programs: an error is one line, and an empty argument is an error."""

from __future__ import annotations

import argparse
from collections.abc import Collection, Sequence
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

    def _check_value(self, action: argparse.Action, value: object) -> None:
        """Raise ArgumentError for what is none of the choices, with the one that may be meant."""
        try:
            super()._check_value(action, value)
        except argparse.ArgumentError as error:
            error.message += _did_you_mean(str(value), [str(each) for each in action.choices or ()], "{}")
            raise

    def reject_unknown_options(self, arguments: Sequence[str]) -> None:
        """Exit if an option is unknown; argparse would report its value as an invalid positional argument instead."""
        for argument in arguments:
            name = argument.partition("=")[0]
            if name.startswith("--") and name not in self._option_string_actions:
                self.error(f"unknown option {name}{_did_you_mean(name, self._option_string_actions, '{}')}")

    def reject_unknown_word(self, arguments: Sequence[str], words: Collection[str]) -> None:
        """Exit if the first argument is neither an option nor an endpoint, but close to a subcommand of `words`."""
        word = next(iter(arguments), "")
        if word == "help":
            self.error(f"there is no subcommand 'help'; did you mean {self.prog} --help?")
        if word.isalpha() and (hint := _did_you_mean(word, words, f"`{self.prog} {{}}`")):
            self.error(f"{word!r} is neither a subcommand nor an endpoint{hint}")

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


def _did_you_mean(word: str, known: Collection[str], form: str) -> str:
    """Return a question for the known word that is nearest, "" if none is near."""
    import difflib  # when it is needed: it takes 1 ms of each start

    near = difflib.get_close_matches(word, known, n=1)
    return f"; did you mean {form.format(near[0])}?" if near else ""
