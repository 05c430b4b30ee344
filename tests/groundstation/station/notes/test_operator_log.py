"""What the operator did, as lines of the log."""

from __future__ import annotations

import math

import pytest

from dialects.axes import NEUTRAL, Axes
from groundstation.intents.driving import DriveKeyDown, EmergencyStop, Stop
from groundstation.intents.vehicle import Arm, SetMode
from groundstation.snapshot import LogLine
from groundstation.station.notes.operator_log import MAX_KEYS, REPORT_WITHIN, OperatorLog
from groundstation.vehicles.readings.key_to_motor import KeyTimings
from groundstation.vehicles.readings.latency import LatencyMeter, SentDemand
from groundstation.vehicles.state.message_log import MessageLog
from groundstation.views.log import LogPage, LogRequest
from tests.test_stops import Drive

FORWARD = Axes(0.6, 0.0)


def lines(log: MessageLog) -> list[LogLine]:
    page = log.build_page(LogRequest(), 0.0, 0.0)
    assert isinstance(page, LogPage | None)
    return [line for line in page.lines if line.label == "you"] if page else []


def texts(log: MessageLog) -> list[str]:
    return [line.text for line in lines(log)]


@pytest.fixture
def log() -> MessageLog:
    return MessageLog()


def push(key: str) -> DriveKeyDown:
    return DriveKeyDown(key=key, throttle=1, steering=0)


def test_commands_are_lines_at_once(log: MessageLog) -> None:
    mine = OperatorLog(log)
    for intent in (Arm(held=1.0), SetMode(mode="AUTO"), Stop(), Stop(reason="another screen is open"), EmergencyStop()):
        mine.handle(intent, 1.0)
    assert texts(log) == ["arm", "mode AUTO", "stop", "emergency stop"]


def test_driving_is_a_line_when_the_vehicle_reports_neutral(log: MessageLog) -> None:
    mine, latency = OperatorLog(log), LatencyMeter(KeyTimings())
    for key in ("i", "u", "i"):
        mine.handle(push(key), 1.0)
    mine.tick(FORWARD, latency, 1.0)
    latency.record_sent(1, SentDemand(1.0, 1.0))
    latency.record_applied(1, 1.03, 0.0)
    mine.tick(FORWARD, latency, 2.0)
    mine.tick(NEUTRAL, latency, 2.9)
    assert texts(log) == [], "its report is not there yet"
    latency.record_sent(2, SentDemand(2.9, 2.9))
    latency.record_applied(2, 2.919, 0.0)
    mine.tick(NEUTRAL, latency, 2.95)
    assert texts(log) == ["i u drove for 1.90 s, neutral applied after 19 ms"]
    mine.tick(NEUTRAL, latency, 9.0)
    assert len(texts(log)) == 1


def test_without_a_report_the_line_claims_none(log: MessageLog) -> None:
    mine = OperatorLog(log)
    mine.handle(push("i"), 1.0)
    mine.tick(FORWARD, None, 1.0)
    mine.tick(NEUTRAL, None, 1.5)
    mine.tick(NEUTRAL, None, 1.5 + REPORT_WITHIN)
    assert texts(log) == []
    mine.tick(NEUTRAL, None, math.nextafter(1.5 + REPORT_WITHIN, 9.0))
    assert texts(log) == ["i drove for 0.50 s"]


def test_driving_on_ends_the_line_of_the_drive_before(log: MessageLog) -> None:
    mine = OperatorLog(log)
    mine.handle(push("i"), 1.0)
    mine.tick(FORWARD, None, 1.0)
    mine.tick(NEUTRAL, None, 1.5)
    mine.tick(FORWARD, None, 1.6)
    assert texts(log) == ["i drove for 0.50 s"]


def test_keys_that_did_not_drive_are_no_line(log: MessageLog) -> None:
    mine = OperatorLog(log)
    mine.handle(push("i"), 1.0)
    mine.tick(NEUTRAL, None, 1.1)
    mine.handle(push("u"), 2.0)
    mine.tick(FORWARD, None, 2.0)
    mine.tick(NEUTRAL, None, 2.2)
    mine.tick(NEUTRAL, None, 3.0)
    assert texts(log) == ["u drove for 0.20 s"]


def test_names_of_keys_are_bounded(log: MessageLog) -> None:
    mine = OperatorLog(log)
    for number in range(1000):
        mine.handle(push(f"k{number}"), 1.0)
    mine.tick(FORWARD, None, 1.0)
    mine.tick(NEUTRAL, None, 1.5)
    mine.tick(NEUTRAL, None, 3.0)
    assert texts(log) == [" ".join(f"k{number}" for number in range(MAX_KEYS)) + " drove for 0.50 s"]


def test_with_the_simulated_rover() -> None:
    drive = Drive()
    drive.get_going()
    drive.held = None
    drive.tell(Stop())
    drive.run(1.0)
    found = texts(drive.station.log)
    assert any(" drove for " in text and "neutral applied after" in text for text in found), found
    assert "stop" in found
    assert not any(line.label == "you" for line in drive.station.snapshot(drive.world.now, 0).texts)
