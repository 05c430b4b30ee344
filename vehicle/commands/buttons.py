"""The buttons of MANUAL_CONTROL: each does what its parameter BTNn_FUNCTION says, at the moment it is pressed.

Pressed is a change from one message to the next. The first message of a station, and the first after a pause, presses
nothing: a button that was held all along, or a joystick that came back, is nobody's wish. What stops is everybody's;
the rest only the driver in control may ask for, as by command. To add a function, add a line to FUNCTIONS.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from dialects.enums import Severity
from dialects.messages import ManualControl
from dialects.modes import Mode
from link.core import Received
from vehicle.drive.control import Control
from vehicle.params import BUTTONS, Params
from vehicle.safety.state_machine import Safety
from vehicle.statustext import StatusTextQueue

STATIONS_MAX = 8
"""Stations whose buttons are remembered; as many as a link has peers."""


@dataclass(frozen=True, slots=True)
class ButtonFunction:
    """What a button may do."""

    label: str
    run: Callable[[Safety, int, float], str | list[str] | None]
    """With the station's system id and the time. Returns why not."""
    stops: bool = False
    """It is open to everybody."""


def _chosen(mode: Mode) -> Callable[[Safety, int, float], str | None]:
    return lambda safety, system, now: safety.choose_mode(mode, now)


def _disarm(safety: Safety, system: int, now: float) -> None:
    safety.disarm(f"by a button of GCS {system}", now)
    safety.end_motor_test()


FUNCTIONS: dict[int, ButtonFunction] = {
    1: ButtonFunction("arm", lambda safety, system, now: safety.arm(system, now)),
    2: ButtonFunction("disarm", _disarm, stops=True),
    3: ButtonFunction(
        "emergency stop", lambda safety, system, now: safety.emergency_stop(f"GCS {system}", now), stops=True
    ),
    4: ButtonFunction("HOLD", _chosen(Mode.HOLD), stops=True),
    5: ButtonFunction("MANUAL", _chosen(Mode.MANUAL)),
    6: ButtonFunction("AUTO", _chosen(Mode.AUTO)),
    7: ButtonFunction("RTL", _chosen(Mode.RTL)),
}
"""BTNn_FUNCTION -> what it does; 0 is nothing."""


class Buttons:
    """Remembers which are held."""

    def __init__(self, params: Params, safety: Safety, control: Control, texts: StatusTextQueue) -> None:
        self._params = params
        self._safety = safety
        self._control = control
        self._texts = texts
        self._held: dict[int, tuple[int, float]] = {}

    def handle_manual_control(self, received: Received, message: ManualControl, now: float) -> None:
        """Do what is newly pressed; stops first."""
        if message.target != self._control.system or not received.introduced:
            return
        before, at = self._held.pop(received.system, (0, 0.0))
        known = at and now - at <= self._params["MAN_TIMEOUT"]
        self._held[received.system] = (message.buttons, now)
        if len(self._held) > STATIONS_MAX:
            del self._held[next(iter(self._held))]
        pressed = message.buttons & ~before if known else 0
        if pressed:
            self._press(pressed, received.system, now)

    def _press(self, pressed: int, system: int, now: float) -> None:
        numbers = (int(self._params[f"BTN{bit}_FUNCTION"]) for bit in range(BUTTONS) if pressed >> bit & 1)
        wanted = [FUNCTIONS[number] for number in numbers if number in FUNCTIONS]
        for function in sorted(wanted, key=lambda each: not each.stops)[:1]:
            stranger = None if function.stops else self._control.denial_reason(system)
            refusal = stranger or function.run(self._safety, system, now)
            if isinstance(refusal, str):  # arming says itself why not
                text = f"GCS {system}: button for {function.label} refused: {refusal}"
                self._texts.send(Severity.WARNING, text, now)
