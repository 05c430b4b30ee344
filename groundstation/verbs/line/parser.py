"""Parses a line of the screens as the command line of a shell is parsed, without printing and without an exit."""

from __future__ import annotations

import argparse
import shlex
from collections.abc import Collection
from typing import NoReturn

import msgspec

from groundstation.verbs.action import VerbAction
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.line.session import here
from groundstation.verbs.main import build_parser
from groundstation.verbs.mavproxy_words import describe_action, describe_word
from groundstation.verbs.table import VERBS
from link.runtime.command_line import CommandLineParser

FOR_SHELLS = ("endpoints", "config", "dialect")
"""Options that a line cannot have: it uses the links, settings and dialect of the station."""


class LineParser(CommandLineParser):
    """Raises VerbError where a program would print and exit."""

    def error(self, message: str) -> NoReturn:
        """Raise VerbError."""
        raise VerbError(ExitCode.USAGE, f"{self._verb}: {' '.join(message.split())}")

    def print_help(self, file: object = None) -> NoReturn:
        """Raise VerbError with the usage."""
        usage = " ".join(self.format_usage().split()).removeprefix("usage: mavhelm ")
        raise VerbError(ExitCode.USAGE, usage)

    @property
    def _verb(self) -> str:
        return self.prog.removeprefix("mavhelm ")


class ParsedLine(msgspec.Struct, frozen=True):
    """What a line asks for."""

    name: str
    """Verb, or verb and action."""
    action: VerbAction
    options: argparse.Namespace


def parse_line(text: str, modes: Collection[str] = ()) -> ParsedLine:
    """Return what a line asks for. The name of one of the `modes` alone, in any case, chooses that mode.

    Raises VerbError, also for what another screen does.
    """
    words = _split(text)
    if len(words) == 1 and words[0].upper() in modes:
        words = ["mode", words[0]]
    elif words == ["rtl"]:  # an autopilot that has another name for it
        words = ["home"]
    verb = words[0]
    if (hint := describe_action(words, VERBS)) or verb not in VERBS:
        hint = hint or describe_word(verb, VERBS) or f"{verb!r} is not a verb; TAB lists them"
        raise VerbError(ExitCode.USAGE, here(hint))
    _refuse_elsewhere(verb)
    options = build_parser(verb, LineParser).parse_args(words[1:])
    name = f"{verb} {options.action}".strip()
    action = VERBS[verb].actions[options.action]
    if action.line.elsewhere:
        raise VerbError(ExitCode.USAGE, f"{name}: {action.line.elsewhere}")
    if any(getattr(options, each) for each in FOR_SHELLS):
        raise VerbError(ExitCode.USAGE, f"{name}: a line uses the links and the dialect of this ground station")
    if options.all or options.group:
        raise VerbError(ExitCode.USAGE, f"{name}: a line is for the selected vehicle; use --all and --group in a shell")
    if action.check is not None:
        action.check(options)
    return ParsedLine(name, action, options)


def _split(text: str) -> list[str]:
    try:
        words = shlex.split(text)
    except ValueError as error:
        raise VerbError(ExitCode.USAGE, f"{text!r}: {error}") from error
    if not words:
        raise VerbError(ExitCode.USAGE, "write a verb; TAB lists them")
    return words


def _refuse_elsewhere(verb: str) -> None:
    """Name the screen at once, before the arguments, where no action of the verb runs here."""
    rules = [action.line.elsewhere for action in VERBS[verb].actions.values()]
    if all(rules):
        raise VerbError(ExitCode.USAGE, f"{verb}: {rules[0]}")
