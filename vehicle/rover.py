"""The rover as a core: messages, readings and time in; messages and motor outputs out."""

from __future__ import annotations

from collections.abc import Sequence

from link.core import LinkReport, Outgoing, Received
from vehicle.outputs import Outputs
from vehicle.params import Params
from vehicle.readings import NO_READINGS, Readings


class Rover:
    """A `link.core.Core`. Drive it with `receive` as messages come, `sense` with readings, `tick` at 50 Hz."""

    def __init__(self, params: Params, *, now: float, wall_clock: float | None = None) -> None:
        """`now` is the monotonic time of boot; `wall_clock` the Unix time at `now`, None where it is not known."""
        self._boot = now
        self._params = params
        self._wall_clock = wall_clock
        self._readings = NO_READINGS
        self._outgoing: list[Outgoing] = []
        self._outputs = Outputs((0.0, 0.0), enabled=False)

    @property
    def outputs(self) -> Outputs:
        """What the motors must get now; recomputed inside `receive` and `tick`."""
        return self._outputs

    def receive(self, received: Received, now: float) -> None:
        """Take one message; a fresh demand is in `outputs` when this returns."""

    def tick(self, now: float) -> None:
        """Let time pass: act on silence, send what is due."""

    def observe(self, reports: Sequence[LinkReport], now: float) -> None:
        """Take what the links say of themselves, about once a second."""

    def messages_to_send(self) -> list[Outgoing]:
        """What to send now; empties what it returns."""
        outgoing, self._outgoing = self._outgoing, []
        return outgoing

    def sense(self, readings: Readings, now: float) -> None:
        """Take the newest readings."""
        self._readings = readings

    def motor_failed(self, reason: str, now: float) -> None:
        """The motor driver reports an error: zero, disarm, and no arming until `motor_repaired`."""

    def motor_repaired(self, now: float) -> None:
        """The motor driver has passed its self test again: arming is possible."""

    def shutdown(self, now: float) -> None:
        """The last call: neutral, disarmed, and one HEARTBEAT that says POWEROFF."""
