"""DO_SET_GLOBAL_ORIGIN, and SET_GPS_GLOBAL_ORIGIN before it: another place on the globe is 0/0 of local positions.

Nothing moves on the globe by it: what is kept in metres is reckoned anew (vehicle/autonomy/navigator.py, `rebase`). Local
heights count from the origin's, home's where none is given. Whoever asks is told the origin, moved or not (common.xml).
"""

from __future__ import annotations

from collections.abc import Callable

from dialects.enums import Command, Result, Severity
from dialects.messages import SetGpsGlobalOrigin
from link.core import Outgoing, Peer, Received
from link.services.command.server import CommandHandler, CommandRequest
from vehicle.autonomy.navigator import Navigator
from vehicle.autonomy.setpoints import global_to_local
from vehicle.commands.access import ALTITUDE_MAX, CommandAccess, parse_altitude, parse_position
from vehicle.drive.control import Control
from vehicle.navigation.geo import Origin
from vehicle.safety.state_machine import Safety
from vehicle.statustext import StatusTextQueue
from vehicle.telemetry import build_motion
from vehicle.telemetry.view import TelemetryView

MAX_ORIGIN_DISTANCE = 10e3
"""m from the rover: flat ground is wrong by 0.2 % that far from its origin, and no rover of this size drives there."""


class OriginCommands:
    """Of the driver, while disarmed and where the position is known."""

    def __init__(
        self,
        safety: Safety,
        control: Control,
        navigator: Navigator,
        texts: StatusTextQueue,
        look: Callable[[float], TelemetryView],
    ) -> None:
        self._safety = safety
        self._control = control
        self._navigator = navigator
        self._texts = texts
        self._asking = CommandAccess(control, texts)
        self._build_view = look
        self._outbox: list[Outgoing] = []

    def handlers(self) -> dict[int, CommandHandler]:
        """The table for link.services.command.server.CommandServer."""
        return {Command.DO_SET_GLOBAL_ORIGIN: self._asking.require_control(self._set)}

    def messages_to_send(self) -> list[Outgoing]:
        """What goes with an acknowledgement; empties what it returns."""
        outbox, self._outbox = self._outbox, []
        return outbox

    def receive(self, received: Received, message: SetGpsGlobalOrigin, now: float) -> list[Outgoing]:
        """The older message: it has no answer but the origin, and a refusal is told by a text."""
        if not received.introduced:
            return []
        point = message.latitude, message.longitude
        if global_to_local(*point, self._navigator.estimate) is None:
            why: str | None = "it is no place, or the position is not known"
        else:
            why = self._control.denial_reason(received.system) or self._forbidden(*point)
        if why:
            self._texts.send(Severity.WARNING, f"GCS {received.system}: SET_GPS_GLOBAL_ORIGIN refused: {why}", now)
        else:
            self._move(*point, message.altitude / 1e3, received.system, now)
        return self._build_reply(received.peer, now)

    def _set(self, request: CommandRequest, now: float) -> Result:
        """Parameters 5 to 7: the place, and m above the sea, or above home where the frame says so."""
        place = parse_position(request)
        if isinstance(place, Result):
            return place
        if self._safety.armed:
            return Result.TEMPORARILY_REJECTED
        altitude = parse_altitude(request, self._navigator.home)
        if altitude is not None and not abs(altitude) < ALTITUDE_MAX:
            return Result.DENIED
        if why := self._forbidden(*place):
            return self._asking.reject(request, why, now)
        self._move(*place, altitude, request.system, now)
        self._outbox += self._build_reply(request.peer, now)
        return Result.ACCEPTED

    def _forbidden(self, latitude: float, longitude: float) -> str | None:
        """Why the origin stays where it is, or None. Degrees x 1e7."""
        estimate = self._navigator.estimate
        if self._safety.armed:
            return "armed"
        point = global_to_local(latitude, longitude, estimate)
        if point is None or not estimate.good:
            return "position is not known"
        distance = point.distance(estimate.place)
        return (
            None
            if distance <= MAX_ORIGIN_DISTANCE
            else f"it is {distance / 1e3:.0f} km away, {MAX_ORIGIN_DISTANCE / 1e3:g} at most"
        )

    def _move(self, latitude: float, longitude: float, altitude: float | None, system: int, now: float) -> None:
        self._navigator.set_origin(Origin(latitude / 1e7, longitude / 1e7), altitude, self._safety, now)
        self._texts.send(Severity.NOTICE, f"GCS {system} has set the origin of local positions", now)

    def _build_reply(self, peer: Peer, now: float) -> list[Outgoing]:
        message = build_motion.gps_global_origin(self._build_view(now))
        return [] if message is None else [Outgoing(message, peer)]
