"""PREFLIGHT_STORAGE: what is kept over a restart, parameters and plans, put back to the start or made sure of.

Everything that is set or uploaded is kept at once, so that there is never anything to read back. The answer comes when
the disk has it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Protocol

from dialects.enums import MissionResult, Result
from link.services.command.jobs import CommandJob
from link.services.command.server import CommandRequest, value_or_default
from link.services.mission.commit import WRITE_TIMEOUT, PlanChange
from vehicle.commands.access import CommandAccess
from vehicle.commands.mission import MissionService
from vehicle.commands.params import ParamService
from vehicle.safety.state_machine import Safety

NOTHING, READ, WRITE, RESET, RESET_ALL = -1, 0, 1, 2, 4
PARAMETERS = (NOTHING, READ, WRITE, RESET, RESET_ALL)
"""PREFLIGHT_STORAGE_PARAMETER_ACTION; 3 would reset the calibration of sensors, and there is none."""
PLANS = (NOTHING, READ, WRITE, RESET)
"""PREFLIGHT_STORAGE_MISSION_ACTION, of mission, fence and rally points."""
LOGGING = (-1, 0, 1)
"""Parameter 3: stop, nothing, the usual rate. LOG_DISARMED says when to record, and there are no other rates."""


class PreflightStorage:
    """Begins it, for the driver while disarmed."""

    def __init__(self, params: ParamService, plans: MissionService, safety: Safety, asking: CommandAccess) -> None:
        self._params = params
        self._plans = plans
        self._safety = safety
        self._asking = asking

    def run(self, request: CommandRequest, now: float) -> Result | CommandJob:
        """Parameter 1: what happens to parameters; 2: to plans. NaN: nothing."""
        if self._safety.armed:
            return Result.TEMPORARILY_REJECTED
        params, plans = value_or_default(request.params[0], NOTHING), value_or_default(request.params[1], NOTHING)
        if params not in PARAMETERS or plans not in PLANS or value_or_default(request.params[2]) not in LOGGING:
            return Result.DENIED
        wanted = [kept for kept, wish in ((self._params, params), (self._plans, plans)) if wish not in (NOTHING, READ)]
        if why := self._unsavable(params == WRITE, plans == WRITE):
            return self._asking.reject(request, why, now)
        erased = self._plans.clear() if plans == RESET else None
        if plans == RESET and erased is None:
            return Result.TEMPORARILY_REJECTED  # somebody uploads
        if plans == WRITE:
            self._plans.save()
        if params == WRITE:
            self._params.save()
        if params in (RESET, RESET_ALL):
            self._params.reset(now)
        saving = SaveJob(wanted, erased, partial(self._asking.reject, request), now)
        result = saving.step(now)
        return saving if result is None else result

    def _unsavable(self, params: bool, plans: bool) -> str | None:
        """Why parameters, or plans, cannot be saved when that is asked for."""
        if (params and self._params.is_volatile) or (plans and self._plans.is_volatile):
            return "nothing is kept in this run"
        if params and self._params.damage:  # a file of nothing would be a good one at the next start
            return f"{self._params.damage}; set one to go on"
        return None


class WriteStatus(Protocol):
    """Parameters, or plans."""

    @property
    def idle(self) -> bool:
        """Nothing is being written."""

    @property
    def problem(self) -> str | None:
        """Why what was last to be written is not."""


class SaveJob:
    """What was wanted is on its way to the disk: a `link.services.command.jobs.Job`."""

    percent: int | None = None

    def __init__(
        self, kept: Sequence[WriteStatus], erased: PlanChange | None, refuse: Callable[[str, float], Result], now: float
    ) -> None:
        self._kept = kept
        self._erased = erased
        self._refuse = refuse
        self._began = now

    def step(self, now: float) -> Result | None:
        """Look whether it is there."""
        if not all(each.idle for each in self._kept):
            return None if now - self._began < WRITE_TIMEOUT else self._refuse("the disk does not answer", now)
        problem = next(filter(None, (each.problem for each in self._kept)), None)
        if self._erased and self._erased.verdict is not MissionResult.ACCEPTED:
            problem = problem or "the plans could not be erased"
        return self._refuse(problem, now) if problem else Result.ACCEPTED

    def cancel(self, now: float) -> None:
        """Files are written whole or not at all: it cannot be stopped half way."""
