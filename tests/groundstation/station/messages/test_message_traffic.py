"""Rates, counts and rows of messages by source, and their filter and order."""

from __future__ import annotations

import pytest

from dialects import messages as m
from groundstation.intents.watch import Watch
from groundstation.ipc import MAX_PACKET, encode
from groundstation.station.messages.message_detail import MessageInspector
from groundstation.station.messages.message_traffic import MAX_KINDS, MAX_ROWS, MessageTraffic
from groundstation.views.base import View
from groundstation.views.messages import MessageRequest, MessageRow, MessagesPage, MessagesRequest, MessageView
from link.core import LinkReport, SourceCount
from tests.groundstation.cockpits import Cockpit

BEAT = m.Heartbeat(10, 0, 0, 0, 3, 3)
ATTITUDE = m.Attitude(0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def traffic() -> MessageTraffic:
    """Return 10 s: vehicle 1 with 1 Hz and 10 Hz, radio 51/68 with 1 Hz until 5 s, and what we send at 1 Hz."""
    made = MessageTraffic(255, 190)
    made.set_labels({(1, 1): "Rover 1"})
    for tenth in range(100):
        now = tenth / 10
        made.count(ATTITUDE, 1, 1, now, known=True)
        if tenth % 10 == 0:
            made.count(BEAT, 1, 1, now, known=True)
            made.count_sent(BEAT, now)
            if now < 5.0:
                made.count(m.RadioStatus(0, 0, 0, 0, 0, 0, 0), 51, 68, now, known=False)
    return made


def rows(made: MessageTraffic, **request: object) -> tuple[MessageRow, ...]:
    return made.build_page(MessagesRequest(**request), 9.9, 0.0).rows  # type: ignore[arg-type]


def names(made: MessageTraffic, **request: object) -> list[str]:
    return [row.name or f"{row.system}/{row.component}" for row in rows(made, **request)]


def test_the_tree_has_sources_over_their_messages_and_ours_last() -> None:
    made = traffic()
    assert names(made) == ["1/1", "ATTITUDE", "HEARTBEAT", "51/68", "RADIO_STATUS", "255/190", "HEARTBEAT"]
    vehicle, attitude, beat, radio, status, ours, sent = rows(made)
    assert (vehicle.label, radio.label, ours.label) == ("Rover 1", "telemetry radio", "this station")
    assert attitude.rate == pytest.approx(10.0, abs=0.5)
    assert vehicle.rate == pytest.approx(attitude.rate + beat.rate)
    assert vehicle.count == 110
    assert (status.rate, status.count) == (0.0, 5)
    assert status.age == pytest.approx(5.9)
    assert (sent.sent, ours.sent, beat.sent) == (True, True, False)
    assert beat.bytes == pytest.approx(21 * beat.rate)  # a HEARTBEAT as MAVLink 2: 12 bytes and 9 of payload


def test_a_closed_source_hides_its_messages() -> None:
    made = traffic()
    closed = ((1, 1, False), (255, 190, True))
    assert names(made, closed=closed) == ["1/1", "51/68", "RADIO_STATUS", "255/190"]


def test_the_loss_is_that_of_the_source() -> None:
    made = traffic()
    made.observe(
        [
            LinkReport("udp", sources={(1, 1): SourceCount(90, 10)}),
            LinkReport("tcp", 1, sources={(1, 1): SourceCount(9, 9)}),
        ],
        9.9,
    )
    vehicle, attitude, *_, ours, _ = rows(made)
    assert (vehicle.loss, vehicle.lost) == (0.1, 10)
    assert attitude.loss is None
    assert ours.loss is None
    assert names(made, text="lost heart") == ["1/1", "HEARTBEAT"]
    assert names(made, text="lost src:51") == []


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("att", ["1/1", "ATTITUDE"]),
        (">5Hz", ["1/1", "ATTITUDE"]),
        ("<0.5hz", ["51/68", "RADIO_STATUS"]),
        ("age>3", ["51/68", "RADIO_STATUS"]),
        ("src:51", ["51/68", "RADIO_STATUS"]),
        ("src:1/1 heart", ["1/1", "HEARTBEAT"]),
        ("src:1/2", []),
        ("field:rssi", ["51/68", "RADIO_STATUS"]),
        ("sent", ["255/190", "HEARTBEAT"]),
        (">xHz", []),
        ("rs", ["51/68", "RADIO_STATUS"]),
        ("nothing like it", []),
    ],
)
def test_words_of_the_filter(text: str, wanted: list[str]) -> None:
    assert names(traffic(), text=text) == wanted


@pytest.mark.parametrize(
    ("order", "first"), [("name", "ATTITUDE"), ("rate", "ATTITUDE"), ("bytes", "ATTITUDE"), ("age", "ATTITUDE")]
)
def test_other_orders_are_flat_lists(order: str, first: str) -> None:
    found = names(traffic(), order=order)
    assert len(found) == 4
    assert found[0] == first
    assert names(traffic(), order="age")[-1] == "RADIO_STATUS"


def test_an_order_by_numbers_changes_once_a_second_at_most() -> None:
    made = traffic()
    request = MessagesRequest(order="age", text="src:1")

    def order(now: float) -> list[str]:
        return [row.name for row in made.build_page(request, now, 0.0).rows]

    assert order(10.0) == ["ATTITUDE", "HEARTBEAT"]
    made.count(BEAT, 1, 1, 10.5, known=True)
    assert order(10.9) == ["ATTITUDE", "HEARTBEAT"]
    assert order(11.1) == ["HEARTBEAT", "ATTITUDE"]


def test_a_page_has_the_rows_that_were_asked_for() -> None:
    page = traffic().build_page(MessagesRequest(first=1, count=2), 9.9, 0.0)
    assert ([row.name for row in page.rows], page.first, page.total) == (["ATTITUDE", "HEARTBEAT"], 1, 7)
    assert (page.kinds, page.order, page.text) == (4, "source", "")
    assert traffic().build_page(MessagesRequest(first=10**6, count=2), 9.9, 0.0).first == 5


def test_a_flood_of_invented_ids_is_bounded_and_spares_a_vehicle() -> None:
    made = MessageTraffic(255, 190)
    for number in range(MAX_KINDS + 500):
        made.count(BEAT, 1 + number % 255, number // 255, 0.0, known=False)
    made.count(BEAT, 9, 100, 0.0, known=True)
    page = made.build_page(MessagesRequest(count=10**6), 0.0, 0.0)
    assert (page.kinds, page.not_shown) == (MAX_KINDS + 1, 500)
    assert len(page.rows) == MAX_ROWS
    assert len(encode(page)) < MAX_PACKET / 4


def test_a_message_comes_with_its_fields() -> None:
    build = MessageInspector(traffic()).sources[MessageRequest].build
    view = build(MessageRequest(1, 1, False, "HEARTBEAT"), 9.9, 0.0)
    assert isinstance(view, MessageView)
    assert (view.id, view.count, view.length) == (0, 10, 21)
    assert view.fields[0].meaning == "GROUND_ROVER"
    assert build(MessageRequest(2, 1, False, "HEARTBEAT"), 9.9, 0.0) is None


def test_pages_and_messages_keep_their_rates_while_watched() -> None:
    cockpit = Cockpit()
    cockpit.run(2.0)
    sent: list[View] = []

    def send(view: View) -> bool:
        sent.append(view)
        return True

    def run(seconds: float) -> None:
        for _ in range(round(seconds / 0.025)):
            cockpit.run(0.025)
            cockpit.station.views.send_due(send, cockpit.now, cockpit.now)

    run(1.0)
    assert sent == []
    requests = (MessagesRequest(), MessageRequest(1, 1, False, "HEARTBEAT"))
    cockpit.do(Watch(requests))
    run(4.0)
    pages = [view for view in sent if isinstance(view, MessagesPage)]
    details = [view for view in sent if isinstance(view, MessageView)]
    assert 7 <= len(pages) <= 9
    assert 14 <= len(details) <= 17
    assert any(row.name == "HEARTBEAT" and row.sent for row in pages[-1].rows)
