"""The message log."""

from __future__ import annotations

from collections.abc import Iterator

from dialects.messages import StatusText
from groundstation.ipc import MAX_PACKET, encode
from groundstation.snapshot.log_origin import LogOrigin
from groundstation.vehicles.state.message_log import MAX_LENGTH, MAX_LINES, NEWEST, PAGE, STATE, MessageLog
from groundstation.views.log import LogPage, LogRequest


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


def test_a_line_has_the_source_and_the_first_time_of_its_text() -> None:
    log = MessageLog()
    log.name_of = lambda system: "ArduPilot rover 1" if system == 1 else ""
    for at in (10.0, 12.5):
        log.handle_statustext(said(b"no space on card"), 1, at, 191)
    log.handle_statustext(said(b"no space on card"), 2, 13.0, 1)
    ours, other = log.build_lines(20.0, 1020.0)
    assert (ours.first, ours.time, ours.count) == (1010.0, 1012.5, 2)
    assert ours.origin == LogOrigin(1, 191, "ArduPilot rover 1")
    assert other.origin is not None, "the text of another vehicle is not a repeat"
    assert (other.origin.system, other.first) == (2, None)


def test_the_log_is_bounded_and_keeps_the_newest() -> None:
    log = MessageLog()
    for number in range(5000):
        log.add(0.0, "station", f"{number} " + "x" * 1000)
    lines = log.build_lines(0.0, 0.0)
    assert len(lines) == NEWEST
    assert lines[-1].text.startswith("4999 ")
    assert max(len(line.text) for line in lines) == MAX_LENGTH
    kept = [line for page in pages(log) for line in page.lines]
    assert [line.number for line in kept] == list(range(5001 - MAX_LINES, 5001))


def pages(log: MessageLog, state: int = 0) -> Iterator[LogPage]:
    """Request what is new until nothing is."""
    while (page := log.build_page(LogRequest(state), 0.0, 0.0)) is not None:
        yield page
        state = page.state


def test_a_screen_gets_each_line_once_and_a_repeated_one_again() -> None:
    log = MessageLog()
    log.add(1.0, "vehicle", "one")
    log.add(2.0, "vehicle", "two")
    (first,) = pages(log)
    assert [(line.number, line.text, line.time) for line in first.lines] == [(1, "one", 1.0), (2, "two", 2.0)]
    assert log.build_page(LogRequest(first.state), 3.0, 3.0) is None
    log.add(3.0, "vehicle", "two")
    log.add(4.0, "vehicle", "three")
    (second,) = pages(log, first.state)
    assert [(line.number, line.count) for line in second.lines] == [(2, 2), (3, 1)]


def test_a_page_of_the_longest_texts_fits_the_pipe() -> None:
    log = MessageLog()
    for number in range(MAX_LINES):
        log.add(0.0, "station", chr(0x1F600 + number % 40) * 1000)
    first = next(pages(log))
    assert len(first.lines) == PAGE
    assert len(first.lines[0].text) == MAX_LENGTH
    assert len(encode(first)) < MAX_PACKET


def test_changes_of_state_are_in_the_log_but_not_in_the_snapshot() -> None:
    log = MessageLog()
    log.add(1.0, "vehicle", "low battery", 4)
    for number in range(NEWEST):
        log.add(2.0, STATE, f"mode {number}")
    assert [line.text for line in log.build_lines(3.0, 3.0)] == ["low battery"]
    assert len([line for page in pages(log) for line in page.lines]) == 1 + NEWEST


def test_escape_sequences_never_get_through() -> None:
    log = MessageLog()
    log.handle_statustext(said(b"\x1b[2Jgone\x07"), 1, 0.0)
    (line,) = log.build_lines(0.0, 0.0)
    assert line.text.isprintable()
    assert "gone" in line.text


def texts(log: MessageLog) -> list[str]:
    return [line.text for line in log.build_lines(9.0, 9.0)]


def test_chunks_are_joined_in_their_order() -> None:
    log = MessageLog()
    assert log.handle_statustext(said(b"a" * 50, 9, 0), 1, 0.0) == ()
    assert log.handle_statustext(said(b"tail", 9, 2), 1, 0.1) == ()
    [text] = log.handle_statustext(said(b"b" * 50, 9, 1), 1, 0.2)
    assert text == (1, "a" * 50 + "b" * 50 + "tail", 6)
    assert len(log.build_lines(1.0, 1.0)) == 1


def test_a_lost_chunk_leaves_a_gap_where_it_was() -> None:
    log = MessageLog()
    log.handle_statustext(said(b"1 begin ".ljust(50, b"b"), 91, 0, 3), 1, 0.0)
    log.handle_statustext(said(b" end", 91, 2, 3), 1, 0.1)
    assert log.expire(1.0) == ()
    assert log.expire(3.0) == ((1, f"{'1 begin '.ljust(50, 'b')} [...] end", 3),)
    assert texts(log) == [f"{'1 begin '.ljust(50, 'b')} [...] end"]
    assert log.expire(6.0) == ()


def test_gaps_at_the_ends_are_shown() -> None:
    log = MessageLog()
    log.handle_statustext(said(b"a" * 50, 9, 0), 1, 0.0)
    log.handle_statustext(said(b"tail", 10, 1), 1, 0.0)
    log.expire(3.0)
    assert texts(log) == ["a" * 50 + " [...]", "[...] tail"]


def test_a_character_cut_by_a_chunk_is_whole() -> None:
    log, raw = MessageLog(), b"2 ".ljust(49, b"x") + "üy".encode()
    log.handle_statustext(said(raw[:50], 92, 0), 1, 0.0)
    log.handle_statustext(said(raw[50:], 92, 1), 1, 0.0)
    assert texts(log) == ["2 ".ljust(49, "x") + "üy"]


def test_a_character_cut_by_a_gap_is_left_out() -> None:
    log, raw = MessageLog(), b"x" * 49 + "ü".encode() * 50
    for number in (0, 2):
        log.handle_statustext(said(raw[50 * number :][:50], 93, number), 1, 0.0)
    log.expire(3.0)
    assert texts(log) == ["x" * 49 + " [...] " + "ü" * 24]


def test_tabs_and_line_ends_are_blanks() -> None:
    log = MessageLog()
    log.handle_statustext(said(b"Takeoff\tdetected\nnow\t"), 1, 0.0)
    assert texts(log) == ["Takeoff detected now"]


def test_two_components_with_one_text_id_are_kept_apart() -> None:
    log = MessageLog()
    for component, letter in ((1, b"a"), (191, b"b")):
        log.handle_statustext(said(letter * 50, 7, 0), 1, 0.0, component)
    for component, letter in ((1, b"A"), (191, b"B")):
        log.handle_statustext(said(letter, 7, 1), 1, 0.0, component)
    assert texts(log) == ["a" * 50 + "A", "b" * 50 + "B"]


def test_a_text_that_reuses_an_id_joins_no_older_one() -> None:
    log = MessageLog()
    log.handle_statustext(said(b"a" * 50, 7, 0), 1, 0.0)
    log.handle_statustext(said(b"b" * 50, 7, 0), 1, 0.5)
    log.handle_statustext(said(b"tail", 7, 1), 1, 0.5)
    assert texts(log) == ["a" * 50 + " [...]", "b" * 50 + "tail"]


def test_chunks_of_a_flood_are_bounded() -> None:
    log = MessageLog()
    for number in range(1, 3000):
        log.handle_statustext(said(b"a" * 50, number, number % 256), number % 250 + 1, 0.0)
    assert len(log._joiner._open) <= 8
    assert len(log.build_lines(0.0, 0.0)) <= MAX_LINES
