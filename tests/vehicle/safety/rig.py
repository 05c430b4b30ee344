"""Safety, its monitor and the driver's control without the rest of a rover: to see one cycle, to the moment."""

from __future__ import annotations

from dialects.axes import Axes, build_manual_control
from dialects.enums import Failsafe, Severity
from dialects.modes import Mode
from link.core import Peer, Received
from tests.vehicle.bench import DRIVER, NEUTRAL
from vehicle.drive.control import Control
from vehicle.params import Params
from vehicle.safety.monitor import SafetyMonitor
from vehicle.safety.state_machine import Safety
from vehicle.statustext import StatusTextQueue

START = 100.0


class Rig:
    """`now` moves only where a test moves it. Texts are kept with their severity."""

    def __init__(self, **params: float) -> None:
        self.now = START
        self.texts: list[tuple[Severity, str]] = []
        self.unready: dict[Mode, str] = {}
        """Modes that cannot work, and why."""
        self.unfenced: str | None = None
        self.params = Params(params)
        queue = StatusTextQueue(lambda severity, text: self.texts.append((severity, text)))
        self.control = Control(self.params, queue, system=1, boot=0.0)
        self.safety = Safety(self.params, self.control, queue, START, self.unready.get, lambda: self.unfenced)
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
        self.control.update_liveness(received, self.now)
        return self.control.handle_manual_control(received, message, self.now)

    def cycle(self, seconds: float = 0.02, *, refused: int = 0, driving: bool = False,
              hazards: dict[Failsafe, float] | None = None) -> None:  # fmt: skip
        """One cycle, `seconds` after the last."""
        self.now += seconds
        self.monitor.update(self.now, refused, hazards or {}, driving=driving)

    def armed(self, *, neutral: bool = True) -> Rig:
        """Boot, arm, and show a stick at rest."""
        self.cycle()
        assert self.safety.arm(DRIVER, self.now) == []
        if neutral:
            assert self.stick(NEUTRAL)
        return self

    def said(self, part: str) -> bool:
        """Whether a text has `part` in it."""
        return any(part in text for _, text in self.texts)

    def severity(self, part: str) -> Severity:
        """Of the newest text with `part` in it."""
        return next(severity for severity, text in reversed(self.texts) if part in text)
