"""Requests telemetry from a foreign vehicle: which messages, at which rates, by which command.

Our own rover chooses its telemetry itself once it knows that we speak its dialect (dialect_probe.py).

Messages are requested one after the other by SET_MESSAGE_INTERVAL. If the vehicle refuses one, its group is requested
by REQUEST_DATA_STREAM; if it does not know the command or does not answer, all groups are.

WAIT --foreign, or nothing arrives--> REQUEST --every message requested--> DONE
 ^                                                                          |
 +----------------------- lost and back, or rebooted -----------------------+
"""

from __future__ import annotations

import math
from collections.abc import Collection

import msgspec

from dialects import messages as m
from dialects.enums import Autopilot, DataStream, Result
from groundstation.vehicles.probes.dialect_probe import FOREIGN_AUTOPILOTS
from link.services.command.client import CommandOutcome

IDENTIFY_TIMEOUT = 3.0
"""s for an unknown vehicle to send telemetry without a request."""

CAPACITY_SHARE = 0.4
"""Share of the link's capacity: at 60 % ArduPilot's own buffer begins to delay everything (0.18 s at 57600 baud), and
parameters, texts and acknowledgements need room as well."""

MIN_RATE = 0.1
"""Hz. A link that cannot carry this is too slow to drive over."""

FRAME = 12
"""Bytes around a payload (MAVLink 2, unsigned)."""

GROUP_TRIES, GROUP_PERIOD = 3, 1.0
"""How often a group is requested, and s between requests: REQUEST_DATA_STREAM is not acknowledged."""

REBOOT_STEP = 5000
"""ms by which time_boot_ms must go back to count as a reboot."""

REBOOT_PERIOD = 5.0
"""Least time between two reboots, s. With two vehicles of one system id, or a clock that jumps, each message would
otherwise start all requests again: 200 PARAM_REQUEST_READ/s to each such vehicle."""


class StreamRate(msgspec.Struct, frozen=True):
    """Rate at which the Drive screen needs a message, Hz, and ArduPilot's stream group that contains it."""

    rate: float
    group: DataStream
    only: Autopilot | None = None
    """The autopilot that has the message; None: all."""


STREAM_RATES: dict[int, StreamRate] = {
    m.Attitude.id: StreamRate(10.0, DataStream.EXTRA1),
    m.LocalPositionNed.id: StreamRate(5.0, DataStream.POSITION),
    m.ServoOutputRaw.id: StreamRate(5.0, DataStream.RC_CHANNELS),
    m.VfrHud.id: StreamRate(4.0, DataStream.EXTRA2),
    m.GlobalPositionInt.id: StreamRate(2.0, DataStream.POSITION),
    m.SysStatus.id: StreamRate(1.0, DataStream.EXTENDED_STATUS),
    m.GpsRawInt.id: StreamRate(1.0, DataStream.EXTENDED_STATUS),
    m.BatteryStatus.id: StreamRate(1.0, DataStream.EXTRA3),
    m.RcChannels.id: StreamRate(2.0, DataStream.RC_CHANNELS, Autopilot.ARDUPILOT),
    m.ActuatorOutputStatus.id: StreamRate(2.0, DataStream.RC_CHANNELS, Autopilot.PX4),
    m.EkfStatusReport.id: StreamRate(0.5, DataStream.EXTRA3, Autopilot.ARDUPILOT),
    m.EstimatorStatus.id: StreamRate(0.5, DataStream.EXTRA3, Autopilot.PX4),
    m.Vibration.id: StreamRate(0.5, DataStream.EXTRA3),
    m.FenceStatus.id: StreamRate(1.0, DataStream.EXTENDED_STATUS, Autopilot.ARDUPILOT),
    m.MissionCurrent.id: StreamRate(1.0, DataStream.EXTENDED_STATUS),
    m.NavControllerOutput.id: StreamRate(1.0, DataStream.EXTENDED_STATUS),
}
"""Message id -> how to request it. Telemetry to request from a foreign vehicle is one row here."""

FLIGHT_RATES: dict[int, StreamRate] = {m.ExtendedSysState.id: StreamRate(5.0, DataStream.EXTENDED_STATUS)}
"""The same, of what flies only: whether it is on the ground."""

LOAD = sum((m.MESSAGES[number].unpacker.size + FRAME) * wanted.rate for number, wanted in STREAM_RATES.items())
"""Bytes/s of all of them together, of both autopilots: 1807. Those of what flies add 4 %."""

_ALL = {**STREAM_RATES, **FLIGHT_RATES}


class StreamRequests:
    """The telemetry requests to one vehicle and their progress. `now` is when the vehicle was found."""

    def __init__(self, target: tuple[int, int], now: float) -> None:
        self._target = target
        self._since = now
        self._boot = 0
        self._rebooted_at = -math.inf
        self._received: set[int] = set()
        self._pending: list[int] | None = None
        """Messages still to be requested; None until it is known whether any are."""
        self._groups: dict[DataStream, int] = {}
        """Groups to request -> how many times still."""
        self._group_due = 0.0

    def restart(self, now: float) -> None:
        """Start again: the vehicle is back, and may have forgotten all requests."""
        self._since, self._pending = now, None
        self._received.clear()
        self._groups.clear()

    def handle_message(self, message: m.Message, now: float) -> bool:
        """Record what arrives without a request. Returns True when the vehicle's clock shows a reboot; starts again."""
        self._received.add(type(message).id)
        boot = getattr(message, "time_boot_ms", None)
        if boot is None:
            return False
        rebooted = bool(boot < self._boot - REBOOT_STEP) and now - self._rebooted_at >= REBOOT_PERIOD
        self._boot = boot
        if rebooted:
            self._rebooted_at = now
            self.restart(now)
        return rebooted

    def next_message(self, autopilot: int, now: float, *, flies: bool = False) -> int | None:
        """Return the message to request next by SET_MESSAGE_INTERVAL. Call only while no request is pending."""
        if self._pending is None:
            self._pending = self._missing(autopilot, flies, now)
        return self._pending.pop(0) if self._pending else None

    def handle_outcome(self, outcome: CommandOutcome) -> None:
        """Fall back to groups if the vehicle refused a SET_MESSAGE_INTERVAL."""
        if outcome.result is Result.ACCEPTED:
            return
        if outcome.result in (None, Result.UNSUPPORTED):  # the vehicle does not know the command
            self._fall_back(STREAM_RATES)
            self._pending = []
        else:
            self._fall_back([int(outcome.params[0])])

    def due_group_requests(self, capacity: float | None, now: float) -> list[m.Message]:
        """Return the group requests that are due. `capacity` of the link in bytes/s, None if unknown."""
        if not self._groups or now < self._group_due:
            return []
        self._group_due = now + GROUP_PERIOD
        due, self._groups = self._groups, {group: left - 1 for group, left in self._groups.items() if left > 1}
        return [m.RequestDataStream(*self._target, group, _group_rate(group, capacity), 1) for group in due]

    def _missing(self, autopilot: int, flies: bool, now: float) -> list[int] | None:
        rows = (_ALL if flies else STREAM_RATES).items()
        if autopilot in FOREIGN_AUTOPILOTS:  # they send little without a request: 1 Hz, or nothing
            return [number for number, wanted in rows if wanted.only in (None, autopilot)]
        if now - self._since < IDENTIFY_TIMEOUT:
            return None
        common = [number for number, wanted in rows if wanted.only is None]
        return [number for number in common if number not in self._received]

    def _fall_back(self, messages: Collection[int]) -> None:
        for number in messages:
            if number in _ALL:
                self._groups[_ALL[number].group] = GROUP_TRIES


def stream_rate(message: int, capacity: float | None) -> float:
    """Return the rate to request for a message, Hz, so that all of them together fit the link."""
    wanted = _ALL[message].rate
    return wanted if capacity is None else max(MIN_RATE, wanted * min(1.0, CAPACITY_SHARE * capacity / LOAD))


def _group_rate(group: DataStream, capacity: float | None) -> int:
    """Return the rate of a group, rounded down: REQUEST_DATA_STREAM takes whole Hz."""
    return max(
        1, int(max(stream_rate(number, capacity) for number, wanted in STREAM_RATES.items() if wanted.group is group))
    )
