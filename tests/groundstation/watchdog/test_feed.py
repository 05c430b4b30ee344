"""What the station reports to its watchdog: descriptors travel when they have changed, everything else each time."""

from __future__ import annotations

import contextlib
import os
import socket
from collections.abc import Iterator
from contextlib import ExitStack

import pytest

from dialects.enums import OperatorFlag
from dialects.messages import Heartbeat, ManualControl, RcChannelsOverride, RoverOperatorPresence
from groundstation.station.driving.driven import WatchdogTarget
from groundstation.watchdog.feed import WatchdogFeed
from groundstation.watchdog.report import MAX_OUTLETS, MAX_REPORT, StationReport, decode_report
from link.endpoint import Side
from link.links import open_links
from link.runtime.local_socket import open_pair
from link.transport.transport import Link

ROVER = WatchdogTarget(system=1, component=1, name="rover 1", autopilot=3, kind=10)
DEMAND = ManualControl(target=1, x=600, y=0, z=0, r=0, buttons=0)


class Rig:
    """A feed with a link to a rover, and the watchdog's end of the socket."""

    def __init__(self, stack: ExitStack) -> None:
        self.ours, self.theirs = open_pair()
        for end in (self.ours, self.theirs):
            stack.enter_context(end)
            end.setblocking(False)
        self.rover = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        self.rover.bind(("127.0.0.1", 0))
        self.rover.settimeout(5.0)
        self.feed = WatchdogFeed(0, self.ours, (252, 191))
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


def test_a_link_that_gets_proofs_with_axes_is_a_route(rig: Rig) -> None:
    for flags, routes in ((OperatorFlag(0), 1), (OperatorFlag.AXES, 2)):
        proof = RoverOperatorPresence(target_system=1, target_component=1, time_boot_ms=1, echo_time_boot_ms=1,
                                      session_id=7, input_count=0, last_input_age_ms=0, flags=flags,
                                      x=0, y=0, z=0, r=0)  # fmt: skip
        rig.feed.record_sent(rig.link, "another address", proof, 1, rig.now)
        assert len(rig.report()[0].routes) == routes


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


def test_a_report_tells_all_that_the_watchdog_needs(rig: Rig) -> None:
    rig.feed.set_flags(screen_has_quit=True)
    rig.feed.set_flags(keys_version=2)
    assert rig.feed.report([ROVER], rig.now, rests=True)
    report = decode_report(rig.theirs.recv(MAX_REPORT))
    assert (report.ids, report.vehicles, len(report.routes)) == ((252, 191), (ROVER,), 1)
    assert (report.screen_has_quit, report.keys_version, report.rests) == (True, 2, True)
    assert not (report.screen_is_gone)
    assert not (report.ending)


def test_overrides_are_demands_and_other_messages_are_not(rig: Rig) -> None:
    rig.now += 10.0
    rig.feed.record_sent(rig.link, rig.link.transport.fixed_address, Heartbeat(6, 8, 0, 0, 4, 3), 4, rig.now)
    assert rig.report()[0].routes == ()
    override = RcChannelsOverride(1, 1, *(0,) * 8)
    rig.feed.record_sent(rig.link, rig.link.transport.fixed_address, override, 5, rig.now)
    report, descriptors = rig.report()
    assert [(route.vehicle, route.sequence) for route in report.routes] == [(0, 5)]
    assert rig.reaches_rover(*descriptors)


def test_a_route_is_that_of_its_own_vehicle(rig: Rig) -> None:
    other = WatchdogTarget(system=2, component=1, name="rover 2", autopilot=3, kind=10)
    assert rig.feed.report([other, ROVER], rig.now)
    data, descriptors, _, _ = socket.recv_fds(rig.theirs, MAX_REPORT, MAX_OUTLETS)
    assert [route.vehicle for route in decode_report(data).routes] == [1]
    assert rig.reaches_rover(*descriptors)


@pytest.mark.parametrize(("after", "routes"), [(3.0, 1), (3.01, 0)])
def test_a_route_is_kept_for_3_s_after_a_demand(rig: Rig, after: float, routes: int) -> None:
    rig.now += after
    report, descriptors = rig.report()
    assert len(report.routes) == routes
    for descriptor in descriptors:
        os.close(descriptor)


def test_a_link_that_is_closed_has_no_route(rig: Rig) -> None:
    rig.link.close()
    assert rig.report() == (StationReport(ids=(252, 191), vehicles=(ROVER,), keeps_descriptors=True), [])


def test_a_report_has_32_routes_at_most(rig: Rig) -> None:
    for port in range(40):
        rig.feed.record_sent(rig.link, ("127.0.0.1", 1000 + port), DEMAND, 1, rig.now)
    report, descriptors = rig.report()
    assert len(report.routes) == len(descriptors) == 32
    for descriptor in descriptors:
        os.close(descriptor)


def test_the_numbers_of_many_addresses_are_bounded(rig: Rig) -> None:
    rig.demand(7)
    for port in range(256):
        rig.feed.record_sent(rig.link, ("192.0.2.1", port), Heartbeat(6, 8, 0, 0, 4, 3), 1, rig.now)
    report, descriptors = rig.report()
    assert [route.sequence for route in report.routes] == [7]
    rig.feed.record_sent(rig.link, ("192.0.2.2", 1), Heartbeat(6, 8, 0, 0, 4, 3), 1, rig.now)
    assert [route.sequence for route in rig.report()[0].routes] == [0]
    os.close(*descriptors)


def test_a_watchdog_that_is_gone_is_reported_once(rig: Rig, caplog: pytest.LogCaptureFixture) -> None:
    assert rig.feed.alive
    rig.theirs.close()
    assert [rig.feed.report([ROVER], rig.now) for _ in range(3)] == [False, True, True]
    assert not rig.feed.alive
    assert "no report to the watchdog" in caplog.text


def test_a_watchdog_that_stood_still_is_not_gone(rig: Rig) -> None:
    with contextlib.suppress(BlockingIOError):
        while True:
            rig.ours.send(b"full")
    assert rig.feed.report([ROVER], rig.now)
    rig.theirs.close()
    assert not rig.feed.report([ROVER], rig.now)


def test_a_feed_that_is_closed_ends_its_watchdog_in_order() -> None:
    ours, theirs = open_pair()
    with ours, theirs:
        feed = WatchdogFeed.start(ours, None, (255, 190))
        assert feed.report([ROVER], 100.0)
        assert feed.report([], 100.0)
        feed.close()
        with contextlib.suppress(ChildProcessError):  # it has been waited for, unless this machine is busy
            assert os.waitpid(feed._process, 0)[1] == 0
        theirs.setblocking(False)
        with pytest.raises(BlockingIOError):
            theirs.recv(1)
