"""The message log."""

from __future__ import annotations

from dialects.messages import StatusText
from groundstation.vehicles.message_log import MAX_LENGTH, MAX_LINES, MessageLog


def said(text: bytes, number: int = 0, chunk: int = 0, severity: int = 6) -> StatusText:
    return StatusText(severity, text, number, chunk)


def test_repeats_in_a_row_are_counted() -> None:
    log = MessageLog()
    for at in range(50):
        log.add(float(at), "vehicle", "WheelEncoder: wheel offset not set!", 4)
    log.add(60.0, "vehicle", "ready")
    lines = log.build_lines(100.0, 1100.0)
    assert [(line.text, line.count, line.time) for line in lines] == [
        ("WheelEncoder: wheel offset not set!", 50, 1049.0),
        ("ready", 1, 1060.0),
    ]


def test_the_log_is_bounded_and_keeps_the_newest() -> None:
    log = MessageLog()
    for number in range(1000):
        log.add(0.0, "station", f"{number} " + "x" * 1000)
    lines = log.build_lines(0.0, 0.0)
    assert len(lines) == MAX_LINES
    assert lines[-1].text.startswith("999 ")
    assert max(len(line.text) for line in lines) == MAX_LENGTH


def test_escape_sequences_never_get_through() -> None:
    log = MessageLog()
    log.handle_statustext(said(b"\x1b[2Jgone\x07"), 1, 0.0)
    (line,) = log.build_lines(0.0, 0.0)
    assert line.text.isprintable()
    assert "gone" in line.text


def test_chunks_are_joined_in_their_order() -> None:
    log = MessageLog()
    assert log.handle_statustext(said(b"a" * 50, 9, 0), 1, 0.0) is None
    assert log.handle_statustext(said(b"tail", 9, 2), 1, 0.1) is None
    assert log.handle_statustext(said(b"b" * 50, 9, 1), 1, 0.2) == "a" * 50 + "b" * 50 + "tail"
    assert len(log.build_lines(1.0, 1.0)) == 1


def test_a_lost_chunk_is_not_waited_for_for_ever() -> None:
    log = MessageLog()
    log.handle_statustext(said(b"a" * 50, 9, 0), 1, 0.0)
    log.expire(1.0)
    assert log.build_lines(1.0, 1.0) == ()
    log.expire(3.0)
    assert log.build_lines(3.0, 3.0)[0].text == "a" * 50 + " ..."


def test_chunks_of_a_flood_are_bounded() -> None:
    log = MessageLog()
    for number in range(1, 3000):
        log.handle_statustext(said(b"a" * 50, number, number % 256), number % 250 + 1, 0.0)
    assert len(log._chunks) <= 8
    assert len(log.build_lines(0.0, 0.0)) <= MAX_LINES
