"""What the vehicle tells of its computer: an id that gives nothing away, the time, and how busy the loop is."""

from __future__ import annotations

from pathlib import Path

import pytest

from dialects import messages as m
from dialects.enums import Command
from tests.vehicle.bench import Bench
from tests.vehicle.ground import Ground, running
from vehicle.params import Params
from vehicle.rover import Rover
from vehicle.runtime.host_info import HostMonitor, read_uid
from vehicle.telemetry.host import HostInfo

MACHINE = "0123456789abcdef0123456789abcdef"
UID = "92b243149fc64d0cb6e4fa9e55479f8b"
"""As `systemd-id128 machine-id --app-specific=...` prints it."""

NEW_YEAR = 1_800_000_000.0
"""Unix time, s."""


def computer(folder: Path, text: bytes | None) -> Path:
    (folder / "etc").mkdir()
    if text is not None:
        (folder / "etc/machine-id").write_bytes(text)
    return folder


def test_the_id_is_that_of_the_computer_and_hides_it(tmp_path: Path) -> None:
    uid = read_uid(computer(tmp_path, f"{MACHINE}\n".encode()))
    assert uid.hex() == UID
    assert uid == read_uid(tmp_path)


@pytest.mark.parametrize(
    "text", [None, b"", b"uninitialized\n", b"0" * 32, b"\xff" * 32, MACHINE.upper().encode(), MACHINE[1:].encode()]
)
def test_what_is_no_id_gives_none(tmp_path: Path, text: bytes | None) -> None:
    assert read_uid(computer(tmp_path, text)) == b""


def with_host(host: HostInfo) -> Bench:
    bench = Bench()
    bench.rover = Rover(Params(), now=bench.now, host=host)
    bench.meet()
    bench.wait(1.1)
    return bench


def test_the_id_is_in_autopilot_version() -> None:
    bench = with_host(HostInfo(uid=bytes.fromhex(UID)))
    bench.command(Command.REQUEST_MESSAGE, m.AutopilotVersion.id)
    told = bench.newest(m.AutopilotVersion)
    assert bytes(told.uid2).hex() == UID + "0000"
    assert f"{told.uid:016x}" == UID[:16]


def test_without_an_id_there_is_none() -> None:
    bench = with_host(HostInfo())
    bench.command(Command.REQUEST_MESSAGE, m.AutopilotVersion.id)
    told = bench.newest(m.AutopilotVersion)
    assert (told.uid, any(told.uid2)) == (0, False)


@pytest.mark.parametrize(("share", "told"), [(0.0, 0), (0.0421, 42), (1.0, 1000)])
def test_the_load_is_in_sys_status(share: float, told: int) -> None:
    bench = with_host(HostInfo(load=share))
    bench.command(Command.REQUEST_MESSAGE, m.SysStatus.id)
    assert bench.newest(m.SysStatus).load == told


def test_the_load_is_what_was_not_waited() -> None:
    host, waited = HostInfo(), 5.0
    meter = HostMonitor(host, lambda: waited, lambda: 0.0, now=100.0)
    waited += 0.5
    meter.update(100.5)
    assert host.load == 0.0  # not yet
    waited += 0.4
    meter.update(101.0)
    assert host.load == pytest.approx(0.1)
    meter.update(102.0)
    assert host.load == 1.0
    waited += 1.1  # clocks are read one after the other
    meter.update(103.0)
    assert host.load == 0.0


def test_the_wall_clock_is_asked_again() -> None:
    """A Pi without a battery for its clock learns the time some seconds or minutes after boot."""
    host, wall = HostInfo(), 5.0
    meter = HostMonitor(host, lambda: 0.0, lambda: wall, now=100.0)
    assert host.unix_time(100.25) == 5.25
    wall = NEW_YEAR
    meter.update(101.0)
    assert host.unix_time(101.5) == NEW_YEAR + 0.5


def test_system_time_follows_it() -> None:
    host = HostInfo()
    bench = with_host(host)
    bench.command(Command.REQUEST_MESSAGE, m.SystemTime.id)
    assert bench.newest(m.SystemTime).time_unix_usec == 0  # nobody knows
    host.epoch = NEW_YEAR - bench.now
    bench.command(Command.REQUEST_MESSAGE, m.SystemTime.id)
    assert bench.newest(m.SystemTime).time_unix_usec == pytest.approx(NEW_YEAR * 1e6, abs=1e6)


@pytest.mark.e2e
def test_the_daemon_knows_its_load(tmp_path: Path) -> None:
    with Ground() as ground, running(tmp_path, "--sim", ground.endpoint) as vehicle:
        vehicle.ready()

        def loads() -> list[int]:
            return [each.load for each in ground.heard if isinstance(each, m.SysStatus)]

        ground.wait(lambda: any(loads()), "a load that is not zero")
        assert max(loads()) <= 1000
