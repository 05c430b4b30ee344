"""`mavhelm messages`, `watch`, `request`, `rate`, `command` and `ping` with a foreign vehicle on real sockets."""

from __future__ import annotations

import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mav

from groundstation.verbs.common.exit_codes import ExitCode
from link.runtime.stdio import READER_GONE
from tests.fakes.services import ForeignVehicle, foreign_vehicle
from tests.groundstation.verbs.verb_runs import VerbRun, run_verb
from tests.waits import Waits

Capture = pytest.CaptureFixture[str]


def verb(capsys: Capture, vehicle: ForeignVehicle, *words: str) -> VerbRun:
    return run_verb(capsys, *words, "-e", vehicle.endpoint, "-v", "1")


def hud(speed: float) -> mav.MAVLink_vfr_hud_message:
    return mav.MAVLink_vfr_hud_message(0.0, speed, 90, 0, 1.5, 0.0)


@contextmanager
def streaming(vehicle: ForeignVehicle) -> Iterator[None]:
    """VFR_HUD at 50 Hz, each 0.1 m/s faster than the one before."""
    ended = threading.Event()

    def stream() -> None:
        speed = 0.0
        while not ended.wait(0.02):
            vehicle.send(hud(speed))
            speed = round(speed + 0.1, 1)

    thread = threading.Thread(target=stream)
    thread.start()
    yield
    ended.set()
    thread.join()


def test_messages_with_their_rates(capsys: Capture) -> None:
    with foreign_vehicle() as vehicle, streaming(vehicle):
        [record] = verb(capsys, vehicle, "messages", "vfr*", "--for", "0.5", "--json").records
        assert (record["system"], record["name"]) == (1, "VFR_HUD")
        assert 30 < record["rate"] < 60
        listed = verb(capsys, vehicle, "messages", "--for", "1.1").out.splitlines()
        assert [line.split()[1] for line in listed] == ["message", "HEARTBEAT", "VFR_HUD"]
        assert verb(capsys, vehicle, "messages", "GPS*", "--for", "0.1").code == ExitCode.DIFFERS


def test_watch_until_a_condition_holds(capsys: Capture) -> None:
    with foreign_vehicle() as vehicle, streaming(vehicle):
        reached = verb(capsys, vehicle, "watch", "VFR_HUD.groundspeed", "--until", ">=1.5", "--timeout", "20")
        assert (reached.code, float(reached.out.splitlines()[-1]) >= 1.5) == (0, True)
        whole = verb(capsys, vehicle, "watch", "vfr_hud", "--until", "heading == 90", "--json").records
        assert (whole[0]["fields"]["heading"], whole[0]["name"]) == (90, "VFR_HUD")
        missed = verb(capsys, vehicle, "watch", "VFR_HUD.heading", "--until", ">90", "--timeout", "0.3")
        assert missed.code == ExitCode.DIFFERS
        assert "not so within 0.3 s; the last was 90" in missed.err


def test_watch_as_csv_and_by_the_name_of_an_enum(capsys: Capture) -> None:
    with foreign_vehicle() as vehicle, streaming(vehicle):
        lines = verb(capsys, vehicle, "watch", "VFR_HUD", "--csv", "--timeout", "0.2").out.splitlines()
        assert lines[0] == "time,airspeed,groundspeed,heading,throttle,alt,climb"
        assert lines[1].split(",")[3:] == ["90", "0", "1.5", "0"]
        rover = verb(capsys, vehicle, "watch", "HEARTBEAT.type", "--until", "=GROUND_ROVER", "--timeout", "5")
        assert (rover.code, rover.out) == (0, "10\n")


def test_watch_says_that_nothing_comes(capsys: Capture) -> None:
    with foreign_vehicle() as vehicle:
        quiet = verb(capsys, vehicle, "watch", "ATTITUDE.roll", "--until", ">0", "--timeout", "2.2")
        assert quiet.code == ExitCode.DIFFERS
        assert "`mavhelm rate ATTITUDE 2` requests it" in quiet.err


def test_request_prints_a_message(capsys: Capture) -> None:
    with foreign_vehicle() as vehicle:
        vehicle.telemetry[74] = hud(1.25)
        assert "groundspeed  1.25 m/s\n" in verb(capsys, vehicle, "request", "VFR_HUD").out
        vehicle.telemetry[251] = mav.MAVLink_named_value_float_message(0, b"depth", 2.5)
        [record] = verb(capsys, vehicle, "request", "NAMED_VALUE_FLOAT", "--json").records[:1]
        assert record == {"name": "NAMED_VALUE_FLOAT", "fields": {"time_boot_ms": 0, "name": "depth", "value": 2.5}}
        vehicle.answers[512] = (3, "")
        assert verb(capsys, vehicle, "request", "ATTITUDE").code == ExitCode.REFUSED
        vehicle.answers.clear()
        assert verb(capsys, vehicle, "request", "ATTITUDE").code == ExitCode.NO_ANSWER


def test_a_rate_is_read_back(capsys: Capture) -> None:
    with foreign_vehicle() as vehicle:
        vehicle.on_command[510] = lambda: vehicle.send(mav.MAVLink_message_interval_message(30, 125000))
        done = verb(capsys, vehicle, "rate", "ATTITUDE", "10", "--json")
        assert (done.code, done.records[0]["rate"]) == (0, 8.0)
        [asked] = [each for each in vehicle.of("COMMAND_LONG") if each.command == 511]
        assert (asked.param1, asked.param2) == (30, 100000)
        assert verb(capsys, vehicle, "rate", "ATTITUDE", "0").code == 0
        assert [each.param2 for each in vehicle.of("COMMAND_LONG") if each.command == 511][-1] == -1


def test_a_command_by_name_and_number(capsys: Capture) -> None:
    with foreign_vehicle() as vehicle:
        vehicle.answers[183] = (4, "no servo 7")
        assert verb(capsys, vehicle, "command", "do_set_home", "1", "0", "nan").code == 0
        refused = verb(capsys, vehicle, "command", "183", "7", "1500")
        assert (refused.code, "no servo 7" in refused.err) == (ExitCode.REFUSED, True)
        home, servo = [each for each in vehicle.of("COMMAND_LONG") if each.command in (179, 183)]
        assert (home.param1, home.param3 != home.param3, servo.param2) == (1, True, 1500)


def test_verbs_that_only_look_never_have_the_ids_of_a_driver(capsys: Capture) -> None:
    with foreign_vehicle() as vehicle:
        for words, component in ((("request", "VFR_HUD"), 25), (("command", "RUN_PREARM_CHECKS"), 190)):
            vehicle.senders.clear()
            verb(capsys, vehicle, *words)
            assert {sender for _, sender in vehicle.senders} == {component}


def test_ping(capsys: Capture) -> None:
    with foreign_vehicle() as vehicle:
        trips = verb(capsys, vehicle, "ping", "--count", "3", "--interval", "0.01", "--json").records
        assert [each["number"] for each in trips] == [1, 2, 3]
        assert all(0 < each["round_trip"] < 1 for each in trips)
        vehicle.silent.add(111)  # TIMESYNC
        assert verb(capsys, vehicle, "ping", "--count", "1").code == ExitCode.NO_ANSWER


@pytest.mark.parametrize("words", [("watch", "VFR_HUD"), ("status", "--watch")])
def test_a_reader_that_goes_ends_a_verb_quietly(words: tuple[str, ...]) -> None:
    with foreign_vehicle() as vehicle, streaming(vehicle):
        command = [sys.executable, "-m", "groundstation", *words, "-e", vehicle.endpoint]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None
            assert process.stderr is not None
            process.stdout.readline()
            process.stdout.close()
            assert process.stderr.read() == ""
        assert process.returncode == READER_GONE


MISTAKES = [
    ("watch VRF_HUD", "did you mean VFR_HUD"),
    ("watch VFR_HUD.groundsped", "did you mean groundspeed?"),
    ("watch VFR_HUD --until groundspeed", "is not a condition: write it as 'climb>0.5'"),
    ("watch VFR_HUD --until >0.5", "is not a condition"),
    ("watch VFR_HUD.heading --until <", "is not a condition"),
    ("watch VFR_HUD --csv --json", "not both"),
    ("watch VFR_HUD --timeout nan", "'nan' is not a number of seconds"),
    ("messages --for -1", "'-1' is not a number of seconds"),
    ("command MAV_CMD_DO_SET_HOM", "did you mean DO_SET_HOME"),
    ("command 70000", "there is no command '70000'"),
    ("command DO_SET_HOME 1 2 3 4 5 6 7 8", "8 parameters, but a command has 7"),
    ("command DO_SET_HOME inf", "'inf' is not a number"),
    ("request NOTHING", "there is no message 'NOTHING'"),
    ("rate ATTITUDE nan", "'nan' is not a number"),
    ("rate ATTITUDE 1000", "is not a rate from 0.001 to 200 Hz"),
    ("request WIND", "Messages of ArduPilot alone: --dialect ardupilotmega.xml"),
    ("ping --count 0", "'0' is not a number from 1"),
    ("send", "required"),
    ("send STATUSTEXT severty=1", "did you mean severity?"),
    ("send STATUSTEXT severity=INF", "severity: 'INF' is not a whole number: did you mean INFO?"),
    ("send STATUSTEXT severity=300", "severity: 300 does not fit uint8_t"),
    ("send STATUSTEXT severity=nan", "'nan' is not a whole number"),
    ("send STATUSTEXT severity", "write field=value"),
    ("send STATUSTEXT severity=1 severity=2", "severity is given twice"),
    (f"send STATUSTEXT text={'x' * 60}", "text: 60 bytes, but the field has 50"),
    ("send BATTERY_STATUS voltages=1,2,3,4,5,6,7,8,9,10,11", "11 values, but the array has 10"),
    ("send ATTITUDE roll=1e300", "roll: 1e300 does not fit float"),
    ("send ATTITUDE roll=1 --rate 5", "--rate and --for go together"),
    ("send MANUAL_CONTROL x=100", "MANUAL_CONTROL can move the vehicle: --yes sends it"),
    ("send SET_POSITION_TARGET_LOCAL_NED vx=1", "can move the vehicle"),
    ("send RC_CHANNELS_OVERRIDE chan3_raw=1600", "can move the vehicle"),
    ("send COMMAND_LONG command=400", "can move the vehicle and has no end"),
    ("send MANUAL_CONTROL x=1001 --yes", "x: 1001 is not -1000 to 1000"),
    ("send SET_POSITION_TARGET_LOCAL_NED vx=1 --yes", "give type_mask"),
    ("send SET_POSITION_TARGET_LOCAL_NED vx=nan type_mask=3527 --yes", "a demand needs finite numbers"),
    ("send ROVER_OPERATOR_PRESENCE x=1 --yes", "is made by this program"),
]


@pytest.mark.parametrize(("words", "said"), MISTAKES, ids=[words for words, _ in MISTAKES])
def test_a_mistake_is_one_line_before_any_link_opens(capsys: Capture, words: str, said: str) -> None:
    waits, before = Waits(), time.monotonic()
    run = run_verb(capsys, *words.split(), "-e", "udpin:127.0.0.1:1")
    assert (run.code, run.out, len(run.err.splitlines())) == (ExitCode.USAGE, "", 1), run.err
    assert said in run.err
    assert time.monotonic() - before < 5 + waits.total()
