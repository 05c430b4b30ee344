"""Messages with ids outside the dialect: rows with rate and length, and no fields."""

from __future__ import annotations

from dialects import messages as m
from groundstation.station.messages.message_traffic import MessageTraffic
from groundstation.views.messages import MessageRequest, MessageRow, MessagesRequest
from link.core import LinkReport
from link.protocol.channel import Channel
from tests.link.frames import heartbeat

HERE = ("127.0.0.1", 14550)


def traffic() -> MessageTraffic:
    """Return 10 s of 51000 at 4 Hz over two links, and one 60000 of another source at 2 s."""
    made = MessageTraffic(255, 190)
    made.count(m.Heartbeat(10, 0, 0, 0, 3, 3), 1, 1, 9.5, known=True)
    for second in range(11):
        first = {(1, 1, 51000): (second, 30)} | ({(9, 25, 60000): (1, 14)} if second >= 2 else {})
        second_link = {(1, 1, 51000): (3 * second, 31)}
        made.observe([LinkReport("udp", unknown_ids=first), LinkReport("tcp", unknown_ids=second_link)], float(second))
    return made


def rows(made: MessageTraffic, now: float = 10.0, text: str = "") -> dict[str, MessageRow]:
    return {row.name: row for row in made.build_page(MessagesRequest(text=text), now, 0.0).rows if row.name}


def test_they_are_under_their_source_with_rate_count_and_age() -> None:
    page = traffic().build_page(MessagesRequest(), 10.0, 0.0)
    assert [(row.system, row.name) for row in page.rows] == [
        (1, ""), (1, "HEARTBEAT"), (1, "#51000"), (9, ""), (9, "#60000")
    ]  # fmt: skip
    row = rows(traffic())["#51000"]
    assert (row.unknown, row.rate, row.bytes, row.count, row.age, row.label) == (True, 4.0, 124.0, 40, 0.0, "31 B")
    lone = rows(traffic())["#60000"]
    assert (lone.rate, lone.count, lone.age, lone.label) == (0.0, 1, 8.0, "14 B")
    assert not rows(traffic())["HEARTBEAT"].unknown


def test_the_filter_finds_them_by_number_and_rate_not_by_field() -> None:
    assert rows(traffic(), text="#5").keys() == {"#51000"}
    assert rows(traffic(), text=">1Hz").keys() == {"#51000"}
    assert not rows(traffic(), text="field:a").keys() & {"#51000", "#60000"}


def test_one_of_them_comes_without_fields() -> None:
    view = traffic().unknown.build_message(MessageRequest(1, 1, False, "#51000"), 10.0)
    assert view is not None
    assert (view.id, view.count, view.length, view.fields) == (51000, 40, 31, ())
    for name in ("#1", "#", "51000", "#x", "ATTITUDE"):
        assert traffic().unknown.build_message(MessageRequest(1, 1, False, name), 10.0) is None


def test_a_channel_reports_them() -> None:
    channel = Channel("udp", 0, system=255, component=190)
    unknown = bytes([0xFD, 2, 0, 0, 9, 1, 1, 0x38, 0xC7, 0, 1, 2, 0x12, 0x34])
    channel.receive(heartbeat(0, 1, 1), HERE, 0.0)
    channel.receive(unknown, HERE, 0.1)
    made = MessageTraffic(255, 190)
    made.observe([channel.report()], 1.0)
    assert rows(made, 1.0).keys() == {"#51000"}
