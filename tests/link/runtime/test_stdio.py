"""Programs whose standard streams are closed, full or asked for what they cannot say. In processes of their own."""

from __future__ import annotations

import logging
import os
import subprocess
import sys
from pathlib import Path

import pytest

from link.runtime import stdio
from link.runtime.stdio import READER_GONE

ROOT = Path(__file__).resolve().parents[3]
LOOK = """
import os, sys
from link.runtime import stdio
stdio.ensure_open()
opened = os.open("kept", os.O_WRONLY | os.O_CREAT)
print("out"); print("err", file=sys.stderr); sys.stdin.read()
os.write(2, b"a line of the log")
sys.stdout.flush()
sys.exit(opened)
"""
"""The next thing that it opens is a file, whose number is its exit code."""


def run(command: list[str], folder: Path, redirect: str = "") -> subprocess.CompletedProcess[bytes]:
    """`python COMMAND` in a shell, which can close what Python's subprocess cannot."""
    return subprocess.run(
        ["sh", "-c", f'exec "$@" {redirect}', "sh", sys.executable, *command],
        capture_output=True,
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(ROOT), "PYTHONIOENCODING": "utf-8", "PYTHONUNBUFFERED": ""},
        timeout=60,
        check=False,
    )


@pytest.mark.parametrize("closed", ["2>&-", ">&- 2>&-", "<&- >&- 2>&-", "<&-", ""])
def test_nothing_opened_takes_the_place_of_a_closed_stream(closed: str, tmp_path: Path) -> None:
    done = run(["-c", LOOK], tmp_path, closed)
    assert done.returncode > 2, done
    assert (tmp_path / "kept").read_bytes() == b""
    assert (b"out" in done.stdout) == (">&- " not in closed)
    assert (b"a line of the log" in done.stderr) == ("2>&-" not in closed)


@pytest.mark.parametrize(
    ("command", "redirect", "code"),
    [
        (["vehicle", "check", "nowhere"], ">&-", 2),
        (["vehicle"], "2>&-", 2),
        (["vehicle", "--nope"], "<&- >&- 2>&-", 2),
        (["link.bridge"], "<&- >&- 2>&-", 2),
        (["groundstation"], "<&- >&- 2>&-", 2),
    ],
)
def test_a_mistake_is_a_mistake_also_where_nobody_is_told(
    command: list[str], redirect: str, code: int, tmp_path: Path
) -> None:
    done = run(["-m", *command], tmp_path, redirect)
    assert done.returncode == code
    assert b"Traceback" not in done.stdout + done.stderr


def test_a_full_disk_behind_the_output_is_one_line(tmp_path: Path) -> None:
    done = run(["-m", "vehicle", "schema"], tmp_path, ">/dev/full")
    assert done.returncode == 1
    assert done.stderr == b"mavhelm vehicle schema: No space left on device\n"


@pytest.mark.parametrize(
    "words",
    [
        ["vehicle", "schema"],
        ["vehicle", "--help"],
        ["vehicle", "--version"],
        ["link.bridge", "--help"],
        ["link.bridge", "doctor"],
        ["groundstation", "--version"],
        ["groundstation", "--help"],
        ["groundstation", "status", "--help"],
        ["groundstation", "completion", "bash"],
        ["groundstation", "config", "show"],
    ],
)
def test_a_reader_that_goes_is_no_error(words: list[str], tmp_path: Path) -> None:
    reader, writer = os.pipe()
    os.close(reader)
    done = subprocess.run(
        [sys.executable, "-m", *words],
        stdout=writer,
        stderr=subprocess.PIPE,
        env=os.environ | {"PYTHONPATH": str(ROOT), "PYTHONUNBUFFERED": ""},
        cwd=tmp_path,
        timeout=60,
        check=False,
    )
    os.close(writer)
    assert done.stderr == b""
    assert done.returncode in (
        {0, READER_GONE} if "--help" in words else {READER_GONE}
    )  # argparse ignores a failed write


def test_help_on_a_full_disk_is_one_line(tmp_path: Path) -> None:
    done = run(["-m", "groundstation", "--version"], tmp_path, ">/dev/full")
    assert (done.returncode, done.stderr) == (1, b"mavhelm: output: No space left on device\n")


def test_another_pipe_that_breaks_is_not_hidden() -> None:
    def run_program() -> int:
        raise BrokenPipeError

    with pytest.raises(BrokenPipeError):
        stdio.run_program("program", run_program)


@pytest.mark.parametrize(
    ("words", "code", "says"),
    [
        ([b"check", b"\xff.toml"], 2, b"\\udcff.toml"),
        ([b"--sim", b"udpout:\xff:14550"], 1, b"host '\\udcff' is not known"),  # a name may be known later
        ([b"--sim", b"--motor-log", b"/nowhere/\xff"], 2, b"motor log /nowhere/\\udcff: No such file"),
    ],
)
def test_a_name_that_is_no_text_is_told(words: list[bytes], code: int, says: bytes, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "vehicle", *words],
        capture_output=True,
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(ROOT), "PYTHONIOENCODING": "utf-8", "PYTHONUNBUFFERED": ""},
        timeout=60,
        check=False,
    )
    assert done.returncode == code
    assert says in done.stdout + done.stderr
    assert (done.stdout + done.stderr).count(b"\n") == 1


def test_a_log_line_has_no_control_characters_and_forges_none() -> None:
    text = "fleet of a\x1b[2J\x1b]0;b\x07\rc\u202e\n2026-01-01 INFO vehicle: all is well"
    record = logging.LogRecord("link", logging.WARNING, __file__, 1, "%s", (text,), None)
    lines = stdio.PlainFormatter("bridge: %(message)s").format(record).split("\n")
    assert all(line.isprintable() for line in lines)
    assert lines[0].startswith(r"bridge: fleet of a\x1b[2J\x1b]0;b\x07\rc\u202e")
    assert lines[1] == "    2026-01-01 INFO vehicle: all is well"
