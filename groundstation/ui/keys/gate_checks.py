"""GATE_CHECKS: why keys must not drive now, as far as the app knows; one row for each reason, the first that holds."""

from __future__ import annotations

from collections.abc import Callable

import msgspec

from groundstation.ui.keys.key_gate import LENT, REPLAY, GateClosure


class AppCondition(msgspec.Struct, frozen=True):
    """What decides, as it is now."""

    leaving: GateClosure | None
    """The app quits."""
    station_alive: bool
    outage: str
    """What the watchdog reports of a station that does not respond; empty while it runs."""
    other_screen: GateClosure | None
    """Another screen, a menu or a text field is on top of Drive."""
    detached: bool
    """Nobody is attached to tmux."""
    focus: bool
    """The window of the terminal has the focus."""
    too_small: bool
    terminal_silent: bool
    """The terminal does not answer pings."""
    terminal_stuck: bool
    """The terminal accepts no output."""
    replay: bool = False
    """A log is shown."""
    lent: bool = False
    """The terminal belongs to a log that was opened from here."""
    style: str = ""
    """Why the drive style is not for this terminal; empty: it is."""
    driver: str = ""
    """Name of the other screen that drives; empty: this one does."""


GateCheck = Callable[[AppCondition], GateClosure | None]


def _check(holds: Callable[[AppCondition], bool], reason: str) -> GateCheck:
    closure = GateClosure(reason)
    return lambda now: closure if holds(now) else None


GATE_CHECKS: tuple[GateCheck, ...] = (
    lambda now: now.leaving,
    _check(lambda now: not now.station_alive, "the station has ended"),
    _check(lambda now: bool(now.outage), "the station does not respond"),
    lambda now: LENT if now.lent else None,
    lambda now: now.other_screen,
    lambda now: REPLAY if now.replay else None,
    lambda now: GateClosure(f"{now.driver} drives") if now.driver else None,
    _check(lambda now: now.detached, "nobody is attached to tmux"),
    _check(lambda now: not now.focus, "this window does not have the focus"),
    _check(lambda now: now.too_small, "the terminal is too small"),
    _check(lambda now: now.terminal_silent, "the terminal does not answer"),
    _check(lambda now: now.terminal_stuck, "the terminal accepts no output"),
    lambda now: GateClosure(now.style) if now.style else None,
)


def find_closure(now: AppCondition) -> GateClosure | None:
    """Return the first reason; None when keys may drive.

    Under another screen, which comes early in the table, a key permits nothing either if there is one more reason.
    """
    found = (closure for check in GATE_CHECKS if (closure := check(now)) is not None)
    first = next(found, None)
    if first is not None and first.agent_keys and next(found, None) is not None:
        return GateClosure(first.reason, first.level)
    return first
