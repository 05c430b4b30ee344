"""`mavhelm disarm`, `stop` and `estop` with vehicles as ArduPilot and PX4 behave, on real sockets."""

from __future__ import annotations

import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from groundstation.station_socket.connect import running_stations
from groundstation.verbs.common.exit_codes import ExitCode
from tests.fakes.lines import on_line
from tests.fakes.services import ARDUPILOT, PX4, ForeignVehicle, foreign_vehicle
from tests.fakes.vehicle import FakeVehicle
from tests.fakes.wires import PymavlinkWire
from tests.groundstation.verbs.verb_runs import VerbRun, run_verb
from tests.ports import free_port
from tests.waits import wait_until

Capture = pytest.CaptureFixture[str]
HOLD = {ARDUPILOT: 4, PX4: 3 << 24 | 4 << 16}
COMMAND_INT, COMMAND_LONG = 75, 76
SWITCH, DISARM, MODE = 5300, 400, 176


def verb(capsys: Capture, vehicle: ForeignVehicle, *arguments: str) -> VerbRun:
    return run_verb(capsys, *arguments, "-e", vehicle.endpoint, "-v", "1")


def sent(vehicle: ForeignVehicle, command: int) -> list[tuple[float, float]]:
    return [(each.param1, each.param2) for each in vehicle.of("COMMAND_LONG") if each.command == command]


@pytest.mark.parametrize("autopilot", [ARDUPILOT, PX4])
def test_disarm_and_stop_are_done_when_the_heartbeat_reports_it(capsys: Capture, autopilot: int) -> None:
    with foreign_vehicle(autopilot) as vehicle:
        vehicle.armed = True
        stopped = verb(capsys, vehicle, "stop", "--json")
        assert (stopped.code, vehicle.mode, vehicle.armed) == (0, HOLD[autopilot], True), stopped.err
        assert stopped.records[0]["verb"] == "stop"
        disarmed = verb(capsys, vehicle, "disarm")
        assert (disarmed.code, vehicle.armed) == (0, False)
        assert disarmed.err.endswith("rover 1 is disarmed\n")


@pytest.mark.parametrize("autopilot", [ARDUPILOT, PX4])
def test_an_emergency_stop_disarms_by_force(capsys: Capture, autopilot: int) -> None:
    with foreign_vehicle(autopilot) as vehicle:
        vehicle.armed, vehicle.answers[SWITCH] = True, (3, "")
        stopped = verb(capsys, vehicle, "estop")
        assert (stopped.code, vehicle.armed) == (0, False), stopped.err
        assert (0.0, 21196.0) in sent(vehicle, DISARM)
        assert "arming is possible" in stopped.err


def test_an_answer_alone_is_no_stop_and_it_is_sent_again(capsys: Capture) -> None:
    with foreign_vehicle() as vehicle:
        vehicle.armed, vehicle.obeys = True, False
        threading.Timer(1.0, lambda: setattr(vehicle, "obeys", True)).start()
        disarmed = verb(capsys, vehicle, "disarm")
        assert (disarmed.code, vehicle.armed) == (0, False)
        assert len(sent(vehicle, DISARM)) >= 2


def test_an_accepted_stop_that_is_not_done_is_refused_in_the_end(capsys: Capture) -> None:
    with foreign_vehicle() as vehicle:
        vehicle.armed, vehicle.obeys = True, False
        disarmed = verb(capsys, vehicle, "disarm", "--timeout", "1")
        assert disarmed.code == ExitCode.REFUSED
        assert "accepted, but its heartbeat reports ARMED in MANUAL" in disarmed.err


def test_a_refusal_has_the_vehicles_own_words(capsys: Capture) -> None:
    with foreign_vehicle(PX4) as vehicle:
        vehicle.armed, vehicle.answers[DISARM] = True, (2, "Disarming denied: not landed")
        refused = verb(capsys, vehicle, "disarm")
        assert (refused.code, vehicle.armed) == (ExitCode.REFUSED, True)
        assert refused.err.endswith('disarm: refused, DENIED (2), "Disarming denied: not landed"\n')


@pytest.mark.parametrize("name", ["disarm", "stop", "estop"])
def test_without_an_answer_it_is_repeated_to_the_end(capsys: Capture, name: str) -> None:
    with foreign_vehicle() as vehicle:
        vehicle.armed = True
        vehicle.silent |= {COMMAND_LONG, COMMAND_INT}
        silent = verb(capsys, vehicle, name, "--timeout", "1.5")
        assert (silent.code, len(vehicle.of("COMMAND_LONG")) >= 3) == (ExitCode.NO_ANSWER, True), silent.err


def test_without_a_vehicle_chosen_all_of_them_stop(capsys: Capture) -> None:
    with foreign_vehicle() as one, foreign_vehicle(system=2) as other:
        one.armed = other.armed = True
        both = run_verb(capsys, "disarm", "-e", one.endpoint, "-e", other.endpoint)
        assert (both.code, one.armed, other.armed) == (0, False, False)
        one.armed = other.armed = True
        other.answers[DISARM] = (4, "no")
        assert run_verb(capsys, "disarm", "-e", one.endpoint, "-e", other.endpoint).code == ExitCode.PARTLY
        assert (one.armed, other.armed) == (False, True)


def is_disarmed(vehicle: ForeignVehicle) -> bool:
    return not vehicle.armed


def is_held(vehicle: ForeignVehicle) -> bool:
    return vehicle.mode == HOLD[vehicle.autopilot]


STOPS = {"disarm": is_disarmed, "estop": is_disarmed, "stop": is_held}
"""Verb -> whether a vehicle obeys it."""


@pytest.mark.parametrize("name", STOPS)
def test_a_vehicle_with_the_same_id_confirms_no_stop(capsys: Capture, name: str) -> None:
    with foreign_vehicle() as deaf, foreign_vehicle() as other:
        deaf.armed, deaf.mode, other.mode = True, 10, 4
        deaf.silent |= {COMMAND_LONG, COMMAND_INT}
        run = run_verb(capsys, name, "-v", "1", "-e", other.endpoint, "-e", deaf.endpoint, "--timeout", "3")
        assert run.code in (ExitCode.REFUSED, ExitCode.NO_ANSWER), run.err
        assert "reports ARMED in AUTO" in run.err
        deaf.silent.clear()
        done = run_verb(capsys, name, "-v", "1", "-e", other.endpoint, "-e", deaf.endpoint)
        assert (done.code, STOPS[name](deaf), STOPS[name](other)) == (0, True, True), done.err


@pytest.mark.parametrize("name", [*STOPS, "arm"])
def test_no_answer_of_a_vehicle_that_signs_is_explained(capsys: Capture, name: str) -> None:
    signing = ForeignVehicle()
    with on_line(signing, "udpout", wire=PymavlinkWire(key=bytes(range(32)))) as vehicle:
        vehicle.armed = name != "arm"
        vehicle.silent |= {COMMAND_LONG, COMMAND_INT}
        options = () if name == "arm" else ("--timeout", "2.5")
        silent = verb(capsys, vehicle, name, *options)
        assert silent.code == ExitCode.NO_ANSWER
        assert "no answer, after all tries; it signs its frames with a key that is not here" in silent.err


def test_a_release_is_confirmed_by_a_heartbeat_of_each_sender(capsys: Capture) -> None:
    with on_line(FakeVehicle()) as deaf, on_line(FakeVehicle()) as other:
        deaf.locked = other.locked = True
        deaf.silent |= {COMMAND_LONG, COMMAND_INT}
        both = ("-v", "1", "-e", other.endpoint, "-e", deaf.endpoint)
        kept = run_verb(capsys, "estop", "--clear", *both)
        assert (kept.code, other.locked) == (ExitCode.REFUSED, False), kept.err
        assert "locked by its emergency stop" in kept.err
        deaf.silent.clear()
        done = run_verb(capsys, "estop", "--clear", *both)
        assert (done.code, deaf.locked) == (0, False), done.err


def test_a_release_without_a_heartbeat_is_not_reported(capsys: Capture) -> None:
    with on_line(FakeVehicle()) as vehicle:
        vehicle.locked = True
        vehicle.on_command[SWITCH] = lambda: setattr(vehicle, "beats", False)
        vehicle.obeys = False
        silent = run_verb(capsys, "estop", "--clear", "-v", "1", "-e", vehicle.endpoint)
        assert silent.code == ExitCode.REFUSED
        assert "accepted, but no heartbeat has come since then" in silent.err


def test_where_nobody_was_heard_there_is_no_address(capsys: Capture) -> None:
    silent = run_verb(capsys, "estop", "-e", f"udpin:127.0.0.1:{free_port()}", "--timeout", "0.5")
    assert (silent.code, "there is no address to send to" in silent.err) == (ExitCode.NO_VEHICLE, True)


@pytest.mark.parametrize("switch", [0, 3])
def test_an_emergency_stop_says_whether_the_safety_switch_locks(capsys: Capture, switch: int) -> None:
    with foreign_vehicle() as vehicle:
        vehicle.armed, vehicle.answers[SWITCH] = True, (switch, "")
        stopped = verb(capsys, vehicle, "estop")
        locked = "locked by its safety switch; `estop --clear` releases it" in stopped.err
        assert (stopped.code, locked) == (0, switch == 0), stopped.err


def test_a_stop_goes_past_a_station_that_hangs(
    capsys: Capture, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    with foreign_vehicle() as vehicle:
        vehicle.armed = True
        command = [sys.executable, "-m", "groundstation", "serve", "--headless", vehicle.endpoint]
        with subprocess.Popen(command, stderr=subprocess.DEVNULL) as station:
            try:
                wait_until(lambda: running_stations() == [station.pid], "the station runs")
                station.send_signal(signal.SIGSTOP)
                stopped = run_verb(capsys, "disarm", "-e", vehicle.endpoint)
                assert (stopped.code, vehicle.armed) == (0, False), stopped.err
            finally:
                station.kill()
