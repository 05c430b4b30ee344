"""Core of the watchdog: when to send neutral in the place of the station, to whom, until when, and what is known of it.

It begins at once when the station's end of the socket is closed, or after STALL_TIMEOUT without a report
(REST_STALL_TIMEOUT if the newest one says that the station rests). It ends when the station runs again, when every
vehicle has reported that it stands, or after SEND_FOR. A report of the station ends it without a handshake: by then the
station has found out that it stood still, and is neutral itself (stall.py).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import Enum, auto

import msgspec

from dialects import codec
from dialects.enums import ModeFlag
from dialects.messages import Heartbeat, Message, RoverDriveStatus, VfrHud
from groundstation.snapshot import StationOutage
from groundstation.station.driving.driven import WatchdogTarget
from groundstation.station.driving.stall import REST_STALL_TIMEOUT, STALL_TIMEOUT
from groundstation.vehicles.demand.demand_stream import DRIVING_PERIOD, NEUTRAL_PERIOD, SETTLE
from groundstation.watchdog.neutral import NeutralFrames
from groundstation.watchdog.report import StationReport
from link.protocol.frame import Frame
from link.signing.signature import is_signed
from link.signing.signing import Signing
from link.signing.verifier import Verified

SEND_FOR = 5.0
"""s of neutral at most. A vehicle that is silent for longer has lost its link, and its own failsafe acts; and the port
must be free when the operator starts the ground station again."""

STANDING_SPEED, STANDING_FOR = 0.2, 0.5
"""m/s below which, and s for which, a foreign vehicle counts as standing: GPS speed has noise."""

TWIN_BEAT = 2.5
"""s after a HEARTBEAT that reports armed for which none that reports disarmed confirms anything: two heartbeats of
another vehicle with the same id, one of which may get lost."""

WANTED = frozenset((Heartbeat.id, RoverDriveStatus.id, VfrHud.id))
"""Ids of the messages that show whether a vehicle stands."""


class Cause(Enum):
    """Why the station does not send."""

    ENDED = auto()
    STALLED = auto()


_STATION = {
    Cause.ENDED: "station process ended",
    Cause.STALLED: "station not responding",
}


class _Target(msgspec.Struct):
    """A vehicle that gets neutral."""

    vehicle: WatchdogTarget
    sent: bool = False
    """The kernel has accepted a frame."""
    error: str = ""
    """Why the newest frame that it refused was not accepted."""
    disarmed: bool = False
    armed_at: float = -math.inf
    """When a HEARTBEAT reported armed last: another vehicle may have the same id, and one report confirms nothing."""
    stands: bool = False
    slow_since: float = math.inf

    def handle(self, message: Message, now: float) -> None:
        """Note what a message of the vehicle shows, after the first neutral was sent."""
        match message:
            case Heartbeat():
                armed = bool(message.base_mode & ModeFlag.ARMED)
                self.armed_at = now if armed else self.armed_at
                self.disarmed = now - self.armed_at > TWIN_BEAT
            case RoverDriveStatus():
                self.stands = not any(message.output)
            case VfrHud() if self.vehicle.session is None:
                fastest = max(message.groundspeed, abs(message.climb) if self.vehicle.flies else 0.0)
                slow = fastest < STANDING_SPEED
                self.slow_since = min(self.slow_since, now) if slow else math.inf
                self.stands = now - self.slow_since >= STANDING_FOR

    @property
    def confirmed(self) -> bool:
        """The newest messages of the vehicle show that it does not drive."""
        return self.disarmed or self.stands

    def describe(self, *, sending: bool) -> str:
        """Return what is known, as a text for the driver."""
        name, flies = self.vehicle.name, self.vehicle.flies
        if self.confirmed:
            return f"{name} {'is disarmed' if self.disarmed else 'hovers' if flies else 'stands'}"
        if not self.sent:
            then = "; its own failsafe acts" if flies else ""
            return f"neutral could NOT be sent to {name} ({self.error or 'no link'}){then}"
        if sending:
            return f"neutral is sent to {name}"  # short: an alert has 70 characters at 80 columns
        return f"{name}: its own failsafe flies it" if flies else f"{name} may still move"


@dataclass(slots=True)
class _Takeover:
    """One time in which the watchdog sends."""

    cause: Cause
    since: float
    targets: list[_Target]
    frames: list[tuple[int, int, NeutralFrames]]
    """Route, target, and what goes there."""
    due: float = field(init=False)

    def __post_init__(self) -> None:
        self.due = self.since

    def is_sending(self, now: float) -> bool:
        """Return whether there is a reason to go on."""
        if not self.frames or now - self.since > SEND_FOR:
            return False
        return now - self.since < SETTLE or not all(target.confirmed for target in self.targets)


class Watchdog:
    """One station. Times are s of the clock that the station uses, too."""

    def __init__(self, signing: Signing | None = None) -> None:
        """`signing`: the station's, with which it signs in its place."""
        self._signing = signing
        self._report = StationReport()
        self._heard_at = math.inf
        """When the newest report came; before the first the station is still starting."""
        self._ended = False
        self._takeover: _Takeover | None = None

    def handle_report(self, report: StationReport, now: float) -> None:
        """Note that the station runs, and what it drives."""
        self._report, self._heard_at = report, now
        self._takeover = None

    def handle_end(self, now: float) -> None:
        """Note that the station's process has ended."""
        self._ended = True
        if self._takeover is not None:
            self._takeover.cause = Cause.ENDED
        elif self._heard_at < math.inf and not self._report.ending:
            self._begin(Cause.ENDED, now)

    def handle_frame(self, frame: Frame, now: float) -> None:
        """Note what a frame shows.

        Of a vehicle that signs only what is genuine and new counts: else a forger ends the neutral with a HEARTBEAT
        that says disarmed.
        """
        number, system, component, _, raw = frame
        ids = (system, component)
        driven = next((each for each in self._report.vehicles if (each.system, each.component) == ids), None)
        if driven is not None and (not driven.verified or self._verifies(raw, system, component, now)):
            self.handle_message(system, codec.decode_frame(number, raw), now)

    def _verifies(self, raw: bytes, system: int, component: int, now: float) -> bool:
        if self._signing is None or not is_signed(raw):
            return False
        return isinstance(self._signing.verifier.check(raw, system, component, now), Verified)

    def handle_message(self, system: int, message: Message, now: float) -> None:
        """Note whether a vehicle stands. Called only once the station has ended: it reads the same sockets."""
        for target in self._takeover.targets if self._takeover else ():
            if target.vehicle.system == system and target.sent:
                target.handle(message, now)

    def tick(self, now: float) -> list[tuple[int, int, bytes]]:
        """Return the frames to send now: route, target (for `record_sent`) and bytes."""
        if self._takeover is None and not self._ended and now - self._heard_at > self._stall_timeout:
            self._begin(Cause.STALLED, now)
        takeover = self._takeover
        if takeover is None or now < takeover.due or not takeover.is_sending(now):
            return []
        takeover.due = now + (DRIVING_PERIOD if now - takeover.since < SETTLE else NEUTRAL_PERIOD)
        return [(route, target, frames.next_frame(now)) for route, target, frames in takeover.frames]

    def record_sent(self, target: int, error: str | None) -> None:
        """Record whether the kernel has accepted a frame (None) or why not."""
        if self._takeover is not None:
            each = self._takeover.targets[target]
            if error is None:
                each.sent = True
            else:
                each.error = error

    def timeout(self, now: float) -> float | None:
        """Return the s until the next `tick`; None: only an event of the station brings one."""
        takeover = self._takeover
        if takeover is not None:
            return max(0.0, takeover.due - now) if takeover.is_sending(now) else None
        return max(0.0, self._heard_at + self._stall_timeout - now) + 0.001 if self._heard_at < math.inf else None

    @property
    def _stall_timeout(self) -> float:
        return REST_STALL_TIMEOUT if self._report.rests else STALL_TIMEOUT

    def finished(self, now: float) -> bool:
        """Return whether the station has ended and nothing is left to send."""
        return self._ended and (self._takeover is None or not self._takeover.is_sending(now))

    def outage(self, now: float) -> StationOutage:
        """Return what the screen shows; without a text while the station runs."""
        takeover = self._takeover
        if takeover is None:
            return StationOutage()
        sending = takeover.is_sending(now)
        known = [target.describe(sending=sending) for target in takeover.targets] or ["nothing is sent"]
        return StationOutage(f"{_STATION[takeover.cause]}: {', '.join(known)}", takeover.cause is Cause.ENDED)

    def _begin(self, cause: Cause, now: float) -> None:
        report = self._report
        targets = [_Target(vehicle) for vehicle in report.vehicles]
        frames = [
            (index, route.vehicle, NeutralFrames(report.vehicles[route.vehicle], report.ids, route, self._signing))
            for index, route in enumerate(report.routes)
        ]
        self._takeover = _Takeover(cause, now, targets, frames)
