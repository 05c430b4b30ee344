"""The modes of one vehicle: as it lists them, else by autopilot and type; and changes of mode, to the heartbeat."""

from __future__ import annotations

from collections.abc import Callable

import msgspec

from dialects import messages as m
from dialects.enums import Autopilot, Command, Result, result_name
from dialects.modes import DRIVABLE_MODES, STANDING_MODES, known_modes, mode_name, set_mode_params
from groundstation.vehicles.command_requests import CommandRequests
from groundstation.vehicles.identity import AvailableMode, VehicleIdentity
from groundstation.vehicles.requests import RequestBook
from link.core import Received
from link.services.command.client import TRIES, CommandOutcome

CONFIRM_WITHIN = 3.0
"""s for the heartbeat to report the mode that was accepted: three heartbeats."""


class VehicleMode(msgspec.Struct, frozen=True):
    """A mode that the operator may choose."""

    name: str
    custom_mode: int
    selectable: bool = True
    """Whether the vehicle takes it now."""

    @property
    def moves_itself(self) -> bool:
        """Whether the vehicle may move without demands in this mode; also of one that is not known here."""
        return self.name not in DRIVABLE_MODES | STANDING_MODES


class _Change(msgspec.Struct):
    """A change of mode under way."""

    number: int
    name: str
    mode: VehicleMode | None = None
    accepted_at: float | None = None


class ModeRequests:
    """Requests about modes. `autopilot` returns MAV_AUTOPILOT and MAV_TYPE."""

    def __init__(
        self,
        commands: CommandRequests,
        identity: VehicleIdentity,
        book: RequestBook,
        autopilot: Callable[[], tuple[int, int]],
    ) -> None:
        self._commands = commands
        self._identity = identity
        self._book = book
        self._autopilot = autopilot
        self._change: _Change | None = None
        self._lists: list[int] = []
        """Requests that wait for the list."""
        self.current: int | None = None
        """custom_mode of the newest HEARTBEAT."""

    @property
    def modes(self) -> tuple[VehicleMode, ...]:
        """The modes of the vehicle, in its order."""
        return listed_or_known(self._identity, self._autopilot())

    def list_modes(self, number: int, now: float) -> None:
        """Request the list of modes; it ends when `modes` are as good as they get."""
        if self._book.begin(number, "list modes"):
            self._identity.want_modes()
            self._lists.append(number)

    def set(self, number: int, name: str, now: float) -> None:
        """Change to the mode of this name; it ends when the heartbeat reports it.

        The list of modes is requested only for a name that is not known by autopilot and type: it is a round trip for
        each mode.
        """
        if not self._book.begin(number, f"mode {name}"):
            return
        if self._change is not None:
            self._book.refuse(number, f"mode {self._change.name} is being requested", now, by_vehicle=False)
            return
        self._change = _Change(number, name)
        self._begin(now)

    def receive(self, received: Received, now: float) -> None:
        """Take the mode of a HEARTBEAT of the vehicle."""
        if isinstance(received.message, m.Heartbeat) and received.component == self._commands.target[1]:
            self.current = received.message.custom_mode
            self._confirm()

    def tick(self, now: float) -> None:
        """Begin what waits for the list, give up what is not confirmed."""
        if self._identity.modes_settled:
            for number in self._lists:
                self._book.accept(number, "" if self._identity.modes else "not listed by the vehicle")
            self._lists.clear()
        self._begin(now)
        change = self._change
        if change is not None and change.accepted_at is not None and now - change.accepted_at > CONFIRM_WITHIN:
            self._change = None
            self._book.refuse(change.number, "accepted, but its heartbeat reports another mode", now)

    def handle_outcome(self, outcome: CommandOutcome, now: float) -> None:
        """Take how DO_SET_MODE ended."""
        change = self._change
        if change is None or change.mode is None:
            return
        if outcome.result is Result.ACCEPTED:
            change.accepted_at = now
            self._confirm()
            return
        self._change = None
        if outcome.number is None:
            self._book.fail(change.number, f"after {TRIES} tries")
        else:
            self._book.refuse(change.number, result_name(outcome.number).upper().replace(" ", "_"), now)

    def _begin(self, now: float) -> None:
        """Send the change once its mode is known, or refuse it once it will not be."""
        change = self._change
        if change is None or change.mode is not None or self._commands.is_waiting(Command.DO_SET_MODE):
            return
        change.mode = next((mode for mode in self.modes if mode.name.upper() == change.name.upper()), None)
        if change.mode is None and not self._identity.modes_settled:
            self._identity.want_modes()
            return
        if change.mode is None:
            self._change = None
            names = ", ".join(mode.name for mode in self.modes) or "none is known"
            self._book.refuse(change.number, f"no such mode; there are: {names}", now, by_vehicle=False)
            return
        params = set_mode_params(change.mode.custom_mode, self._autopilot()[0])
        self._commands.query(Command.DO_SET_MODE, params, now)

    def _confirm(self) -> None:
        change = self._change
        if change is None or change.mode is None or change.accepted_at is None:
            return
        if self.current == change.mode.custom_mode:
            self._change = None
            self._book.accept(change.number)


def listed_or_known(identity: VehicleIdentity | None, model: tuple[int, int]) -> tuple[VehicleMode, ...]:
    """Return the modes that the vehicle has listed, else those of its `model`: MAV_AUTOPILOT and MAV_TYPE."""
    autopilot, kind = model
    if identity is not None and identity.modes is not None:
        return tuple(_listed(mode, autopilot) for mode in identity.modes)
    return tuple(VehicleMode(name, number) for name, number in known_modes(autopilot, kind).items())


def _listed(mode: AvailableMode, autopilot: int) -> VehicleMode:
    """Return a mode of the list. ArduPilot abbreviates names to four letters: the usual ones stand for them."""
    usual = mode_name(mode.custom_mode, autopilot)
    name = usual if autopilot == Autopilot.ARDUPILOT and not usual.startswith("mode ") else mode.name
    return VehicleMode(name or usual, mode.custom_mode, mode.selectable)
