"""What the station reports to its watchdog: descriptors travel when they have changed, everything else each time."""

from __future__ import annotations

import contextlib
import os
import socket
from collections.abc import Iterator
from contextlib import ExitStack

import pytest

from dialects.messages import ManualControl
from groundstation.station.driving.driven import DrivenVehicle
from groundstation.watchdog.feed import WatchdogFeed
from groundstation.watchdog.report import MAX_OUTLETS, MAX_REPORT, StationReport, decode_report
from link.endpoint import Side
from link.links import open_links
from link.transport.transport import Link

ROVER = DrivenVehicle(system=1, component=1, name="rover 1", autopilot=3)
DEMAND = ManualControl(target=1, x=600, y=0, z=0, r=0, buttons=0)


class Rig:
    """A feed with a link to a rover, and the watchdog's end of the socket."""

    def __init__(self, stack: ExitStack) -> None:
        self.ours, self.theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        for end in (self.ours, self.theirs):
            stack.enter_context(end)
            end.setblocking(False)
        self.rover = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        self.rover.bind(("127.0.0.1", 0))
        self.rover.settimeout(5.0)
        self.feed = WatchdogFeed(0, self.ours, (255, 190))
        self.now = 100.0
        self.link = self.open()

    def open(self) -> Link:
        """Open a link, which the test closes, and send a demand on it."""
        endpoint = f"udpout:127.0.0.1:{self.rover.getsockname()[1]}"
        (self.link,) = open_links([endpoint], system=255, component=190, side=Side.GROUND_STATION)
        self.demand(1)
        return self.link

    def demand(self, sequence: int) -> None:
        """Record that a demand was sent."""
        self.feed.record_sent(self.link, self.link.transport.fixed_address, DEMAND, sequence, self.now)

    def report(self) -> tuple[StationReport, list[int]]:
        """Report; return what the watchdog gets, with copies of the descriptors."""
        assert self.feed.report([ROVER], self.now)
        data, descriptors, _, _ = socket.recv_fds(self.theirs, MAX_REPORT, MAX_OUTLETS)
        return decode_report(data), descriptors

    def reaches_rover(self, descriptor: int) -> bool:
        """Return whether what is written to a descriptor arrives."""
        os.write(descriptor, b"neutral")
        os.close(descriptor)
        return self.rover.recv(100) == b"neutral"


@pytest.fixture
def rig() -> Iterator[Rig]:
    with ExitStack() as stack:
        rig = Rig(stack)
        yield rig
        rig.link.close()


def test_descriptors_travel_once_and_newest_sequence_each_time(rig: Rig) -> None:
    first, descriptors = rig.report()
    assert not first.keeps_descriptors
    assert rig.reaches_rover(*descriptors)
    rig.demand(2)
    second, none = rig.report()
    assert second.keeps_descriptors
    assert none == []
    assert [route.sequence for route in (*first.routes, *second.routes)] == [1, 2]


def test_another_socket_with_the_same_number_travels(rig: Rig) -> None:
    rig.report()
    before = rig.link.transport.outlet("")
    rig.link.close()
    after = rig.open().transport.outlet("")
    assert before is not None
    assert after is not None
    assert after.descriptor == before.descriptor
    report, descriptors = rig.report()
    assert not report.keeps_descriptors
    assert rig.reaches_rover(*descriptors)


def test_a_route_without_a_way_takes_its_descriptor_back(rig: Rig) -> None:
    rig.report()
    rig.now += 10.0
    report, descriptors = rig.report()
    assert report.routes == ()
    assert not report.keeps_descriptors
    assert descriptors == []
    rig.demand(3)
    report, descriptors = rig.report()
    assert not report.keeps_descriptors
    assert rig.reaches_rover(*descriptors)


def test_descriptors_of_an_unsent_report_travel_with_the_next(rig: Rig) -> None:
    with contextlib.suppress(BlockingIOError):
        while True:
            rig.ours.send(b"full")
    assert rig.feed.report([ROVER], rig.now), "a watchdog that stands still is there"
    with contextlib.suppress(BlockingIOError):
        while rig.theirs.recv(100):
            pass
    report, descriptors = rig.report()
    assert not report.keeps_descriptors
    assert rig.reaches_rover(*descriptors)
