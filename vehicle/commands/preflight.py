"""For a vehicle that stands disarmed: stored parameters, calibration, restart, signing; and the banner."""

from __future__ import annotations

from dialects.enums import Command, DriveType, Result, Severity
from dialects.messages import SetupSigning
from link.core import Received
from link.services.command.server import CommandHandler, CommandRequest
from vehicle.autonomy.navigator import Navigator
from vehicle.commands.access import CommandAccess
from vehicle.commands.calibration import CalibrationCommand
from vehicle.commands.mission import MissionService
from vehicle.commands.params import ParamService
from vehicle.commands.preflight_storage import PreflightStorage
from vehicle.commands.reboot import REBOOT_DELAY, RebootRequest, parse_reboot_request
from vehicle.drive.control import Control
from vehicle.params import Params
from vehicle.safety.state_machine import Safety
from vehicle.statustext import StatusTextQueue
from vehicle.telemetry.build_status import VERSION


class PreflightCommands:
    """Answers them."""

    def __init__(
        self,
        params: Params,
        safety: Safety,
        control: Control,
        navigator: Navigator,
        param_service: ParamService,
        plans: MissionService,
        texts: StatusTextQueue,
    ) -> None:
        self._params = params
        self._safety = safety
        self._control = control
        self._texts = texts
        self._asking = CommandAccess(control, texts)
        self._calibration = CalibrationCommand(safety, navigator, self._asking, texts)
        self._storage = PreflightStorage(param_service, plans, safety, self._asking)
        self._leave: tuple[RebootRequest, float] | None = None

    def handlers(self) -> dict[int, CommandHandler]:
        """The table for link.services.command.server.CommandServer."""
        return {
            Command.PREFLIGHT_CALIBRATION: self._asking.require_control(self._calibration.handle_command),
            Command.PREFLIGHT_STORAGE: self._asking.require_control(self._storage.run),
            Command.PREFLIGHT_REBOOT_SHUTDOWN: self._asking.require_control(self._reboot),
            Command.DO_SEND_BANNER: CommandHandler(self._banner),
        }

    def receive(self, received: Received, now: float) -> None:
        """SETUP_SIGNING brings a key: it goes nowhere from here."""
        message = received.message
        if isinstance(message, SetupSigning) and message.target_system == self._control.system:
            self._texts.send_once("signing", Severity.WARNING, "Signing is not offered: the key was not used", now)

    def reboot_request(self, now: float) -> RebootRequest | None:
        """How the program is to end now, or None. Who has armed meanwhile keeps it."""
        if self._leave is None or now < self._leave[1]:
            return None
        if self._safety.armed:
            self._leave = None
            self._texts.send(Severity.WARNING, "Armed: no restart", now)
        return self._leave[0] if self._leave else None

    def _reboot(self, request: CommandRequest, now: float) -> Result:
        """Parameter 1: this program; 2: the computer; 3 and 4: a component, which may be this one or all."""
        if self._safety.armed:
            return self._asking.reject(request, "armed", now)
        leave = parse_reboot_request(request.params)
        if leave is None:
            return Result.DENIED
        if self._params["REBOOT_ENABLE"] < (1 if leave is RebootRequest.RESTART else 2):
            self._asking.reject(request, f"REBOOT_ENABLE is {self._params['REBOOT_ENABLE']:g}", now)
            return Result.DENIED
        self._leave = self._leave or (leave, now + REBOOT_DELAY)  # a repeat does not put it off
        self._texts.send(Severity.WARNING, f"GCS {request.system}: {leave.label}", now)
        return Result.ACCEPTED

    def _banner(self, request: CommandRequest, now: float) -> Result:
        if not request.may_ask:
            return Result.TEMPORARILY_REJECTED
        version = ".".join(map(str, VERSION))
        drive = DriveType(int(self._params["DRIVE_TYPE"])).name.lower()
        self._texts.send(Severity.INFO, f"mavhelm {version}, {drive} drive, mode {self._safety.mode.name}", now)
        return Result.ACCEPTED
