"""The watchdog signs in the station's place: with its key, its time, and a link id of its own."""

from __future__ import annotations

import msgspec
import pytest

from dialects.enums import Autopilot
from dialects.messages import Heartbeat, RoverOperatorPresence
from groundstation.station.driving.driven import WatchdogTarget
from groundstation.watchdog.report import DemandRoute, StationReport, decode_report, encode_report
from groundstation.watchdog.watchdog import Watchdog
from link.protocol.framer import Framer
from link.protocol.signing_guard import SigningContext
from link.signing.clock import TICKS
from link.signing.signature import is_signed, link_and_stamp
from tests.link.frames import frame as unsigned
from tests.link.signing.signed import DAY, DRIVER, HERE, NOW, STRANGER, THERE, keep, send, signed, station, vehicle

ROVER = WatchdogTarget(
    system=1, component=1, name="Rover 1", autopilot=Autopilot.GENERIC, kind=10, session=7, boot_time=1000
)

DISARMED = Heartbeat(10, 0, 0, 0, 3, 3)


@pytest.mark.parametrize("ahead", [0, 3650 * DAY])
def test_a_vehicle_that_requires_signing_obeys_the_watchdog(ahead: int) -> None:
    """Also one whose clock is years ahead: the station has told the watchdog."""
    far = vehicle(keep(DRIVER, wall=1_795_000_000.0 + ahead / 100_000))
    ground, shared = station(keep(DRIVER)), keep(DRIVER)
    ground.receive(signed(stamp=NOW + ahead, ids=(1, 1)), HERE, 0.0)
    assert far.receive(send(ground, now=0.0)[0], THERE, 0.0)
    way = ground.signing_way(HERE, 0.0)
    report = StationReport(ids=(255, 190), vehicles=(ROVER,), routes=(DemandRoute(0, None, 3, way),))
    watchdog = Watchdog(shared)
    watchdog.handle_report(decode_report(encode_report(report)), 0.1)
    watchdog.handle_end(0.2)
    frames = [frame for n in range(4) for _, _, frame in watchdog.tick(0.2 + n * 0.1)]
    assert len(frames) == 4
    found = [each for frame in frames for each in far.receive(frame, THERE, 0.3)]
    assert [type(each.message) for each in found] == [RoverOperatorPresence] * 4
    assert all(each.signed for each in found)
    assert link_and_stamp(frames[0])[0] >= 128
    later = far.receive(send(ground, now=0.7)[0], THERE, 0.7)
    assert [type(each.message) for each in later] == [Heartbeat], "the station that goes on is not a replay"


def test_without_keys_it_signs_nothing() -> None:
    watchdog = Watchdog()
    watchdog.handle_report(StationReport(ids=(255, 190), vehicles=(ROVER,), routes=(DemandRoute(0, None, 3),)), 0.1)
    watchdog.handle_end(0.2)
    [(_, _, frame)] = watchdog.tick(0.2)
    assert not is_signed(frame)


@pytest.mark.parametrize(
    ("frame", "believed"),
    [
        (signed(DISARMED, stamp=NOW, ids=(1, 1)), True),
        (signed(DISARMED, STRANGER, NOW, ids=(1, 1)), False),
        (signed(DISARMED, stamp=NOW - 61 * TICKS, ids=(1, 1)), False),
        (unsigned(DISARMED, system=1, component=1), False),
    ],
)
def test_only_the_vehicle_itself_ends_the_neutral(frame: bytes, believed: bool) -> None:
    """A forged or recorded HEARTBEAT that says disarmed neither ends it nor calms the driver."""
    rover = msgspec.structs.replace(ROVER, verified=True)
    watchdog = Watchdog(keep(DRIVER))
    way = SigningContext(DRIVER.name, 0, 128)
    watchdog.handle_report(StationReport(vehicles=(rover,), routes=(DemandRoute(0, None, 3, way),)), 0.1)
    watchdog.handle_end(0.2)
    for _, target, _ in watchdog.tick(0.2):
        watchdog.record_sent(target, None)
    (found,) = Framer(stream=False).feed(frame, 0.3)
    watchdog.handle_frame(found, 0.3)
    assert ("is disarmed" in watchdog.outage(0.3).text) is believed
    assert bool(watchdog.tick(2.0)) is not believed


def test_without_keys_no_vehicle_that_signs_is_believed() -> None:
    rover = msgspec.structs.replace(ROVER, verified=True)
    watchdog = Watchdog()
    watchdog.handle_report(StationReport(vehicles=(rover,), routes=(DemandRoute(0, None, 3),)), 0.1)
    watchdog.handle_end(0.2)
    for _, target, _ in watchdog.tick(0.2):
        watchdog.record_sent(target, None)
    (found,) = Framer(stream=False).feed(signed(DISARMED, stamp=NOW, ids=(1, 1)), 0.3)
    watchdog.handle_frame(found, 0.3)
    assert "is disarmed" not in watchdog.outage(0.3).text
