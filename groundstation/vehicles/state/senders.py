"""The senders of one system id: paths on which HEARTBEATs of a vehicle arrive, and what each reported last.

Two vehicles may have one id. A report counts for its sender only, so that the disarmed one does not speak for the armed
one. One vehicle on two links has two senders as well, and both must report the same; they are told apart by boot time,
unique id, and by reports that differ for longer than a link is late. Time is an argument.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Iterator
from ipaddress import ip_address

import msgspec

from dialects import messages as m
from dialects.enums import ModeFlag, SystemState
from dialects.kinds import find_kind
from groundstation.vehicles.probes.dialect_probe import FOREIGN_AUTOPILOTS
from groundstation.vehicles.state.vehicle_heartbeat import is_vehicle
from link.core import Received

MAX_SENDERS = 16
"""Senders kept of one id; a flood of invented addresses must not grow a table."""

LIVE = 2.5
"""s without a HEARTBEAT for which a sender counts as heard: two and a half heartbeats."""

REMEMBERED = 60.0
"""s for which a sender that fell silent armed is named: it may still drive where it is not heard."""

BOOT_DIFFERS = 3.0
"""s by which two boot times differ that are not of one vehicle; a link is late by less."""

DIFFERS_FOR = 3.0
"""s for which two senders report differently before they are called two vehicles; a link is late by less."""

TELLING = frozenset({m.Heartbeat, m.AutopilotVersion, m.SystemTime, m.Attitude})
"""Messages that are looked at: any other with time_boot_ms tells no more, and there are a hundred a second."""

Key = tuple[int, int, Hashable, int]


class ReportingSender(msgspec.Struct):
    """One path from a vehicle."""

    component: int
    where: str
    """Its address, as the user writes it."""
    autopilot: int
    kind: int
    armed: bool
    custom_mode: int
    at: float
    """When its newest HEARTBEAT arrived."""
    clash: bool = False
    """It shares its address with another sender that has the same ids, and counts its frames apart."""
    booted_at: float | None = None
    """When it started by our clock, from its newest time_boot_ms."""
    uid: int = 0
    """Unique id of its AUTOPILOT_VERSION; 0: not known."""
    locked: bool = False
    """It reports that its motors are locked. ArduPilot and PX4 mean something else by EMERGENCY."""
    differs_since: float = math.inf
    """Since when its reports differ from those of another sender."""

    def is_live(self, now: float) -> bool:
        """Return whether it is heard."""
        return now - self.at <= LIVE

    @property
    def _mode(self) -> str:
        return find_kind(self.autopilot, self.kind).modes.get(self.custom_mode) or f"mode {self.custom_mode}"

    @property
    def report(self) -> str:
        """What it reported last, in words."""
        locked = ", locked by its emergency stop" if self.locked else ""
        return f"{'ARMED' if self.armed else 'disarmed'} in {self._mode}{locked}"


def is_disarmed(sender: ReportingSender) -> bool:
    """Return whether its last report is disarmed."""
    return not sender.armed


class Senders:
    """The senders of one system id."""

    def __init__(self) -> None:
        self._senders: dict[Key, ReportingSender] = {}

    def receive(self, received: Received, now: float) -> None:
        """Handle a HEARTBEAT of a vehicle, and what tells vehicles apart."""
        message = received.message
        if type(message) not in TELLING:
            return
        key = _key(received)
        if isinstance(message, m.Heartbeat) and is_vehicle(message):
            self._beat(key, message, received, now)
        sender = self._senders.get(key)
        if sender is None:
            return
        if (boot_time := getattr(message, "time_boot_ms", None)) is not None:
            sender.booted_at = now - boot_time / 1000
        elif isinstance(message, m.AutopilotVersion):
            sender.uid = message.uid

    @property
    def components(self) -> tuple[int, ...]:
        """Component ids that claim to be the autopilot, in rising order."""
        return tuple(sorted({each.component for each in self._senders.values()}))

    def is_one_of_here(self, now: float) -> bool:
        """Return whether only one sender is heard, and it is on this machine."""
        live = [each for each in self._senders.values() if each.is_live(now)]
        return len(live) == 1 and _is_loopback(live[0].where)

    def is_armed(self, component: int, now: float) -> bool:
        """Return whether one of the senders of a component that are heard reports armed; else the newest report."""
        found = [each for each in self._senders.values() if each.component == component]
        live = [each for each in found if each.is_live(now)] or found
        if not live:
            return False
        return any(each.armed for each in live) if live is not found else max(live, key=lambda each: each.at).armed

    def find_doubt(
        self, now: float, is_done: Callable[[ReportingSender], bool] = is_disarmed, since: float = -math.inf
    ) -> str:
        """Return which sender does not show that a stop is done, in words; "" if the last report of each does.

        Of several senders each must have reported at or after `since`: one that was disarmed a second ago may be armed.
        """
        for sender in sorted(self._senders.values(), key=lambda each: each.at):
            if not self._counts(sender, now):
                continue
            if is_done(sender):
                if not self._speaks_since(sender, since, now):
                    return f"{self._name(sender)} has not reported since it began"
                continue
            if sender.is_live(now):
                return f"{self._name(sender)} reports {sender.report}"
            return f"{self._name(sender)} reported {sender.report} {now - sender.at:.0f} s ago"
        return ""

    def differ(self, now: float) -> bool:
        """Return whether senders that are heard report differently now, for whatever reason."""
        return any(each.is_live(now) and each.differs_since <= now for each in self._senders.values())

    def describe_duplicates(self, now: float) -> str:
        """Return what shows that several vehicles use this id, in words; "" if nothing does."""
        live = [each for each in self._senders.values() if each.is_live(now)]
        for sender, other in _pairs(live):
            if sender.component == other.component and _are_two(sender, other, now):
                return f"{sender.where} ({sender.report}) and {other.where} ({other.report})"
        return ""

    def _beat(self, key: Key, message: m.Heartbeat, received: Received, now: float) -> None:
        sender = self._senders.get(key)
        armed = bool(message.base_mode & ModeFlag.ARMED)
        if sender is None:
            self._make_room(now)
            where = _where(received)
            sender = ReportingSender(
                received.component, where, message.autopilot, message.type, armed, message.custom_mode, now
            )
            if received.clash:
                self._senders.pop((*key[:3], 0), None)
            self._senders[key] = sender
        sender.autopilot, sender.armed, sender.custom_mode = message.autopilot, armed, message.custom_mode
        sender.locked = message.system_status == SystemState.EMERGENCY and message.autopilot not in FOREIGN_AUTOPILOTS
        sender.at, sender.clash = now, received.clash
        self._compare(sender, now)

    def _compare(self, sender: ReportingSender, now: float) -> None:
        others = [each for each in self._senders.values() if each is not sender and each.component == sender.component]
        differs = any(each.is_live(now) and _state(each) != _state(sender) for each in others)
        sender.differs_since = min(sender.differs_since, now) if differs else math.inf

    def _make_room(self, now: float) -> None:
        self._senders = {key: each for key, each in self._senders.items() if now - each.at <= REMEMBERED}
        if len(self._senders) >= MAX_SENDERS:
            oldest = min(self._senders, key=lambda key: self._senders[key].at)
            del self._senders[oldest]

    def _counts(self, sender: ReportingSender, now: float) -> bool:
        """Return whether what a sender reported last is still the newest that is known of its vehicle."""
        if sender.is_live(now) or not any(each.is_live(now) for each in self._senders.values()):
            return True
        if now - sender.at > REMEMBERED:
            return False
        return not any(each.is_live(now) and _is_same(sender, each) for each in self._senders.values())

    def _speaks_since(self, sender: ReportingSender, since: float, now: float) -> bool:
        """Return whether its report is new enough: one vehicle alone, on whatever paths, is judged by its answer."""
        if sender.at >= since or not sender.is_live(now):
            return True
        others = [each for each in self._senders.values() if each is not sender and each.is_live(now)]
        return all(_is_same(sender, each) for each in others)

    def _name(self, sender: ReportingSender) -> str:
        several = len({each.component for each in self._senders.values()}) > 1
        alone = len(self._senders) == 1
        if alone:
            return "its heartbeat"
        return f"component {sender.component} at {sender.where}" if several else f"the sender at {sender.where}"


def _key(received: Received) -> Key:
    peer = received.peer
    return received.component, peer.link, peer.address, received.numbering if received.clash else 0


def _where(received: Received) -> str:
    address = received.peer.address
    where = f"{address[0]}:{address[1]}" if isinstance(address, tuple) else str(address)
    return f"{where} (numbering {received.numbering})" if received.clash else where


def _state(sender: ReportingSender) -> tuple[bool, int, bool]:
    return sender.armed, sender.custom_mode, sender.locked


def _is_same(sender: ReportingSender, other: ReportingSender) -> bool:
    """Return whether two senders are known to be one vehicle on two paths."""
    if sender.component != other.component:
        return False
    if sender.uid and other.uid:
        return sender.uid == other.uid
    if sender.booted_at is None or other.booted_at is None:
        return False
    return abs(sender.booted_at - other.booted_at) <= BOOT_DIFFERS


def _are_two(sender: ReportingSender, other: ReportingSender, now: float) -> bool:
    """Return whether two senders are known to be two vehicles."""
    if sender.clash and other.clash:
        return True
    if sender.uid and other.uid:
        return sender.uid != other.uid
    started = (sender.booted_at, other.booted_at)
    if started[0] is not None and started[1] is not None and abs(started[0] - started[1]) > BOOT_DIFFERS:
        return True
    return now - max(sender.differs_since, other.differs_since) >= DIFFERS_FOR


def _pairs(senders: list[ReportingSender]) -> Iterator[tuple[ReportingSender, ReportingSender]]:
    return ((one, other) for at, one in enumerate(senders) for other in senders[at + 1 :])


def _is_loopback(where: str) -> bool:
    """Return whether the address of a socket, as text, is on the loopback of this machine."""
    try:
        return ip_address(where.rpartition(":")[0]).is_loopback
    except ValueError:
        return False
