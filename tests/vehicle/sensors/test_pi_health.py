from __future__ import annotations

import os
from pathlib import Path

import pytest

from vehicle.readings import ComputerReadings
from vehicle.sensors.pi_health import PiHealth

THROTTLED = "sys/devices/platform/soc/soc:firmware/get_throttled"


@pytest.fixture
def pi(tmp_path: Path) -> Path:
    files = {
        "sys/class/thermal/thermal_zone0/temp": "51540\n",
        THROTTLED: "0\n",
        "proc/loadavg": "1.20 0.58 0.59 1/389 12345\n",
        "proc/meminfo": "MemTotal:   8000000 kB\nMemFree: 10 kB\nMemAvailable:  6000000 kB\nHugePages_Total: 0\n",
        "proc/uptime": "350735.47 234388.90\n",
    }
    for name, text in files.items():
        write(tmp_path, name, text)
    return tmp_path


def write(root: Path, name: str, text: str) -> None:
    (root / name).parent.mkdir(parents=True, exist_ok=True)
    (root / name).write_text(text)


def test_everything_at_once(pi: Path) -> None:
    assert PiHealth(pi).sample() == ComputerReadings(
        temperature=51.54,
        load=1.2 / (os.cpu_count() or 1),
        memory_used=2_000_000 * 1024,
        memory_total=8_000_000 * 1024,
        uptime=350735.47,
        under_voltage=False,
        throttled=False,
    )


@pytest.mark.parametrize(
    ("text", "under_voltage", "throttled"),
    [
        ("0", False, False),
        ("1", True, False),
        ("0x50005", True, True),
        ("50000", False, False),  # only some time ago
        ("2", False, True),
        ("4", False, True),
        ("8", False, True),
        ("f", True, True),
    ],
)
def test_the_bits_of_get_throttled(pi: Path, text: str, under_voltage: bool, throttled: bool) -> None:
    write(pi, THROTTLED, text)
    computer = PiHealth(pi).sample()
    assert (computer.under_voltage, computer.throttled) == (under_voltage, throttled)


def test_a_pi_5_has_another_name_for_it(pi: Path) -> None:
    (pi / THROTTLED).unlink()
    write(pi, "sys/devices/platform/soc@107c000000/soc@107c000000:firmware/get_throttled", "1\n")
    assert PiHealth(pi).sample().under_voltage is True


@pytest.mark.parametrize(("alarm", "under_voltage"), [("1\n", True), ("0\n", False)])
def test_the_voltage_monitor_of_other_kernels(pi: Path, alarm: str, under_voltage: bool) -> None:
    (pi / THROTTLED).unlink()
    write(pi, "sys/class/hwmon/hwmon0/name", "cpu_thermal\n")
    write(pi, "sys/class/hwmon/hwmon1/name", "rpi_volt\n")
    write(pi, "sys/class/hwmon/hwmon1/in0_lcrit_alarm", alarm)
    computer = PiHealth(pi).sample()
    assert (computer.under_voltage, computer.throttled) == (under_voltage, None)


def test_a_computer_without_any_of_it(tmp_path: Path) -> None:
    assert PiHealth(tmp_path).sample() == ComputerReadings()


@pytest.mark.parametrize("rubbish", ["", "\n", "hot", "-", "\0" * 10])
def test_rubbish_is_not_known(pi: Path, rubbish: str) -> None:
    for file in [path for path in pi.rglob("*") if path.is_file()]:
        file.write_text(rubbish)
    assert PiHealth(pi).sample() == ComputerReadings()


def test_this_computer_is_read_too() -> None:
    computer = PiHealth().sample()
    assert computer.uptime is not None
    assert computer.memory_total is not None
    assert computer.memory_used is not None
    assert 0 < computer.memory_used < computer.memory_total
