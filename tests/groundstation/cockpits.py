"""A station with its operator and a fake vehicle in virtual time, in the states in which tests of the station start."""

from __future__ import annotations

import pytest

from dialects import messages as m
from groundstation.intents.driving import DriveKeyDown
from groundstation.intents.session import REST_PERIOD, RenewLease, ReportKeyReleases, SetKeyGate
from groundstation.intents.union import AnyIntent
from groundstation.intents.vehicle import Arm
from groundstation.snapshot import OperatorView, Snapshot, VehicleView
from groundstation.station.process.crash_neutral import CrashNeutral
from groundstation.station.station import Station
from link.transport.memory import LossyPipe
from tests.fakes.vehicle import FakeVehicle
from tests.world import World

OURS = 255
FORWARD = DriveKeyDown(key="i", throttle=1, steering=0)
LEFT = DriveKeyDown(key="j", throttle=0, steering=-1)


class Cockpit:
    """A station whose screen renews its lease, connected with a vehicle in virtual time."""

    def __init__(self, vehicle: FakeVehicle | None = None, *, loss: float = 0.0) -> None:
        self.vehicle = vehicle or FakeVehicle()
        self.station = Station(["udpin:127.0.0.1:14550"], session=7, now=100.0)
        self.core = CrashNeutral(self.station)
        up, down = LossyPipe[bytes](loss=loss, seed=1), LossyPipe[bytes](loss=loss, seed=2)
        self.world = World(self.core, self.vehicle, up=up, down=down)
        self.leasing = True
        self._lease_due = 0.0
        self.do(RenewLease(), SetKeyGate(open=True))

    @property
    def now(self) -> float:
        """s"""
        return self.world.now

    def do(self, *intents: AnyIntent) -> None:
        """Handle intents now."""
        for intent in intents:
            self.station.handle_intent(intent, self.now)
        self.world.settle()

    def run(self, seconds: float) -> None:
        """Advance the time."""
        self.world.run(seconds, self._renew)

    def _renew(self, now: float) -> None:
        period = REST_PERIOD if self.station.rests else 0.1
        self._lease_due = min(self._lease_due, now + period)  # the next snapshot tells of the end of a rest
        if self.leasing and now >= self._lease_due:
            self._lease_due = now + period
            if not self.station.renew_lease(now):
                self.station.handle_intent(RenewLease(), now)

    @property
    def snapshot(self) -> Snapshot:
        """The snapshot now; the wall clock is 1000 s ahead."""
        return self.station.snapshot(self.now, self.now + 1000.0)

    @property
    def view(self) -> VehicleView:
        """The selected vehicle."""
        view = self.snapshot.vehicle
        assert view is not None
        return view

    @property
    def operator(self) -> OperatorView:
        """The operator's part of the snapshot."""
        return self.snapshot.operator

    @property
    def texts(self) -> list[str]:
        """The message log."""
        return [line.text for line in self.snapshot.texts]

    def demands(self, since: float = 0.0) -> list[tuple[float, int, int]]:
        """Return time, x and r of the MANUAL_CONTROL that the vehicle received."""
        return [(at, message.x, message.r) for at, message in self.vehicle.all(m.ManualControl) if at >= since]


def armed_cockpit(vehicle: FakeVehicle | None = None) -> Cockpit:
    cockpit = Cockpit(vehicle)
    cockpit.run(1.5)
    cockpit.do(Arm(held=1.0))
    cockpit.run(1.5)
    assert cockpit.view.armed
    return cockpit


def driving_cockpit(vehicle: FakeVehicle | None = None) -> Cockpit:
    """Armed, key releases reported, `i` held: the vehicle gets 60 %."""
    cockpit = armed_cockpit(vehicle)
    cockpit.do(ReportKeyReleases(), FORWARD)
    cockpit.run(0.51)  # what comes next comes between two demands
    assert cockpit.operator.throttle == pytest.approx(0.6)
    return cockpit


def cockpit_with(vehicle: FakeVehicle) -> Cockpit:
    cockpit = Cockpit(vehicle)
    cockpit.run(1.5)
    assert cockpit.view.alive
    return cockpit
