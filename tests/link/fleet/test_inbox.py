"""Frames that wait to be handed over: bounded, and the newest wins."""

from __future__ import annotations

from dialects import messages as m
from link.fleet.inbox import BATCH, BULK, MAX_SENDERS, Inbox
from tests.link.frames import demand, frame, heartbeat

STATUS = frame(m.SysStatus(*(0,) * 13), 0, 1, 1)


def test_of_demands_only_the_newest_waits() -> None:
    inbox = Inbox()
    for number in range(50):
        inbox.put("alice", demand(number), 0.1)
    assert inbox.take(0.2) == ([(demand(49), "alice")], False)
    assert inbox.dropped == 49


def test_what_waits_longer_than_a_demand_is_used_is_dropped() -> None:
    inbox = Inbox()
    inbox.put("alice", demand(0), 0.0)
    assert inbox.take(0.6) == ([], False)


def test_a_flood_of_one_sender_neither_grows_nor_delays_another() -> None:
    inbox = Inbox()
    for _ in range(2 * BULK // len(STATUS)):
        inbox.put("rover1", STATUS, 0.0)
    inbox.put("rover2", heartbeat(0, 2, 1), 0.0)
    taken, more = inbox.take(0.0)
    assert (heartbeat(0, 2, 1), "rover2") in taken[:2]
    assert (len(taken), more) == (BATCH, True)
    while more:
        rest, more = inbox.take(0.0)
        taken += rest
    assert sum(len(data) for data, _ in taken) <= BULK + 100


def test_senders_are_bounded() -> None:
    inbox = Inbox()
    for number in range(MAX_SENDERS + 3):
        inbox.put(f"rover{number}", STATUS, 0.0)
    assert inbox.dropped == 3
    inbox.forget("rover0")
    inbox.put("new", STATUS, 0.0)
    assert inbox.dropped == 3
    while inbox.take(0.0)[1]:
        pass
    inbox.put("another", STATUS, 0.0)
    assert inbox.take(0.0) == ([(STATUS, "another")], False)
    assert inbox.dropped == 3
