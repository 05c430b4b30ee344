"""BTNn_FUNCTION: what the buttons of MANUAL_CONTROL do when they are pressed.

A press is a change from one message to the next. The first message of a station, and the first one after a pause longer
than MAN_TIMEOUT, press nothing: a button held all along, or a joystick that reconnects, is no request. Anyone may stop;
the rest needs control, as for commands. To add a function, add a row to FUNCTIONS.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import msgspec

from dialects.enums import Severity
from dialects.messages import ManualControl
from dialects.modes import Mode
from link.core import Received
from vehicle.commands.context import Context
from vehicle.drive.conversation import Conversation
from vehicle.params import BUTTONS
from vehicle.safety.state_machine import Safety

STATIONS_MAX = 8
"""Stations whose buttons are remembered; as many as a link has peers."""


class ButtonFunction(msgspec.Struct, frozen=True):
    """One value of BTNn_FUNCTION."""

    label: str
    run: Callable[[Safety, Conversation, float], str | list[str] | None]
    """Called with the ground station and the time. Returns why it was denied, or None."""
    stops: bool = False
    """Open to anyone."""


def _chosen(mode: Mode) -> Callable[[Safety, Conversation, float], str | None]:
    return lambda safety, asker, now: safety.choose_mode(mode, now)


def _disarm(safety: Safety, asker: Conversation, now: float) -> None:
    safety.disarm(f"by a button of GCS {asker.system}", now)
    safety.end_motor_test()


FUNCTIONS: dict[int, ButtonFunction] = {
    1: ButtonFunction("arm", lambda safety, asker, now: safety.arm(asker, now)),
    2: ButtonFunction("disarm", _disarm, stops=True),
    3: ButtonFunction(
        "emergency stop", lambda safety, asker, now: safety.emergency_stop(f"GCS {asker.system}", now), stops=True
    ),
    4: ButtonFunction("HOLD", _chosen(Mode.HOLD), stops=True),
    5: ButtonFunction("MANUAL", _chosen(Mode.MANUAL)),
    6: ButtonFunction("AUTO", _chosen(Mode.AUTO)),
    7: ButtonFunction("RTL", _chosen(Mode.RTL)),
}
"""BTNn_FUNCTION -> function; 0 is none."""


class Buttons:
    """Runs the function of each button when it is pressed."""

    def __init__(self, context: Context) -> None:
        self._params = context.params
        self._safety = context.safety
        self._control = context.control
        self._texts = context.statustext
        self._held: dict[Conversation, tuple[int, float]] = {}
        """Ground station -> its newest `buttons`, and when they came."""

    def handle_manual_control(self, received: Received, message: ManualControl, now: float) -> None:
        """Run the function of what is newly pressed; a stop comes before the others."""
        if message.target != self._control.system or not received.introduced:
            return
        conversation = Conversation.of(received)
        before, at = self._held.pop(conversation, (0, -math.inf))
        known = now - at <= self._params["MAN_TIMEOUT"]
        self._held[conversation] = (message.buttons, now)
        if len(self._held) > STATIONS_MAX:
            del self._held[next(iter(self._held))]
        pressed = message.buttons & ~before if known else 0
        if pressed:
            self._press(pressed, received, now)

    def _press(self, pressed: int, received: Received, now: float) -> None:
        system = received.system
        numbers = (int(self._params[f"BTN{bit}_FUNCTION"]) for bit in range(BUTTONS) if pressed >> bit & 1)
        wanted = [FUNCTIONS[number] for number in numbers if number in FUNCTIONS]
        for function in sorted(wanted, key=lambda each: not each.stops)[:1]:
            denial = None if function.stops else self._control.ownership.denial_reason(received, now)
            refusal = denial or function.run(self._safety, Conversation.of(received), now) or []
            if isinstance(refusal, str):
                refusal = [f"GCS {system}: button for {function.label} refused: {refusal}"]
            else:
                refusal = [f"PreArm: {problem}" for problem in refusal]
            for text in refusal:
                self._texts.reply(received, Severity.WARNING, text, now)
