"""What a vehicle says about its pre-arm checks: the bits of SYS_STATUS, and the texts of the last checks."""

from __future__ import annotations

import msgspec

from dialects import messages as m
from dialects.enums import Command, Result, Sensor
from groundstation.doctor.facts import PreArmText, SensorBits
from groundstation.doctor.prearm_advice import reason_of
from link.core import Received

KEPT_FOR = 35.0
"""s for which a reason is kept: ArduPilot repeats those that hold every 30 s."""
ANSWER_WITHIN = 2.0
"""s around the acknowledgement of the checks within which their texts arrive; older reasons hold no more."""
MAX_TEXTS = 20
"""Reasons kept; a flood of invented ones must not grow a table."""
READY = "ready to arm"
"""What our rover says when nothing is wrong."""


class ArmingChecks(msgspec.Struct):
    """The newest report of one vehicle. `component` is the one that the station talks to."""

    component: int
    bits: SensorBits | None = None
    checked_at: float | None = None
    """When the vehicle has accepted a request for the checks, whoever has made it."""

    _texts: dict[str, float] = msgspec.field(default_factory=dict)
    """Reason -> when it arrived."""

    def receive(self, received: Received, now: float) -> None:
        """Handle SYS_STATUS, and the answer to a request for the checks."""
        match received.message:
            case m.SysStatus() as message if received.component == self.component:
                self._take_bits(message)
            case m.CommandAck(command=Command.RUN_PREARM_CHECKS, result=Result.ACCEPTED):
                self.checked_at = now
                self._texts = {text: at for text, at in self._texts.items() if now - at <= ANSWER_WITHIN}

    def _take_bits(self, message: m.SysStatus) -> None:
        """While the checks are passed no reason holds."""
        self.bits = SensorBits(
            message.onboard_control_sensors_present,
            message.onboard_control_sensors_enabled,
            message.onboard_control_sensors_health,
        )
        if self.bits.present & self.bits.health & Sensor.PREARM:
            self._texts.clear()

    def handle_text(self, text: str, now: float) -> None:
        """Handle a whole STATUSTEXT."""
        reason = reason_of(text)
        if reason == READY:
            self._texts.clear()
        elif reason is not None:
            self._texts.pop(reason, None)
            self._texts[reason] = now
            if len(self._texts) > MAX_TEXTS:
                del self._texts[next(iter(self._texts))]

    def checked_ago(self, now: float) -> float | None:
        """Return whole s since the checks ran; None: they have not run on request."""
        return None if self.checked_at is None else (now - self.checked_at) // 1

    def texts(self, now: float) -> tuple[PreArmText, ...]:
        """Return the reasons that still hold, in the order in which they came."""
        self._texts = {text: at for text, at in self._texts.items() if now - at <= KEPT_FOR}
        return tuple(PreArmText(text, now - at) for text, at in self._texts.items())
