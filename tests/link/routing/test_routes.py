"""The route table: its timeouts, its limits and its counts."""

from __future__ import annotations

from link.routing.router import MAX_TRACKED_SOURCES
from link.routing.routes import MAX_PEERS, MAX_SOURCES, PEER_SILENCE, ROUTE_SILENCE
from tests.link.frames import frame, heartbeat
from tests.link.routing.test_router import BROADCAST, GCS, OTHER, SERIAL, UDP, Rig, command, unknown


def test_silent_addresses_get_nothing_more_and_their_counts_stay() -> None:
    rig = Rig()
    rig.send(SERIAL, heartbeat(1, 1, 1), now=PEER_SILENCE + 1.2)
    rig.router.tick(PEER_SILENCE + 1.3)
    assert set(rig.send(SERIAL, frame(BROADCAST, 2, 1, 1), now=PEER_SILENCE + 1.4)) == {(OTHER, "out")}
    assert rig.router.table.transport_reports()[UDP].frames_in == 1


def test_a_silent_vehicle_is_still_told_to_stop_for_minutes() -> None:
    rig = Rig()
    rig.router.tick(ROUTE_SILENCE)
    assert set(rig.send(UDP, command(1, 1), now=ROUTE_SILENCE)) == {(SERIAL, "tty")}
    rig.router.tick(ROUTE_SILENCE + 1.1)
    assert rig.send(UDP, command(1, 1, 2), now=ROUTE_SILENCE + 1.2) == {}


def test_a_connection_that_ends_takes_its_routes_along() -> None:
    rig = Rig()
    rig.router.table.handle_disconnect(SERIAL, "tty")
    assert rig.send(UDP, command(1, 1)) == {}
    assert (SERIAL, "tty") in rig.send(UDP, heartbeat(2))  # the port is still there


def test_strangers_fill_no_table() -> None:
    rig = Rig()
    for number in range(5000):
        rig.send(UDP, b"GET / HTTP/1.1\r\n", ("10.1.0.1", number))
        rig.send(UDP, unknown(1), ("10.2.0.1", number))
    assert rig.router.table.transport_reports()[UDP].peers == 1
    for number in range(5000):
        rig.send(UDP, heartbeat(0, 2), ("10.3.0.1", number))
    assert len(rig.router.table.peers_of(UDP)) == MAX_PEERS
    for system in range(1, 256):
        for component in (1, 2, 3):
            rig.send(UDP, heartbeat(0, system, component))
    assert len(rig.router.table.peers_of(UDP)[GCS].sources) == MAX_SOURCES
    assert len(rig.router._recent) <= MAX_TRACKED_SOURCES
    assert (SERIAL, "tty") in rig.send(UDP, heartbeat(7, 200, 9))  # known or not, it is forwarded


def test_loss_is_counted_by_link() -> None:
    rig = Rig()
    for number in (1, 2, 5, 4, 6):
        rig.send(SERIAL, frame(BROADCAST, number, 1, 1))
    report = rig.router.table.transport_reports()[SERIAL]
    assert (report.received, report.lost) == (6, 1)
