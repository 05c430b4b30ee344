"""A bridge with all places of a link taken: who gets one, and that a stop needs none."""

from __future__ import annotations

from collections.abc import Hashable

import pytest

from dialects.messages import CommandLong
from link.routing.router import Router
from tests.link.frames import frame, heartbeat
from tests.link.routing.test_router import BROADCAST, GCS, SERIAL, UDP, Rig, command

PLACES = 128
NEWCOMER = ("10.9.0.1", 14550)
STOP = CommandLong(1, 1, 400, 0, 0, 0, 0, 0, 0, 0, 0)
TELEMETRY = frame(BROADCAST, 2, 1, 1)


def crowded(frames: int, *, one_host: bool = False, now: float = 1.0) -> Rig:
    """A bridge with the usual ground station, and strangers with so many frames each."""
    rig = Rig()
    rig.send(UDP, heartbeat(1) + heartbeat(2) + heartbeat(3), now=now)
    for stranger in range(PLACES - 1):
        address = ("10.1.0.1", stranger) if one_host else (f"10.1.0.{stranger}", 14550)
        for sequence in range(frames):
            rig.send(UDP, heartbeat(sequence, 100), address, now=now)
    assert len(rig.router.table.peers_of(UDP)) == PLACES
    return rig


def get_telemetry(rig: Rig, now: float) -> set[Hashable]:
    return {address for _, address in rig.send(SERIAL, TELEMETRY, now=now)}


def test_strangers_with_one_frame_each_keep_nobody_out() -> None:
    rig = crowded(1)
    rig.send(UDP, heartbeat(0, 254), NEWCOMER, now=3.1)
    assert NEWCOMER in get_telemetry(rig, 3.2)
    assert GCS in get_telemetry(rig, 3.3), "a program that stays is not replaced by one that passes"


@pytest.mark.parametrize(("frames", "after", "admitted"), [(1, 1.9, False), (1, 2.1, True), (2, 2.1, True),
                                                           (3, 9.9, False), (3, 10.1, True)])  # fmt: skip
def test_who_stays_keeps_a_place_for_10_s_of_silence(frames: int, after: float, admitted: bool) -> None:
    rig = crowded(frames)
    rig.send(UDP, heartbeat(0, 254), NEWCOMER, now=1.0 + after)
    assert (NEWCOMER in rig.router.table.peers_of(UDP)) is admitted
    assert rig.router.table.refused_peers == (not admitted)


def test_a_host_with_most_places_gives_one_up_to_another_host() -> None:
    rig = crowded(3, one_host=True)
    rig.send(UDP, heartbeat(0, 254), NEWCOMER, now=1.5)
    assert NEWCOMER in get_telemetry(rig, 1.6)
    rig.send(UDP, heartbeat(0, 100), ("10.1.0.1", 999), now=1.7)
    assert NEWCOMER in get_telemetry(rig, 1.8), "the host does not take it back"


def test_hosts_with_4_places_keep_them() -> None:
    rig = Rig()
    for stranger in range(PLACES - 1):
        for sequence in range(3):
            rig.send(UDP, heartbeat(sequence, 100), (f"10.1.0.{stranger // 4}", stranger), now=1.0)
    rig.send(UDP, heartbeat(0, 254), NEWCOMER, now=1.5)
    assert NEWCOMER not in rig.router.table.peers_of(UDP)


def test_runs_of_one_operator_of_a_fleet_keep_no_other_out() -> None:
    router = Router([(True, None), (True, "tty")])
    router.receive(1, [(heartbeat(0, 1, 1), "tty")], 1.0)
    for run in range(PLACES):
        router.receive(0, [(b"", f"eve/{run}")], 1.0)
    router.receive(0, [(b"", "alice/1")], 1.1)
    found = {each.address for each in router.receive(1, [(TELEMETRY, "tty")], 1.2)}
    assert "alice/1" in found
    assert len(found) == PLACES


def test_a_stop_passes_a_bridge_without_a_place_and_is_answered() -> None:
    rig = crowded(3)
    assert rig.send(UDP, command(1, 1), NEWCOMER, now=1.5) == {}, "arming is not a stop"
    stop = frame(STOP, 2, system=254)
    assert rig.send(UDP, stop, NEWCOMER, now=1.6)[SERIAL, "tty"] == stop
    assert NEWCOMER in get_telemetry(rig, 1.7)
    assert GCS in get_telemetry(rig, 1.8)


def test_of_those_who_stop_the_newest_8_are_answered() -> None:
    rig = crowded(3)
    for host in range(50):
        found = rig.send(UDP, frame(STOP, host, system=254), (f"10.8.0.{host}", 1), now=1.5 + host / 100)
        assert (SERIAL, "tty") in found
    there = get_telemetry(rig, 2.5)
    assert {f"10.8.0.{host}" for host in range(50) if (f"10.8.0.{host}", 1) in there} == {
        f"10.8.0.{host}" for host in range(42, 50)
    }
    assert len(rig.router.table.peers_of(UDP)) == PLACES + 8
