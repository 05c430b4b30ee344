"""`mavhelm send`: what arrives, and that no demand is left when the process is interrupted, killed or stopped."""

from __future__ import annotations

import signal

import pytest

from tests.fakes.services import PX4, foreign_vehicle
from tests.groundstation.verbs.driving_process import check_signal, check_standstill
from tests.groundstation.verbs.verb_runs import run_demanding, run_verb

Capture = pytest.CaptureFixture[str]
DRIVE = ("send", "MANUAL_CONTROL", "z=400", "--rate", "20", "--for", "30", "--yes")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL])
def test_a_process_that_a_signal_ends_leaves_no_demand(number: signal.Signals) -> None:
    check_signal(number, *DRIVE)


def test_stopped_process_leaves_no_demand_and_does_not_drive_on() -> None:
    check_standstill(*DRIVE)


def test_a_demand_begins_and_ends_neutral_in_the_vehicles_axes() -> None:
    with foreign_vehicle(PX4) as vehicle:
        vehicle.armed = True
        words = ("send", "MANUAL_CONTROL", "z=700", "--rate", "20", "--for", "0.3", "--yes", "-v", "1")
        assert run_demanding(*words, "-e", vehicle.endpoint).code == 0
        throttles = [each.z for each in vehicle.of("MANUAL_CONTROL")]
        assert throttles[:3] == [500] * 3
        assert throttles[-5:] == [500] * 5
        assert set(throttles) == {500, 700}


def test_overridden_channels_are_centred_and_given_back() -> None:
    with foreign_vehicle() as vehicle:
        words = ("send", "RC_CHANNELS_OVERRIDE", "chan3_raw=1600", "--yes", "-v", "1")
        assert run_demanding(*words, "-e", vehicle.endpoint).code == 0
        sent = [(each.chan3_raw, each.chan1_raw) for each in vehicle.of("RC_CHANNELS_OVERRIDE")]
        assert sorted(set(sent), key=sent.index) == [(1500, 65535), (1600, 65535), (0, 65535)]


def test_other_messages_are_sent_as_written(capsys: Capture) -> None:
    with foreign_vehicle() as vehicle:
        words = ("-e", vehicle.endpoint, "-v", "1")
        assert run_verb(capsys, "send", "STATUSTEXT", "severity=INFO", "text=hello", *words).code == 0
        assert run_verb(capsys, "send", "PARAM_REQUEST_READ", "param_index=3", *words).code == 0
        many = run_verb(capsys, "send", "DEBUG", "value=1.5", "--rate", "50", "--for", "0.2", "--json", *words)
        assert 2 <= many.records[0]["count"] <= 11, "a late machine sends less, and never more at once"
        vehicle.wait_for("DEBUG", 9)
        [text] = vehicle.of("STATUSTEXT")
        [read] = vehicle.of("PARAM_REQUEST_READ")
        assert (text.severity, text.text) == (6, "hello")
        assert (read.target_system, read.target_component, read.param_index, read.param_id) == (1, 1, 3, "")
