"""Readings take a shorter way through the station, with the same result."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.codec import encode_payload
from groundstation.intents.session import RenewLease, SetKeyGate
from groundstation.snapshot import Snapshot
from groundstation.station import operator_core
from groundstation.station.readings import READINGS
from groundstation.station.station import Station
from link.protocol.channel import Channel
from tests.benchmarks.traffic import mix

EXCHANGED = (
    m.Heartbeat,
    m.StatusText,
    m.SysStatus,
    m.RcChannels,
    m.ParamValue,
    m.CommandAck,
    m.CommandLong,
    m.Timesync,
    m.Ping,
    m.MagCalProgress,
    m.MagCalReport,
    m.ControlStatus,
    m.RoverControl,
    m.RoverDriveStatus,
)


def run() -> tuple[Snapshot, list[bytes]]:
    """Let a station hear two seconds of a vehicle that sends much; return what it shows and has sent."""
    now = 100.0
    station = Station(["memory"], session=7, now=now)
    channel = Channel("memory", 0, system=255, component=190)
    sent: list[bytes] = []
    for intent in (RenewLease(), SetKeyGate(open=True)):
        station.handle_intent(intent, now)
    for number, frame in enumerate(mix(2000)):
        now = 100.0 + number / 1000
        for received in channel.receive(frame, "vehicle", now):
            station.receive(received, now)
        if number % 25 == 0:
            station.renew_lease(now)
            station.tick(now)
        sent += [encode_payload(outgoing.message) for outgoing in station.messages_to_send()]
    return station.snapshot(now, now + 1000.0), sent


def test_station_that_gives_all_messages_to_all_parts_is_same(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    shown, sent = run()
    monkeypatch.setattr(operator_core, "READINGS", frozenset())
    assert (shown, sent) == run()
    assert shown.vehicle is not None
    assert shown.vehicle.heading is not None


@pytest.mark.parametrize("kind", EXCHANGED)
def test_what_a_part_of_the_station_waits_for_is_no_reading(kind: type[m.Message]) -> None:
    assert kind not in READINGS
