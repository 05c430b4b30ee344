"""The parameter service: who may set which parameter, saving, and what a reset changes.

The protocol itself is link/services/param/server.py.
"""

from __future__ import annotations

import contextlib

from dialects import messages as m
from dialects.enums import Severity
from link.core import Outgoing, Received
from link.services.param.server import ParamServer
from link.transport.backoff import Backoff
from vehicle.commands.access import Access
from vehicle.commands.context import Context
from vehicle.commands.inbound import InboundMessage, InboundTable, from_server
from vehicle.params import PARAMETERS, ParamError
from vehicle.storage.param_store import ParamStore

SAVE_RETRY_TIMES = (2.0, 60.0)
"""s until a failed save is tried again: the first time, and at most."""


class ParamService:
    """Parameters of ground stations: only the driver sets them, and safety parameters only while disarmed."""

    def __init__(self, context: Context, store: ParamStore | None = None) -> None:
        """Without a `store`, values end with the program."""
        self._params = context.params
        self._texts = context.statustext
        self._store = store or ParamStore()
        self._backoff = Backoff(*SAVE_RETRY_TIMES)
        self._retry_due: float | None = None
        """When a failed save is tried again; None while everything is saved."""
        self._changed_by: dict[str, int] = {}
        """Safety parameter -> the ground station that has set it in this cycle."""
        self._await_proof = context.access.await_proof
        context.params.pop_unannounced()
        system, component = context.ids
        self._server = ParamServer(
            context.params.table,
            context.params,
            system=system,
            component=component,
            pacer=context.pacer,
            allowed=context.access.may_set_up,
            armed=lambda: context.safety.armed,
            changed=self._handle_change,
            refused=lambda received, text, now: context.statustext.reply(received, Severity.WARNING, text, now),
        )

    def messages(self) -> InboundTable:
        """Return the rows of the messages handled here."""
        serve = from_server(self._server.receive)
        return (
            InboundMessage(m.ParamRequestList, Access.CONNECTED, "all PARAM_VALUE, paced", serve),
            InboundMessage(m.ParamRequestRead, Access.CONNECTED, "PARAM_VALUE, or PARAM_ERROR", serve),
            InboundMessage(m.ParamSet, Access.DRIVER_OR_UNCLAIMED,
                           "PARAM_VALUE, after a PARAM_ERROR if it is refused", self._await_proof(serve)),
        )  # fmt: skip

    def tick(self, now: float) -> list[Outgoing]:
        """Return the next values of running lists, and those that the vehicle itself has changed."""
        self._announce_safety_changes(now)
        return self._server.broadcast(self._params.pop_unannounced()) + self._server.tick(now)

    def observe(self, now: float) -> None:
        """Check about once a second that values are saved; retry failed saves, with backoff."""
        if problem := self._store.problem:
            text = f"Parameters are not saved: {problem}; trying again"
            self._texts.send_once(f"param_store {problem}", Severity.WARNING, text, now)
            self._retry(now)
        elif self._retry_due is not None:
            self._retry_due = None
            self._backoff.reset()
            self._texts.reset_once("param_store")
            self._texts.send(Severity.NOTICE, "Parameters are saved now", now)

    @property
    def is_volatile(self) -> bool:
        """Values end with the program."""
        return self._store.is_volatile

    @property
    def damage(self) -> str | None:
        """Why the saved values are lost, until a parameter is set."""
        return self._params.damage

    @property
    def problem(self) -> str | None:
        """Why values are not saved, one line, or None."""
        return self._store.problem

    @property
    def idle(self) -> bool:
        """No write is pending."""
        return self._store.idle

    def save(self) -> None:
        """Queue all values for saving again: each was queued already when it was set."""
        self._store.save()

    def reset(self, now: float) -> None:
        """Reset every parameter that a ground station may set to its default, and announce the changes.

        A value of the command line stays in force until the program ends, but its default is saved.
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
        self._params.set_unannounced(changed)
        self._texts.send(Severity.NOTICE, f"Parameters: {len(changed)} reset to defaults", now)

    def _retry(self, now: float) -> None:
        if self._retry_due is not None and now >= self._retry_due and self._store.idle:
            self._store.save()
            self._retry_due = None
        if self._retry_due is None:
            self._retry_due = now + self._backoff.next_delay()

    def _handle_change(self, received: Received, name: str, value: float) -> None:
        self._params.mark_announced(name)  # the server broadcasts its PARAM_VALUE
        self._save_value(name, value)
        if PARAMETERS[name].safety:
            self._changed_by[name] = received.system

    def _announce_safety_changes(self, now: float) -> None:
        """Report which safety parameters ground stations have set since the last cycle, to all."""
        for name, system in self._changed_by.items():
            default = self._params.get_default(name)
            text = f"GCS {system}: {name} set to {self._params[name]:g}, default {default:g}"
            self._texts.send_change(Severity.NOTICE, text, now)
        self._changed_by.clear()

    def _save_value(self, name: str, value: float) -> None:
        self._params.clear_damage()
        self._store.set(name, value)
