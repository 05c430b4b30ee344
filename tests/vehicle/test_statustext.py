"""STATUSTEXT: once, in chunks, and never too many."""

from __future__ import annotations

from dialects.enums import Severity
from dialects.messages import StatusText, decode_text
from vehicle.statustext import StatusTextQueue


def raw(message: StatusText) -> bytes:
    return bytes(message._text_raw)


def test_a_short_text_is_one_message() -> None:
    texts = StatusTextQueue()
    texts.send(Severity.NOTICE, "Armed", 0.0)
    (message,) = texts.pop_due(0.0)
    assert (decode_text(message), message.severity, message.id) == ("Armed", Severity.NOTICE, 0)
    assert texts.pop_due(0.0) == []


def test_a_long_text_comes_in_chunks_that_make_it_again() -> None:
    texts = StatusTextQueue()
    text = "Größe " * 20
    texts.send(Severity.INFO, text, 0.0)
    messages = texts.pop_due(0.0)
    assert len({message.id for message in messages}) == 1
    assert messages[0].id != 0
    assert [message.chunk_seq for message in messages] == list(range(len(messages)))
    assert b"".join(raw(message) for message in messages).decode() == text
    assert all(len(raw(message)) == 50 for message in messages[:-1])


def test_the_last_chunk_is_never_full() -> None:
    texts = StatusTextQueue()
    texts.send(Severity.INFO, "x" * 100, 0.0)
    assert [len(raw(message)) for message in texts.pop_due(0.0)] == [50, 50, 0]


def test_fifty_bytes_need_no_chunks() -> None:
    texts = StatusTextQueue()
    texts.send(Severity.INFO, "x" * 50, 0.0)
    assert [message.id for message in texts.pop_due(0.0)] == [0]


def test_daemons_log_gets_each_text_whole_though_none_listens() -> None:
    heard: list[tuple[Severity, str]] = []
    texts = StatusTextQueue(lambda severity, text: heard.append((severity, text)))
    long = "Motor driver failed: " + "x" * 100
    for now in (0.0, 1.0):
        texts.send(Severity.CRITICAL, long, now)
    texts.send(Severity.NOTICE, "Disarmed", 1.0)
    assert heard == [(Severity.CRITICAL, long), (Severity.NOTICE, "Disarmed")]


def test_a_flood_does_not_fill_the_log() -> None:
    heard: list[str] = []
    texts = StatusTextQueue(lambda severity, text: heard.append(text))
    for number in range(1000):
        texts.send(Severity.WARNING, f"No parameter P{number}", number / 1000)
    assert 30 <= len(heard) <= 40
    assert heard[0] == "No parameter P0"


def test_the_same_is_not_said_again_for_a_while() -> None:
    texts = StatusTextQueue()
    for now in (0.0, 1.0, 2.9):
        texts.send(Severity.INFO, "PreArm: battery low", now)
    assert len(texts.pop_due(2.9)) == 1
    texts.send(Severity.INFO, "PreArm: battery low", 3.1)
    assert len(texts.pop_due(3.1)) == 1


def test_once_is_once_until_it_is_forgotten() -> None:
    texts = StatusTextQueue()
    for now in (0.0, 10.0):
        texts.send_once("demand 9", Severity.INFO, "ignored", now)
    assert len(texts.pop_due(10.0)) == 1
    texts.reset_once("demand")
    texts.send_once("demand 9", Severity.INFO, "ignored", 20.0)
    assert len(texts.pop_due(20.0)) == 1


def test_at_most_ten_a_second_and_the_newest_survive() -> None:
    texts = StatusTextQueue()
    sent = []
    for cycle in range(500):
        now = cycle * 0.02
        texts.send(Severity.INFO, f"text {cycle}", now)
        sent += texts.pop_due(now)
    assert 95 <= len(sent) <= 106
    tail = [decode_text(message) for message in texts.pop_due(60.0)]
    assert len(tail) <= 5
    assert tail[0] > "text 460"


def test_memory_is_bounded() -> None:
    texts = StatusTextQueue()
    for number in range(10_000):
        texts.send(Severity.INFO, f"{number} " * 100, number * 0.01)
    assert all(len(lane.waiting) <= 30 for lane in texts._lanes)
    assert len(texts._repeats) <= 32


def test_the_most_important_comes_first_and_is_never_dropped() -> None:
    heard: list[str] = []
    texts = StatusTextQueue(lambda severity, text: heard.append(text))
    texts.send_event(Severity.EMERGENCY, "EMERGENCY STOP", 0.0)
    texts.send_event(Severity.NOTICE, "Disarmed", 0.0)
    for number in range(1000):
        texts.send(Severity.WARNING, f"report {number}", 0.0)
    texts.send(Severity.CRITICAL, "Motor driver failed", 0.0)
    sent = [decode_text(message) for message in texts.pop_due(0.0)]
    assert sent[:3] == ["EMERGENCY STOP", "Motor driver failed", "Disarmed"]
    assert {"EMERGENCY STOP", "Disarmed", "Motor driver failed"} <= set(heard)


def test_an_event_is_no_repeat_but_a_report_is() -> None:
    texts = StatusTextQueue()
    for text in ("Armed", "Disarmed", "Armed"):
        texts.send_event(Severity.NOTICE, text, 0.0)
    for text in ("Log: full", "Log: slow", "Log: full"):
        texts.send(Severity.WARNING, text, 0.0)
    sent = [decode_text(message) for message in texts.pop_due(0.0) + texts.pop_due(1.0)]
    assert sent == ["Armed", "Disarmed", "Armed", "Log: full", "Log: slow"]


def test_the_keys_of_once_are_bounded() -> None:
    texts = StatusTextQueue()
    for number in range(2000):
        texts.send_once(f"setpoint {number}", Severity.INFO, f"ignored {number}", float(number))
    assert sum(map(len, texts._once.values())) <= 300
