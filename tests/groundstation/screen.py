"""A client without a screen: renews the lease and waits for snapshots."""

from __future__ import annotations

import select
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any

from groundstation.client import StationClient
from groundstation.intents.driving import DriveKeyDown, DriveKeyUp
from groundstation.intents.session import RenewLease, ReportKeyReleases, SetKeyGate
from groundstation.intents.vehicle import Arm, SetMode
from groundstation.snapshot import Snapshot
from tests.fakes.vehicle import FakeVehicle
from tests.ports import free_port
from tests.waits import PATIENCE

TRY = 3.0
"""s for a key to show; a screen or a station that the machine held up for 0.3 s wants it pressed again."""
FORWARD = DriveKeyDown(key="i", throttle=1, steering=0)


class Screen:
    """Starts a station process on a free port, or attaches to one; renews the lease until `freeze`."""

    def __init__(self, *endpoints: str, none: bool = False, **options: Any) -> None:
        """`none`: without any link. With a simulator the station has a port of its own if no endpoint is given."""
        if not (endpoints or none or options.get("sitl")):
            endpoints = (f"udpin:127.0.0.1:{free_port()}",)
        self._begin(StationClient.start(endpoints, **options))

    @classmethod
    def attach(cls, station: int, name: str = "second screen") -> Screen:
        """Connect to a station that runs."""
        screen = cls.__new__(cls)
        screen._begin(StationClient.attach(station, name))
        return screen

    def _begin(self, client: StationClient) -> None:
        self.client = client
        self.snapshot = Snapshot()
        self.client.send(RenewLease(), SetKeyGate(open=True))
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._renew, daemon=True)
        self._thread.start()

    def __enter__(self) -> Screen:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.freeze()
        self.client.close()

    @property
    def endpoint(self) -> str:
        return self.client.endpoints[0]

    @property
    def speed(self) -> float:
        """Of the vehicle in the newest snapshot, m/s."""
        return 0.0 if self.snapshot.vehicle is None else self.snapshot.vehicle.speed or 0.0

    def freeze(self) -> None:
        """Stop renewing the lease."""
        self._stop.set()
        self._thread.join()

    def see(self, condition: Callable[[Snapshot], bool], within: float = PATIENCE) -> Snapshot:
        """Wait for a snapshot of which `condition` is true."""
        deadline = time.monotonic() + within
        while time.monotonic() < deadline and self.client.alive:
            select.select(self.client.filenos(), [], [], 0.2)
            newest = self.client.receive()
            if newest is not None:
                self.snapshot = newest
                if condition(newest):
                    return newest
        raise AssertionError(f"not seen within {within} s (alive: {self.client.alive}); last: {self.snapshot}")

    def drive(self, vehicle: FakeVehicle) -> None:
        """Arm and hold `i`; return when the vehicle receives the demand."""
        self.hold_forward()
        begun = time.monotonic()
        self.turn_wheels(lambda: any(x == 600 for _, x in vehicle.demands(begun)))

    def hold_forward(self) -> None:
        """Arm and hold `i`; return when the snapshot shows the demand."""
        self.see(lambda snapshot: snapshot.vehicle is not None)
        self.client.send(ReportKeyReleases())
        self.insist(
            lambda: self.client.send(Arm(held=1.0)), lambda seen: seen.vehicle is not None and seen.vehicle.armed
        )
        self.see(lambda snapshot: snapshot.operator.gate_open)
        self.insist(lambda: self.client.send(DriveKeyUp(key="i"), FORWARD), lambda seen: seen.operator.throttle > 0)

    def turn_wheels(self, turning: Callable[[], bool]) -> None:
        """Press `i` until the wheels turn; what a failsafe has ended meanwhile on a late machine is begun anew."""

        def press() -> None:
            vehicle = self.snapshot.vehicle
            if vehicle is not None and not vehicle.armed:
                self.client.send(Arm(held=1.0))
            if vehicle is not None and vehicle.mode == "HOLD":
                self.client.send(SetMode("MANUAL"))
            self.client.send(DriveKeyUp(key="i"), FORWARD)

        self.insist(press, lambda _: turning())

    def insist(self, act: Callable[[], None], condition: Callable[[Snapshot], bool], within: float = TRY) -> None:
        """Do it again until it shows, which takes `within` s at most."""
        for _ in range(round(PATIENCE / within)):
            act()
            with suppress(AssertionError):
                self.see(condition, within)
                return
        raise AssertionError(f"not seen: {self.snapshot}")

    def _renew(self) -> None:
        while not self._stop.wait(0.1):
            self.client.send(RenewLease())


def running(pid: int) -> bool:
    """Is there a process that has not ended? A zombie has."""
    try:
        with open(f"/proc/{pid}/stat", "rb") as status:
            return status.read().rpartition(b")")[2].split()[0] != b"Z"
    except OSError:
        return False


def children(pid: int) -> list[int]:
    """Processes whose parent is `pid`."""
    with open(f"/proc/{pid}/task/{pid}/children", encoding="ascii") as listed:
        return [int(child) for child in listed.read().split()]


def simulators(station: int) -> list[int]:
    """Return the simulators that a station process has started; its other child is the watchdog."""
    return [child for child in children(station) if b"\0vehicle\0" in Path(f"/proc/{child}/cmdline").read_bytes()]
