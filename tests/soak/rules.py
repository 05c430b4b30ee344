"""What must hold for the motors at every moment of a soak: tables of what was sent, and the motor log beside them.

Times are monotonic, s; all processes of the machine share that clock.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections import Counter, deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from itertools import pairwise

from dialects import codec
from dialects import messages as m
from dialects.axes import FULL_DEFLECTION
from dialects.enums import ModeFlag
from link.protocol.framer import Framer
from link.signing.signature import is_signed
from tests.e2e.programs import Output

OBEYED = 0.45
"""s: MAN_TIMEOUT and OPR_ECHO_MAX, after which no demand counts any more (docs/safety.md)."""
RAMP = 0.4
"""s from full power to neutral."""
NOISE = 0.15
"""s of a busy machine that the kernel does not count as waiting, and two control cycles."""
SETTLED = 0.1
"""s after a HEARTBEAT: the outputs are set in the cycle in which it was made."""
KEPT = 60.0
"""s of sent demands that are kept; older ones are judged already."""
DEMANDS = (m.RoverOperatorPresence.id, m.ManualControl.id)


@dataclass
class Witness:
    """What the programs have sent, as the network saw it before it lost, delayed or copied anything."""

    demands: deque[float] = field(default_factory=deque)
    """When each demand of motion was sent, by any station."""
    by_station: dict[int, int] = field(default_factory=dict)
    """System id -> number of its demands of motion."""
    beats: deque[tuple[float, bool]] = field(default_factory=deque)
    """When the vehicle sent a HEARTBEAT, and whether it was armed."""
    oldest_obeyed: float = 0.0
    """s; largest age of a demand of motion that the vehicle has reported as obeyed (ROVER_DRIVE_STATUS)."""

    signed: int = 0
    """Frames of all programs with a signature."""
    unsigned: Counter[str] = field(default_factory=Counter)
    """Sender and message -> frames without a signature."""

    def station_says(self, data: bytes, now: float) -> None:
        """Note what a station sends."""
        for number, system, message in self._messages(data, now, DEMANDS):
            if number in DEMANDS and _moves(message):
                self.demands.append(now)
                self.by_station[system] = self.by_station.get(system, 0) + 1

    def vehicle_says(self, data: bytes, now: float) -> None:
        """Note what the vehicle sends."""
        for _, _, message in self._messages(data, now, (m.Heartbeat.id, m.RoverDriveStatus.id)):
            if isinstance(message, m.Heartbeat):
                self.beats.append((now, bool(message.base_mode & ModeFlag.ARMED)))
            elif isinstance(message, m.RoverDriveStatus) and (message.demand_throttle or message.demand_steering):
                self.oldest_obeyed = max(self.oldest_obeyed, message.demand_age_ms / 1000)

    def forget(self, now: float) -> None:
        """Forget what no rule needs any more."""
        while self.demands and self.demands[0] < now - KEPT:
            self.demands.popleft()
        while self.beats and self.beats[0][0] < now - KEPT:
            self.beats.popleft()

    def _messages(self, data: bytes, now: float, wanted: tuple[int, ...]) -> Iterator[tuple[int, int, m.Message]]:
        """Count the frames of a datagram; yield number, system and message of those that are wanted."""
        for number, system, component, _, raw in Framer(stream=False).feed(data, now):
            if is_signed(raw):
                self.signed += 1
            else:
                self.unsigned[f"{system}/{component} {m.MESSAGES[number].msgname}"] += 1
            if number in wanted:
                yield number, system, codec.decode_frame(number, raw)


@dataclass(frozen=True, slots=True)
class Stretch:
    """A time in which the outputs were the same and not neutral."""

    start: float
    end: float
    power: float
    before: float
    """Power until `start`."""


def stretches(outputs: Iterable[Output], last: Output | None, end: float) -> Iterator[Stretch]:
    """Yield where motors had power, from the output `last` (None: none so far) on, up to `end`."""
    power, since, before = _power(last), last.at if last else 0.0, 0.0
    for each in (*outputs, None):
        until = each.at if each else end
        if power and until > since:
            yield Stretch(since, until, power, before)
        before, power, since = power, _power(each), until


def judge(stretch: Stretch, demands: list[float], beats: list[tuple[float, bool]], slack: float) -> Iterator[str]:
    """Yield what is wrong with a stretch, given the sorted demands and beats of the time around it."""
    age = oldest(stretch, demands)
    if age > OBEYED + RAMP + slack:
        yield f"motors had power {age:.3f} s after the newest demand of motion was sent"
    rise = age_at(stretch.start, demands)
    if stretch.power > stretch.before and rise > OBEYED + slack:
        yield f"power rose to {stretch.power:.2f} by a demand that is at least {rise:.3f} s old"
    if was_disarmed(stretch, beats):
        yield f"power {stretch.power:.2f} while disarmed"


def oldest(stretch: Stretch, demands: list[float]) -> float:
    """Return the largest age of the newest demand during a stretch, s; inf without any."""
    inside = demands[bisect_right(demands, stretch.start) : bisect_left(demands, stretch.end)]
    return max(age_at(at, demands) for at in (*inside, stretch.end))


def age_at(at: float, demands: list[float]) -> float:
    """Return the age of the newest demand that was sent before `at`, s; inf without any."""
    place = bisect_left(demands, at)
    return at - demands[place - 1] if place else float("inf")


def was_disarmed(stretch: Stretch, beats: list[tuple[float, bool]]) -> bool:
    """Return whether a stretch lies between two heartbeats that both report disarmed, at least in part."""
    return any(
        not one_armed and not two_armed and stretch.start < two and stretch.end > one + SETTLED
        for (one, one_armed), (two, two_armed) in pairwise(beats)
    )


def _power(output: Output | None) -> float:
    return max(map(abs, output.throttles)) if output else 0.0


def _moves(message: m.Message) -> bool:
    axes = (getattr(message, "x", 0), getattr(message, "r", 0))
    return any(axis and abs(axis) <= FULL_DEFLECTION for axis in axes)
