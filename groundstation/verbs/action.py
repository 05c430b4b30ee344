"""VerbAction: one action of a verb, a row of the table VERBS."""

from __future__ import annotations

import argparse
from collections.abc import Awaitable, Callable
from typing import TYPE_CHECKING, Any

import msgspec

if TYPE_CHECKING:
    from groundstation.vehicles.state.vehicle_state import VehicleState
    from groundstation.verbs.common.arguments import Argument
    from groundstation.verbs.common.channel import CompanionChannel
    from groundstation.verbs.common.output import Output
    from link.protocol.log_tap import LogTap

ONLY = ""
"""Name of the action of a verb that has only one, and takes no name for it."""


class LineRule(msgspec.Struct, frozen=True):
    """What a line of the screens (`:`) makes of an action."""

    elsewhere: str = ""
    """Where to do it; then a line does not run it."""
    asks: Callable[[argparse.Namespace, VehicleState], bool] = lambda options, state: False
    """Whether the operator must answer y first, as for the same key of a screen."""


RUNS, ASKS = LineRule(), LineRule(asks=lambda options, state: True)
IN_A_SHELL, USE_DRIVE = LineRule("use it in a shell"), LineRule("use the Drive screen (F1)")
USE_MAP, USE_MESSAGES = LineRule("use the Map screen (F2)"), LineRule("use the Messages screen (F3)")
USE_PARAMS, USE_LINKS = LineRule("use the Params screen (F4)"), LineRule("use the Links screen (F7)")
USE_SETUP, USE_FILES = LineRule("use the Setup screen (F8)"), LineRule("use the Files screen (^g 9)")


def held_key(key: str) -> LineRule:
    """Return the rule of what a key of the Drive screen does."""
    return LineRule(f"is a key that is held for 1 s on Drive, so that no text does it: {key}")


class VerbAction(msgspec.Struct, frozen=True):
    """One action of a verb."""

    help: str
    run: Callable[[Any, argparse.Namespace, Output], Awaitable[int]]
    """Gets a VerbSession, a DoctorSession, or None; returns the exit code."""
    arguments: tuple[Argument, ...] = ()
    aliases: tuple[str, ...] = ()
    """Other words for it."""
    offline: bool = False
    """Needs neither vehicle nor link: `run` gets None. It has its own arguments, --dialect, --json and --quiet."""
    examines: bool = False
    """`run` gets a DoctorSession: an OperatorCore with the doctor. It finds its vehicle itself."""
    prepare: Callable[[argparse.Namespace], Any] | None = None
    """Returns `options.given`: what the files and the configuration of the user say, in plain values.

    It runs in the process of the user before any link is opened, also for a verb that a station runs. Raises VerbError.
    """
    companion: Callable[[argparse.Namespace, Output, CompanionChannel], Awaitable[None]] | None = None
    """Runs beside `run` in the process of the user, which may be another one: files that are written as data arrive,
    programs and libraries of others. `session.companion` is the other end of its channel."""
    finds: bool = True
    """Waits for the vehicle before it runs."""
    in_station: bool = False
    """Only a ground station that runs can do it."""
    many: bool = False
    """May be done for many vehicles at once (--all, --group). Nothing that steers is."""
    watches: bool = False
    """Only looks, and so has ids that are never those of a driver."""
    follows: bool = False
    """Keeps the session of the verb before alive, if there was one just now (kept_session.py)."""
    needs_session: bool = False
    """Proves a session to the vehicle first, because the vehicle takes it from the ground station in control only."""
    shows_neutral: bool = False
    """Shows neutral then, because it can make the vehicle move."""
    check: Callable[[argparse.Namespace], None] | None = None
    """Raises VerbError for arguments that cannot be right, before any link is opened."""
    only_reads: Callable[[argparse.Namespace], bool] = lambda _: False
    """Whether it only looks with these arguments, so that it takes no part."""
    stops: bool = False
    """It is a stop: sent from the first moment, also to vehicles that are not heard, and past a station that hangs."""
    own_timeout: bool = False
    """Ends by itself after --timeout, with a code of its own."""
    guarded: Callable[[argparse.Namespace], bool] = lambda _: False
    """Whether it sends demands, so that a watchdog must outlive it."""
    tap: Callable[[argparse.Namespace, tuple[int, int]], LogTap | None] = lambda *_: None
    """Returns what takes all frames; gets our system and component id. Raises VerbError before any link is opened."""
    line: LineRule = IN_A_SHELL
    """How a line of the screens runs it."""
