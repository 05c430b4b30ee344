"""For a vehicle that stands disarmed: stored parameters, calibration, restart, signing; and the banner."""

from __future__ import annotations

import math

from dialects.enums import Command, DriveType, Result, Severity
from dialects.messages import SetupSigning
from link.core import Received
from link.services.command import CommandRequest, Handler
from vehicle.asking import Asking
from vehicle.calibration import Calibration
from vehicle.control import Control
from vehicle.leaving import DELAY, Leave
from vehicle.navigator import Navigator
from vehicle.param_service import ParamService
from vehicle.params import Params
from vehicle.safety import Safety
from vehicle.status import VERSION
from vehicle.texts import Texts

READ, WRITE, RESET, RESET_ALL = 0, 1, 2, 4
"""PREFLIGHT_STORAGE_PARAMETER_ACTION; 3 would reset the calibration of sensors, and there is none."""
PLANS_STAY = (0, -1)
"""Parameter 2 of PREFLIGHT_STORAGE: plans are read and written by nobody's order."""
LEAVES: dict[tuple[float, float], Leave] = {
    (1, 0): Leave.RESTART,
    (0, 1): Leave.REBOOT,
    (1, 1): Leave.REBOOT,
    (0, 2): Leave.POWER_OFF,
    (1, 2): Leave.POWER_OFF,
}
"""REBOOT_SHUTDOWN_ACTION for the autopilot, for the computer on board -> what happens. The rest is not offered."""


class Preflight:
    """Answers them."""

    def __init__(
        self,
        params: Params,
        safety: Safety,
        control: Control,
        navigator: Navigator,
        param_service: ParamService,
        texts: Texts,
    ) -> None:
        self._params = params
        self._safety = safety
        self._control = control
        self._param_service = param_service
        self._texts = texts
        self._asking = Asking(control, texts)
        self._calibration = Calibration(safety, navigator, self._asking, texts)
        self._leave: tuple[Leave, float] | None = None

    def handlers(self) -> dict[int, Handler]:
        """The table for link.services.command.CommandServer."""
        return {
            Command.PREFLIGHT_CALIBRATION: self._asking.of_owner(self._calibration.run),
            Command.PREFLIGHT_STORAGE: self._asking.of_owner(self._store),
            Command.PREFLIGHT_REBOOT_SHUTDOWN: self._asking.of_owner(self._reboot),
            Command.DO_SEND_BANNER: Handler(self._banner),
        }

    def receive(self, received: Received, now: float) -> None:
        """SETUP_SIGNING brings a key: it goes nowhere from here."""
        message = received.message
        if isinstance(message, SetupSigning) and message.target_system == self._control.system:
            self._texts.say_once("signing", Severity.WARNING, "Signing is not offered: the key was not used", now)

    def leaving(self, now: float) -> Leave | None:
        """How the program is to end now, or None. Who has armed meanwhile keeps it."""
        if self._leave is None or now < self._leave[1]:
            return None
        if self._safety.armed:
            self._leave = None
            self._texts.say(Severity.WARNING, "Armed: no restart", now)
        return self._leave[0] if self._leave else None

    def _store(self, request: CommandRequest, now: float) -> Result:
        """Parameter 1: what happens to parameters. What is set is kept at once, so that there is nothing to read."""
        if self._safety.armed:
            return Result.TEMPORARILY_REJECTED
        action, plans = request.params[:2]
        if action not in (READ, WRITE, RESET, RESET_ALL) or not (plans in PLANS_STAY or math.isnan(plans)):
            return Result.DENIED
        if action in (RESET, RESET_ALL):
            self._param_service.reset(now)
            return Result.ACCEPTED
        problem = self._param_service.unkept
        return self._asking.refuse(request, problem, now) if problem and action == WRITE else Result.ACCEPTED

    def _reboot(self, request: CommandRequest, now: float) -> Result:
        """Parameter 1: this program; 2: the computer; 3: other components, which there are none of."""
        if self._safety.armed:
            return self._asking.refuse(request, "armed", now)
        leave = LEAVES.get((request.params[0], request.params[1])) if request.params[2] == 0 else None
        if leave is None or self._params["REBOOT_ENABLE"] < (1 if leave is Leave.RESTART else 2):
            return Result.DENIED
        self._leave = self._leave or (leave, now + DELAY)  # a repeat does not put it off
        self._texts.say(Severity.WARNING, f"GCS {request.system}: {leave.words}", now)
        return Result.ACCEPTED

    def _banner(self, request: CommandRequest, now: float) -> Result:
        if not request.may_ask:
            return Result.TEMPORARILY_REJECTED
        version = ".".join(map(str, VERSION))
        drive = DriveType(int(self._params["DRIVE_TYPE"])).name.lower()
        self._texts.say(Severity.INFO, f"mavhelm {version}, {drive} drive, mode {self._safety.mode.name}", now)
        return Result.ACCEPTED
