"""Handing control over: our request to the station in control, its request to us, and what the operator answers.

A vehicle that refuses REQUEST_OPERATOR_CONTROL forwards it to the ground station in control, which may release control
(development.xml, MAV_CMD_REQUEST_OPERATOR_CONTROL). The requester repeats its request once the vehicle is free.
"""

from __future__ import annotations

import msgspec

from dialects.enums import Command, Severity
from dialects.messages import CommandLong
from groundstation.snapshot import HandoverNotice
from groundstation.station.driving.commander import Commander
from groundstation.station.driving.driving import DrivingController
from groundstation.vehicles.fleet import Contact, Fleet
from groundstation.vehicles.state.message_log import MessageLog
from groundstation.vehicles.state.vehicle_state import VehicleState
from link.core import Received

RELEASE, REQUEST = 0, 1
"""Parameter 1 of REQUEST_OPERATOR_CONTROL."""

ANSWER_WITHIN = 10.0
"""s for the other operator to answer; then control stays where it is. Parameter 3 of our request."""

LEAST_ANSWER, MOST_ANSWER = 3.0, 60.0
"""Limits of that parameter in the specification; outside of them ANSWER_WITHIN holds."""

RELEASE_WITHIN = 3.0
"""s for the vehicle to report that we are not in control any more; then the keys drive again."""

REPEAT_PERIOD = 1.0
"""s between our requests to a vehicle that has become free; the command client repeats each in between."""


class _Notice(msgspec.Struct):
    """Another ground station asks for a vehicle that we control."""

    contact: Contact
    station: int
    until: float


class _Release(msgspec.Struct):
    """We release a vehicle: the final neutrals first, then the command."""

    contact: Contact
    until: float
    station: int = 0
    """Who gets control; 0: whoever asks the vehicle for it."""
    sent: bool = False


class _Asked(msgspec.Struct):
    """We have asked for a vehicle."""

    contact: Contact
    until: float
    due: float


class Handover:
    """Requests for control in both directions. `system` is our system id."""

    def __init__(
        self, fleet: Fleet, commander: Commander, driving: DrivingController, log: MessageLog, system: int
    ) -> None:
        self._fleet = fleet
        self._commander = commander
        self._driving = driving
        self._log = log
        self._system = system
        self._notice: _Notice | None = None
        self._asked: _Asked | None = None
        self._releases: list[_Release] = []

    # ---- what the operator wants ----

    def request(self, vehicle: VehicleState, now: float) -> None:
        """Request control; the vehicle asks the operator in control, if there is one."""
        if vehicle.model.refusal:
            text = f"request control: {vehicle.name}: {vehicle.model.refusal}"
            self._log.add(now, "station", text, Severity.WARNING)
            return
        self._send_request(vehicle, now)
        contact = self._fleet.get(vehicle.system)
        if contact is not None and not self._driving.is_driven_by_duplicate_gcs(
            contact
        ):  # which the vehicle would never ask
            self._asked = _Asked(contact, now + ANSWER_WITHIN, now + REPEAT_PERIOD)

    def release(self, vehicle: VehicleState, now: float, *, station: int = 0) -> None:
        """Release control. Others than our own vehicle get the final neutrals, then no more demands.

        Our own gives control to the `station` that has asked for it, with 0 to any that has, and keeps its mode; while
        nobody asks it changes to HOLD.
        """
        self._asked = None
        contact = self._fleet.get(vehicle.system)
        if contact is None or not self._driving.is_in_control(contact):
            self._log.add(now, "station", f"not in control of {vehicle.name}", Severity.NOTICE)
            return
        if self._notice is not None and self._notice.contact is contact:
            self._notice = None
        contact.releasing = True
        self._releases.append(
            _Release(contact, now + RELEASE_WITHIN, station if contact.state.has_rover_dialect else 0)
        )

    def release_all(self, now: float) -> None:
        """Release control of every vehicle that we control."""
        for contact in self._fleet:
            if self._driving.is_in_control(contact):
                self.release(contact.state, now)

    def give(self, now: float) -> None:
        """Give control to the station that asks for it; without a request nothing happens."""
        notice = self._notice
        if notice is not None:
            self._log.add(now, "station", f"control given to GCS {notice.station}", Severity.NOTICE)
            self.release(notice.contact.state, now, station=notice.station)

    def keep(self, now: float) -> None:
        """Refuse the request; without one nothing happens."""
        notice, self._notice = self._notice, None
        if notice is not None:
            self._log.add(now, "station", f"control not given to GCS {notice.station}", Severity.NOTICE)

    # ---- messages and time ----

    def receive(self, contact: Contact, received: Received, now: float) -> None:
        """Handle a request that the vehicle has forwarded to us."""
        message = received.message
        if not isinstance(message, CommandLong) or message.command != Command.REQUEST_OPERATOR_CONTROL:
            return
        station = int(message.param4) if 1 <= message.param4 <= 255 else 0
        if message.target_system != self._system or message.param1 != REQUEST or station in (0, self._system):
            return
        if contact.state.paths.is_late(received.peer):
            return  # it came over another path before, and may be answered by now
        if self._driving.is_in_control(contact):
            within = message.param3 if LEAST_ANSWER <= message.param3 <= MOST_ANSWER else ANSWER_WITHIN
            self._show(_Notice(contact, station, now + within), now)

    def tick(self, now: float) -> None:
        """End what is overdue or done, and repeat our request when the vehicle is free."""
        notice = self._notice
        if notice is not None and not self._driving.is_in_control(notice.contact):
            self._notice = None
        elif notice is not None and now >= notice.until:
            self.keep(now)
        for release in list(self._releases):
            self._follow_release(release, now)
        if self._asked is not None:
            self._follow_request(self._asked, now)

    @property
    def finished(self) -> bool:
        """No release is under way."""
        return not self._releases

    @property
    def busy(self) -> bool:
        """Whether a request for control, ours or another station's, is under way."""
        return self._notice is not None or self._asked is not None or bool(self._releases)

    def notice(self, now: float) -> HandoverNotice | None:
        """Return the request that waits for the operator's answer."""
        notice = self._notice
        if notice is None:
            return None
        return HandoverNotice(notice.station, notice.contact.state.name, max(0.0, notice.until - now))

    def waits_for(self, contact: Contact, now: float) -> float | None:
        """Return for how many s more we wait for control of a vehicle; None if we do not."""
        asked = self._asked
        if asked is None or asked.contact is not contact or contact.state.driver in (None, 0):
            return None
        return max(0.0, asked.until - now)

    def _show(self, notice: _Notice, now: float) -> None:
        if self._notice is None or self._notice.station != notice.station:
            text = f"GCS {notice.station} requests control of {notice.contact.state.name}"
            self._log.add(now, "station", text, Severity.WARNING)
        self._notice = notice

    def _follow_release(self, release: _Release, now: float) -> None:
        contact = release.contact
        if not release.sent and contact.demand_stream.finished:
            release.sent = True
            self._commander.release_control(contact.state, now, station=release.station)
        if now >= release.until or (release.sent and not self._driving.is_in_control(contact)):
            contact.releasing = False
            self._releases.remove(release)

    def _follow_request(self, asked: _Asked, now: float) -> None:
        state = asked.contact.state
        if self._driving.is_in_control(asked.contact):
            self._asked = None
        elif now >= asked.until:
            self._asked = None
            if state.driver:
                self._log.add(now, "station", f"control not given by GCS {state.driver}", Severity.WARNING)
        elif state.driver == 0 and now >= asked.due:
            asked.due = now + REPEAT_PERIOD
            self._send_request(state, now)

    def _send_request(self, vehicle: VehicleState, now: float) -> None:
        """Request control; others must ask us for it later, so that they cannot take it in the middle of a drive."""
        command = Command.REQUEST_OPERATOR_CONTROL.name
        self._commander.send(vehicle, "request control", command, REQUEST, 0, ANSWER_WITHIN, now=now)
