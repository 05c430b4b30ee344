"""A real ArduRover as recorded, in the rows and fields of the Messages screen; plain pymavlink gives the reference."""

from __future__ import annotations

from collections import Counter
from functools import cache
from typing import Any

import pytest
from pymavlink.dialects.v20 import ardupilotmega

from dialects.messages import MESSAGES
from groundstation.station.messages.message_detail import MessageInspector
from groundstation.station.messages.message_traffic import MessageTraffic
from groundstation.views.messages import MessageRequest, MessagesRequest, MessageView
from link.protocol.channel import Channel
from link.tlog.tlog import read_records
from tests.recorded import WHOLE_ARDUROVER, read_recording

pytestmark = pytest.mark.xdist_group("recorded traffic")
"""Each worker would play the recording."""

KNOWN = {kind.msgname for kind in MESSAGES.values()} & {kind.msgname for kind in ardupilotmega.mavlink_map.values()}
"""Messages of both dialects."""


@cache
def replay() -> tuple[MessageTraffic, Counter[tuple[int, int, str]], dict[tuple[int, int, str], Any], float]:
    """Return the traffic, the counts and newest messages by pymavlink, and the time of the end."""
    traffic = MessageTraffic(254, 190)
    channel = Channel("recording", 0, system=254, component=190)
    bare = ardupilotmega.MAVLink(None)
    counts: Counter[tuple[int, int, str]] = Counter()
    newest: dict[tuple[int, int, str], Any] = {}
    records = list(read_records(read_recording(WHOLE_ARDUROVER)))
    now = 0.0
    for record in records:
        now = (record.microseconds - records[0].microseconds) / 1e6
        for received in channel.receive(record.raw, "recording", now):
            traffic.count(received.message, received.system, received.component, now, known=received.system == 1)
        message = bare.decode(bytearray(record.raw))
        key = message.get_srcSystem(), message.get_srcComponent(), message.get_type()
        if message.get_type() in KNOWN:
            counts[key] += 1
            newest[key] = message
    traffic.observe([channel.report()], now)
    return traffic, counts, newest, now


def build(traffic: MessageTraffic, request: MessageRequest, now: float, wall: float) -> MessageView | None:
    view = MessageInspector(traffic).sources[MessageRequest].build(request, now, wall)
    assert view is None or isinstance(view, MessageView)
    return view


def test_every_kind_of_every_source_has_its_row_with_its_count() -> None:
    traffic, counts, _, now = replay()
    page = traffic.build_page(MessagesRequest(count=200), now, 0.0)
    found = {(row.system, row.component, row.name): row.count for row in page.rows if row.name in KNOWN}
    assert found == dict(counts)
    assert len(found) > 30
    assert len([row for row in page.rows if not row.name]) == len({key[:2] for key in counts})


def test_the_filter_finds_what_arrives_often() -> None:
    traffic, _, _, now = replay()
    page = traffic.build_page(MessagesRequest(text="src:1 >1Hz"), now, 0.0)
    assert {row.system for row in page.rows} == {1}
    assert all(row.rate > 1.0 for row in page.rows)
    assert page.total < page.kinds


def test_the_fields_are_those_that_were_sent() -> None:
    traffic, counts, newest, now = replay()
    for system, component, name in counts:
        view = build(traffic, MessageRequest(system, component, False, name), now, 0.0)
        assert view is not None
        sent = newest[system, component, name]
        for field in view.fields:
            value = getattr(sent, field.name, None)
            if isinstance(value, int) and not field.value.startswith("0x"):
                assert int(field.value) == value, (name, field)
            elif isinstance(value, int):
                assert int(field.value, 16) == value, (name, field)
            assert all(text.isprintable() for text in (field.value, field.meaning, *field.flags))


def test_enums_and_units_of_ardurover_are_named() -> None:
    traffic, _, _, now = replay()
    beat = build(traffic, MessageRequest(1, 1, False, "HEARTBEAT"), now, 0.0)
    status = build(traffic, MessageRequest(1, 1, False, "SYS_STATUS"), now, 0.0)
    assert beat is not None
    assert status is not None
    fields = {field.name: field for field in (*beat.fields, *status.fields)}
    assert fields["type"].meaning == "GROUND_ROVER"
    assert fields["autopilot"].meaning == "ARDUPILOTMEGA"
    assert "3D_GYRO" in " ".join(fields["onboard_control_sensors_health"].flags)
    assert fields["voltage_battery"].meaning.endswith(" V")
