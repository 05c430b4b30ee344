"""Texts for one ground station: a budget for each, in a bounded table."""

from __future__ import annotations

from typing import NamedTuple

from dialects.enums import Severity
from link.core import Peer
from vehicle.replies import ASKERS_MAX, BURST, LOG_BURST, LOG_RATE, QUEUE_SIZE, RATE, ReplyQueue


class Sender(NamedTuple):
    """A ground station."""

    peer: Peer
    system: int = 254
    may_ask: bool = True


def sender(number: int, *, may_ask: bool = True) -> Sender:
    return Sender(Peer(0, f"gcs {number}"), may_ask=may_ask)


def new_queue() -> tuple[ReplyQueue, list[str]]:
    """Return a queue and its log."""
    logged: list[str] = []
    return ReplyQueue(lambda severity, text: logged.append(text)), logged


def test_a_text_goes_to_its_asker() -> None:
    queue, logged = new_queue()
    queue.add(sender(1), Severity.WARNING, "no", 1, 0.0)
    assert queue.pop() == [(Peer(0, "gcs 1"), Severity.WARNING, "no")]
    assert queue.pop() == []
    assert logged == ["no"]


def test_each_asker_has_its_own_budget_and_its_own_repeats() -> None:
    queue, _ = new_queue()
    for number in range(1000):
        queue.add(sender(1), Severity.WARNING, f"no {number}", 1, number * 0.01)
    assert BURST <= len(queue.pop()) <= BURST + RATE * 10
    queue.add(sender(2), Severity.WARNING, "no 999", 1, 10.0)
    queue.add(sender(2), Severity.WARNING, "no 999", 1, 10.1)
    assert len(queue.pop()) == 1
    queue.add(sender(2), Severity.WARNING, "no 999", 1, 13.1)
    assert len(queue.pop()) == 1


def test_long_texts_cost_more() -> None:
    queue, _ = new_queue()
    for number in range(10):
        queue.add(sender(1), Severity.WARNING, f"no {number}", 4, 0.0)
    assert len(queue.pop()) == BURST // 4


def test_the_log_has_one_budget_for_all_askers() -> None:
    queue, logged = new_queue()
    for number in range(3000):
        queue.add(sender(number), Severity.WARNING, f"no {number}", 1, number * 0.01)
    assert LOG_BURST <= len(logged) <= LOG_BURST + LOG_RATE * 30 + 1


def test_tables_are_bounded_and_the_one_used_least_is_forgotten() -> None:
    queue, _ = new_queue()
    for number in range(5000):
        queue.add(sender(number), Severity.WARNING, f"no {number}", 1, 0.0)
        queue.add(sender(0), Severity.WARNING, f"no {number}", 1, 0.0)
    assert len(queue._budgets) == ASKERS_MAX
    assert sender(0).peer in queue._budgets
    assert len(queue.pop()) <= QUEUE_SIZE


def test_an_asker_that_may_not_ask_gets_nothing() -> None:
    queue, logged = new_queue()
    queue.add(sender(1, may_ask=False), Severity.WARNING, "no HEARTBEAT", 1, 0.0)
    assert queue.pop() == []
    assert logged == ["no HEARTBEAT"]
