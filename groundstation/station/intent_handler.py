"""Carries out the operator's intents: one table row for each kind of intent.

A new intent is a class in groundstation/intents. A command to the selected vehicle (VehicleIntent) and a request to one
of its services (ServiceIntent) need no more; every other intent has a row in HANDLERS.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from dialects.enums import Severity
from dialects.mode_tables import HOLD
from groundstation.intents.agents import DeclineProposal, EndPermission, PermitProposal
from groundstation.intents.base import Intent
from groundstation.intents.driving import (
    STOP_KEY,
    DriveByPicture,
    DriveKeyDown,
    DriveKeyUp,
    DrivePad,
    EmergencyStop,
    ReleasePad,
    SetStyle,
    StepLimits,
    Stop,
)
from groundstation.intents.links import CloseLink
from groundstation.intents.services import CancelRequest, ServiceIntent
from groundstation.intents.session import Quit, RenewLease, ReportKeyReleases, SetKeyGate
from groundstation.intents.union import AnyIntent
from groundstation.intents.vehicle import (
    GiveControl,
    KeepControl,
    ReleaseControl,
    RequestControl,
    SelectNextVehicle,
    SelectVehicle,
    SetMode,
)
from groundstation.intents.vehicle_intent import VehicleIntent
from groundstation.station.core_parts import CoreParts
from groundstation.station.driving.permission import Permission
from groundstation.vehicles.state.vehicle_state import VehicleState

EMERGENCY_WINS = 0.5
"""s after an emergency stop for which a stop key does not end the landing of what flies."""
SECOND_STOP_WITHIN = 3.0
"""s after an emergency stop within which another one goes to every vehicle, not only to ours."""

MOVES_STICKS = frozenset((DriveKeyDown, DriveKeyUp, DrivePad, ReleasePad, StepLimits, PermitProposal))
"""Intents that change the demand and nothing that decides who may drive, so that it need not be judged again."""

Handle = Callable[[Any, float], None]
"""Carries out one kind of intent; called with it and the time."""
Rows = Mapping[type[Intent], Handle]


class IntentHandler:
    """Applies intents: one table says who carries out which. Parts beside the core add their rows."""

    def __init__(self, parts: CoreParts) -> None:
        self._operator, self._fleet, self._log = parts.operator, parts.fleet, parts.log
        self._commander, self._driving, self._services = parts.commander, parts.driving, parts.services
        self._shutdown, self._handover, self._link_closing = parts.shutdown, parts.handover, parts.link_closing
        self._verbs, self._proposals = parts.verbs, parts.proposals
        self._emergency_at = -math.inf
        self._permission = Permission("starting", "starting")
        """Before the intent that is being carried out."""
        rows: dict[type[Intent], Handle] = {kind: partial(do, self) for kind, do in HANDLERS.items()}
        rows |= dict.fromkeys(VehicleIntent.__subclasses__(), self._send_command)
        rows |= dict.fromkeys(ServiceIntent.__subclasses__(), self._services.start)
        self._table = {kind: [handle] for kind, handle in rows.items()}
        self._last: dict[type[Intent], Handle] = {}

    def add(self, rows: Rows) -> None:
        """Let these handle their intents, before the handlers that an intent has already."""
        for kind, handle in rows.items():
            self._table.setdefault(kind, []).insert(0, handle)

    def add_last(self, rows: Rows) -> None:
        """Let these handle their intents, one each, when everything else is done: links, files and lines of verbs."""
        self._last |= rows

    @property
    def kinds(self) -> frozenset[type[Intent]]:
        """All kinds of intents that somebody handles."""
        return frozenset((*self._table, *self._last))

    def handle(self, intent: AnyIntent, permission: Permission, now: float) -> Permission:
        """Carry out an intent; its messages are ready to be sent when this returns.

        `permission` was judged just before. Returns that which holds now.
        """
        if intent.is_input:
            self._operator.inputs.add(now)
            self._proposals.interrupt(intent, now)
        self._permission = permission
        self._driving.apply(permission, now)
        for handle in self._table.get(type(intent), ()):
            handle(intent, now)
        if type(intent) not in MOVES_STICKS:
            permission = self._driving.judge(now)
        self._driving.update(permission, now)
        return permission

    def finish(self, intent: AnyIntent, now: float) -> None:
        """Call the last handler of an intent, if it has one."""
        handle = self._last.get(type(intent))
        if handle is not None:
            handle(intent, now)

    def _send_command(self, intent: VehicleIntent, now: float) -> None:
        if intent.neutral or isinstance(intent, SetMode):  # a screen that watches may set HOLD only
            self._verbs.stop(now)
        vehicle = self._selected_vehicle(now)
        if vehicle is None:
            return
        if intent.neutral:
            self._operator.sticks.block(now)
        if intent.confirmed and (reason := self._unconfirmed_reason(intent)):
            self._log.add(now, "station", f"{intent.confirmed} refused: {reason}", Severity.WARNING)
            return
        intent.send(self._commander, vehicle, now)

    def _selected_vehicle(self, now: float) -> VehicleState | None:
        if self._fleet.selected is None:
            self._log.add(now, "station", "no vehicle yet", Severity.WARNING)
            return None
        return self._fleet.selected.state

    def _unconfirmed_reason(self, intent: Any) -> str | None:
        """Return why an intent that needs a held key is refused: a screen that is frozen or hidden confirms nothing."""
        if not intent.held >= intent.hold_time:
            return f"the key was not held for {intent.hold_time:.0f} s"
        return self._permission.screen

    def _press(self, intent: DriveKeyDown, now: float) -> None:
        self._operator.press(intent, self._permission.screen, now)

    def _release(self, intent: DriveKeyUp, now: float) -> None:
        self._operator.sticks.release(intent.key)

    def _push_pad(self, intent: DrivePad, now: float) -> None:
        self._operator.push_pad(intent, self._permission.screen, now)

    def _release_pad(self, intent: ReleasePad, now: float) -> None:
        self._operator.sticks.pad.release()

    def _stop(self, intent: Stop, now: float) -> None:
        self._operator.sticks.stop()
        if intent.reason == STOP_KEY:
            self._verbs.stop(now)
        selected = self._fleet.selected
        if intent.reason != STOP_KEY or selected is None or not selected.state.may_move:
            return
        if selected.state.model.flies and now - self._emergency_at <= EMERGENCY_WINS:
            return  # it is to land: one read of keys has the stop beside the emergency stop
        self._commander.set_mode(selected.state, HOLD, now)  # neutral sticks do not stop a mission

    def _emergency_stop(self, intent: EmergencyStop, now: float) -> None:
        """Stop the selected vehicle and those that we armed or drove; the second request in a row stops all.

        All are also those that are not heard, and without a vehicle the first request goes to all.
        """
        self._operator.sticks.block(now)
        self._verbs.stop(now)
        everything, self._emergency_at = now - self._emergency_at <= SECOND_STOP_WITHIN, now
        for contact in self._fleet:
            if everything or contact.ours or contact is self._fleet.selected:
                self._commander.emergency_stop(contact.state, now)
            elif contact.state.armed:
                text = f"{contact.state.name} is armed, too: a second emergency stop stops all vehicles"
                self._log.add(now, "station", text, Severity.CRITICAL)
        if everything or self._fleet.selected is None:
            self._commander.stop_blindly(now)

    def _step_limits(self, intent: StepLimits, now: float) -> None:
        self._operator.sticks.step_limits(intent)

    def _set_style(self, intent: SetStyle, now: float) -> None:
        if self._operator.sticks.set_style(intent.style):
            why = f": {intent.why}" if intent.why else ""
            self._log.add(now, "station", f"drive style {self._operator.sticks.style}{why}", Severity.NOTICE)

    def _set_reports_releases(self, intent: ReportKeyReleases, now: float) -> None:
        self._operator.sticks.set_reports_releases(intent.reports)

    def _set_gate(self, intent: SetKeyGate, now: float) -> None:
        self._operator.set_gate(intent, now)
        self._proposals.tick(now)

    def _renew_lease(self, intent: RenewLease, now: float) -> None:
        self._operator.renew_lease(now)

    def _watch_picture(self, intent: DriveByPicture, now: float) -> None:
        self._operator.watch_picture(intent, now)

    def _permit(self, intent: PermitProposal, now: float) -> None:
        self._proposals.permit(intent, now)

    def _end_permission(self, intent: EndPermission, now: float) -> None:
        """Do nothing more: every input but the held key has ended it."""

    def _decline(self, intent: DeclineProposal, now: float) -> None:
        self._proposals.decline(intent, now)

    def _select(self, intent: SelectVehicle, now: float) -> None:
        self._operator.reset_demand(now)
        self._fleet.select(intent.system, now)

    def _select_next(self, intent: SelectNextVehicle, now: float) -> None:
        self._operator.reset_demand(now)
        self._fleet.select_next(now)

    def _request_control(self, intent: RequestControl, now: float) -> None:
        if (vehicle := self._selected_vehicle(now)) is not None:
            self._handover.request(vehicle, now)

    def _release_control(self, intent: ReleaseControl, now: float) -> None:
        self._operator.sticks.block(now)
        if intent.all:
            self._handover.release_all(now)
        elif (vehicle := self._selected_vehicle(now)) is not None:
            self._handover.release(vehicle, now)

    def _give_control(self, intent: GiveControl, now: float) -> None:
        self._operator.sticks.block(now)
        self._handover.give(now)

    def _keep_control(self, intent: KeepControl, now: float) -> None:
        self._handover.keep(now)

    def _cancel_request(self, intent: CancelRequest, now: float) -> None:
        self._services.cancel(intent.request, now)

    def _close_link(self, intent: CloseLink, now: float) -> None:
        """Go neutral for the vehicles behind the link; the shell closes it after that."""
        self._link_closing.begin(intent.link, now)

    def _quit(self, intent: Quit, now: float) -> None:
        self._operator.sticks.block(now)
        self._handover.give(now)
        self._driving.end()
        self._verbs.end(now)
        self._shutdown.begin(now, disarm=intent.disarm)


HANDLERS: dict[type[Intent], Callable[[IntentHandler, Any, float], None]] = {
    DriveKeyDown: IntentHandler._press,
    DriveKeyUp: IntentHandler._release,
    DrivePad: IntentHandler._push_pad,
    ReleasePad: IntentHandler._release_pad,
    Stop: IntentHandler._stop,
    EmergencyStop: IntentHandler._emergency_stop,
    StepLimits: IntentHandler._step_limits,
    SetStyle: IntentHandler._set_style,
    ReportKeyReleases: IntentHandler._set_reports_releases,
    SetKeyGate: IntentHandler._set_gate,
    RenewLease: IntentHandler._renew_lease,
    DriveByPicture: IntentHandler._watch_picture,
    PermitProposal: IntentHandler._permit,
    EndPermission: IntentHandler._end_permission,
    DeclineProposal: IntentHandler._decline,
    SelectVehicle: IntentHandler._select,
    SelectNextVehicle: IntentHandler._select_next,
    RequestControl: IntentHandler._request_control,
    ReleaseControl: IntentHandler._release_control,
    GiveControl: IntentHandler._give_control,
    KeepControl: IntentHandler._keep_control,
    CancelRequest: IntentHandler._cancel_request,
    CloseLink: IntentHandler._close_link,
    Quit: IntentHandler._quit,
}
"""Intent -> method, for all that are neither commands to the selected vehicle nor requests to its services.

Those of the screens are added by screen_feed.py, those of the shell by the station's process: AddLink, StartSimulator,
RunLine and more."""
