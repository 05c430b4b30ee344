"""LINE_RULES: which verbs a line of the screens may run, how, and which screen has the others.

A verb runs by its own function of the table of verbs (RUN), or by an intent of the station (`own`), because the
station has its own way to do it. `asks`: the operator must answer y first, as for the same key of a screen.
"""

from __future__ import annotations

import argparse
from collections.abc import Awaitable, Callable, Mapping
from typing import Any

import msgspec

from groundstation.vehicles.state.vehicle_state import VehicleState
from groundstation.verbs.collected_output import CollectedOutput
from groundstation.verbs.line import overrides
from groundstation.verbs.line.session import LineSession

Own = Callable[[LineSession, argparse.Namespace, CollectedOutput], Awaitable[int]]


class LineRule(msgspec.Struct, frozen=True):
    """One verb or action."""

    asks: Callable[[Any, VehicleState], bool] = lambda options, state: False
    """Whether it asks first; takes the parsed arguments and the vehicle."""
    own: Own | None = None
    """What runs in place of the verb's function."""
    elsewhere: str = ""
    """Where to do it; then a line does not run it."""


def _moves(options: argparse.Namespace, state: VehicleState) -> bool:
    """Return whether the vehicle may move by itself in this mode."""
    number = state.model.number_of(options.name)
    return number is None or state.model.moves_itself(state.model.mode_name(number))


_RUN = LineRule()
_ASK = LineRule(asks=lambda options, state: True)
_HOLD_KEY = "is a key that is held for 1 s on Drive, so that no text does it"
_MAP, _PARAMS, _FILES = "the Map screen (F2)", "the Params screen (F4)", "the Files screen (^g 9)"
_MESSAGES, _LINKS, _SETUP = "the Messages screen (F3)", "the Links screen (F7)", "the Setup screen (F8)"


def _on(screen: str) -> LineRule:
    return LineRule(elsewhere=f"use {screen}")


LINE_RULES: Mapping[str, LineRule] = {
    "status": _on("the Drive screen (F1)"), "vehicles": _on(_LINKS), "links": _on(_LINKS),
    "arm": LineRule(elsewhere=f"{_HOLD_KEY}: r"),
    "disarm": LineRule(own=overrides.disarm), "stop": LineRule(own=overrides.stop),
    "estop": LineRule(own=overrides.emergency_stop),
    "control show": LineRule(own=overrides.show_control), "control request": LineRule(own=overrides.request_control),
    "control release": LineRule(own=overrides.release_control),
    "control give": LineRule(elsewhere="Y on Drive gives control to the ground station that asks for it"),
    "goto": _ASK, "home": _ASK, "speed": _RUN,
    "drive": LineRule(elsewhere="the keys of the Drive screen (F1) drive"),
    "takeoff": LineRule(elsewhere=f"{_HOLD_KEY}: T, to the altitude of the setting take_off"),
    "land": LineRule(elsewhere="L lands, on the Drive screen (F1)"),
    "messages": _on(_MESSAGES), "watch": _on(_MESSAGES), "ping": _on(_LINKS),
    "send": LineRule(elsewhere="use `mavhelm send` in a shell, over another link of the vehicle"),
    "command": _ASK, "request": _RUN, "rate": _RUN,
    "param get": _RUN, "param set": _ASK, "param store": _ASK, "param reset": _ASK,
    "param save": _on(_PARAMS), "param load": _on(_PARAMS), "param diff": _on(_PARAMS),
    **{f"{plan} {action}": _RUN for plan in ("mission", "fence", "rally") for action in ("show",)},
    **{f"{plan} {action}": _on(_MAP) for plan in ("mission", "fence", "rally") for action in ("get", "put", "check")},
    **{f"{plan} clear": _ASK for plan in ("mission", "fence", "rally")},
    "mission start": _ASK, "mission pause": _RUN, "mission jump": _ASK, "fence on": _RUN, "fence off": _ASK,
    "modes": _RUN, "mode": LineRule(asks=_moves), "reboot": _ASK,
    "doctor": _on(_SETUP), "motor": _on(_SETUP), "calibrate": _on(_SETUP),
    **{f"ftp {action}": _on(_FILES) for action in ("ls", "get", "put", "rm", "crc")},
    "log list": _on(_FILES), "log get": _on(_FILES), "log erase": _on(_FILES),
}  # fmt: skip
"""Verb, or verb and action -> its rule. What is not listed is used in a shell."""

IN_A_SHELL = LineRule(elsewhere="use it in a shell")
