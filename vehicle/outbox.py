"""Outbox: what the rover sends, built after the motors are written. Time is an argument."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from link.core import Outgoing
from vehicle.accessories.accessory_set import AccessorySet
from vehicle.commands.dispatch import Dispatcher
from vehicle.pace import PERIOD, Activity, Pace
from vehicle.safety.state_machine import Safety
from vehicle.safety.states import SafetyState
from vehicle.statustext import StatusTextQueue
from vehicle.telemetry.telemetry import Telemetry
from vehicle.telemetry.view import TelemetryView


class Outbox:
    """Collects replies, telemetry, texts and the messages of services.

    A change of the demand is reported in each cycle, and steady streams are sent when they are due. Services run, and
    other changes are reported, in each cycle while something is under way, and else every PERIOD.
    """

    def __init__(
        self,
        telemetry: Telemetry,
        texts: StatusTextQueue,
        dispatcher: Dispatcher,
        safety: Safety,
        rack: AccessorySet,
        build_view: Callable[[float], TelemetryView],
        activity: Activity,
    ) -> None:
        self._telemetry = telemetry
        self._texts = texts
        self._dispatcher = dispatcher
        self._safety = safety
        self._rack = rack
        self._build_view = build_view
        self._activity = activity
        self._services = Pace(activity)
        self._outgoing: list[Outgoing] = []
        self._demanded: float | None = None  # when a demand came whose telemetry is not built yet
        self._ticked: float | None = None  # when the cycle ran whose messages are not built yet
        self._shortened: float | None = None  # when a short cycle ran, or a demand was repeated, after the last pop()
        self._condition: tuple[object, ...] = ()
        """State, mode and failsafes of the newest cycle whose messages were built."""

    def add(self, messages: Iterable[Outgoing]) -> None:
        """Add messages."""
        self._outgoing += messages

    def note_demand(self, now: float) -> None:
        """Note a changed demand: its telemetry follows."""
        self._demanded = now

    def note_short_cycle(self, now: float) -> None:
        """Note that time has passed and nothing has changed: only steady streams follow, which carry the clock."""
        self._shortened = now

    def note_cycle(self, now: float) -> None:
        """Note a control cycle: the messages that are due follow."""
        self._ticked = now

    def pop(self) -> list[Outgoing]:
        """Return what to send now and forget it."""
        if self._demanded is not None:
            self._outgoing += self._telemetry.build_after_demand(self._build_view(self._demanded))
            self._demanded = None
        if self._ticked is not None and self._safety.state is not SafetyState.OFF:
            self._follow_cycle(self._ticked)
        elif self._shortened is not None and self._telemetry.is_steady_due(self._shortened):
            self._outgoing += self._telemetry.build_steady(self._build_view(self._shortened))
        self._ticked = self._shortened = None
        outgoing, self._outgoing = self._outgoing, []
        return outgoing

    def queue_due(self, now: float, *, all_changes: bool = True) -> None:
        """Queue telemetry and texts that are due. Without `all_changes` only steady streams are checked for changes."""
        self._outgoing += self._telemetry.build_due(self._build_view(now), all_changes=all_changes)
        self._outgoing += [Outgoing(text) for text in self._texts.pop_due(now)]
        self._outgoing += self._texts.pop_replies()

    def _follow_cycle(self, now: float) -> None:
        failsafes = self._safety.failsafes
        condition = (self._safety.state, self._safety.mode_generation, failsafes.active, failsafes.latched)
        if condition != self._condition or self._rack.repeating or self._telemetry.shortest < PERIOD:
            self._condition = condition
            self._activity.resume_full_rate(now)
        whole = self._services.is_due(now)
        self.queue_due(now, all_changes=whole)
        if whole:
            self._services.mark_done(now)
            self._run_services(now)

    def _run_services(self, now: float) -> None:
        found = self._dispatcher.tick(now)
        if found:
            self._activity.resume_full_rate(now)
            self._outgoing += found
