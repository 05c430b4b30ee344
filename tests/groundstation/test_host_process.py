"""The process that is started before its arguments are known: what it gets, and its end without them."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from groundstation.client import StationClient, StationError
from groundstation.host_process import MAX_ARGUMENTS, STATION, ArgumentsError, HostProcess, read_arguments
from link.runtime.local_socket import open_pair

WITHIN = 20.0
"""s for a process to import its modules and end, on a busy machine."""


@pytest.fixture
def process() -> Iterator[HostProcess]:
    started = HostProcess(STATION)
    yield started
    started.end()


@pytest.mark.parametrize(
    "arguments", [["--system=255"], ["", "--", "a b", "new\nline", "ü"], [os.fsdecode(b"/tmp/\xff.log")]]
)
def test_arguments_arrive_as_they_are(process: HostProcess, arguments: list[str]) -> None:
    ours, theirs = open_pair()
    with ours, theirs:
        pipe, process.pipe = process.pipe, ours
        process.send_arguments(arguments)
        process.pipe = pipe
        assert read_arguments(theirs) == arguments


def test_no_arguments_come_from_an_end_that_is_closed() -> None:
    ours, theirs = open_pair()
    ours.close()
    with theirs:
        assert read_arguments(theirs) is None


@pytest.mark.parametrize(
    ("arguments", "words"),
    [(["--log-file=a\0--keep"], "a setting has a zero byte in it"),
     (["x" * MAX_ARGUMENTS, "y"], f"have {MAX_ARGUMENTS + 2} bytes, more than {MAX_ARGUMENTS}")],
)  # fmt: skip
def test_what_cannot_be_sent_is_refused(process: HostProcess, arguments: list[str], words: str) -> None:
    with pytest.raises(ArgumentsError) as caught:
        process.send_arguments(arguments)
    assert words in str(caught.value)


@pytest.mark.e2e
def test_a_setting_that_cannot_be_sent_is_one_line_for_the_user() -> None:
    with pytest.raises(StationError, match="zero byte"):
        StationClient.start(["udpin:127.0.0.1:0"], sign_key="a\0b")


@pytest.mark.e2e
def test_it_ends_with_a_screen_that_never_gave_it_arguments(process: HostProcess) -> None:
    process.pipe.close()
    assert process.process.wait(WITHIN) == 0


@pytest.mark.e2e
def test_end_ends_it_once_and_not_after_release(process: HostProcess) -> None:
    pipe, watchdog, running = process.release()
    process.end()
    assert running.poll() is None
    pipe.close()
    assert watchdog is not None
    watchdog.close()
    assert running.wait(WITHIN) == 0


@pytest.mark.e2e
@pytest.mark.parametrize(("option", "code"), [("--help", 0), ("--version", 0), ("--no-such-option", 2)])
def test_a_command_line_that_opens_no_screen_leaves_no_process(option: str, code: int) -> None:
    program = subprocess.Popen(
        [sys.executable, "-m", "groundstation", option],
        stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True,
    )  # fmt: skip
    assert program.wait(WITHIN) == code
    assert _session(program.pid) == []


def _session(number: int) -> list[str]:
    """Return the programs of a session."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            fields = (folder / "stat").read_text().rpartition(")")[2].split()
            if int(fields[3]) == number:
                found.append((folder / "cmdline").read_text())
        except OSError:  # it has ended meanwhile
            continue
    return found
