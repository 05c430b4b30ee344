"""Verbs through a station that runs, with our real simulated vehicle: one owner of the links, one driver."""

from __future__ import annotations

import operator
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from groundstation.station_socket.connect import running_stations
from groundstation.verbs.common.exit_codes import ExitCode
from link.tlog.tlog import read_records
from tests.e2e.programs import Vehicle
from tests.groundstation.ros1.stand_in import StandIn
from tests.groundstation.screen import Screen
from tests.groundstation.verbs.shell import complete
from tests.groundstation.verbs.verb_runs import VerbRun, run_verb, start_demanding
from tests.ports import free_port
from tests.waits import PATIENCE, Waits, wait_until

pytestmark = [pytest.mark.e2e, pytest.mark.xdist_group("verbs through a station")]
Capture = pytest.CaptureFixture[str]
NOISE = 0.4
"""s of a busy machine that the kernel does not count as waiting."""
VERBS = 20
"""In a row: what each of them leaks counts so often."""
DEMAND = ("send", "MANUAL_CONTROL", "x=400", "--rate", "20", "--for", "60", "--yes")


@pytest.fixture(scope="module")
def station() -> Iterator[int]:
    """The process id of a station without a screen."""
    command = [sys.executable, "-m", "groundstation", "serve", "--headless", f"udpin:127.0.0.1:{PORT}"]
    process = subprocess.Popen(command, stderr=subprocess.DEVNULL)
    wait_until(lambda: running_stations() == [process.pid], f"no station {process.pid}, but {running_stations()}")
    yield process.pid
    process.terminate()
    assert process.wait(PATIENCE) == 0


@pytest.fixture(scope="module")
def vehicle(station: int, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Vehicle]:
    process = Vehicle(tmp_path_factory.mktemp("vehicle"), PORT, "--param", "FS_TIMEOUT=10")
    wait_until(lambda: "ready" in process.errors.read_text(), "the vehicle does not start")
    yield process
    process.end()


@pytest.fixture
def verb(capsys: Capture, vehicle: Vehicle) -> Iterator[Run]:
    run = Run(capsys)
    yield run
    run("disarm")


class Run:
    """Runs `mavhelm words` without an endpoint."""

    def __init__(self, capsys: Capture) -> None:
        self._capsys = capsys

    def __call__(self, *words: str) -> VerbRun:
        return run_verb(self._capsys, *words)


PORT = free_port()


def test_verbs_need_no_endpoint_and_are_one_ground_station(verb: Run, vehicle: Vehicle) -> None:
    first = verb("status", "--json")
    assert first.records, (first, vehicle.errors.read_text())
    assert first.records[0]["vehicle"] == 1
    assert verb("arm", "--wait", "20").code == 0
    assert verb("control", "show", "--json").records[0]["gcs_main"] == 255
    assert verb("mode", "HOLD").code == 0
    assert verb("status", "--json").records[0]["mode"] == "HOLD"
    assert verb("param", "set", "WP_RADIUS", "1.5").code == 0
    assert verb("param", "get", "WP_RADIUS", "--json").records[0]["param_value"] == 1.5
    # The station counts its links once a second, and all of this may take less.
    wait_until(lambda: verb("links", "--for", "0.1", "--json").records[0]["frames"] > 10, "no frames are counted")
    assert verb("disarm").code == 0
    assert verb("mode", "NOWHERE").code == ExitCode.REFUSED
    assert verb("arm", "-v", "9", "--wait", "0.3").code == ExitCode.NO_VEHICLE
    assert verb("watch", "HEARTBEAT.system_status", "--until", "==99", "--timeout", "0.3").code == ExitCode.DIFFERS


def test_what_the_station_hears_can_be_recorded(verb: Run, tmp_path: Path) -> None:
    for number in range(10):  # again, if a busy machine has not heard the vehicle in that time
        out = tmp_path / f"{number}.tlog"
        [record] = verb("record", str(out), "--for", "3", "--json").records
        if record["messages"] > 10:
            break
    heard = list(read_records(out.read_bytes()))
    assert {(each.raw[5], each.raw[6]) for each in heard} == {(1, 1)}
    assert len(heard) == record["messages"] > 10


def test_a_full_disk_of_the_shell_ends_a_recording(verb: Run) -> None:
    ended = verb("record", "/dev/full", "--yes", "--station", "only")
    assert ended.code == ExitCode.PARTLY
    assert ended.err.splitlines()[1:] == ["mavhelm: /dev/full: No space left on device; nothing was recorded"]


def test_a_node_of_ros_drives_until_its_shell_is_killed(verb: Run, vehicle: Vehicle, tmp_path: Path) -> None:
    node = StandIn(tmp_path)
    words = ("ros1", "--python", str(node.python), "--arm", "--max-speed", "1", "--max-turn", "1", "--wait", "30")
    command = [sys.executable, "-m", "groundstation", *words, "--station", "only"]
    shell = subprocess.Popen(command, stderr=subprocess.DEVNULL)
    try:
        node.ready()
        wait_until(lambda: verb("status", "--json").records[0]["armed"] is True, "it does not arm")

        def drives() -> bool:
            node.word("stop")
            node.word("forward")
            return vehicle.turning()

        wait_until(drives, "the wheels do not turn")
        wait_until(lambda: bool(node.told()), "no telemetry reaches the node")
        shell.kill()
        wait_until(vehicle.stands, "the wheels turn on")
    finally:
        shell.kill()
        shell.wait(PATIENCE)
        node.close()


def test_files_are_those_of_the_shell_and_not_of_the_station(
    verb: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)  # the station was started elsewhere
    assert verb("param", "save", "all.param", "WP_*").code == 0
    assert "WP_RADIUS" in (tmp_path / "all.param").read_text()
    assert verb("param", "diff", "all.param").code == 0
    assert verb("param", "save", "all.param").code == ExitCode.USAGE
    assert [each.name for each in tmp_path.iterdir()] == ["all.param"]


def test_a_script_of_keys_is_played_with_the_shells_key_map(
    verb: Run, vehicle: Vehicle, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)  # the station was started elsewhere
    (tmp_path / "my.toml").write_text('[keys]\n"drive.forward" = "e"\n')
    (tmp_path / "run.keys").write_text("0.2 press e\n1.2 release e\n1.4 press e\n1.6 release e\n")
    words = ("drive", "--script", "run.keys", "--config", "my.toml", "--arm", "--wait", "20", "--station", "only")
    began = time.monotonic()
    while "stood still" in (driven := verb(*words)).err:  # again on a late machine, which has ended the demand
        pass
    assert driven.code == 0, driven.err
    assert vehicle.moved_since(began), driven.err
    assert verb("status", "--json").records[0]["armed"] is False


def test_the_vehicle_refuses(verb: Run) -> None:
    assert verb("param", "set", "MAN_TIMEOUT", "77").code == ExitCode.REFUSED


def start_driving(verb: Run, vehicle: Vehicle) -> subprocess.Popen[str]:
    """Start a verb that drives."""

    def prepare() -> None:
        assert verb("arm", "--wait", "20").code == 0
        assert verb("mode", "MANUAL").code == 0

    return start_demanding(DEMAND, vehicle.turning, prepare)


def test_a_demand_drives_and_a_killed_or_stopped_verb_is_neutral(verb: Run, vehicle: Vehicle, station: int) -> None:
    for number, code in ((signal.SIGKILL, -9), (signal.SIGINT, 130), (signal.SIGSTOP, 6)):
        ended, said = end_a_drive(verb, vehicle, station, number)
        while number != signal.SIGSTOP and "stood still for" in said:  # a late machine had ended it before the signal
            ended, said = end_a_drive(verb, vehicle, station, number)
        assert ended == code, said
        if number == signal.SIGSTOP:
            assert "stood still for" in said
            assert "its demand has ended" in said


def end_a_drive(verb: Run, vehicle: Vehicle, station: int, number: signal.Signals) -> tuple[int, str]:
    """Send a signal to a verb that drives; return its code and what it said. The wheels stand in time."""
    wait_until(lambda: not vehicle.turning(), "the wheels turn still")
    process = start_driving(verb, vehicle)
    waits, at = Waits(process.pid, station, vehicle.process.pid), time.monotonic()
    process.send_signal(number)

    def stand() -> bool:
        waits.total()  # of a process that has ended, only what was read before is known
        return not vehicle.turning()

    wait_until(stand, f"the wheels turn after {number.name}")
    fell, _ = vehicle.falls_and_stops_after(at)
    assert fell < 0.45 + NOISE + waits.total(), number
    process.send_signal(signal.SIGCONT)
    _, said = process.communicate(timeout=PATIENCE)
    return process.returncode, said


def test_driving_screen_keeps_out_demands_of_verbs_but_not_stops(verb: Run, vehicle: Vehicle, station: int) -> None:
    process = start_driving(verb, vehicle)
    with Screen.attach(station) as screen:
        _, said = process.communicate(timeout=PATIENCE)
        assert process.returncode == ExitCode.NOT_IN_CONTROL, said
        assert "the second screen drives" in said
        wait_until(lambda: not vehicle.turning(), "the wheels turn still")
        refused = verb(*DEMAND)
        assert (refused.code, "the second screen drives" in refused.err) == (ExitCode.NOT_IN_CONTROL, True)
        screen.hold_forward()
        screen.turn_wheels(vehicle.turning)
        assert verb("stop").code == 0
        wait_until(lambda: not vehicle.turning(), "the wheels turn after stop")


def test_a_shell_completes_names_of_the_station(verb: Run, vehicle: Vehicle, tmp_path: Path) -> None:
    assert verb("param", "set", "WP_RADIUS", "1").code == 0  # the station hears the value
    assert verb("mode", "HOLD").code == 0
    assert complete("mavhelm param get WP_RAD", tmp_path) == {"WP_RADIUS"}
    assert complete("mavhelm status -v ''", tmp_path) == {"1"}
    modes = complete("mavhelm mode ''", tmp_path)
    assert {"HOLD", "RTL"} <= modes
    assert "STABILIZED" not in modes  # of PX4, which a script without a station proposes


def test_station_never_and_only(verb: Run) -> None:
    elsewhere = ("--wait", "0.2", "-e", f"udpin:127.0.0.1:{free_port()}")
    assert verb("status", *elsewhere).code == ExitCode.NO_VEHICLE
    assert verb("status", "--station", "never", "--wait", "0.2", "-e", f"udpin:127.0.0.1:{PORT}").code == ExitCode.USAGE
    assert verb("status", "--station", "only", "-e", "udpout:127.0.0.1:9").code == ExitCode.NO_VEHICLE
    assert verb("status", "-e", f"udpin:127.0.0.1:{PORT}").code == 0
    assert verb("status", "--station", str(os.getpid())).code == ExitCode.USAGE


def test_doctor_and_motor_go_through_the_station(verb: Run, vehicle: Vehicle) -> None:
    rows = {row["row"]: row for row in verb("doctor", "--json", "--station", "only").records if "row" in row}
    assert rows["link"]["health"] in ("ok", "warning"), rows  # a late machine makes a slow round trip
    assert rows["pre_arm"]["health"] == "ok", rows
    began = time.monotonic()
    turned = verb("motor", "1", "10", "--for", "0.5", "--station", "only")
    assert turned.code == 0, turned.err
    assert vehicle.moved_since(began), "the motor did not turn"
    wait_until(lambda: not vehicle.turning(), "the motor turns still")


def test_verbs_in_a_row_leak_nothing(verb: Run, station: int) -> None:
    """A thousand, tried by hand, leak nothing either. The threads for work beside the links may become a few more."""

    def held() -> tuple[int, int]:
        status = Path(f"/proc/{station}/status").read_text()
        threads = next(line for line in status.splitlines() if line.startswith("Threads"))
        return len(os.listdir(f"/proc/{station}/fd")), int(threads.split()[1])

    assert verb("param", "set", "WP_RADIUS", "1").code == 0
    before = held()
    most = [each + VERBS // 2 for each in before]
    for number in range(VERBS):
        assert verb("param", "set", "WP_RADIUS", str(1 + number / 10)).code == 0
    wait_until(lambda: all(map(operator.lt, held(), most)), lambda: f"{held()} descriptors and threads after {before}")
