"""The vehicle as a real process: however it ends, the wheels that turned stand first."""

from __future__ import annotations

import asyncio
import fcntl
import logging
import os
import signal
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from dialects.enums import SystemState
from dialects.messages import Heartbeat, LocalPositionNed, ManualControl
from link.runner import Runner
from link.runtime.command_line import USAGE_ERROR
from tests.vehicle.ground import Ground, drive, running
from tests.vehicle.script import driving
from vehicle.config.run_settings import RunSettings, Simulation
from vehicle.motors import MotorError
from vehicle.runtime import daemon
from vehicle.runtime.daemon import FAULT
from vehicle.runtime.shutdown import Shutdown

BREAKING = "tests.vehicle.motors.breaking"


@pytest.mark.e2e
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGHUP])
def test_a_signal_while_driving_stops_the_wheels(tmp_path: Path, number: signal.Signals) -> None:
    with Ground() as ground, running(tmp_path, "--sim", ground.endpoint) as vehicle:
        assert vehicle.ready() == f"vehicle: ready, system 1, {ground.endpoint}"
        drive(ground, vehicle)
        vehicle.process.send_signal(number)
        code, lines = vehicle.ended()
        assert (code, lines[-1]) == (0, f"vehicle: stopped by {number.name}, motors neutral")
        assert "vehicle: Armed by GCS 255, mode MANUAL" in lines  # what the driver reads, the journal keeps
        assert not any(vehicle.outputs()[-1])
        ground.drain()
        assert not ground.armed
        assert [m for m in ground.heard if isinstance(m, Heartbeat)][-1].system_status == SystemState.POWEROFF


@pytest.mark.e2e
def test_a_fault_in_the_program_stops_the_wheels_first(tmp_path: Path) -> None:
    details = tmp_path / "details"
    words = (f"{BREAKING}:RaisesWhileTurning", "--log-file", str(details))
    with Ground() as ground, running(tmp_path, ground.endpoint, "--motors", *words) as vehicle:
        vehicle.ready()
        drive(ground, vehicle)
        ground.wait(lambda: vehicle.process.poll() is not None, "the fault ends the vehicle")
        code, lines = vehicle.ended()
        assert code == FAULT
        assert all(line.startswith("vehicle: ") for line in lines)
        assert "motors neutral; stopped by a fault in the program: ZeroDivisionError: a bug in the driver" in lines[-1]
        assert not any(vehicle.outputs()[-1])
        assert "Traceback" in details.read_text()
        ground.drain()
        assert not ground.armed


@pytest.mark.e2e
def test_motors_that_cannot_be_stopped_are_said_to_turn(tmp_path: Path) -> None:
    with Ground() as ground, running(tmp_path, ground.endpoint, "--motors", f"{BREAKING}:CannotStop") as vehicle:
        vehicle.ready()
        drive(ground, vehicle)
        ground.wait(lambda: vehicle.process.poll() is not None, "the fault ends the vehicle")
        code, lines = vehicle.ended()
        assert code == FAULT
        assert all(line.startswith("vehicle: ") for line in lines)
        assert "motors may still turn, cut their power" in lines[-1]


@pytest.mark.e2e
def test_a_log_file_that_cannot_be_had_keeps_nobody_from_driving(tmp_path: Path) -> None:
    """The file of settings names one, on a card that is gone or read-only; on the command line it is a mistake."""
    config, endpoint = tmp_path / "rover.toml", "udpout:127.0.0.1:9"
    text = f'endpoints = ["{endpoint}"]\n[motors]\ndriver = "simulated"\n[log]\nfile = "{tmp_path}/none/log"\n'
    config.write_text(text)
    with running(tmp_path, "--config", str(config)) as vehicle:
        told: list[str] = []
        while not told or "ready" not in told[-1]:
            told.append(vehicle.ready())
        assert f"vehicle: log.file {tmp_path}/none/log: No such file or directory; continuing without it" in told
        assert told[-1] == f"vehicle: ready, system 1, {endpoint}"
        vehicle.process.send_signal(signal.SIGTERM)
        code, rest = vehicle.ended()
        assert (code, rest[-1]) == (0, "vehicle: stopped by SIGTERM, motors neutral")


@pytest.mark.e2e
def test_a_terminal_on_hold_does_not_hold_the_vehicle(tmp_path: Path) -> None:
    """Nobody reads stderr and it is full: the vehicle lives on, and ends when asked."""
    reader, writer = os.pipe()
    fcntl.fcntl(writer, fcntl.F_SETPIPE_SZ, 4096)
    os.write(writer, b"." * 4096)
    with Ground() as ground:
        process = subprocess.Popen([sys.executable, "-m", "vehicle", "--sim", ground.endpoint], stderr=writer)
        try:
            ground.arm()
            process.send_signal(signal.SIGTERM)
            ground.wait(lambda: process.poll() is not None, "the vehicle ends")
            assert process.returncode == 0
        finally:
            process.kill()
            process.wait(60)
            os.close(reader)
            os.close(writer)


@pytest.mark.e2e
def test_a_closed_stderr_is_no_fault() -> None:
    reader, writer = os.pipe()
    os.close(reader)
    with Ground() as ground:
        process = subprocess.Popen([sys.executable, "-m", "vehicle", "--sim", ground.endpoint], stderr=writer)
        os.close(writer)
        try:
            ground.arm()
            process.send_signal(signal.SIGTERM)
            assert process.wait(60) == 0
        finally:
            process.kill()
            process.wait(60)


@pytest.mark.e2e
def test_gets_ready_and_says_where_it_listens(tmp_path: Path) -> None:
    """How soon is a matter of benchmarks."""
    with Ground() as ground, running(tmp_path, "--sim", ground.endpoint) as vehicle:
        assert vehicle.ready() == f"vehicle: ready, system 1, {ground.endpoint}"


# ---- ends from outside the cores ----


async def test_an_exception_in_a_callback_stops_the_motors_and_the_run() -> None:
    machine, _, motors = driving()
    ending = Shutdown(machine, Runner(machine, [], period=0.02))
    loop = asyncio.get_running_loop()
    ending.install_handlers(loop)
    loop.call_soon(int, "not a number")
    with pytest.raises(ValueError, match="not a number"):
        await ending.wait()
    assert motors.outputs == (0.0, 0.0)
    assert motors.asked[-1] == "close"


async def test_a_signal_to_motors_that_do_not_stop_is_a_fault() -> None:
    machine, mind, motors = driving()
    motors.broken["disable"] = OSError("bus is gone")
    ending = Shutdown(machine, Runner(machine, [], period=0.02))
    ending.install_handlers(asyncio.get_running_loop())
    signal.raise_signal(signal.SIGTERM)
    with pytest.raises(MotorError, match="cut their power: bus is gone"):
        await ending.wait()
    assert mind.calls[-2:] == ["shutdown", "messages_to_send"]


# ---- mistakes and faults before the start ----


def said(caplog: pytest.LogCaptureFixture) -> str:
    """The one line."""
    assert len(caplog.records) == 1
    assert caplog.records[0].levelno >= logging.ERROR
    assert "\n" not in caplog.records[0].getMessage()
    return caplog.records[0].getMessage()


def test_an_unknown_driver_is_the_users_mistake(caplog: pytest.LogCaptureFixture) -> None:
    assert daemon.run(RunSettings(("udpout:127.0.0.1:9",), motors={"driver": "gipo"})) == USAGE_ERROR
    assert "unknown motor driver 'gipo'" in said(caplog)


def test_missing_hardware_is_a_fault(caplog: pytest.LogCaptureFixture) -> None:
    assert daemon.run(RunSettings(("udpout:127.0.0.1:9",), motors={"driver": f"{BREAKING}:NoHardware"})) == FAULT
    assert said(caplog) == "motor driver: no board at address 0x40"


def test_a_port_in_use_may_be_free_later(caplog: pytest.LogCaptureFixture) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        port = taken.getsockname()[1]
        assert daemon.run(RunSettings((f"udpin:127.0.0.1:{port}",), simulation=Simulation())) == FAULT
    assert f"port {port} is in use" in said(caplog)


def test_a_host_that_nobody_knows_may_be_known_later(caplog: pytest.LogCaptureFixture) -> None:
    assert daemon.run(RunSettings(("udpout:no-such-host.invalid:14550",), simulation=Simulation())) == FAULT
    assert "host 'no-such-host.invalid' is not known" in said(caplog)


def test_a_bad_endpoint_or_parameter_is_the_users_mistake(caplog: pytest.LogCaptureFixture) -> None:
    assert daemon.run(RunSettings(("carrier-pigeon:1",), simulation=Simulation())) == USAGE_ERROR
    caplog.clear()
    assert daemon.run(RunSettings((), simulation=Simulation(), params={"MAN_TIMEOUT": 99.0})) == USAGE_ERROR
    assert "MAN_TIMEOUT" in said(caplog)


def moves(ground: Ground) -> bool:
    return [message for message in ground.heard if isinstance(message, LocalPositionNed)][-1].vy > 0.5


@pytest.mark.e2e
@pytest.mark.parametrize("kind", [3, 4])
def test_the_simulator_drives_four_wheels_sideways_too(tmp_path: Path, kind: int) -> None:
    with (
        Ground() as ground,
        running(tmp_path, "--sim", ground.endpoint, "--param", f"DRIVE_TYPE={kind}") as vehicle,
    ):
        vehicle.ready()
        drive(ground, vehicle)
        ground.demand = None

        def aside() -> bool:
            ground.say(ManualControl(1, 0, 1000, 0, 0, 0))
            return vehicle.outputs()[-1] == (1.0, -1.0, -1.0, 1.0)

        ground.wait(aside, "all four wheels take it to the right")
        ground.wait(lambda: aside() and moves(ground), "it moves to the right")


def test_a_motor_log_that_cannot_be_written_is_the_users_mistake(caplog: pytest.LogCaptureFixture) -> None:
    settings = RunSettings(("udpout:127.0.0.1:9",), simulation=Simulation(), motor_log="/no/such/folder/motors")
    assert daemon.run(settings) == USAGE_ERROR
    assert said(caplog) == "motor log /no/such/folder/motors: No such file or directory"
