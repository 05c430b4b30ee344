"""Thumb stick of a touch screen: to the screen a gamepad, whose dead-man button is the touched stick. No I/O."""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec

from groundstation.input.pad import PadCore, PadFrame, PadReading
from groundstation.input.pad_mapping import PadMapping
from groundstation.intents.driving import PAD_WINDOW

NAME = "thumb stick"

PIPE_VARIABLE = "MAVHELM_STICK_FD"
"""Environment of the screen of a tab: the descriptor from which it reads the frames. Set by the web server only."""

TouchButton = Literal["a", "b", "x", "y", "back", "guide", "start", "dpup", "dpdown"]
"""Buttons of the page, by the names of a gamepad's."""

Unit = Annotated[float, msgspec.Meta(ge=-1.0, le=1.0)]
Milliseconds = Annotated[float, msgspec.Meta(ge=0.0, le=1e12)]

TOUCH = PadMapping(
    dead_zone=0.1,
    buttons={
        "a": "vehicle.control",
        "b": "drive.stop",
        "x": "vehicle.hold",
        "y": "vehicle.manual",
        "back": "stop.emergency",
        "guide": "app.goto",
        "start": "vehicle.arm",
        "dpup": "speed.faster",
        "dpdown": "speed.slower",
    },
)
"""What they do, whatever gamepad this machine has. A thumb is never quite still: a dead zone of a tenth."""

STOPS = frozenset({"b", "back", "x"})
"""Buttons that act however late they come: stop, emergency stop, HOLD."""


class TouchReading(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The stick and its buttons as a page has read them."""

    at: Milliseconds
    """When, by the clock that the server tells the page, never too late."""
    held: bool
    """The stick is touched."""
    x: Unit
    """To the right."""
    y: Unit
    """Up, which is forward."""
    buttons: Annotated[tuple[TouchButton, ...], msgspec.Meta(max_length=8)]


class TouchStick:
    """The stick of one page. Times are of one monotonic clock, s."""

    def __init__(self, since: float) -> None:
        """`since`: when the clock of the page was 0."""
        self._since = since
        self._core = PadCore(TOUCH)

    def clock(self, now: float) -> float:
        """Return what to tell the page of the time, ms."""
        return round((now - self._since) * 1000.0, 1)

    def take(self, reading: TouchReading, now: float) -> PadFrame | None:
        """Handle a reading that arrives `now`. Returns the frame that is due, None if none is.

        The frame has the time of the reading: one that a line has held back is neutral in the station, and of its
        buttons only those that stop are left.
        """
        at = min(self._since + reading.at / 1000.0, now)
        late = now - at > PAD_WINDOW
        buttons: set[str] = {name for name in reading.buttons if not late or name in STOPS}
        if reading.held:
            buttons.add(TOUCH.deadman)
        axes = {"lefty": reading.y, "rightx": reading.x}
        return self._core.update((NAME,), 0, PadReading(0, axes, frozenset(buttons)), at)
