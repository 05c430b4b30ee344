"""PREFLIGHT_REBOOT_SHUTDOWN and DO_SEND_BANNER."""

from __future__ import annotations

from dialects.enums import Command, DriveType, Result, Severity
from link.services.command.request import CommandRequest
from link.signing.role import SigningRole
from vehicle.commands.access import Access
from vehicle.commands.command_table import CommandSpec, CommandTable
from vehicle.commands.context import Context
from vehicle.commands.reboot import REBOOT_DELAY, RebootRequest, parse_reboot_request
from vehicle.telemetry.build_status import VERSION


class PreflightCommands:
    """Handles requests that end the program, and those that have no other place."""

    def __init__(self, context: Context) -> None:
        self._params = context.params
        self._safety = context.safety
        self._texts = context.statustext
        self._access = context.access
        self._pending: tuple[RebootRequest, float] | None = None
        """The request under way, and when the program ends."""

    def commands(self) -> CommandTable:
        """Return the rows of the commands handled here."""
        return (
            CommandSpec(Command.PREFLIGHT_REBOOT_SHUTDOWN, self._reboot, Access.DRIVER_OR_UNCLAIMED,
                        "disarmed, REBOOT_ENABLE; 1: 1 this program, 2 shut down; 2: 1 reboot, 2 shut down",
                        role=SigningRole.SET_UP),
            CommandSpec(Command.DO_SEND_BANNER, self._send_banner, Access.CONNECTED,
                        "sends name and version as STATUSTEXT (of ardupilotmega.xml)"),
        )  # fmt: skip

    def reboot_request(self, now: float) -> RebootRequest | None:
        """Return how the program must end now, or None. Arming cancels the request."""
        if self._pending is None or now < self._pending[1]:
            return None
        if self._safety.armed:
            self._pending = None
            self._texts.send(Severity.WARNING, "Restart cancelled: armed", now)
        return self._pending[0] if self._pending else None

    def _reboot(self, request: CommandRequest, now: float) -> Result:
        """Parameter 1: this program; 2: the computer; 3 and 4: an action and its component, this one or all."""
        if self._safety.armed:
            return self._access.reject(request, "armed", now)
        reboot = parse_reboot_request(request.params)
        if reboot is None:
            return Result.DENIED
        if self._params["REBOOT_ENABLE"] < (1 if reboot is RebootRequest.RESTART else 2):
            self._access.reject(request, f"REBOOT_ENABLE is {self._params['REBOOT_ENABLE']:g}", now)
            return Result.DENIED
        self._pending = self._pending or (reboot, now + REBOOT_DELAY)  # a repeated command does not delay it
        self._texts.send(Severity.WARNING, f"GCS {request.system}: {reboot.label}", now)
        return Result.ACCEPTED

    def _send_banner(self, request: CommandRequest, now: float) -> Result:
        version = ".".join(map(str, VERSION))
        drive = DriveType(int(self._params["DRIVE_TYPE"])).name.lower()
        text = f"mavhelm {version}, {drive} drive, mode {self._safety.mode.name}"
        self._texts.reply(request, Severity.INFO, text, now)
        return Result.ACCEPTED
