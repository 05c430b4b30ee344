"""Rows about the computer: each state that systemd, the kernel and the disk can report has its finding."""

from __future__ import annotations

import pytest

from link.runtime.diagnosis import Finding, Health
from vehicle.cli.check import CheckResult
from vehicle.cli.doctor import device_rows, host_rows
from vehicle.cli.doctor.facts import Clock, Device, Space, VehicleDoctorFacts
from vehicle.cli.doctor.gather import parse_properties, read_clock
from vehicle.readings import ComputerReadings

LOADED = "LoadState=loaded\nUnitFileState=enabled\nNRestarts=0\nExecMainStatus=0\n"
"""As `systemctl show` of systemd 252 prints it."""


def facts(**given: object) -> VehicleDoctorFacts:
    """Facts of a computer without faults, but for those given."""
    usual: dict[str, object] = {
        "path": "rover.toml",
        "user": "pi",
        "checks": (CheckResult("settings", True, "rover.toml"),),
        "health": ComputerReadings(temperature=48.0, under_voltage=False, throttled=False),
        "clock": Clock(2026, True),
    }
    return VehicleDoctorFacts(**(usual | given))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("text", "health", "word"),
    [
        (f"{LOADED}ActiveState=active\nSubState=running\n", Health.OK, "runs"),
        (
            "LoadState=loaded\nUnitFileState=disabled\nActiveState=active\nSubState=running\n",
            Health.WARNING,
            "not start",
        ),
        (f"{LOADED}ActiveState=failed\nSubState=failed\n", Health.FAULT, "has failed"),
        (f"{LOADED}ActiveState=activating\nSubState=auto-restart\n", Health.FAULT, "ends and restarts"),
        (f"{LOADED}ActiveState=inactive\nSubState=dead\n", Health.UNKNOWN, "inactive"),
        ("LoadState=not-found\nActiveState=inactive\nSubState=dead\n", Health.UNKNOWN, "no rover.service"),
    ],
)
def test_the_service(text: str, health: Health, word: str) -> None:
    found = host_rows.service(facts(service=parse_properties(text)))
    assert found.health is health
    assert word in found.evidence


@pytest.mark.parametrize(
    ("readings", "health"),
    [
        (ComputerReadings(temperature=48.0, under_voltage=False), Health.OK),
        (ComputerReadings(temperature=48.0, under_voltage=True), Health.FAULT),
        (ComputerReadings(temperature=81.0, under_voltage=False), Health.WARNING),
        (ComputerReadings(temperature=86.0, under_voltage=False), Health.FAULT),
        (ComputerReadings(temperature=48.0, under_voltage=False, throttled=True), Health.WARNING),
        (ComputerReadings(temperature=48.0), Health.UNKNOWN),
    ],
)
def test_the_power(readings: ComputerReadings, health: Health) -> None:
    assert host_rows.power(facts(health=readings, params={"FS_PI_TEMP": 85.0})).health is health


@pytest.mark.parametrize(
    ("clock", "health"),
    [
        (Clock(2026, True), Health.OK),
        (Clock(2026, False), Health.WARNING),
        (Clock(2026, None), Health.UNKNOWN),
        (Clock(1970, True), Health.WARNING),
    ],
)
def test_the_clock(clock: Clock, health: Health) -> None:
    assert host_rows.clock(facts(clock=clock)).health is health


def test_the_kernel_tells_the_state_of_its_clock() -> None:
    assert read_clock().year >= 2026
    assert read_clock().synchronized is not None


@pytest.mark.parametrize(("free", "health"), [(600e6, Health.OK), (400e6, Health.WARNING), (7e6, Health.FAULT)])
def test_the_disk(free: float, health: Health) -> None:
    spaces = (Space("/var/lib/mavhelm", 10**9), Space("/mnt/logs", int(free)))
    found = host_rows.disk(facts(spaces=spaces, params={"LOG_FILE_MB_FREE": 500.0}))
    assert found.health is health
    assert "/mnt/logs" in found.evidence


PORT = "/dev/ttyAMA0"


@pytest.mark.parametrize(
    ("port", "active", "finding"),
    [
        (Device(PORT), "inactive", Finding(Health.OK, f"{PORT} is there and free")),
        (Device(PORT, holder="vehicle (pid 4)"), "active", Finding(Health.UNKNOWN, "in use by the vehicle that runs")),
        (Device(PORT, holder="agetty (pid 4)"), "active",
         Finding(Health.FAULT, f"{PORT} is open in agetty (pid 4)", device_rows.CONSOLE)),
        (Device(PORT, console=True), "active",
         Finding(Health.FAULT, f"{PORT}: the kernel writes its messages there (console=)", device_rows.CONSOLE)),
    ],
)  # fmt: skip
def test_a_serial_port(port: Device, active: str, finding: Finding) -> None:
    assert device_rows.serial_ports(facts(serial=(port,), service={"ActiveState": active})) == finding


def test_a_device_that_this_user_may_not_open_names_its_group() -> None:
    refused = Device("/dev/i2c-1", group="i2c", allowed=False)
    assert device_rows.permissions(facts(buses=(refused,), serial=(Device(PORT),))) == Finding(
        Health.FAULT, "pi may not open /dev/i2c-1", "sudo usermod -aG i2c $USER, then log in again"
    )
    unused = Device("/dev/gpiochip0", group="gpio", allowed=False)
    assert device_rows.permissions(facts(gpio=(unused,))).health is Health.OK
    assert device_rows.permissions(facts(gpio=(unused,), pins=("GPIO 5",))).health is Health.FAULT


def test_pins_need_their_controller() -> None:
    assert device_rows.pins(facts(pins=("GPIO 5",))).health is Health.FAULT
    assert device_rows.pins(facts(pins=("GPIO 5",), simulated_pins=True)).health is Health.OK
    found = device_rows.pins(facts(pins=("GPIO 5",), gpio=(Device("/dev/gpiochip0"),)))
    assert found == Finding(Health.OK, "GPIO 5: each is used once")
    assert device_rows.pins(facts(buses=(Device("/dev/i2c-1", present=False),))).health is Health.FAULT
