"""The unit as `mavhelm vehicle systemd-unit` prints it, under a real systemd: driven, killed, hung and stopped.

Only the watchdog has a longer timeout than printed, except in the test of a hang, because a machine that pauses is not
a hang. The motor controller is an emulator on a terminal line. Its own timeout does not work, so that only a command
stops it, and it never answers, because a busy machine would make it late.
"""

from __future__ import annotations

import os
from collections.abc import Iterator

import pytest

from dialects.axes import Axes
from dialects.enums import Command
from dialects.messages import CommandLong
from tests.e2e.systemd_machine import Machine, UnableError, booted
from tests.vehicle.cli.test_safe_stop import StubbornSabertooth
from tests.vehicle.ground import Ground
from tests.vehicle.motors.pty_controller import OnPty

pytestmark = [pytest.mark.e2e, pytest.mark.timeout(300), pytest.mark.xdist_group("systemd")]

UNIT = "rover.service"
FILE = "/etc/rover.toml"
STATE = "/var/lib/private/mavhelm"
DIALOUT = 20
WITHIN = 60.0
"""s: never reached if the code is right, so it may be long."""
PATIENT_WATCHDOG = "WatchdogSec=60"


@pytest.fixture(scope="module")
def machine(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Machine]:
    opened = booted(tmp_path_factory.mktemp("systemd"))
    try:
        machine = opened.__enter__()
    except UnableError as error:
        pytest.skip(" ".join(str(error).split()))
    try:
        yield machine
    finally:
        opened.__exit__(None, None, None)


class Service:
    """The rover as a service, its motor controller, and a ground station."""

    def __init__(self, machine: Machine, ground: Ground, line: OnPty) -> None:
        self.machine, self.ground, self._line = machine, ground, line
        self._before = len(machine.journal(UNIT))
        self.write(f'[motors]\ndriver = "sabertooth"\nport = "{line.path}"\ntimeout_proven = true\n')
        self.watch(PATIENT_WATCHDOG)

    def watch(self, watchdog: str) -> None:
        """Return the rover's unit with these lines added."""
        self.machine.write(f"/etc/systemd/system/{UNIT}.d/watchdog.conf", f"[Service]\n{watchdog}\n")
        self.install(UNIT, "--config", FILE)

    def install(self, name: str, *options: str) -> None:
        """Return the unit that the installed `vehicle` prints."""
        code, unit = self.machine.run("/opt/rover/bin/python3", "-m", "vehicle", "systemd-unit", *options)
        assert code == 0, unit
        self.machine.install(name, unit)

    def write(self, rest: str, endpoint: str = "") -> None:
        """Return the path of the settings file."""
        self.machine.write(FILE, f'endpoints = ["{endpoint or self.ground.endpoint}"]\n{rest}')

    def start(self) -> None:
        """Wait until systemd reports the service as running."""
        code, _ = self.machine.run("systemctl", "start", UNIT)
        assert code == 0, "\n".join(text for _, text in self.said())

    def fail_to_start(self) -> None:
        """Wait until systemd reports the service as stopped."""
        assert self.machine.run("systemctl", "start", UNIT)[0] != 0

    def property(self, name: str) -> str:
        return self.machine.property(name, UNIT)

    def turning(self) -> bool:
        return any(self._line.controller.outputs)

    def drive(self) -> int:
        """Drive until the wheels turn; return the daemon's process id inside the container."""
        pid = int(self.property("MainPID"))  # first, because a demand expires soon
        self.ground.wait(lambda: self.turning() or self._ahead(), "the wheels turn", WITHIN)
        return pid

    def drive_and_send(self, signal: str) -> int:
        """Send a signal to the daemon while the wheels turn; return the daemon's process id."""
        while True:  # the short watchdog may have killed the process meanwhile
            pid = self.drive()
            if pid and self.machine.run("bash", "-c", f"kill -{signal} {pid}")[0] == 0:
                return pid

    def ask(self, command: int, *params: float) -> None:
        """Send a message once."""
        self.ground.say(CommandLong(1, 1, command, 0, *params, *[0.0] * (7 - len(params))))

    def _ahead(self) -> bool:
        self.ground.demand = Axes(throttle=0.5) if self.ground.armed else Axes()
        if not self.ground.armed:
            self.ask(Command.COMPONENT_ARM_DISARM, 1)
        return False

    def said(self) -> list[tuple[int, str]]:
        """Return priority and text of each line in the journal since the start of this test."""
        return self.machine.journal(UNIT)[self._before :]

    def back(self, killed: int) -> bool:
        """Return whether the service runs again."""
        return self.property("ActiveState") == "active" and self.property("MainPID") not in ("0", str(killed))


@pytest.fixture
def service(machine: Machine) -> Iterator[Service]:
    with Ground() as ground, OnPty(StubbornSabertooth()) as line:
        os.chown(line.path, 0, DIALOUT)
        os.chmod(line.path, 0o660)
        service = Service(machine, ground, line)
        yield service
        machine.run("systemctl", "stop", UNIT)
        machine.run("systemctl", "reset-failed", UNIT)


def test_the_service_is_active_when_ready_drives_and_stops(service: Service) -> None:
    service.start()
    assert service.property("ActiveState") == "active"
    assert service.property("StatusText") == f"system 1, {service.ground.endpoint}"
    service.drive()
    assert service.machine.run("systemctl", "stop", UNIT)[0] == 0
    service.ground.wait(lambda: not service.turning(), "the last bytes have come through the line", WITHIN)
    assert service.property("Result") == "success"
    assert (6, "vehicle: stopped by SIGTERM, motors neutral") in service.said()
    logs = list(service.machine.path(f"{STATE}/logs").iterdir())
    assert logs
    assert all(log.stat().st_size > 0 for log in logs)


def test_safe_stop_stops_the_wheels_after_a_kill_and_it_restarts(service: Service) -> None:
    service.start()
    killed = service.drive_and_send("KILL")
    stopped_by_safe_stop(service, killed)


def test_after_a_hang_the_watchdog_does_the_same(service: Service) -> None:
    service.watch("")
    service.start()
    hung = service.drive_and_send("STOP")
    stopped_by_safe_stop(service, hung)
    assert any(text.startswith("rover.service: Watchdog timeout") for _, text in service.said())


def stopped_by_safe_stop(service: Service, ended: int) -> None:
    """A restart does not move the rover: the demand continues, but the new daemon is not armed."""
    service.ground.wait(lambda: not service.turning(), "the wheels stand", WITHIN)
    service.ground.wait(lambda: service.back(ended), "it runs again", WITHIN)
    assert (6, "mavhelm vehicle safe-stop: sabertooth: motors neutral and without power") in service.said()
    assert not service.turning()


def test_a_mistake_in_the_file_is_in_the_journal_and_not_retried(service: Service) -> None:
    service.write("[motors\n")
    service.fail_to_start()
    assert (service.property("SubState"), service.property("NRestarts")) == ("failed", "0")
    assert (service.property("ExecMainStatus"), service.property("Result")) == ("2", "exit-code")
    mistake = [
        priority for priority, text in service.said() if text.startswith(f"mavhelm vehicle: {FILE}: Expected ']'")
    ]
    assert mistake == [3]


def test_what_may_come_is_tried_again(service: Service) -> None:
    service.write('[motors]\ndriver = "simulated"\n', "udpout:no-such-host.invalid:14550")
    service.fail_to_start()
    service.ground.wait(lambda: int(service.property("NRestarts")) > 1, "it is tried again", WITHIN)


def test_a_damaged_parameter_file_is_said_and_forbids_to_arm(service: Service) -> None:
    service.start()
    service.machine.run("systemctl", "stop", UNIT)
    service.machine.write(f"{STATE}/parameters", "garbage")
    service.start()
    service.ground.wait(lambda: any("PreArm: parameter file damaged" in text for text in tried(service)), "no", WITHIN)
    assert not service.ground.armed
    assert any(priority == 4 and "parameter file damaged" in text for priority, text in service.said())
    service.machine.run("systemctl", "stop", UNIT)
    service.machine.path(f"{STATE}/parameters.damaged").unlink()


def tried(service: Service) -> list[str]:
    """Return the vehicle's texts after one more attempt to arm."""
    service.ask(Command.COMPONENT_ARM_DISARM, 1)
    return service.ground.texts()


POWER = {"reboot": 1, "poweroff": 2}
"""What the computer shall do -> the parameters of PREFLIGHT_REBOOT_SHUTDOWN."""


@pytest.mark.parametrize("word", POWER)
def test_the_computer_does_what_a_ground_station_asks(service: Service, word: str) -> None:
    """Use empty targets here: they become active, and the machine continues."""
    service.write('[motors]\ndriver = "simulated"\n[params]\nREBOOT_ENABLE = 2\n')
    service.install(UNIT, "--config", FILE)
    for each in POWER:
        service.machine.install(f"{each}.target", "[Unit]\nDescription=nothing\n")
        service.machine.run("systemctl", "stop", f"{each}.target")
        service.install(f"rover-{each}.service", "--power", each)
    service.start()
    service.ground.arm()

    def asked() -> bool:
        service.ask(Command.COMPONENT_ARM_DISARM, 0)
        service.ask(Command.PREFLIGHT_REBOOT_SHUTDOWN, 0, POWER[word])
        return service.machine.property("ActiveState", f"{word}.target") == "active"

    service.ground.wait(asked, f"systemd is told to {word}", WITHIN)
    assert service.property("ActiveState") == "failed"  # not restarted
    for each in POWER:
        assert (service.machine.property("ActiveState", f"{each}.target") == "active") is (each == word)
