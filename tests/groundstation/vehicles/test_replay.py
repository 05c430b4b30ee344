"""A real ArduRover 4.7, as recorded, through channel and station in virtual time; plain pymavlink gives the reference.

It contains unknown ids, another active ground station, every stream, parameters, files and texts.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from functools import cache
from typing import Any, NamedTuple

import pytest
from pymavlink.dialects.v20 import ardupilotmega

from dialects.messages import MESSAGES
from groundstation.intents.session import RenewLease, SetKeyGate
from groundstation.ipc import encode
from groundstation.snapshot import LogLine, Snapshot
from groundstation.station.component import COMPONENT
from groundstation.station.station import Station
from groundstation.views.log import LogRequest
from link.core import LinkReport
from link.protocol.channel import Channel
from link.tlog.tlog import Record, read_records
from tests.recorded import WHOLE_ARDUROVER, read_recording

pytestmark = pytest.mark.xdist_group("replay")
"""Each worker would play the recording."""

OURS = 254
"""The recorded station is 255."""
STEP = 0.1
LARGEST = 8_000
"""Bytes of a snapshot, ten times a second."""


class Moment(NamedTuple):
    """A snapshot, and the newest recorded message of each kind by then."""

    at: float
    snapshot: Snapshot
    recorded: dict[str, Any]


class Replay(NamedTuple):
    """The whole drive."""

    moments: list[Moment]
    sizes: list[int]
    report: LinkReport
    recorded: dict[str, list[Any]]
    systems: tuple[int, ...]
    """System ids of the vehicles found."""
    log: list[LogLine]
    """The whole message log."""


def seconds(records: list[Record]) -> Iterator[tuple[float, bytes]]:
    start = records[0].microseconds
    for record in records:
        yield (record.microseconds - start) / 1e6, record.raw


def log_lines(station: Station) -> list[LogLine]:
    lines: list[LogLine] = []
    state = 0
    while (page := station.log.build_page(LogRequest(state), 0.0, 0.0)) is not None:
        lines += page.lines
        state = page.state
    return lines


@cache
def replay() -> Replay:
    """Played once for all tests."""
    station = Station(["udpin:127.0.0.1:14550"], system=OURS)
    channel = Channel("recording", 0, system=OURS, component=COMPONENT)
    bare = ardupilotmega.MAVLink(None)
    station.handle_intent(SetKeyGate(open=True), 0.0)
    moments: list[Moment] = []
    sizes: list[int] = []
    newest: dict[str, Any] = {}
    everything: dict[str, list[Any]] = {}
    due = 0.0
    for now, raw in seconds(list(read_records(read_recording(WHOLE_ARDUROVER)))):
        while now >= due:
            station.handle_intent(RenewLease(), due)
            if len(sizes) % 10 == 0:
                station.observe([channel.report(now=due)], due)
            station.tick(due)
            station.messages_to_send()
            snapshot = station.snapshot(due, 1e9 + due)
            sizes.append(len(encode(snapshot)))
            moments.append(Moment(due, snapshot, dict(newest)))
            due = len(sizes) * STEP
        for received in channel.receive(raw, "recording", now):
            station.receive(received, now)
        message = bare.decode(bytearray(raw))
        if message.get_srcSystem() == 1:
            newest[message.get_type()] = message
            everything.setdefault(message.get_type(), []).append(message)
    return Replay(moments, sizes, channel.report(), everything, station.fleet.system_ids, log_lines(station))


def test_it_is_known_for_what_it_is() -> None:
    last = replay().moments[-1].snapshot
    assert last.vehicle is not None
    assert last.vehicle.name == "ArduPilot rover 1"
    assert replay().systems == (1,), "the other ground station is not a vehicle"
    assert not last.vehicle.in_control
    assert last.operator.gate_reason == "not in control"
    assert len(replay().moments) == 1300


def test_mode_and_arming_are_those_of_the_heartbeats() -> None:
    seen = set()
    for moment in replay().moments:
        beat, vehicle = moment.recorded.get("HEARTBEAT"), moment.snapshot.vehicle
        assert (beat is None) == (vehicle is None)
        if beat is not None and vehicle is not None:
            armed = bool(beat.base_mode & ardupilotmega.MAV_MODE_FLAG_SAFETY_ARMED)
            mode = {0: "MANUAL", 16: "INITIALISING"}[beat.custom_mode]
            assert (vehicle.armed, vehicle.mode, vehicle.status) == (armed, mode, beat.system_status)
            seen.add((armed, mode))
    assert seen == {(False, "INITIALISING"), (False, "MANUAL"), (True, "MANUAL")}


def test_attitude_and_position_are_those_recorded() -> None:
    compared = 0
    for moment in replay().moments:
        attitude, local = moment.recorded.get("ATTITUDE"), moment.recorded.get("LOCAL_POSITION_NED")
        vehicle = moment.snapshot.vehicle
        if vehicle is None or attitude is None or local is None or vehicle.heading is None:
            continue
        assert vehicle.roll == pytest.approx(attitude.roll)
        assert vehicle.pitch == pytest.approx(attitude.pitch)
        assert math.remainder(vehicle.heading - attitude.yaw, 2 * math.pi) == pytest.approx(0.0, abs=1e-6)
        assert vehicle.position == pytest.approx((local.x, local.y))
        along = local.vx * math.cos(attitude.yaw) + local.vy * math.sin(attitude.yaw)
        assert vehicle.speed == pytest.approx(along, abs=1e-6)
        compared += 1
    assert compared > 1000


def test_battery_and_gps_are_those_recorded() -> None:
    compared = 0
    for moment in replay().moments:
        battery, gps = moment.recorded.get("BATTERY_STATUS"), moment.recorded.get("GPS_RAW_INT")
        vehicle = moment.snapshot.vehicle
        if vehicle is None or battery is None or gps is None:
            continue
        assert vehicle.battery_voltage == pytest.approx(battery.voltages[0] / 1000)
        assert vehicle.battery_remaining == pytest.approx(battery.battery_remaining / 100)
        assert (vehicle.gps_fix, vehicle.gps_satellites) == (gps.fix_type, gps.satellites_visible)
        compared += 1
    assert compared > 1000


def test_outputs_and_demand_are_the_recorded_pulses() -> None:
    """Its limits are 1000, 1500 and 2000 us. Until they have arrived nothing is claimed."""
    compared = 0
    for moment in replay().moments:
        servos, channels = moment.recorded.get("SERVO_OUTPUT_RAW"), moment.recorded.get("RC_CHANNELS")
        vehicle = moment.snapshot.vehicle
        if vehicle is None or vehicle.demand is None or servos is None or channels is None:
            continue
        pulses = [pulse for pulse in (servos.servo1_raw, servos.servo3_raw) if pulse]
        assert [output.value for output in vehicle.outputs] == pytest.approx([(each - 1500) / 500 for each in pulses])
        assert vehicle.demand == pytest.approx([(channels.chan3_raw - 1500) / 500, (channels.chan1_raw - 1500) / 500])
        compared += 1
    assert compared > 1000
    shown = [each for moment in replay().moments if moment.snapshot.vehicle for each in moment.snapshot.vehicle.outputs]
    assert max(abs(each.value or 0.0) for each in shown) > 0.5
    first = next(moment.snapshot.vehicle for moment in replay().moments if "SERVO_OUTPUT_RAW" in moment.recorded)
    assert first is None or first.demand is None


def test_what_stops_it_is_what_its_parameters_say() -> None:
    vehicle = replay().moments[-1].snapshot.vehicle
    assert vehicle is not None
    assert [(stop.name, stop.does, stop.bound, stop.never) for stop in vehicle.stops] == [
        ("no command", "RC input", 3.0, False),
        ("... no RC", "neutral", 0.5, False),
        ("... no RC", "HOLD", 2.0, False),
        ("no station", "nothing", None, True),
    ]


def test_its_health_is_good_at_the_end() -> None:
    vehicle = replay().moments[-1].snapshot.vehicle
    assert vehicle is not None
    lines = {line.name: line for line in vehicle.health}
    assert not [line for line in vehicle.health if line.good is False]
    assert lines["estimate"].text.startswith("good")
    assert (lines["gyro"].text, lines["fence"].text) == ("ok", "off")


def test_unknown_ids_are_counted_and_are_no_loss() -> None:
    ours = {message.msgname for message in MESSAGES.values()}
    unknown = sum(len(messages) for name, messages in replay().recorded.items() if name not in ours)
    report = replay().report
    assert unknown > 9_000
    assert report.unknown == unknown
    assert (report.crc_errors, report.dialect_mismatch) == (0, ())
    losses = [moment.snapshot.links[0].loss for moment in replay().moments if moment.snapshot.links]
    assert max(loss or 0.0 for loss in losses) < 0.01


def test_every_text_is_shown_and_repeats_are_counted() -> None:
    shown = [line for line in replay().log if line.label == "vehicle"]
    texts = [message.text for message in replay().recorded["STATUSTEXT"]]
    assert sum(line.count for line in shown) == len(texts)
    assert "Throttle armed" in {line.text for line in shown}
    assert all((one.text, one.severity) != (two.text, two.severity) for one, two in itertools.pairwise(shown))


def test_its_pre_arm_state_is_that_of_sys_status() -> None:
    seen = set()
    for moment in replay().moments:
        status, vehicle = moment.recorded.get("SYS_STATUS"), moment.snapshot.vehicle
        if status is not None and vehicle is not None:
            ready = bool(status.onboard_control_sensors_health & ardupilotmega.MAV_SYS_STATUS_PREARM_CHECK)
            assert vehicle.prearm == ready
            seen.add(ready)
    assert True in seen


def test_its_dangerous_settings_are_warned_of() -> None:
    vehicle = replay().moments[-1].snapshot.vehicle
    assert vehicle is not None
    assert set(vehicle.warnings) >= {
        "RC_OVERRIDE_TIME 3: drives on for 3 s when the link is lost; set it to 0.5",
        "FS_GCS_ENABLE 0: no failsafe when the ground station is lost; set it to 1",
    }


def test_every_snapshot_fits_the_pipe() -> None:
    assert max(replay().sizes) < LARGEST


def test_the_same_texts_fifty_times_a_second_stay_one_line_each() -> None:
    """What a wrong setting of ArduPilot does ("WheelEncoder: wheel offset not set!")."""
    station = Station(["memory"])
    channel = Channel("flood", 0, system=OURS, component=COMPONENT)
    bare = ardupilotmega.MAVLink(None, srcSystem=1, srcComponent=1)
    beat = ardupilotmega.MAVLink_heartbeat_message(10, 3, 0, 0, 4, 3)
    text = ardupilotmega.MAVLink_statustext_message(4, b"WheelEncoder: wheel offset not set!")
    for number in range(3000):
        message = beat if number % 50 == 0 else text
        for received in channel.receive(message.pack(bare), "vehicle", number / 50):
            station.receive(received, number / 50)
        bare.seq = (bare.seq + 1) % 256
    lines = [line for line in station.snapshot(60.0, 60.0).texts if line.label == "vehicle"]
    assert [(line.text, line.count) for line in lines] == [("WheelEncoder: wheel offset not set!", 2940)]
