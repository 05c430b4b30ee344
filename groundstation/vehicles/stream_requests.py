"""Which telemetry a foreign vehicle is asked for, how often, and how. Our own rover knows by itself what to send
to whom it knows as one of ours (dialect_probe.py).

One message after the other by SET_MESSAGE_INTERVAL; where the vehicle refuses one, the group that holds it by
REQUEST_DATA_STREAM; where it does not know the command or does not answer, all groups.

WAIT --foreign, or nothing comes--> ASK --every message asked for--> DONE
 ^                                                                    |
 +-------------------------- lost and back, or rebooted -------------+
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from dialects import messages as m
from dialects.enums import DataStream, Result
from groundstation.vehicles.dialect_probe import FOREIGN_AUTOPILOTS
from link.services.command.client import CommandOutcome

IDENTIFY_TIMEOUT = 3.0
"""s that a vehicle of no known kind gets to send by itself."""

CAPACITY_SHARE = 0.4
"""Of the link's capacity: 60 % full, ArduPilot's own buffer begins to delay everything (0.18 s at 57600 baud), and
parameters, texts and answers need room, too."""

MIN_RATE = 0.1
"""Hz. A link that takes less is none to drive over."""

FRAME = 12
"""Bytes around a payload (MAVLink 2, unsigned)."""

GROUP_TRIES, GROUP_AGAIN = 3, 1.0
"""Times that a group is asked for, and s between them: nothing answers REQUEST_DATA_STREAM."""

REBOOTED = 5000
"""ms that the vehicle's clock goes back when it has started anew, at least."""


@dataclass(frozen=True, slots=True)
class StreamRate:
    """How often the Drive screen needs a message, Hz, and ArduPilot's group that holds it."""

    rate: float
    group: DataStream


STREAM_RATES: dict[int, StreamRate] = {
    m.Attitude.id: StreamRate(10.0, DataStream.EXTRA1),
    m.LocalPositionNed.id: StreamRate(5.0, DataStream.POSITION),
    m.ServoOutputRaw.id: StreamRate(5.0, DataStream.RC_CHANNELS),
    m.VfrHud.id: StreamRate(4.0, DataStream.EXTRA2),
    m.GlobalPositionInt.id: StreamRate(2.0, DataStream.POSITION),
    m.SysStatus.id: StreamRate(1.0, DataStream.EXTENDED_STATUS),
    m.GpsRawInt.id: StreamRate(1.0, DataStream.EXTENDED_STATUS),
    m.BatteryStatus.id: StreamRate(1.0, DataStream.EXTRA3),
}
"""Message -> how it is wanted."""

LOAD = sum((m.MESSAGES[number].unpacker.size + FRAME) * wanted.rate for number, wanted in STREAM_RATES.items())
"""Bytes/s of all of them together: 1240."""


class StreamRequests:
    """What one vehicle is asked for, and how far that has come. `now` is when it was found."""

    def __init__(self, target: tuple[int, int], now: float) -> None:
        self._target = target
        self._since = now
        self._boot = 0
        self._heard: set[int] = set()
        self._ask: list[int] | None = None
        """Messages still to be asked for; None until it is known whether any are."""
        self._groups: dict[DataStream, int] = {}
        """Groups to ask for -> how often still."""
        self._group_due = 0.0

    def restart(self, now: float) -> None:
        """The vehicle is back, and may have forgotten everything."""
        self._since, self._ask = now, None
        self._heard.clear()
        self._groups.clear()

    def handle_message(self, message: m.Message, now: float) -> None:
        """Note what comes by itself, and a clock that starts anew."""
        self._heard.add(type(message).id)
        boot = getattr(message, "time_boot_ms", None)
        if boot is not None:
            if boot < self._boot - REBOOTED:
                self.restart(now)
            self._boot = boot

    def next_message(self, autopilot: int, now: float) -> int | None:
        """The message to ask for now by SET_MESSAGE_INTERVAL. To be called while no other is being asked for."""
        if self._ask is None:
            self._ask = self._missing(autopilot, now)
        return self._ask.pop(0) if self._ask else None

    def handle_outcome(self, outcome: CommandOutcome) -> None:
        """How it took one of them."""
        if outcome.result is Result.ACCEPTED:
            return
        if outcome.result in (None, Result.UNSUPPORTED):  # it knows the command not at all
            self._fall_back(STREAM_RATES)
            self._ask = []
        else:
            self._fall_back([int(outcome.params[0])])

    def due_group_requests(self, capacity: float | None, now: float) -> list[m.Message]:
        """The group requests that are due. `capacity` of the link in bytes/s, None where nobody knows."""
        if not self._groups or now < self._group_due:
            return []
        self._group_due = now + GROUP_AGAIN
        asked, self._groups = self._groups, {group: left - 1 for group, left in self._groups.items() if left > 1}
        return [m.RequestDataStream(*self._target, group, _group_rate(group, capacity), 1) for group in asked]

    def _missing(self, autopilot: int, now: float) -> list[int] | None:
        if autopilot in FOREIGN_AUTOPILOTS:  # they send little until they are asked: 1 Hz, or nothing
            return list(STREAM_RATES)
        if now - self._since < IDENTIFY_TIMEOUT:
            return None
        return [number for number in STREAM_RATES if number not in self._heard]

    def _fall_back(self, messages: Collection[int]) -> None:
        for number in messages:
            if number in STREAM_RATES:
                self._groups[STREAM_RATES[number].group] = GROUP_TRIES


def stream_rate(message: int, capacity: float | None) -> float:
    """How often to ask for a message, Hz, so that all of them fit the link."""
    wanted = STREAM_RATES[message].rate
    return wanted if capacity is None else max(MIN_RATE, wanted * min(1.0, CAPACITY_SHARE * capacity / LOAD))


def _group_rate(group: DataStream, capacity: float | None) -> int:
    """Whole Hz is all that REQUEST_DATA_STREAM knows."""
    return max(
        1, int(max(stream_rate(number, capacity) for number, wanted in STREAM_RATES.items() if wanted.group is group))
    )
