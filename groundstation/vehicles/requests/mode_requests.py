"""The modes of one vehicle: as it lists them, else by autopilot and type; and changes of mode, to the heartbeat.

A vehicle of a kind that is not driven is only sent a mode that it lists itself: numbers mean something else there.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable

import msgspec
from msgspec.structs import replace

from dialects import messages as m
from dialects.enums import Command, Result, result_token
from dialects.kinds import VehicleKind, find_kind
from dialects.modes import set_mode_params
from groundstation.vehicles.requests.command_requests import CommandRequests
from groundstation.vehicles.requests.requests import RequestBook
from groundstation.vehicles.state.identity import AvailableMode, VehicleIdentity
from link.core import Received
from link.services.command.client import TRIES, CommandOutcome

CONFIRM_WITHIN = 3.0
"""s for the heartbeat to report the mode that was accepted: three heartbeats."""
SILENT_WITHIN = 5.0
"""s more for a heartbeat, if none came in that time: only one that comes can report another mode."""


class VehicleMode(msgspec.Struct, frozen=True):
    """A mode that the operator may choose."""

    name: str
    custom_mode: int
    selectable: bool = True
    """Whether the vehicle takes it now."""
    moves_itself: bool = True
    """The vehicle may move without demands in this mode; also in one that is not known here."""
    listed: str = ""
    """The vehicle's own name for it."""


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
        self._heard_at = -math.inf

    @property
    def modes(self) -> tuple[VehicleMode, ...]:
        """The modes of the vehicle, in its order."""
        return listed_or_known(self._identity, self._autopilot())

    def find(self, name: str) -> VehicleMode | None:
        """Return the mode of this name, in any case: the usual one, the vehicle's own, or an alias."""
        kind, wanted = find_kind(*self._autopilot()), name.upper()
        modes = self.modes
        found = next((mode for mode in modes if wanted in (mode.name.upper(), mode.listed.upper())), None)
        number = kind.number_of(name) if found is None else None
        return found or next((mode for mode in modes if mode.custom_mode == number), None)

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
        """Handle the mode of a HEARTBEAT of the vehicle."""
        if isinstance(received.message, m.Heartbeat) and received.component == self._commands.target[1]:
            self.current, self._heard_at = received.message.custom_mode, now
            self._confirm()

    def tick(self, now: float) -> None:
        """Begin what waits for the list, give up what is not confirmed."""
        if self._identity.modes_settled:
            for number in self._lists:
                self._book.accept(number, "" if self._identity.modes else "not listed by the vehicle")
            self._lists.clear()
        self._begin(now)
        self._give_up(now)

    def handle_outcome(self, outcome: CommandOutcome, now: float) -> None:
        """Note how DO_SET_MODE ended."""
        change = self._change
        if change is None or change.mode is None:
            return
        if outcome.result is Result.ACCEPTED:
            change.accepted_at = now
            self._confirm()
            return
        self._change = None
        if outcome.refusal:  # it was not sent
            self._book.refuse(change.number, outcome.refusal, now, by_vehicle=False)
        elif outcome.number is None:
            self._book.fail(change.number, f"after {TRIES} tries")
        else:
            self._book.refuse(change.number, result_token(outcome.number), now, answer=outcome.number)

    def _give_up(self, now: float) -> None:
        """End a change that was accepted and is not confirmed in time."""
        change = self._change
        if change is None or change.accepted_at is None or now - change.accepted_at <= CONFIRM_WITHIN:
            return
        if self._heard_at >= change.accepted_at:
            self._change = None
            self._book.refuse(change.number, "accepted, but its heartbeat reports another mode", now)
        elif now - change.accepted_at > CONFIRM_WITHIN + SILENT_WITHIN:
            self._change = None
            self._book.fail(change.number, f"accepted, but no heartbeat came for {CONFIRM_WITHIN + SILENT_WITHIN:g} s")

    def _begin(self, now: float) -> None:
        """Send the change once its mode is known, or refuse it once it will not be."""
        change = self._change
        if change is None or change.mode is not None or self._commands.is_waiting(Command.DO_SET_MODE):
            return
        change.mode = self.find(change.name)
        if change.mode is None and not self._identity.modes_settled:
            self._identity.want_modes()
            return
        if change.mode is None:
            self._change = None
            self._book.refuse(change.number, self._unknown_reason(), now, by_vehicle=False)
            return
        params = set_mode_params(change.mode.custom_mode, self._autopilot()[0])
        self._commands.query(Command.DO_SET_MODE, params, now)

    def _unknown_reason(self) -> str:
        names = ", ".join(mode.name for mode in self.modes)
        if names:
            return f"no such mode; there are: {names}"
        refusal = find_kind(*self._autopilot()).refusal
        return f"{refusal}, and it lists no modes itself" if refusal else "no such mode; none is known"

    def _confirm(self) -> None:
        change = self._change
        if change is None or change.mode is None or change.accepted_at is None:
            return
        if self.current == change.mode.custom_mode:
            self._change = None
            self._book.accept(change.number)


def listed_or_known(identity: VehicleIdentity | None, model: tuple[int, int]) -> tuple[VehicleMode, ...]:
    """Return the modes that the vehicle has listed, else those of its `model`: MAV_AUTOPILOT and MAV_TYPE."""
    kind = find_kind(*model)
    if identity is not None and identity.modes is not None:
        return _without_doubles(_listed(mode, kind) for mode in identity.modes)
    return tuple(
        VehicleMode(name, number, moves_itself=kind.moves_itself(name)) for name, number in kind.choices.items()
    )


def _listed(mode: AvailableMode, kind: VehicleKind) -> VehicleMode:
    """Return a mode of the list. ArduPilot abbreviates names to four letters: the usual ones stand for them."""
    name = kind.modes.get(mode.custom_mode) or mode.name or kind.mode_name(mode.custom_mode)
    return VehicleMode(name, mode.custom_mode, mode.selectable, kind.moves_itself(name), mode.name)


def _without_doubles(modes: Iterable[VehicleMode]) -> tuple[VehicleMode, ...]:
    """Return each custom_mode once; a name that another one has already is told apart by its number."""
    found: dict[int, VehicleMode] = {}
    names: set[str] = set()
    for mode in modes:
        if mode.custom_mode not in found:
            name = mode.name if mode.name not in names else f"{mode.name} {mode.custom_mode}"
            names.add(name)
            found[mode.custom_mode] = replace(mode, name=name)
    return tuple(found.values())
