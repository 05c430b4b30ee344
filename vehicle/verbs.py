"""The words of the vehicle beside running: `vehicle init`, `vehicle check` and others. It reads them and hands over."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

DONE, FAULT, MISTAKE = 0, 1, 2
"""Exit codes: it did what was asked; the hardware did not; the user's mistake."""
DEFAULT_FILE = "rover.toml"


class VerbError(Exception):
    """What was asked for cannot be had; the text is one line."""


class _Parser(argparse.ArgumentParser):
    """Says a mistake in one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(MISTAKE, f"{self.prog}: {message} ({self.prog} --help shows how)\n")


@dataclass(frozen=True, slots=True)
class Verb:
    """One word: what it takes, what it does."""

    help: str
    options: Callable[[argparse.ArgumentParser], object]
    run: Callable[[argparse.Namespace], int]


def run(words: Sequence[str]) -> int:
    """Do what the first of `words` says; the exit code."""
    verb = VERBS[words[0]]
    parser = _Parser(prog=f"vehicle {words[0]}", description=f"{verb.help[0].upper()}{verb.help[1:]}.")
    verb.options(parser)
    asked = parser.parse_args(words[1:])
    try:
        return verb.run(asked)
    except VerbError as error:
        parser.exit(MISTAKE, f"{parser.prog}: {error}\n")


def help_lines() -> str:
    """The table as lines for --help."""
    return "\n".join(f"  vehicle {name:<14} {verb.help}" for name, verb in VERBS.items())


def _file(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("file", nargs="?", default=DEFAULT_FILE, metavar="FILE", help=f"default {DEFAULT_FILE}")


def _nothing(parser: argparse.ArgumentParser) -> None:
    """Takes no options."""


def _init(asked: argparse.Namespace) -> int:
    from vehicle.sample import sample

    try:
        with Path(asked.file).open("x", encoding="utf-8") as file:
            file.write(sample())
    except FileExistsError:
        raise VerbError(f"{asked.file} is there already; name another file, or remove it") from None
    except OSError as error:
        raise VerbError(f"{asked.file}: {error.strerror}") from error
    sys.stdout.write(f"wrote {asked.file}; edit it, then: vehicle check {asked.file}\n")
    return DONE


def _schema(asked: argparse.Namespace) -> int:
    from vehicle.schema import schema

    sys.stdout.write(schema())
    return DONE


VERBS: dict[str, Verb] = {
    "init": Verb("write a file of settings with every key and its default", _file, _init),
    "schema": Verb("print the JSON schema of that file, for editors", _nothing, _schema),
}
"""Every word, in the order of --help."""
