"""Protocol between a Python program and `mavhelm api`: one JSON object a line, in both directions.

The program sends Call, Cancel and Waiting. It gets Ready once, CurrentState ten times a second, VehicleText, and for
each call any number of CallRecord and CallNote, then Ended.
"""

from __future__ import annotations

from typing import Any

import msgspec

from groundstation.rover.telemetry import State

MAX_LINE = 1 << 20
"""Bytes of one line of a program."""
STATE_PERIOD = 0.1
"""s between two states."""
WAITING_PERIOD = 0.1
"""s between two Waiting of a program while a call of it drives."""
SILENCE = 0.5
"""s without Waiting after which a call that drives ends with neutral: the program stands still."""


class Call(msgspec.Struct, frozen=True, tag="call"):
    """Run a verb, such as `drive --throttle 40 --for 2`."""

    id: int
    words: tuple[str, ...]


class Cancel(msgspec.Struct, frozen=True, tag="cancel"):
    """End a call, with neutral if it drives."""

    id: int


class Waiting(msgspec.Struct, frozen=True, tag="waiting"):
    """The program runs, and waits for a call: for this one, or for all that run."""

    id: int | None = None


class Ready(msgspec.Struct, frozen=True, tag="ready"):
    """The vehicle was found."""

    system: int
    name: str


class CurrentState(msgspec.Struct, frozen=True, tag="state"):
    """The newest state of the vehicle."""

    state: State


class TextEvent(msgspec.Struct, frozen=True, tag="text"):
    """A STATUSTEXT of the vehicle."""

    severity: int
    """MAV_SEVERITY."""
    text: str


class CallRecord(msgspec.Struct, frozen=True, tag="record"):
    """Data of a call, as `--json` prints them."""

    id: int
    fields: dict[str, Any]


class CallNote(msgspec.Struct, frozen=True, tag="note"):
    """A line of a call for a person."""

    id: int
    text: str


class Ended(msgspec.Struct, frozen=True, tag="ended"):
    """The end of a call. `code` is an exit code of groundstation/verbs/common/exit_codes.py, `text` why it failed."""

    id: int
    code: int
    text: str = ""
    fields: dict[str, Any] = {}


FromProgram = Call | Cancel | Waiting
ToProgram = Ready | CurrentState | TextEvent | CallRecord | CallNote | Ended

encode = msgspec.json.Encoder().encode
decode_call = msgspec.json.Decoder(FromProgram).decode
decode_answer = msgspec.json.Decoder(ToProgram).decode
