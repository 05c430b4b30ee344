"""Safety, its monitor and the driver's control without the rest of a rover: to see one cycle, to the moment."""

from __future__ import annotations

from dialects.axes import Axes, build_manual_control
from dialects.enums import Failsafe, Severity
from dialects.messages import RoverOperatorPresence
from dialects.modes import Mode
from link.core import Peer, Received
from tests.vehicle.bench import DRIVER, NEUTRAL
from tests.vehicle.conversations import conversation
from vehicle.drive.control import Control
from vehicle.navigation.estimate import Estimate
from vehicle.params import Params
from vehicle.readings import Readings
from vehicle.safety.failsafe_inputs import MotionInputs
from vehicle.safety.monitor import SafetyMonitor
from vehicle.safety.state_machine import Safety
from vehicle.statustext import StatusTextQueue

BOOT, START = 50.0, 100.0


STANDING = MotionInputs(
    Readings(), Estimate(good=True), (0.0, 0.0), needs_position=False, setpoint_expires=None, outside_fence=False
)
MOTIONS = {
    Failsafe.POSITION: STANDING._replace(estimate=Estimate(), needs_position=True),
    Failsafe.FENCE: STANDING._replace(outside_fence=True),
    Failsafe.TILT: STANDING._replace(readings=Readings(roll=1.5)),
    Failsafe.BLOCKED: STANDING._replace(readings=Readings(wheel_speeds=(0.0, 0.0)), throttles=(1.0, 1.0)),
}
"""Condition -> what makes it hold."""


class Ready:
    """A readiness that a test sets."""

    def __init__(self) -> None:
        self.unready: dict[Mode, str] = {}
        """Modes that cannot work, and why."""
        self.fence_unenforceable_reason: str | None = None

    def unready_reason(self, mode: Mode) -> str | None:
        return self.unready.get(mode)


class Rig:
    """`now` moves only where a test moves it. Texts are kept with their severity."""

    def __init__(self, **params: float) -> None:
        self.now = START
        self.texts: list[tuple[Severity, str]] = []
        self.ready = Ready()
        self.params = Params(params)
        queue = StatusTextQueue(lambda severity, text: self.texts.append((severity, text)))
        self.control = Control(self.params, queue, system=1, boot=BOOT)
        self.safety = Safety(self.params, self.control, queue, START, self.ready)
        self.monitor = SafetyMonitor(self.params, self.safety, self.control, queue, START)
        self._sequence = 0

    def received(self, message: object, system: int = DRIVER, *, introduced: bool = True) -> Received:
        """As from a link, with a sequence number of its own."""
        self._sequence = (self._sequence + 1) % 256
        return Received(message, system, 190, self._sequence, Peer(0, "gcs"), introduced)  # type: ignore[arg-type]

    def stick(self, axes: Axes, system: int = DRIVER) -> bool:
        """A MANUAL_CONTROL of a ground station, at once."""
        message = build_manual_control(axes, 1)
        received = self.received(message, system)
        self.control.hear(received, self.now)
        return self.control.handle_manual_control(received, message, self.now)

    def presence(
        self, *, target: int = 1, system: int = DRIVER, introduced: bool = True, session: int = 1, echo: int = 0
    ) -> None:
        """A ROVER_OPERATOR_PRESENCE of a ground station, at once."""
        message = RoverOperatorPresence(target, 1, 0, echo, session, 1, 0, 1)
        received = self.received(message, system, introduced=introduced)
        self.control.handle_operator_presence(received, message, self.now)

    def controlled(self) -> Rig:
        """DRIVER takes control and shows a stick at rest."""
        self.control.take(conversation(DRIVER), self.now)
        assert self.stick(NEUTRAL)
        return self

    def cycle(
        self, seconds: float = 0.02, cause: Failsafe | None = None, *, refused: int = 0, driving: bool = False
    ) -> None:
        """One cycle, `seconds` after the last, in which `cause` holds."""
        self.now += seconds
        self.monitor.update(self.now, refused, STANDING if cause is None else MOTIONS[cause], driving=driving)

    def endure(self, cause: Failsafe) -> None:
        """`cause` holds for long enough for each of its steps, with a driver who sends a stick at rest."""
        for _ in range(12):
            self.stick(NEUTRAL)
            self.cycle(0.2, cause)

    def armed(self, *, neutral: bool = True) -> Rig:
        """Boot, arm, and show a stick at rest."""
        self.cycle()
        assert self.safety.arm(conversation(DRIVER), self.now) == []
        if neutral:
            assert self.stick(NEUTRAL)
        return self

    def said(self, part: str) -> bool:
        """Whether a text has `part` in it."""
        return any(part in text for _, text in self.texts)

    def severity(self, part: str) -> Severity:
        """Of the newest text with `part` in it."""
        return next(severity for severity, text in reversed(self.texts) if part in text)
