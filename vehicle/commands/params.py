"""The parameters as ground stations see them: who may set which, and what follows; the protocol is link/services'."""

from __future__ import annotations

import contextlib
from collections.abc import Callable

from dialects.enums import Severity
from link.core import Outgoing, Received
from link.services.pacing import BulkPacer
from link.services.param.server import ParamServer
from link.transport.backoff import Backoff
from vehicle.drive.control import Control
from vehicle.params import ParamError, Params
from vehicle.statustext import StatusTextQueue
from vehicle.storage.param_store import ParamStore

SAVE_RETRY_TIMES = (2.0, 60.0)
"""s until what could not be saved is tried again: at first, and at most."""


class ParamService:
    """Only the driver in control sets, or anybody while nobody is; safety settings never while armed."""

    def __init__(
        self,
        params: Params,
        control: Control,
        texts: StatusTextQueue,
        *,
        ids: tuple[int, int],
        pacer: BulkPacer,
        armed: Callable[[], bool],
        store: ParamStore | None = None,
    ) -> None:
        self._params = params
        self._control = control
        self._texts = texts
        self._store = store or ParamStore()
        self._backoff = Backoff(*SAVE_RETRY_TIMES)
        self._retry_due: float | None = None
        """When what could not be saved is tried again; None while all is saved."""
        params.unannounced.clear()
        self._server = ParamServer(
            params.table,
            params,
            system=ids[0],
            component=ids[1],
            pacer=pacer,
            allowed=lambda received: control.denial_reason(received.system) is None,
            armed=armed,
            changed=self._handle_change,
            send_text=lambda text, now: texts.send(Severity.WARNING, text, now),
        )

    def receive(self, received: Received, now: float) -> list[Outgoing]:
        """Answer one message."""
        return self._server.receive(received, now)

    def tick(self, now: float) -> list[Outgoing]:
        """The next values of running lists, and those that the vehicle itself has changed."""
        announced = self._server.broadcast(sorted(self._params.unannounced)) if self._params.unannounced else []
        self._params.unannounced.clear()
        return announced + self._server.tick(now)

    def observe(self, now: float) -> None:
        """About once a second: are values kept? Else they are tried again, ever less often: a disk gets room again."""
        if problem := self._store.problem:
            text = f"Parameters are not saved: {problem}; trying again"
            self._texts.send_once(f"param store {problem}", Severity.WARNING, text, now)
            self._retry(now)
        elif self._retry_due is not None:
            self._retry_due = None
            self._backoff.reset()
            self._texts.reset_once("param store ")
            self._texts.send(Severity.NOTICE, "Parameters are saved now", now)

    @property
    def is_volatile(self) -> bool:
        """What is set ends with the program."""
        return self._store.is_volatile

    @property
    def damage(self) -> str | None:
        """Why what was kept is lost, until somebody sets a parameter."""
        return self._params.damage

    @property
    def problem(self) -> str | None:
        """Why values are not kept, one line."""
        return self._store.problem

    @property
    def idle(self) -> bool:
        """Nothing is being written."""
        return self._store.idle

    def save(self) -> None:
        """Once more: what is set was written already, where the disk took it."""
        self._store.save()

    def reset(self, now: float) -> None:
        """Defaults for all that a ground station may set; who listens is told what that changed.

        What this run was given stays in force until its end, but only its default is kept.
        """
        before, run = {name: self._params[name] for name in self._params}, self._params.run_values
        table = [each for each in self._params.table if not each.read_only]
        for _ in range(2):  # one value may have to make room for another
            for each in table:
                with contextlib.suppress(ParamError):
                    self._params.set(each.name, run.get(each.name, each.default))
        changed = {each.name for each in table if self._params[each.name] != before[each.name]}
        for each in table:
            if each.name in changed or each.name in run:
                self._save_value(each.name, each.default)
        self._params.unannounced = changed
        self._texts.send(Severity.NOTICE, f"Parameters: {len(changed)} back to their defaults", now)

    def _retry(self, now: float) -> None:
        if self._retry_due is not None and now >= self._retry_due and self._store.idle:
            self._store.save()
            self._retry_due = None
        if self._retry_due is None:
            self._retry_due = now + self._backoff.next_delay()

    def _handle_change(self, name: str, value: float) -> None:
        self._params.unannounced.discard(name)  # its answer tells everybody
        self._save_value(name, value)

    def _save_value(self, name: str, value: float) -> None:
        self._params.damage = None  # somebody sees to the parameters
        self._store.set(name, value)
