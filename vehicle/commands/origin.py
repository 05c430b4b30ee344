"""DO_SET_GLOBAL_ORIGIN and the older SET_GPS_GLOBAL_ORIGIN: move 0/0 of local positions to another place on the globe.

The rover and its home keep their places on the globe (vehicle/autonomy/navigator.py, `set_origin`). Local altitudes
count from the altitude of the origin, or from home if none is given. The sender gets GPS_GLOBAL_ORIGIN, moved or not
(common.xml).
"""

from __future__ import annotations

from dialects.enums import Command, Result, Severity
from dialects.messages import SetGpsGlobalOrigin
from link.core import Outgoing, Peer, Received
from link.services.command.request import CommandRequest
from link.services.command.server import CommandReply
from vehicle.autonomy.setpoints import global_to_local
from vehicle.commands.access import ALTITUDE_MAX, Access, parse_altitude, parse_position
from vehicle.commands.command_table import CommandSpec, CommandTable
from vehicle.commands.context import Context, Reporting
from vehicle.commands.inbound import Effect, InboundMessage, InboundTable
from vehicle.navigation.geo import Origin
from vehicle.telemetry import build_motion

MAX_ORIGIN_DISTANCE = 10e3
"""m from the rover: local positions are wrong by 0.2 % that far from the origin, and no small rover drives there."""


class OriginCommands:
    """Moves the origin for the driver, while disarmed and with a known position."""

    def __init__(self, context: Context, reporting: Reporting) -> None:
        self._safety = context.safety
        self._control = context.control
        self._navigator = context.navigator
        self._texts = context.statustext
        self._access = context.access
        self._build_view = reporting.build_view

    def commands(self) -> CommandTable:
        """Return the rows of the commands handled here."""
        return (
            CommandSpec(Command.DO_SET_GLOBAL_ORIGIN, self._set, Access.DRIVER_OR_UNCLAIMED,
                        "disarmed; 5, 6: position of the local origin, 7: its altitude"),
        )  # fmt: skip

    def messages(self) -> InboundTable:
        """Return the rows of the messages handled here."""
        return (
            InboundMessage(SetGpsGlobalOrigin, Access.DRIVER_OR_UNCLAIMED,
                           "as DO_SET_GLOBAL_ORIGIN; answered by GPS_GLOBAL_ORIGIN",
                           self._handle_set_origin, Effect.MOTION),
        )  # fmt: skip

    def _handle_set_origin(self, received: Received, message: SetGpsGlobalOrigin, now: float) -> tuple[Outgoing, ...]:
        """Move the origin. A denial is reported by a STATUSTEXT; the answer is the origin in either case."""
        if message.target_system != self._control.system:
            return ()
        point = message.latitude, message.longitude
        if global_to_local(*point, self._navigator.estimate) is None:
            denial: str | None = "invalid position, or the position is not known"
        else:
            denial = self._control.ownership.denial_reason(received, now) or self._rejection(*point)
        if denial:
            text = f"GCS {received.system}: SET_GPS_GLOBAL_ORIGIN refused: {denial}"
            self._texts.reply(received, Severity.WARNING, text, now)
        else:
            self._move(*point, message.altitude / 1e3, received.system, now)
        return self._build_reply(received.peer, now)

    def _set(self, request: CommandRequest, now: float) -> Result | CommandReply:
        """Parameters 5 to 7: the position, and m above sea level, or above home in a relative frame."""
        place = parse_position(request)
        if isinstance(place, Result):
            return place
        if self._safety.armed:
            return Result.TEMPORARILY_REJECTED
        altitude = parse_altitude(request, self._navigator.home)
        if altitude is not None and not abs(altitude) < ALTITUDE_MAX:
            return Result.DENIED
        if why := self._rejection(*place):
            return self._access.reject(request, why, now)
        self._move(*place, altitude, request.system, now)
        return CommandReply(Result.ACCEPTED, self._build_reply(request.peer, now))

    def _rejection(self, latitude: float, longitude: float) -> str | None:
        """Return why the origin cannot move there, or None. Degrees x 1e7."""
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
            else f"{distance / 1e3:.0f} km away, limit is {MAX_ORIGIN_DISTANCE / 1e3:g} km"
        )

    def _move(self, latitude: float, longitude: float, altitude: float | None, system: int, now: float) -> None:
        self._navigator.set_origin(Origin(latitude / 1e7, longitude / 1e7), altitude, self._safety, now)
        self._texts.send_change(Severity.NOTICE, f"GCS {system} has set the origin of local positions", now)

    def _build_reply(self, peer: Peer, now: float) -> tuple[Outgoing, ...]:
        message = build_motion.gps_global_origin(self._build_view(now))
        return () if message is None else (Outgoing(message, peer),)
