"""`mavhelm ftp` and `log` with a vehicle as ArduPilot behaves, on real sockets."""

from __future__ import annotations

import random
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from groundstation.verbs.common.exit_codes import ExitCode
from link.services.ftp.protocol import crc32
from tests.fakes.services import PX4, ForeignVehicle, foreign_vehicle
from tests.groundstation.verbs.verb_runs import VerbRun, run_verb
from tests.waits import PATIENCE

Capture = pytest.CaptureFixture[str]
LOG_ERASE = 121
DATA = random.Random(5).randbytes(60_000)


@pytest.fixture
def vehicle() -> Iterator[ForeignVehicle]:
    with foreign_vehicle() as running:
        assert running.files is not None
        running.files.files = {"/logs/1.bin": DATA, "/logs/2.bin": b"", "/scripts/a.lua": b"-- a"}
        running.logs[:] = [DATA[:5000], DATA]
        yield running


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def verb(capsys: Capture, vehicle: ForeignVehicle, *arguments: str) -> VerbRun:
    return run_verb(capsys, *arguments, "-e", vehicle.endpoint, "-v", "1")


def test_list_get_put_remove_and_compare(capsys: Capture, vehicle: ForeignVehicle, here: Path) -> None:
    assert vehicle.files is not None
    assert verb(capsys, vehicle, "ftp", "ls", "/logs").out == "     60000  1.bin\n         0  2.bin\n"
    assert verb(capsys, vehicle, "ftp", "get", "/logs/1.bin").code == 0
    assert (here / "1.bin").read_bytes() == DATA
    assert verb(capsys, vehicle, "ftp", "crc", "/logs/1.bin").out == f"{crc32(DATA):08x}\n"
    assert verb(capsys, vehicle, "ftp", "crc", "/logs/1.bin", "1.bin").code == 0
    (here / "b.lua").write_bytes(b"-- b" * 300)
    assert verb(capsys, vehicle, "ftp", "put", "b.lua", "/scripts/b.lua").code == 0
    assert vehicle.files.files["/scripts/b.lua"] == b"-- b" * 300
    differs = verb(capsys, vehicle, "ftp", "crc", "/scripts/a.lua", "b.lua")
    assert differs.code == ExitCode.DIFFERS
    assert verb(capsys, vehicle, "ftp", "rm", "/scripts/b.lua").code == 0
    assert "/scripts/b.lua" not in vehicle.files.files


def test_each_program_gets_answers_to_its_own_requests(capsys: Capture, vehicle: ForeignVehicle, here: Path) -> None:
    """The vehicle repeats its last reply to a request that has the numbers of the last one, as autopilots do."""
    assert vehicle.files is not None
    vehicle.files.files |= {"/a.bin": b"a", "/b.bin": b"b"}
    for name in ("/a.bin", "/b.bin"):
        assert verb(capsys, vehicle, "ftp", "rm", name).code == 0
        assert name not in vehicle.files.files
    assert verb(capsys, vehicle, "ftp", "rm", "/a.bin").code == ExitCode.REFUSED
    assert "1.bin" in verb(capsys, vehicle, "ftp", "ls", "/logs").out


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (["ftp", "get", "/logs/9.bin"], ExitCode.REFUSED, "refused, no such file on the vehicle"),
        (["ftp", "rm", "/logs/9.bin"], ExitCode.REFUSED, "refused, no such file on the vehicle"),
        (["ftp", "put", "a", "@SYS/a"], ExitCode.REFUSED, "refused, the vehicle protects the file"),
        (["ftp", "put", "none", "/a"], ExitCode.USAGE, "none: No such file or directory"),
        (["ftp", "get", "/logs/1.bin", "a"], ExitCode.USAGE, "a: exists already; --yes overwrites it"),
        (["ftp", "get", "/"], ExitCode.USAGE, "'/' names no file"),
        (["log", "get", "7"], ExitCode.DIFFERS, "there is no log 7; there are: 1, 2"),
    ],
)
def test_refusals_are_one_line(
    capsys: Capture, vehicle: ForeignVehicle, here: Path, arguments: list[str], code: int, words: str
) -> None:
    (here / "a").write_bytes(b"a")
    run = verb(capsys, vehicle, *arguments)
    assert run.code == code, run.err
    assert words in run.err
    assert run.err.count("\n") == 1
    assert sorted(path.name for path in here.iterdir()) == ["a"], "nothing half is left"


def test_a_download_goes_on_behind_what_an_interrupted_one_left(
    capsys: Capture, vehicle: ForeignVehicle, here: Path
) -> None:
    (here / "1.bin.part").write_bytes(DATA[:40_000])
    assert verb(capsys, vehicle, "ftp", "get", "/logs/1.bin").code == 0
    assert (here / "1.bin").read_bytes() == DATA
    assert not (here / "1.bin.part").exists()
    bursts = [bytes(message.payload) for message in vehicle.of("FILE_TRANSFER_PROTOCOL")]
    offsets = [int.from_bytes(payload[8:12], "little") for payload in bursts if payload[3] == 15]
    assert min(offsets) == 40_000


def test_what_was_left_of_another_file_is_not_used(capsys: Capture, vehicle: ForeignVehicle, here: Path) -> None:
    (here / "1.bin.part").write_bytes(b"something else" * 100)
    assert verb(capsys, vehicle, "ftp", "get", "/logs/1.bin").code == 0
    assert (here / "1.bin").read_bytes() == DATA


def test_a_killed_download_is_resumed(capsys: Capture, vehicle: ForeignVehicle, here: Path) -> None:
    assert vehicle.files is not None
    big = random.Random(6).randbytes(1_500_000)
    vehicle.files.files["/logs/1.bin"] = big
    command = [sys.executable, "-m", "groundstation", "ftp", "get", "/logs/1.bin", "-e", vehicle.endpoint, "-v", "1"]
    with subprocess.Popen(command, stderr=subprocess.PIPE) as process:
        vehicle.wait_for("FILE_TRANSFER_PROTOCOL", 20)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=PATIENCE)
    assert process.returncode == 128 + signal.SIGINT, errors
    assert b"Traceback" not in errors
    part = (here / "1.bin.part").read_bytes()
    assert 10_000 < len(part) < len(big)
    assert part == big[: len(part)]
    assert verb(capsys, vehicle, "ftp", "get", "/logs/1.bin").code == 0
    assert (here / "1.bin").read_bytes() == big


def test_logs(capsys: Capture, vehicle: ForeignVehicle, here: Path) -> None:
    listed = verb(capsys, vehicle, "log", "list")
    assert listed.out == ("    1  2023-11-14T22:13:21Z       5000\n    2  2023-11-14T22:13:22Z      60000\n")
    assert verb(capsys, vehicle, "log", "get", "latest").code == 0
    assert (here / f"1-00002{'.ulg' if vehicle.autopilot == PX4 else '.bin'}").read_bytes() == DATA
    (here / "b.bin.part").write_bytes(DATA[:3000])
    assert verb(capsys, vehicle, "log", "get", "1", "b.bin").code == 0
    assert (here / "b.bin").read_bytes() == DATA[:5000]
    assert [message.ofs for message in vehicle.of("LOG_REQUEST_DATA")][-1] == 2880  # the last whole piece again


def test_logs_over_a_link_that_loses(capsys: Capture, here: Path) -> None:
    with foreign_vehicle(loss=0.03) as vehicle:
        vehicle.logs[:] = [DATA[:20_000]]
        assert verb(capsys, vehicle, "log", "get", "1").code == 0
        assert (here / "1-00001.bin").read_bytes() == DATA[:20_000]


def test_a_vehicle_without_files_and_logs(capsys: Capture, here: Path) -> None:
    with foreign_vehicle(PX4, ftp=False) as vehicle:
        vehicle.silent.add(117)
        none = verb(capsys, vehicle, "log", "list")
        assert (none.code, "list logs: no answer, after 12 tries" in none.err) == (ExitCode.NO_ANSWER, True)
        assert verb(capsys, vehicle, "ftp", "ls", "--timeout", "2").code == ExitCode.NO_ANSWER


def test_all_logs_are_erased_only_with_yes(capsys: Capture, vehicle: ForeignVehicle) -> None:
    refused = verb(capsys, vehicle, "log", "erase")
    assert (refused.code, refused.err) == (2, "mavhelm: this erases ALL logs of the vehicle; --yes does it\n")
    assert len(vehicle.logs) == 2
    assert verb(capsys, vehicle, "log", "erase", "--yes").code == 0
    assert vehicle.logs == []


def test_a_vehicle_that_keeps_its_logs(capsys: Capture, vehicle: ForeignVehicle) -> None:
    vehicle.silent = {LOG_ERASE}
    kept = verb(capsys, vehicle, "log", "erase", "--yes")
    assert kept.code == ExitCode.REFUSED
    assert "erase all logs: refused, 2 logs are still there" in kept.err
