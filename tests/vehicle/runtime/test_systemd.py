"""What systemd hears, through its own kind of socket; and that only completed cycles feed its watchdog."""

from __future__ import annotations

import os
import signal
import socket
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.vehicle.ground import Ground, running
from tests.vehicle.script import AHEAD, MESSAGE, Bench, Script
from vehicle.control_loop import ControlLoop
from vehicle.motors import MotorError
from vehicle.runtime.systemd import Notifier
from vehicle.sensors import NoSensors


@pytest.fixture
def manager(tmp_path: Path) -> Iterator[socket.socket]:
    """The service manager's end."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as listener:
        listener.bind(str(tmp_path / "notify"))
        listener.setblocking(False)
        yield listener


def heard(manager: socket.socket) -> list[str]:
    words = []
    while True:
        try:
            words.append(manager.recv(4096).decode())
        except BlockingIOError:
            return words


def environment(manager: socket.socket, **more: str) -> dict[str, str]:
    return {"NOTIFY_SOCKET": str(manager.getsockname()), **more}


def test_ready_and_stopping(manager: socket.socket) -> None:
    notifier = Notifier(environment(manager))
    notifier.ready("system 1")
    notifier.stopping()
    notifier.close()
    notifier.stopping()
    assert heard(manager) == ["READY=1\nSTATUS=system 1", "STOPPING=1"]


def test_alive_is_said_four_times_in_the_watchdogs_time(manager: socket.socket) -> None:
    notifier = Notifier(environment(manager, WATCHDOG_USEC="1000000", WATCHDOG_PID=str(os.getpid())))
    words = []
    for cycle in range(500):
        notifier.alive(100.0 + cycle * 0.02)
        words += heard(manager)
    notifier.close()
    assert set(words) == {"WATCHDOG=1"}
    assert len(words) in range(37, 42)


@pytest.mark.parametrize(
    "more", [{}, {"WATCHDOG_USEC": "1000000", "WATCHDOG_PID": "1"}, {"WATCHDOG_USEC": "soon"}, {"WATCHDOG_USEC": ""}]
)
def test_without_a_watchdog_for_us_nothing_is_said(manager: socket.socket, more: dict[str, str]) -> None:
    notifier = Notifier(environment(manager, **more))
    for cycle in range(500):
        notifier.alive(cycle * 0.02)
    notifier.close()
    assert heard(manager) == []


@pytest.mark.parametrize("address", ["", "/no/such/socket"])
def test_without_systemd_there_is_silence(address: str) -> None:
    notifier = Notifier({"NOTIFY_SOCKET": address, "WATCHDOG_USEC": "1000000"})
    notifier.ready("")
    notifier.alive(1.0)
    notifier.stopping()
    notifier.close()


def test_an_abstract_socket_is_spoken_to_as_well() -> None:
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as listener:
        listener.bind(f"\0mavhelm test {os.getpid()}")
        notifier = Notifier({"NOTIFY_SOCKET": f"@mavhelm test {os.getpid()}"})
        notifier.stopping()
        assert listener.recv(100) == b"STOPPING=1"
        notifier.close()


def test_a_manager_that_reads_nothing_does_not_hold_the_loop(manager: socket.socket) -> None:
    notifier = Notifier(environment(manager))
    for _ in range(10_000):
        notifier.stopping()
    notifier.close()
    assert 0 < len(heard(manager)) < 10_000


# ---- only a completed cycle counts


def machine() -> tuple[ControlLoop, Script, Bench, list[float]]:
    mind, motors, cycles = Script(), Bench(), list[float]()
    return ControlLoop(mind, motors, NoSensors(), completed=cycles.append), mind, motors, cycles


def test_a_cycle_counts_when_the_motors_have_their_outputs() -> None:
    body, mind, motors, cycles = machine()
    mind.outputs = AHEAD
    body.tick(1.0)
    assert motors.outputs == (0.5, 0.4)
    assert cycles == [1.0]


def test_a_message_is_no_cycle() -> None:
    body, _, _, cycles = machine()
    body.receive(MESSAGE, 1.0)
    body.observe([], 1.0)
    body.messages_to_send()
    assert cycles == []


def test_a_cycle_that_raises_does_not_count() -> None:
    body, mind, _, cycles = machine()
    mind.fault = ZeroDivisionError()
    with pytest.raises(ZeroDivisionError):
        body.tick(1.0)
    assert cycles == []


def test_a_closed_machine_does_not_count() -> None:
    body, _, _, cycles = machine()
    body.close()
    body.tick(1.0)
    assert cycles == []


def test_a_failed_driver_is_the_rovers_matter_and_no_hang() -> None:
    """The vehicle says so and tries again; a restart would only take its voice."""
    body, mind, motors, cycles = machine()
    mind.outputs, motors.broken["set"] = AHEAD, MotorError("no reply")
    body.tick(1.0)
    assert "failed: no reply" in mind.calls
    assert cycles == [1.0]


# ---- the daemon


def passed(ground: Ground, seconds: float) -> None:
    """Let time pass."""
    end = time.monotonic() + seconds
    ground.wait(lambda: time.monotonic() > end, "time passes")


@pytest.mark.e2e
def test_the_daemon_reports_ready_alive_and_its_end(
    tmp_path: Path, manager: socket.socket, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NOTIFY_SOCKET", str(manager.getsockname()))
    monkeypatch.setenv("WATCHDOG_USEC", "200000")
    words: list[str] = []

    def said(word: str, times: int = 1) -> bool:
        words.extend(heard(manager))
        return sum(each.startswith(word) for each in words) >= times

    with Ground() as ground, running(tmp_path, "--sim", ground.endpoint) as vehicle:
        vehicle.ready()
        ground.wait(lambda: said("READY=1\nSTATUS=system 1, udpout:"), "it says that it is ready")
        ground.wait(lambda: said("WATCHDOG=1", 10), "it says that it is alive")
        os.kill(vehicle.process.pid, signal.SIGSTOP)
        passed(ground, 0.2)  # what was on its way
        heard(manager)
        passed(ground, 0.5)
        assert heard(manager) == []
        os.kill(vehicle.process.pid, signal.SIGCONT)
        words.clear()
        ground.wait(lambda: said("WATCHDOG=1", 3), "it is alive again")
        words.clear()
        vehicle.process.send_signal(signal.SIGTERM)
        assert vehicle.ended()[0] == 0
        assert said("STOPPING=1")
        assert words[-1] == "STOPPING=1"
