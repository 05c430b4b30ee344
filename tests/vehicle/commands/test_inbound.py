"""Each message that the vehicle handles has one row, and its links decode exactly those."""

from __future__ import annotations

import re
from pathlib import Path

from dialects import codec
from dialects import messages as m
from dialects.traits import LOG_ONLY
from tests.vehicle.bench import MESSAGE_IDS, OTHER, Bench
from vehicle.commands.access import Access
from vehicle.telemetry.streams import STREAMS

ROOT = Path(__file__).parents[3]
SERVERS = ("param/server.py", "mission/server.py", "mission/download.py", "log/server.py", "ftp/server.py")
ROWS = Bench().rover.messages


def served() -> set[str]:
    """Names of messages that the protocol servers match."""
    found: set[str] = set()
    for name in SERVERS:
        text = (ROOT / "link" / "services" / name).read_text()
        for line in re.findall(r"case (m\.[^:]+):|isinstance\((?:received\.)?message, ([^)]+)\)", text):
            found |= set(re.findall(r"m\.([A-Z]\w+)", "".join(line)))
    return found


def test_every_message_of_a_server_has_a_row() -> None:
    assert served() >= {"ParamSet", "MissionCount", "LogErase", "FileTransferProtocol"}
    assert {name for name in served() if getattr(m, name).id not in MESSAGE_IDS} == set()
    assert m.ManualControl.id in MESSAGE_IDS


def test_each_message_has_one_row_with_a_handler() -> None:
    assert len(MESSAGE_IDS) == len(ROWS)
    assert all(callable(row.handle) for row in ROWS)


def test_telemetry_of_other_vehicles_is_not_decoded() -> None:
    of_companions = {m.Heartbeat.id, m.DistanceSensor.id, m.ObstacleDistance.id}
    streamed = {stream.message.id for stream in STREAMS} - of_companions
    assert not streamed & MESSAGE_IDS


def test_a_message_that_needs_a_heartbeat_is_dropped_without_one() -> None:
    bench = Bench()
    bench.heartbeat()
    sent = len(bench.sent)
    rows = [row for row in ROWS if row.access is not Access.ANYONE and not row.checks_sender]
    assert {row.access for row in rows} == set(Access) - {Access.ANYONE}
    for row in rows:
        message = codec.decode(row.message.id, bytes([1]) * row.message.unpacker.size)
        bench.say(message, OTHER, introduced=False)
    assert bench.sent[sent:] == []


def test_only_these_handlers_check_their_sender_themselves() -> None:
    assert {row.message for row in ROWS if row.checks_sender} == {m.SetMode, m.LogErase}


def test_notes_of_a_log_have_no_handler() -> None:
    assert MESSAGE_IDS.isdisjoint(LOG_ONLY)
