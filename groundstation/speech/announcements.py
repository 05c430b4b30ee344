"""What is said of a vehicle, and how urgent it is: changes of its state, and its texts. Values only."""

from __future__ import annotations

from collections.abc import Iterator
from enum import IntEnum

import msgspec

from groundstation.snapshot import VehicleView

ERROR, NOTICE = 3, 5
"""MAV_SEVERITY."""


class Priority(IntEnum):
    """How urgent an announcement is."""

    CHATTER = 0
    """Left out while anything else is said."""
    CHANGE = 1
    """Waits for what is being said."""
    URGENT = 2
    """Must not be missed: it ends what is less urgent, and the bell rings."""


class Announcement(msgspec.Struct, frozen=True):
    """One sentence."""

    priority: Priority
    text: str


class SpokenState(msgspec.Struct, frozen=True):
    """What is compared of a vehicle."""

    name: str
    alive: bool
    armed: bool
    mode: str
    stands: bool
    """The mode is one in which it stays stopped, such as HOLD."""
    emergency_stop: bool = False
    failsafes: tuple[str, ...] = ()
    breach: str = ""
    """That it is outside its fence."""
    driver: str = ""
    """Who is in control, in words; "" if that is not known."""


class StateAnnouncer:
    """Compares the state of the vehicle with what was said last."""

    def __init__(self) -> None:
        self._said: SpokenState | None = None

    def update(self, state: SpokenState | None) -> list[Announcement]:
        """Return what is new, the most urgent first. None: no vehicle is heard."""
        before, self._said = self._said, state
        if state is None:
            return []
        if before is None or before.name != state.name:
            armed = "armed" if state.armed else "disarmed"
            link = "" if state.alive else ", link lost"
            description = Announcement(Priority.CHANGE, f"{state.name}: {state.mode}, {armed}{link}")
            before = msgspec.structs.replace(state, failsafes=(), breach="", emergency_stop=False)
            return [*self._dangers(before, state), description]
        found = [*self._dangers(before, state), *self._states(before, state)]
        return sorted(found, key=lambda each: -each.priority)

    def _dangers(self, before: SpokenState, now: SpokenState) -> Iterator[Announcement]:
        if now.emergency_stop != before.emergency_stop:
            released = Announcement(Priority.CHANGE, "emergency stop released")
            yield _urgent("emergency stop") if now.emergency_stop else released
        if now.alive != before.alive:
            yield Announcement(Priority.CHANGE, "link is back") if now.alive else _urgent("link lost")
        for each in now.failsafes:
            if each not in before.failsafes:
                yield _urgent(f"failsafe: {each}")
        if now.breach and now.breach != before.breach:
            yield _urgent(now.breach)

    def _states(self, before: SpokenState, now: SpokenState) -> Iterator[Announcement]:
        if now.armed != before.armed:
            yield Announcement(Priority.CHANGE, "armed") if now.armed else _urgent("disarmed")
        if now.mode != before.mode:
            stopped = now.stands and before.armed
            yield _urgent(f"stop: {now.mode}") if stopped else Announcement(Priority.CHANGE, f"mode {now.mode}")
        if now.driver != before.driver:
            yield Announcement(Priority.CHANGE, f"in control: {now.driver}")


def spoken_state(vehicle: VehicleView) -> SpokenState:
    """Return what is compared of a vehicle."""
    return SpokenState(
        vehicle.name,
        vehicle.alive,
        vehicle.armed,
        vehicle.mode,
        stands=not vehicle.drivable and not vehicle.drives_itself,
        emergency_stop=vehicle.emergency_stop,
        failsafes=vehicle.failsafes,
        breach=vehicle.breach,
        driver=_driver(vehicle),
    )


def _driver(vehicle: VehicleView) -> str:
    if vehicle.in_control:
        return "you"
    if vehicle.driver is None:
        return ""
    return f"ground station {vehicle.driver}" if vehicle.driver else "nobody"


def text_announcement(severity: int, text: str) -> Announcement:
    """Return the announcement of a text of the vehicle."""
    priority = Priority.CHANGE if severity <= ERROR else Priority.CHATTER
    return Announcement(priority, text)


def is_worth_saying(severity: int) -> bool:
    """Return whether a text is said: not what is information for logs."""
    return severity <= NOTICE


def _urgent(text: str) -> Announcement:
    return Announcement(Priority.URGENT, text)
