"""The command line: errors before the screen opens are one line with exit code 2, without a traceback."""

from __future__ import annotations

import os
import pty
import re
import socket
import struct
import subprocess
import sys
from collections.abc import Sequence
from fcntl import ioctl
from pathlib import Path
from termios import TIOCSWINSZ

import pytest

from groundstation.cli.main import main
from link.runtime.install_hint import install_command

ROOT = Path(__file__).resolve().parents[3]


def error_line(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    """Run in this process; return the line on stderr."""
    assert main(arguments) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.count("\n") == 1
    assert captured.err.startswith("mavhelm: ")
    return captured.err


def in_terminal(
    arguments: Sequence[str], *, columns: int = 80, rows: int = 24, timeout: float = 60.0
) -> tuple[int, str]:
    """Run in a terminal of this size; return the exit code and everything shown."""
    ours, theirs = pty.openpty()
    ioctl(theirs, TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))
    environment = {key: value for key, value in os.environ.items() if key not in ("COLUMNS", "LINES")}
    command = [sys.executable, "-m", "groundstation", *arguments]
    with subprocess.Popen(command, stdin=theirs, stdout=theirs, stderr=theirs, cwd=ROOT, env=environment) as process:
        os.close(theirs)
        code = process.wait(timeout)
        shown = os.read(ours, 65536)
    os.close(ours)
    return code, shown.decode().replace("\r\n", "\n")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["carrier:pigeon"], "udpin:HOST:PORT"),
        (["udpin:127.0.0.1:0"], "port '0' is not a number from 1 to 65535"),
        (["--keys", "emacs"], "unknown key map 'emacs': choose standard, teleop"),
        (["--keys", "/nowhere/keys.toml"], "no such file: name one of your own"),
        (["udpin:127.0.0.1:14999"], "is not a terminal"),
        (["walk"], "'walk' is not an endpoint such as udpin:127.0.0.1:14550 (mavhelm --help lists them)"),
        (["help"], "'help' is not an endpoint: did you mean --help?"),
        (["sitl"], "'sitl' is not an endpoint: did you mean --sitl?"),
        (["udpin:127.0.0.1:14550", "param", "get"], "'param' is a verb: write it first, and the endpoint behind -e"),
        (["learn", "five"], "'five' is neither a lesson file nor a number: `mavhelm learn list`"),
        (["--sitl", "udpin"], "'udpin' is not an endpoint such as udpin:127.0.0.1:14550"),
    ],
)
def test_mistakes_are_one_line(capsys: pytest.CaptureFixture[str], arguments: list[str], words: str) -> None:
    assert words in error_line(capsys, *arguments)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--fly"], "unrecognized arguments: --fly"),
        (["--stil"], "unrecognized arguments: --stil: did you mean --sitl?"),
        (["--master", "udp:127.0.0.1:14550"], "--master: write the endpoint without an option, e.g. udpin:"),
        (["--master=udp:127.0.0.1:14550"], "write the endpoint without an option, e.g. udpin:"),
        (["--baud", "57600"], "write serial:PATH:BAUD"),
        (["--style", "wild"], "invalid choice: 'wild'"),
        (["--speed", "2"], "'2' is not a number from 0.1 to 1"),
        (["--speed", "nan"], "'nan' is not a number from 0.1 to 1"),
        (["--speed", "fast"], "'fast' is not a number"),
        (["--system", "256"], "'256' is not a number from 1 to 255"),
        (["attach", "abc"], "'abc' is not the number of a process"),
        (["mode", "HOLD", "udpin:127.0.0.1:1"], "arguments: udpin:127.0.0.1:1: write -e udpin:127.0.0.1:1"),
        (["mode", "HOLD", "twice"], "unrecognized arguments: twice (mavhelm mode --help"),
        (["--system", "-1"], "'-1' is not a number from 1 to 255"),
    ],
)
def test_wrong_options(capsys: pytest.CaptureFixture[str], arguments: list[str], words: str) -> None:
    with pytest.raises(SystemExit) as caught:
        main(arguments)
    assert caught.value.code == 2
    error = capsys.readouterr().err
    assert words in error
    assert re.match(r"mavhelm( attach| mode)?: ", error)
    assert error.count("\n") == 1


def test_help_teaches(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        main(["--help-all"])
    assert caught.value.code == 0
    text = capsys.readouterr().out
    for word in (
        "mavhelm --sitl",
        "udpin:HOST:PORT",
        "teleop",
        "hold `r` for a second to arm",
        '"drive.forward" = ["e", "up"]',
        "key→motor: time",
        "inside tmux",
        "128 + n after signal n",
    ):
        assert word in text


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["--version"])
    assert capsys.readouterr().out.startswith("mavhelm 0.")


@pytest.mark.e2e
def test_a_terminal_that_is_far_too_small() -> None:
    code, shown = in_terminal(["udpin:127.0.0.1:14999"], columns=30, rows=8)
    assert code == 2
    assert shown == "mavhelm: the terminal is 30x8: make it at least 40x10, better 80x24\n"


@pytest.mark.e2e
def test_a_port_in_use_is_reported_before_the_screen_opens() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        code, shown = in_terminal([f"udpin:127.0.0.1:{taken.getsockname()[1]}"])
    assert code == 2
    assert "is in use" in shown
    assert shown.count("\n") == 1
    assert "\x1b" not in shown


@pytest.mark.e2e
def test_a_log_file_that_cannot_be_written() -> None:
    code, shown = in_terminal(["--log-file", "/nowhere/station.log"])
    assert code == 2
    assert shown == "mavhelm: log file /nowhere/station.log: No such file or directory\n"


@pytest.mark.e2e
def test_texts_of_parameters_that_cannot_be_read() -> None:
    code, shown = in_terminal(["--param-docs", "/nowhere/apm.pdef.xml"])
    assert code == 2
    assert "mavhelm: --param-docs /nowhere/apm.pdef.xml: No such file or directory" in shown


@pytest.mark.e2e
def test_a_pipe_for_a_log_file_is_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "station.log")
    code, shown = in_terminal(["--log-file", str(tmp_path / "station.log")])
    assert code == 2
    assert shown == f"mavhelm: log file {tmp_path}/station.log: a pipe; name a file\n"


def test_a_gamepad_without_its_packages_is_one_line(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("groundstation.gamepad.child.PACKAGES", ("no_such_package",))
    monkeypatch.setattr("groundstation.cli.console.check_terminal", lambda: None)
    assert install_command("gamepad") in error_line(capsys, "--gamepad", "any", "udpin:127.0.0.1:14999")


@pytest.mark.parametrize("before", [("-q",), ("--json", "--quiet")])
def test_options_of_all_verbs_may_stand_before_the_verb(
    before: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([*before, "export", "none.tlog", "--csv", "out"]) == 2
    assert "none.tlog: no such file" in capsys.readouterr().err
