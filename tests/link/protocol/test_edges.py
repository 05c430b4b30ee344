"""Edges of limits, and counts beyond one: signing, flow control, places, packet numbers."""

from __future__ import annotations

import pytest

from dialects.messages import RadioStatus
from link.core import SigningCounts
from link.protocol.channel import Channel
from link.protocol.flow_control import FORGET_AFTER, MAX_DELAY, NOMINAL_INTERVAL, FlowControl
from link.protocol.peer_table import MAX_PEERS, PEER_SILENCE
from link.protocol.sequence import FrameOrder, SequenceTracker
from link.protocol.signing_guard import LANES, WATCHDOG_LANE, SigningPolicy
from tests.link.frames import frame, heartbeat
from tests.link.signing.signed import ARM, DAY, DRIVER, HERE, NOW, THERE, WATCHER, keep, send, signed, vehicle
from tests.rows import each_row

GREETS = SigningPolicy(unsigned=None, greets_late=True)


# ---- signing ----


def test_each_refused_frame_is_counted() -> None:
    channel = vehicle(keep(DRIVER))
    for _ in range(3):
        channel.receive(signed(ARM), HERE, 0.0)
    for number in range(2):
        channel.receive(signed(ARM, stamp=NOW - DAY + number, link_id=1), HERE, 0.0)
    assert channel.report().refused == SigningCounts(replayed=2, too_old=2)


def test_only_a_heartbeat_that_is_late_brings_our_frames() -> None:
    channel = vehicle(keep(DRIVER), GREETS)
    channel.receive(signed(ARM, stamp=NOW - DAY), HERE, 0.0)
    assert send(channel) == []


def test_the_watchdog_signs_as_the_peer_on_a_link_id_of_its_own() -> None:
    channel = vehicle(keep(DRIVER, WATCHER), index=2)
    channel.receive(signed(key=WATCHER, stamp=NOW + 1000), HERE, 0.0)
    channel.receive(signed(stamp=NOW, ids=(254, 190)), THERE, 0.0)
    watcher, driver = channel.signing_way(HERE, 0.0), channel.signing_way(THERE, 0.0)
    assert watcher == (WATCHER.name, 1000, WATCHDOG_LANE + 2)
    assert driver == (DRIVER.name, 0, WATCHDOG_LANE + 2)
    assert WATCHDOG_LANE == 128 == 32 * LANES, "bytes 0 to 127 are the station's"


# ---- flow control ----


@each_row(
    ("free", "delay"),
    [
        (0, 0.16),
        (19, 0.16),
        (20, 0.12),
        (49, 0.12),
        (50, 0.1),
        (90, 0.1),
        (91, 0.08),
        (95, 0.08),
        (96, 0.06),
        (100, 0.06),
    ],
)
def test_each_level_of_the_radios_buffer_changes_the_delay(free: int, delay: float) -> None:
    flow = FlowControl()
    for _ in range(5):
        flow.handle_radio_status(30, 0.0)
    flow.handle_radio_status(free, 0.0)
    assert flow.headroom(0.0) == pytest.approx(NOMINAL_INTERVAL / (NOMINAL_INTERVAL + delay))


def test_the_delay_has_a_limit_and_ends_with_the_reports() -> None:
    flow = FlowControl()
    assert flow.headroom(0.0) == 1.0
    flow.handle_radio_status(60, 0.0)
    assert flow.headroom(0.0) == 1.0
    for _ in range(100):
        flow.handle_radio_status(0, 1.0)
    slowest = NOMINAL_INTERVAL / (NOMINAL_INTERVAL + MAX_DELAY)
    assert flow.headroom(1.0 + FORGET_AFTER) == pytest.approx(slowest)
    assert flow.headroom(1.001 + FORGET_AFTER) == 1.0


def test_link_without_radio_has_full_capacity_and_says_why_down() -> None:
    channel = Channel("udpin:127.0.0.1:14550", 0, system=1, component=1)
    channel.receive(frame(RadioStatus(200, 200, 1, 30, 30, 0, 0), 0, 51, 68), HERE, 0.0)
    assert channel.report().headroom == 1.0
    assert channel.report("unplugged").down == "unplugged"


# ---- places ----


def test_one_frame_of_the_ids_in_control_fills_a_reserved_place() -> None:
    channel = Channel("udpin:127.0.0.1:14550", 0, system=1, component=1)
    for port in range(MAX_PEERS):
        channel.receive(heartbeat(0, system=100), f"10.0.0.9:{port}", 0.0)
    channel.reserve((255, 190))
    assert channel.receive(heartbeat(0, system=99) + heartbeat(1), HERE, PEER_SILENCE) != []
    assert len(list(channel._peers)) == MAX_PEERS + 1, "nobody is silent for too long yet"


# ---- packet numbers ----


def test_each_late_number_is_remembered() -> None:
    tracker = SequenceTracker(10, 1, 10, 0.0)
    orders = [tracker.accept(number, 1, number, 0.0) for number in (14, 12, 11, 12, 11, 10)]
    assert orders == [FrameOrder.NEW, FrameOrder.LATE, FrameOrder.LATE, *[FrameOrder.DUPLICATE] * 3]
    assert (tracker.received, tracker.lost) == (2, 1)
