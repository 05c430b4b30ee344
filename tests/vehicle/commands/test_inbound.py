"""The table of what the vehicle listens to is what its handlers know, and what its links let through."""

from __future__ import annotations

import re
from pathlib import Path

from dialects import messages as m
from vehicle.commands.inbound import INBOUND_IDS, INBOUND_MESSAGES
from vehicle.telemetry.streams import STREAMS

ROOT = Path(__file__).parents[3]
HANDLERS = ("vehicle/rover.py", "vehicle/commands/dispatch.py", "vehicle/commands/preflight.py", "link/services/param/server.py",
            "link/services/mission/server.py", "link/services/mission/download.py", "link/services/log/server.py",
            "link/services/ftp/server.py")  # fmt: skip


def handled() -> set[str]:
    """Names of messages that the handlers match."""
    found: set[str] = set()
    for name in HANDLERS:
        text = (ROOT / name).read_text()
        for line in re.findall(r"case (m\.[^:]+):|isinstance\((?:received\.)?message, ([^)]+)\)", text):
            found |= set(re.findall(r"m\.([A-Z]\w+)", "".join(line)))
    return found


def test_what_a_handler_knows_is_heard() -> None:
    names = {name for name in handled() if getattr(m, name).id not in INBOUND_IDS}
    assert handled() >= {"ManualControl", "ParamSet", "MissionCount", "LogErase", "FileTransferProtocol"}
    assert names == set()


def test_each_message_has_one_line_and_its_handler_is_there() -> None:
    assert len(INBOUND_IDS) == len(INBOUND_MESSAGES)
    for heard in INBOUND_MESSAGES:
        for name in heard.handler.split(", "):
            assert (ROOT / name).exists(), name


def test_nobody_elses_telemetry_is_decoded() -> None:
    told = {stream.message.id for stream in STREAMS} - {m.Heartbeat.id}
    assert not told & INBOUND_IDS
