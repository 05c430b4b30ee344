"""`mavhelm record`: what is in the file, when it ends, and a file that cannot be written."""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mav

from dialects.messages import StatusText
from groundstation.verbs.common.exit_codes import ExitCode
from groundstation.verbs.messages.record import FileRecording
from link.tlog.tlog import read_records
from tests.fakes.services import foreign_vehicle
from tests.groundstation.verbs.verb_runs import run_verb
from tests.link.frames import heartbeat
from tests.ports import free_port
from tests.waits import wait_until

Capture = pytest.CaptureFixture[str]


def ids(path: Path) -> set[tuple[int, int, int]]:
    """System, component and message id of each record."""
    raws = [record.raw for record in read_records(path.read_bytes())]
    return {(raw[5], raw[6], int.from_bytes(raw[7:10], "little")) for raw in raws}


def test_what_is_heard_and_sent_is_in_the_file(capsys: Capture, tmp_path: Path) -> None:
    out = tmp_path / "out.tlog"
    with foreign_vehicle() as vehicle:
        ended = run_verb(capsys, "record", str(out), "--for", "1.2", "-e", vehicle.endpoint, "--json")
    assert ended.code == ExitCode.DONE
    assert {(1, 1, 0), (254, 25, 0)} <= ids(out), "its HEARTBEAT and ours"
    [record] = ended.records
    heard = [each for each in read_records(out.read_bytes()) if each.raw[5] == 1]
    assert (record["file"], record["messages"], record["sources"]) == (str(out), len(heard), "1/1")


def test_a_file_that_exists_is_kept_without_yes(capsys: Capture, tmp_path: Path) -> None:
    out = tmp_path / "out.tlog"
    out.write_bytes(b"drive of yesterday")
    with foreign_vehicle() as vehicle:
        words = ("record", str(out), "--for", "0.6", "-e", vehicle.endpoint)
        refused = run_verb(capsys, *words)
        assert (refused.code, out.read_bytes()) == (ExitCode.USAGE, b"drive of yesterday")
        assert f"{out}: exists already; --yes overwrites it" in refused.err
        assert run_verb(capsys, *words, "--yes").code == ExitCode.DONE
    assert (1, 1, 0) in ids(out)


def test_a_full_disk_is_one_line_and_a_code(capsys: Capture) -> None:
    with foreign_vehicle() as vehicle:
        ended = run_verb(capsys, "record", "/dev/full", "--yes", "-e", vehicle.endpoint)
    assert ended.code == ExitCode.PARTLY
    assert ended.err.splitlines()[1:] == ["mavhelm: /dev/full: No space left on device; nothing was recorded"]


@pytest.mark.parametrize("name", ["nowhere/out.tlog", "."])
def test_a_file_that_cannot_be_made_is_named_before_a_link_opens(capsys: Capture, tmp_path: Path, name: str) -> None:
    ended = run_verb(capsys, "record", str(tmp_path / name), "-e", "udpin:127.0.0.1:1")
    assert ended.code == ExitCode.USAGE
    assert len(ended.err.splitlines()) == 1
    assert str(tmp_path) in ended.err


def test_when_nothing_is_heard_there_is_no_file(capsys: Capture, tmp_path: Path) -> None:
    words = ("record", str(tmp_path / "out.tlog"), "--for", "0.2", "-e", f"udpout:127.0.0.1:{free_port()}")
    ended = run_verb(capsys, *words)
    assert ended.code == ExitCode.NO_VEHICLE
    assert "nothing was heard" in ended.err
    assert os.listdir(tmp_path) == []


def test_ctrl_c_ends_it_in_order(tmp_path: Path) -> None:
    out = tmp_path / "out.tlog"
    with foreign_vehicle() as vehicle:
        command = [sys.executable, "-m", "groundstation", "record", str(out), "-e", vehicle.endpoint]
        program = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        wait_until(lambda: out.exists() and out.stat().st_size > 0)
        vehicle.send(mav.MAVLink_statustext_message(6, b"the last one"))
        wait_until(lambda: any(number == StatusText.id for _, _, number in ids(out)))
        program.send_signal(signal.SIGINT)
        printed, _ = program.communicate(timeout=60)
    assert program.returncode == 128 + signal.SIGINT
    assert printed.startswith(f"{out}: ")
    assert " messages of 1/1 in " in printed


def test_only_what_is_in_the_file_is_counted(tmp_path: Path) -> None:
    path, before = tmp_path / "cut.tlog", resource.getrlimit(resource.RLIMIT_FSIZE)
    recording = FileRecording(str(path), (254, 25))
    recording.open()
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, before[1]))  # as on a disk that is full then
    try:
        recording.recorder.add(1.0, [heartbeat(number, 1, 1) for number in range(100)])
        recording.close()
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    written = list(read_records(path.read_bytes()))
    assert recording.recorder.failure == "File too large"
    assert 0 < recording.heard.total() == len(written) < 100
