"""Subcommand: one row of the table in subcommands.py."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping
from typing import Any

import msgspec

DONE, FAULT = 0, 1
"""Exit codes: success, and an error of the hardware. USAGE_ERROR is an error of the user."""

Arguments = Mapping[str, Mapping[str, Any]]
"""Name -> arguments of argparse."""


class SubcommandError(Exception):
    """The subcommand cannot be executed; the text is one line."""


class Subcommand(msgspec.Struct, frozen=True):
    """One subcommand, or one of its actions."""

    help: str
    run: Callable[[argparse.Namespace], int] | None = None
    """Executes the subcommand and returns the exit code; None if it has actions."""
    arguments: Arguments = msgspec.field(default_factory=dict)
    one_of: Arguments = msgspec.field(default_factory=dict)
    """Arguments of which at most one may be given."""
    need_one: bool = False
    """One of `one_of` must be given."""
    actions: Mapping[str, Subcommand] = msgspec.field(default_factory=dict)
    """Name -> action."""

    def add_to(self, parser: argparse.ArgumentParser) -> None:
        """Add arguments and actions to a parser, whose options then have `run`."""
        parser.description = f"{self.help[0].upper()}{self.help[1:]}."
        parser.set_defaults(run=self.run)
        for argument, settings in self.arguments.items():
            parser.add_argument(argument, **settings)
        if self.one_of:
            group = parser.add_mutually_exclusive_group(required=self.need_one)
            for argument, settings in self.one_of.items():
                group.add_argument(argument, **settings)
        if self.actions:
            parsers = parser.add_subparsers(required=True, metavar="ACTION", parser_class=type(parser))
            for name, action in self.actions.items():
                action.add_to(parsers.add_parser(name, help=action.help))
