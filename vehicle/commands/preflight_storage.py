"""PREFLIGHT_STORAGE: reset parameters, erase plans, or save either again.

Everything that is set or uploaded is saved at once, so that there is never anything to read back. The command ends when
the disk has written it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Protocol

from dialects.enums import Command, MissionResult, Result
from link.services.command.jobs import CommandJob
from link.services.command.request import CommandRequest, value_or_default
from link.services.mission.commit import WRITE_TIMEOUT, PlanChange
from link.signing.role import SigningRole
from vehicle.commands.access import Access
from vehicle.commands.command_table import CommandSpec, CommandTable
from vehicle.commands.context import Context
from vehicle.commands.mission import MissionService
from vehicle.commands.params import ParamService

NOTHING, READ, WRITE, RESET, RESET_ALL = -1, 0, 1, 2, 4
PARAMETERS = (NOTHING, READ, WRITE, RESET, RESET_ALL)
"""PREFLIGHT_STORAGE_PARAMETER_ACTION; 3 would reset sensor calibration, of which there is none."""
PLANS = (NOTHING, READ, WRITE, RESET)
"""PREFLIGHT_STORAGE_MISSION_ACTION, for mission, fence and rally points."""
LOGGING = (-1, 0, 1)
"""Parameter 3: stop, no change, default rate. All have no effect: LOG_DISARMED says when to record, at one rate."""


class PreflightStorage:
    """Handles PREFLIGHT_STORAGE for the driver, while disarmed."""

    def __init__(self, context: Context, params: ParamService, plans: MissionService) -> None:
        self._safety = context.safety
        self._access = context.access
        self._params = params
        self._plans = plans

    def commands(self) -> CommandTable:
        """Return the rows of the commands handled here."""
        return (
            CommandSpec(Command.PREFLIGHT_STORAGE, self._run, Access.DRIVER_OR_UNCLAIMED,
                        "disarmed; 1: 2 or 4 resets parameters to their defaults, or to the values of this run; "
                        "2: 2 erases the plans; 1 saves either again",
                        role=SigningRole.SET_UP),
        )  # fmt: skip

    def _run(self, request: CommandRequest, now: float) -> Result | CommandJob:
        """Parameter 1: action for parameters; 2: for plans. NaN: none."""
        if self._safety.armed:
            return Result.TEMPORARILY_REJECTED
        params, plans = value_or_default(request.params[0], NOTHING), value_or_default(request.params[1], NOTHING)
        if params not in PARAMETERS or plans not in PLANS or value_or_default(request.params[2]) not in LOGGING:
            return Result.DENIED
        actions = ((self._params, params), (self._plans, plans))
        written = [service for service, action in actions if action not in (NOTHING, READ)]
        if why := self._unsavable(params == WRITE, plans == WRITE):
            return self._access.reject(request, why, now)
        erased = self._plans.clear() if plans == RESET else None
        if plans == RESET and erased is None:
            return Result.TEMPORARILY_REJECTED  # an upload is under way
        if plans == WRITE:
            self._plans.save()
        if params == WRITE:
            self._params.save()
        if params in (RESET, RESET_ALL):
            self._params.reset(now)
        saving = SaveJob(written, erased, partial(self._access.reject, request), now)
        result = saving.step(now)
        return saving if result is None else result

    def _unsavable(self, params: bool, plans: bool) -> str | None:
        """Return why a requested save of parameters or plans is impossible, or None."""
        if (params and self._params.is_volatile) or (plans and self._plans.is_volatile):
            return "nothing is saved in this run"
        if params and self._params.damage:  # saving now would make an empty file valid at the next start
            return f"{self._params.damage}; set one to go on"
        return None


class WriteStatus(Protocol):
    """Progress of the writes of one service."""

    @property
    def idle(self) -> bool:
        """No write is pending."""

    @property
    def problem(self) -> str | None:
        """Why the last write failed, or None."""


class SaveJob:
    """Waits for the disk: a `link.services.command.jobs.CommandJob`."""

    percent: int | None = None

    def __init__(
        self,
        services: Sequence[WriteStatus],
        erased: PlanChange | None,
        reject: Callable[[str, float], Result],
        now: float,
    ) -> None:
        self._services = services
        self._erased = erased
        self._reject = reject
        self._began = now

    def step(self, now: float) -> Result | None:
        """Return the result once all writes are done, or have failed."""
        if not all(each.idle for each in self._services):
            return None if now - self._began < WRITE_TIMEOUT else self._reject("the disk does not respond", now)
        problem = next(filter(None, (each.problem for each in self._services)), None)
        if self._erased and self._erased.verdict is not MissionResult.ACCEPTED:
            problem = problem or "the plans could not be erased"
        return self._reject(problem, now) if problem else Result.ACCEPTED

    def cancel(self, now: float) -> None:
        """Do nothing: files are written whole, and a write cannot be stopped half way."""
