"""From Zenoh's threads to the loop: bounded, and the newest wins."""

from __future__ import annotations

from dialects import messages as m
from link.fleet.inbox import BATCH, BULK, MAX_SENDERS, Inbox
from tests.link.frames import demand, frame, heartbeat

STATUS = frame(m.SysStatus(*(0,) * 13), 0, 1, 1)


def test_the_loop_is_told_once_and_of_demands_only_the_newest_waits() -> None:
    inbox = Inbox()
    told = [inbox.put("alice", demand(number), 0.1) for number in range(50)]
    assert told == [True, *(False,) * 49]
    assert inbox.take(0.2) == ([(demand(49), "alice")], False)
    assert inbox.dropped == 49
    assert inbox.put("alice", demand(50), 0.3)


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
    assert inbox.put("new", STATUS, 0.0) is False  # the loop knows already
    assert inbox.dropped == 3
    while inbox.take(0.0)[1]:
        pass
    assert inbox.put("another", STATUS, 0.0)
    assert inbox.dropped == 3
