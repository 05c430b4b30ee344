"""Names that a vehicle, a fleet or a file may have, in real interactive shells: none is expanded, run or an option."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from dialects import codec
from dialects import messages as m
from dialects.enums import Autopilot, VehicleType
from groundstation.station_socket.connect import running_stations
from groundstation.station_socket.names import PARAMS, VEHICLES, find_names, plain_names
from tests.groundstation.verbs.shell import InteractiveShell, skip_without
from tests.ports import free_port
from tests.waits import wait_until

SHELLS = ("bash", "zsh", "fish")
HOSTILE = (
    "$(touch PWNED)", "`touch PWNED`", "a$(touch PWNED)", "$(touch${IFS}PWNED)", "${IFS}", "~root", "a~", "-o",
    "--clear", "-", ";touch PWNED;", "a;touch PWNED", "a|touch PWNED", "a&touch PWNED", "a>PWNED", "<(touch PWNED)",
    "*", "a?", "[a]", "{a,b}", "'", '"', "a'b", "$'a", "\\", "a\\", "a b", "a\tb", "!!", "#a", "=ls", "^a^b", "%1",
    "\x1b[2J", "a\x1b]0;b\x07", "a\rb", "\u202eb", "\u00e4",
)  # fmt: skip
FILES = (*HOSTILE, "a\nb")


@pytest.mark.parametrize("shell", SHELLS)
@pytest.mark.parametrize("line", ["param get", "param set", "mode", "status -v"])
def test_no_hostile_name_gets_into_a_command_line(shell: str, line: str, tmp_path: Path) -> None:
    """The program is replaced by one that filters nothing: the script of the shell is the second gate."""
    skip_without(shell)
    names = [*HOSTILE, *(f"Q{each}" for each in HOSTILE if not plain_names([f"Q{each}"])), "Q_PLAIN"]
    with InteractiveShell(shell, tmp_path, "\n".join(names).encode()) as typed:
        for prefix in ("Q", "Q_", ""):
            assert typed.tab(f"mavhelm {line} {prefix}") == [*line.split(), "Q_PLAIN"]
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("shell", SHELLS)
def test_a_hostile_file_name_arrives_as_one_argument(shell: str, tmp_path: Path) -> None:
    skip_without(shell)
    for number, name in enumerate(FILES):
        (tmp_path / f"{number}").mkdir()
        (tmp_path / f"{number}" / name).touch()
    with InteractiveShell(shell, tmp_path) as typed:
        for number, name in enumerate(FILES):
            folder = tmp_path / f"{number}"
            typed.type(f"cd {folder}; mavhelm ready\n")
            words = typed.tab("mavhelm mission put ")
            assert words[:2] == ["mission", "put"]
            assert words[2:] in _proposals(shell, name), (name, words)
            assert os.listdir(folder) == [name]


def _proposals(shell: str, name: str) -> list[list[str]]:
    """Return what may be proposed for a file: with ./ before its name if that looks like an option."""
    if shell == "fish" and name.startswith("-"):
        return [[]]  # left out
    if shell == "fish" and "\t" in name:
        return [[name.partition("\t")[0]]]  # to fish, what follows a tab describes the word
    return [[f"./{name}"]] if name.startswith("-") else [[name], [f"./{name}"]]


@pytest.fixture
def station() -> Iterator[int]:
    """The port of a station without a screen."""
    port = free_port()
    command = [sys.executable, "-m", "groundstation", "serve", "--headless", f"udpin:127.0.0.1:{port}"]
    with subprocess.Popen(command, stderr=subprocess.DEVNULL) as process:
        wait_until(lambda: process.pid in running_stations(), "no station")
        yield port
        process.terminate()


@pytest.mark.e2e
@pytest.mark.parametrize("shell", SHELLS)
def test_a_vehicle_with_hostile_names_runs_nothing_at_tab(shell: str, station: int, tmp_path: Path) -> None:
    skip_without(shell)
    raw = [name.encode()[:16] for name in HOSTILE]
    messages: list[m.Message] = [
        m.Heartbeat(VehicleType.GROUND_ROVER, Autopilot.ARDUPILOT, 0, 0, 4, 3),
        *(m.ParamValue(name, 1.0, 9, len(raw) + 1, number) for number, name in enumerate([*raw, b"SPEED_MAX"])),
    ]
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        sender.connect(("127.0.0.1", station))

        def heard() -> bool:
            for number, message in enumerate(messages):
                sender.send(codec.frame(type(message).id, codec.encode_payload(message), number, 7, 1))
            return find_names(PARAMS) == ["SPEED_MAX"] and find_names(VEHICLES) == ["7"]

        wait_until(heard, "the station has heard no parameter")
    with InteractiveShell(shell, tmp_path) as typed:
        assert typed.tab("mavhelm param get ") == ["param", "get", "SPEED_MAX"]
        assert typed.tab("mavhelm status -v ") == ["status", "-v", "7"]
    assert not list(tmp_path.iterdir())


def test_only_plain_names_are_proposed() -> None:
    assert plain_names(HOSTILE) == []
    plain = ["SPEED_MAX", "WP.1", "a:b", "a-b", "7", "x"]
    assert plain_names([*plain, *(f"{name}\n" for name in plain)]) == plain
