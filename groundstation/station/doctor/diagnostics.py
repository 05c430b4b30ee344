"""Diagnostics: examines the chain once a second, builds its view, and carries out what the Setup screen wants."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

from groundstation.doctor.chain import count_faults, examine
from groundstation.doctor.prearm_advice import find_advice
from groundstation.intents.base import Intent
from groundstation.intents.setup import (
    SETUP,
    Calibrate,
    ConfirmPosition,
    EndCalibration,
    StopMotorTest,
    TurnMotor,
    WatchSticks,
)
from groundstation.snapshot import Snapshot
from groundstation.station.doctor.doctor_facts import (
    VehicleReport,
    collect,
    find_motors,
    motor_rows,
    sensor_rows,
    vehicle_facts,
)
from groundstation.station.driving.motor_test import THROTTLE_MAX, MotorTester
from groundstation.station.driving.operator import OperatorSession
from groundstation.station.links.link_stats import LinkStats
from groundstation.station.outbox import StationOutbox
from groundstation.station.services.service_requests import ServiceRequests
from groundstation.station.services.vehicle_queries import VehicleQueries
from groundstation.station.view_feed import ViewSource
from groundstation.vehicles.fleet import Contact, Fleet
from groundstation.views.base import ViewRequest
from groundstation.views.doctor import (
    CheckText,
    DoctorRequest,
    DoctorRow,
    DoctorView,
)
from groundstation.views.requests import RequestLine
from link.core import Received

PERIOD = 1.0
"""s between two examinations."""
QUICK = 0.2
"""s between two views: a motor test and a calibration are watched closely."""
CHECKS = "pre-arm checks"


class Diagnostics:
    """What the Setup screen and the verb `doctor` need. `ids` are our system and component id."""

    def __init__(
        self,
        fleet: Fleet,
        services: ServiceRequests,
        queries: VehicleQueries,
        links: LinkStats,
        operator: OperatorSession,
        outbox: StationOutbox,
        ids: tuple[int, int],
        shown: Callable[[float], Snapshot],
    ) -> None:
        """`shown` builds the snapshot of a moment: the doctor judges what the screens show."""
        self._fleet, self._services, self._queries = fleet, services, queries
        self._links, self._ids, self._shown = links, ids, shown
        self.tester = MotorTester(fleet, operator, outbox, ids)
        self.faults = 0
        """How many links of the chain stop the operator."""
        self._reports: dict[int, VehicleReport] = {}
        self._request = DoctorRequest()
        self._rows: tuple[DoctorRow, ...] = ()
        self._due = -math.inf
        self._outbox = outbox.commands

    @property
    def sources(self) -> Mapping[type[ViewRequest], ViewSource]:
        """Request -> its source."""
        return {DoctorRequest: ViewSource(self.build, QUICK)}

    # ---- core ----

    def receive(self, contact: Contact, received: Received, now: float) -> None:
        """Handle a message of a vehicle."""
        report = self._report(contact)
        report.checks.receive(received, now)
        report.params.receive(received, now)
        report.calibration.receive(received)
        self.tester.receive(received, now)

    def handle_text(self, contact: Contact, text: str, now: float) -> None:
        """Handle a whole STATUSTEXT of a vehicle."""
        report = self._report(contact)
        report.checks.handle_text(text, now)
        report.calibration.handle_text(text)
        if contact is self._fleet.selected:
            self.tester.handle_text(text, now)

    def tick(self, now: float, *, watched: bool) -> None:
        """Renew or end a motor test, read the parameters while somebody sees the chain (`watched`)."""
        self.tester.tick(now, watched=watched)
        chosen = self._fleet.selected
        for contact in self._fleet:
            self._follow_sticks(contact)
            if contact.lost_at is not None and contact.state.system in self._reports:
                self._reports[contact.state.system].params.restart()  # it may come back with other values
        for system, report in self._reports.items():
            wanted = watched and chosen is not None and chosen.state.system == system
            self._outbox += report.params.tick(now, watched=wanted)

    def _follow_sticks(self, contact: Contact) -> None:
        """Read the parameters of the channels that are moved; end the calibration in an armed vehicle."""
        report = self._reports.get(contact.state.system)
        if report is None or not report.calibration.sticks.running:
            return
        contact.drive.params.want(report.calibration.sticks.values)
        if contact.state.armed:
            report.calibration.end_sticks("RC sticks: ended, the vehicle is armed")

    def examine_if_due(self, now: float) -> None:
        """Examine the chain, once a second. Called when everything else of a tick is done."""
        if now >= self._due:
            self._due = now + PERIOD
            self._rows = self._examine(now)
            self.faults = count_faults(self._rows)

    # ---- the operator ----

    @property
    def handlers(self) -> dict[type[Intent], Callable[[Any, float], None]]:
        """Intents of the Setup screen -> who carries them out; the services of the vehicle get some of them, too."""
        return {
            Calibrate: self._begin_calibration,
            TurnMotor: self._turn,
            StopMotorTest: self._stop,
            ConfirmPosition: self._confirm,
            EndCalibration: self._end_calibration,
            WatchSticks: self._watch_sticks,
        }

    def end_test(self, intent: Intent, now: float) -> None:
        """End the test of a motor with any input of the operator that is not one of `handlers`."""
        if intent.is_input and type(intent) not in _OWN:
            self.tester.stop("stopped: another key", now)

    def _turn(self, intent: TurnMotor, now: float) -> None:
        self.tester.press(intent, find_motors(self._fleet.selected), now)

    def _stop(self, intent: StopMotorTest, now: float) -> None:
        self.tester.stop("stands", now)

    def _confirm(self, intent: ConfirmPosition, now: float) -> None:
        if intent.system in self._reports:
            self._reports[intent.system].calibration.confirm_position()

    def _end_calibration(self, intent: EndCalibration, now: float) -> None:
        if intent.system in self._reports:
            self._reports[intent.system].calibration.end_compass(accept=intent.accept)

    def _begin_calibration(self, intent: Calibrate, now: float) -> None:
        self.tester.stop("stopped: calibration", now)
        if intent.system in self._reports:
            self._reports[intent.system].calibration.begin(intent.kind)

    def _watch_sticks(self, intent: WatchSticks, now: float) -> None:
        self.tester.stop("stopped: calibration", now)
        contact = self._fleet.selected
        if contact is None or contact.state.system != intent.system:
            return
        calibration = self._report(contact).calibration
        if not intent.on:
            calibration.end_sticks("")
        elif not contact.state.armed:
            calibration.begin_sticks()

    # ---- the view ----

    def _examine(self, now: float) -> tuple[DoctorRow, ...]:
        contact = self._fleet.selected
        system = 0 if contact is None else contact.state.system
        facts = collect(
            self._shown(now),
            contact,
            self._reports.get(system),
            self._links,
            system=self._request.station or self._ids[0],
            terminal=self._request.terminal,
            tested=self._tested(contact),
            now=now,
        )
        return examine(facts)

    def build(self, request: DoctorRequest, now: float, wall: float) -> DoctorView:
        """Build the view of the selected vehicle; a new request has the chain examined at once."""
        if request != self._request:
            self._request, self._due = request, -math.inf
        self.examine_if_due(now)
        contact = self._fleet.selected
        if contact is None:
            return DoctorView(rows=self._rows)
        self._queries.request_version(contact, now)
        report, requests = self._report(contact), self._requests(contact.state.system)
        sticks, values = report.calibration.sticks, contact.drive.params.values
        checked = next((line for line in reversed(requests) if line.what == CHECKS), None)
        return DoctorView(
            system=contact.state.system,
            name=contact.state.name,
            armed=contact.state.armed,
            rows=self._rows,
            sensors=sensor_rows(report.checks.bits),
            texts=tuple(
                CheckText(each.text, find_advice(each.text), each.age // 1) for each in report.checks.texts(now)
            ),
            checked=checked,
            checked_ago=report.checks.checked_ago(now),
            motors=motor_rows(contact, report, self._tested(contact), self._shown(now).vehicle),
            motor_limit=min(THROTTLE_MAX, report.params.values.get("MOT_TEST_MAX", 30.0) / 100),
            test=self.tester.view,
            calibrations=report.calibration.rows(contact.state.autopilot, requests),
            calibration=report.calibration.text,
            waits_for_position=report.calibration.position is not None,
            calibration_share=report.calibration.compass.share,
            compass_ready=report.calibration.compass.ready,
            sticks=sticks.rows if sticks.running else None,
            stick_changes=sticks.changes(values) if sticks.running else (),
            sticks_unread=sticks.unread(values) if sticks.running else (),
            facts=vehicle_facts(contact),
            requests=requests,
        )

    def _tested(self, contact: Contact | None) -> frozenset[int]:
        return self.tester.tested.get(contact.state.system, frozenset()) if contact is not None else frozenset()

    def _requests(self, system: int) -> tuple[RequestLine, ...]:
        found = self._services.requests_of(SETUP, system)
        return (*(line for line in found.ended if line.system == system), *found.running)

    def _report(self, contact: Contact) -> VehicleReport:
        report = self._reports.get(contact.state.system)
        if report is None or report.component != contact.state.component:
            report = self._reports[contact.state.system] = VehicleReport.of(contact, self._outbox, self._ids)
        return report


_OWN = frozenset((Calibrate, TurnMotor, StopMotorTest, ConfirmPosition, EndCalibration, WatchSticks))
"""The intents of `handlers`."""
