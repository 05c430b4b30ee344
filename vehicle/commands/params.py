"""The parameters as ground stations see them: who may set which, and what follows; the protocol is link/services'."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from typing import Protocol

from dialects.enums import Severity
from link.core import Outgoing, Received
from link.services.pacing import Pacer
from link.services.param.server import ParamServer
from link.transport.backoff import Backoff
from vehicle.drive.control import Control
from vehicle.params import ParamError, Params
from vehicle.statustext import Texts

RETRY = (2.0, 60.0)
"""s until what could not be saved is tried again: at first, and at most."""


class Keeper(Protocol):
    """Remembers values for the next start."""

    @property
    def problem(self) -> str | None:
        """Why values are not kept, one line."""

    @property
    def idle(self) -> bool:
        """What was to be remembered is, or cannot be."""

    def keep(self, name: str, value: float) -> None:
        """Remember it, soon. Never blocks and never raises."""

    def save(self) -> None:
        """Write once more what is remembered."""


class NoKeeper:
    """Values end with the program, as in the simulator."""

    problem: str | None = None
    idle = True

    def keep(self, name: str, value: float) -> None:
        """Forget it."""

    def save(self) -> None:
        """Nothing."""


class ParamService:
    """Only the driver in control sets, or anybody while nobody is; safety settings never while armed."""

    def __init__(
        self,
        params: Params,
        control: Control,
        texts: Texts,
        *,
        ids: tuple[int, int],
        pacer: Pacer,
        armed: Callable[[], bool],
        keeper: Keeper | None = None,
    ) -> None:
        self._params = params
        self._control = control
        self._texts = texts
        self._keeper = keeper or NoKeeper()
        self._backoff = Backoff(*RETRY)
        self._retry_due: float | None = None
        """When what could not be saved is tried again; None while all is saved."""
        params.untold.clear()
        self._server = ParamServer(
            params.table,
            params,
            system=ids[0],
            component=ids[1],
            pacer=pacer,
            allowed=lambda received: control.stranger(received.system) is None,
            armed=armed,
            changed=self._changed,
            say=lambda text, now: texts.say(Severity.WARNING, text, now),
        )

    def receive(self, received: Received, now: float) -> list[Outgoing]:
        """Answer one message."""
        return self._server.receive(received, now)

    def tick(self, now: float) -> list[Outgoing]:
        """The next values of running lists, and those that the vehicle itself has changed."""
        announced = self._server.announce(sorted(self._params.untold)) if self._params.untold else []
        self._params.untold.clear()
        return announced + self._server.tick(now)

    def observe(self, now: float) -> None:
        """About once a second: are values kept? Else they are tried again, ever less often: a disk gets room again."""
        if problem := self._keeper.problem:
            text = f"Parameters are not saved: {problem}; trying again"
            self._texts.say_once(f"keeper {problem}", Severity.WARNING, text, now)
            self._retry(now)
        elif self._retry_due is not None:
            self._retry_due = None
            self._backoff.reset()
            self._texts.forget("keeper ")
            self._texts.say(Severity.NOTICE, "Parameters are saved now", now)

    @property
    def forgets(self) -> bool:
        """What is set ends with the program."""
        return isinstance(self._keeper, NoKeeper)

    @property
    def damage(self) -> str | None:
        """Why what was kept is lost, until somebody sets a parameter."""
        return self._params.damage

    @property
    def problem(self) -> str | None:
        """Why values are not kept, one line."""
        return self._keeper.problem

    @property
    def idle(self) -> bool:
        """Nothing is being written."""
        return self._keeper.idle

    def save(self) -> None:
        """Once more: what is set was written already, where the disk took it."""
        self._keeper.save()

    def reset(self, now: float) -> None:
        """Defaults for all that a ground station may set; who listens is told what that changed.

        What this run was given stays in force until its end, but only its default is kept.
        """
        before, run = {name: self._params[name] for name in self._params}, self._params.run
        table = [each for each in self._params.table if not each.read_only]
        for _ in range(2):  # one value may have to make room for another
            for each in table:
                with contextlib.suppress(ParamError):
                    self._params.set(each.name, run.get(each.name, each.default))
        changed = {each.name for each in table if self._params[each.name] != before[each.name]}
        for each in table:
            if each.name in changed or each.name in run:
                self._keep(each.name, each.default)
        self._params.untold = changed
        self._texts.say(Severity.NOTICE, f"Parameters: {len(changed)} back to their defaults", now)

    def _retry(self, now: float) -> None:
        if self._retry_due is not None and now >= self._retry_due and self._keeper.idle:
            self._keeper.save()
            self._retry_due = None
        if self._retry_due is None:
            self._retry_due = now + self._backoff.wait()

    def _changed(self, name: str, value: float) -> None:
        self._params.untold.discard(name)  # its answer tells everybody
        self._keep(name, value)

    def _keep(self, name: str, value: float) -> None:
        self._params.damage = None  # somebody sees to the parameters
        self._keeper.keep(name, value)
