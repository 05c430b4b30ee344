"""Requests that make a vehicle drive its mission or to a place, as each autopilot understands them.

Our vehicle takes MAV_CMD_MISSION_START and DO_PAUSE_CONTINUE. ArduRover and PX4 start, go on and pause by a change of
mode: ArduRover has no DO_PAUSE_CONTINUE, and PX4 answers MISSION_START only where the mission was uploaded to it.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from dialects.enums import Autopilot, Command
from dialects.kinds import VehicleKind
from dialects.mode_tables import HOLD
from dialects.modes import Mode
from groundstation.geo import place_fault
from groundstation.vehicles.requests.command_requests import CommandRequests
from groundstation.vehicles.requests.mode_requests import ModeRequests
from groundstation.vehicles.requests.requests import RequestBook
from groundstation.vehicles.state.plan_progress import PlanProgress
from link.services.command.client import CommandPlace
from link.services.mission.items import DEGREES_SCALE

GLOBAL, RELATIVE = 0, 3
"""MAV_FRAME_GLOBAL and MAV_FRAME_GLOBAL_RELATIVE_ALT."""
PAUSED = 4
"""MISSION_STATE."""
CHANGE_MODE = 1.0
"""MAV_DO_REPOSITION_FLAGS_CHANGE_MODE."""
DEFAULT_SPEED = -1.0
"""Parameter 1 of DO_REPOSITION that leaves the speed to the vehicle."""
_AUTO: dict[int, str] = {Autopilot.ARDUPILOT: Mode.AUTO.name, Autopilot.PX4: "AUTO_MISSION"}
"""MAV_AUTOPILOT -> the mode that drives the mission; HOLD pauses it."""


FLIES = "missions of what flies are not started here: their altitudes would be those of a rover"


class MissionRequests:
    """Requests to one vehicle; `autopilot` returns its MAV_AUTOPILOT, `model` its kind."""

    def __init__(
        self,
        commands: CommandRequests,
        modes: ModeRequests,
        progress: PlanProgress,
        book: RequestBook,
        autopilot: Callable[[], int],
        model: Callable[[], VehicleKind],
    ) -> None:
        self._commands = commands
        self._modes = modes
        self._progress = progress
        self._book = book
        self._autopilot = autopilot
        self._model = model

    def enable_fence(self, number: int, now: float, *, on: bool) -> None:
        """Switch the fence on or off."""
        what = f"fence {'on' if on else 'off'}"
        self._commands.send(number, Command.DO_FENCE_ENABLE, (float(on),), what, now)

    def start(self, number: int, now: float) -> None:
        """Start the mission with the current item, or go on where it was paused."""
        auto, refusal = _AUTO.get(self._autopilot()), self._model().refusal or (FLIES if self._model().flies else "")
        if refusal:
            if self._book.begin(number, "start the mission"):
                self._book.refuse(number, refusal, now, by_vehicle=False)
        elif auto is not None:
            self._modes.set(number, auto, now)
        elif self._progress.state == PAUSED and self._modes.current == Mode.AUTO:
            self._commands.send(number, Command.DO_PAUSE_CONTINUE, (1.0,), "go on with the mission", now)
        else:
            self._commands.send(number, Command.MISSION_START, (0.0, 0.0), "start the mission", now)

    def pause(self, number: int, now: float) -> None:
        """Stop where the vehicle is."""
        if self._autopilot() in _AUTO:
            self._modes.set(number, HOLD, now)
        else:
            self._commands.send(number, Command.DO_PAUSE_CONTINUE, (0.0,), "pause the mission", now)

    def jump(self, number: int, index: int, now: float) -> None:
        """Make an item the current one; `index` counts without home."""
        item = index + (1 if self._autopilot() == Autopilot.ARDUPILOT else 0)  # its item 0 is home
        self._commands.send(number, Command.DO_SET_MISSION_CURRENT, (float(item),), f"jump to item {item}", now)

    def go_to(self, number: int, latitude: float, longitude: float, now: float) -> None:
        """Drive to a place; the vehicle changes to GUIDED (PX4: HOLD)."""
        what = f"go to {latitude:.6f} {longitude:.6f}"
        altitude = math.nan if self._autopilot() == Autopilot.PX4 else 0.0
        frame = GLOBAL if self._autopilot() == Autopilot.PX4 else RELATIVE
        params = (DEFAULT_SPEED, CHANGE_MODE, 0.0, math.nan, 0.0, 0.0, altitude)
        self._send_at(number, Command.DO_REPOSITION, params, (latitude, longitude), frame, what, now)

    def set_home(self, number: int, latitude: float, longitude: float, now: float) -> None:
        """Move home to a place, at the altitude that it has."""
        what, altitude = f"home at {latitude:.6f} {longitude:.6f}", self._progress.home_altitude
        if altitude is None:
            if self._book.begin(number, what):
                self._book.refuse(number, "the altitude of home is not known yet", now, by_vehicle=False)
            return
        params = (0.0,) * 6 + (altitude,)
        self._send_at(number, Command.DO_SET_HOME, params, (latitude, longitude), GLOBAL, what, now)

    def _send_at(
        self, number: int, command: Command, params: tuple[float, ...], at: tuple[float, float], frame: int, what: str,
        now: float,
    ) -> None:  # fmt: skip
        fault = destination_fault(*at)
        if fault is None:
            place = CommandPlace(frame, *(round(each * DEGREES_SCALE) for each in at))
            self._commands.send(number, command, params, what, now, place)
        elif self._book.begin(number, what):
            self._book.refuse(number, fault, now, by_vehicle=False)


def destination_fault(latitude: float, longitude: float) -> str | None:
    """Return why these degrees are not a place that a vehicle may drive to, or None."""
    return "0, 0 is not a place" if (latitude, longitude) == (0, 0) else place_fault(latitude, longitude)
