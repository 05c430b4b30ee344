"""`mavhelm vehicle doctor` on this computer: real files, sockets, terminal lines and locks; what runs and stops it."""

from __future__ import annotations

import json
import os
import socket
import subprocess
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from tests.ports import free_port
from tests.vehicle.motors.controllers import RoboClaw
from tests.vehicle.motors.pty_controller import OnPty
from tests.vehicle.words import said_by
from vehicle.cli.doctor.table import ROWS
from vehicle.runtime.lock import MotorLock

QUIET = "[sensors]\ncomputer = false\n"
SIMULATED = f'[motors]\ndriver = "simulated"\n{QUIET}'


@pytest.fixture
def line() -> Iterator[OnPty]:
    with OnPty(RoboClaw()) as opened:
        yield opened


def examined(folder: Path, text: str) -> tuple[int, dict[str, dict[str, str]], dict[str, Any]]:
    """The exit code, the rows by id, and the summary of --json."""
    file = folder / "rover.toml"
    file.write_text(text)
    code, out, error = said_by("doctor", str(file), "--state", str(folder), "--json")
    assert error == ""
    *rows, summary = map(json.loads, out.splitlines())
    return code, {row["row"]: row for row in rows}, summary


def test_a_vehicle_without_faults_has_every_row(tmp_path: Path) -> None:
    code, rows, summary = examined(tmp_path, f'endpoints = ["udpin:127.0.0.1:{free_port()}"]\n{SIMULATED}')
    assert list(rows) == [row.id for row in ROWS]
    assert {rows[name]["health"] for name in ("config", "motors", "links", "disk")} == {"ok"}
    assert rows["motors"]["evidence"] == "simulated with 2 motors, neutral and without power"
    others = [name for name in summary["faults"] if name not in ("service", "power")]  # those of this computer
    assert (others, summary["ok"], code == 0) == ([], not summary["faults"], not summary["faults"])


def test_mistake_in_file_stops_it_but_the_computer_is_examined(tmp_path: Path) -> None:
    code, rows, summary = examined(tmp_path, "endpont = 1\n[params]\nMAN_TIMEOUT = 9\n")
    assert code == 7
    assert "config" in summary["faults"]
    assert "endpont: unknown key" in rows["config"]["evidence"]
    assert "(+1 more: mavhelm vehicle check" in rows["config"]["evidence"]
    assert rows["motors"]["health"] == "unknown"
    assert rows["clock"]["evidence"] != rows["motors"]["evidence"]


def test_text_shows_what_to_do_below_a_fault(tmp_path: Path) -> None:
    code, out, _ = said_by("doctor", str(tmp_path / "none.toml"))
    first, second, *_ = out.splitlines()
    assert code == 7
    assert first.startswith("X  config       ")
    assert second == f"                -> `mavhelm vehicle init {tmp_path}/none.toml` writes a template"


def test_a_port_in_use_stops_it_unless_the_vehicle_runs(line: OnPty, tmp_path: Path) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        motors = {"driver": "roboclaw", "port": line.path, "reply_time": 0.05}
        table = "".join(f"{key} = {json.dumps(value)}\n" for key, value in motors.items())
        text = f'endpoints = ["udpin:127.0.0.1:{taken.getsockname()[1]}"]\n[motors]\n{table}{QUIET}'
        code, rows, _ = examined(tmp_path, text)
        assert (code, rows["motors"]["health"], rows["links"]["health"]) == (7, "ok", "fault")
        assert "is in use" in rows["links"]["evidence"]
        with closing(MotorLock(motors)):
            code, rows, _ = examined(tmp_path, text)
        assert (rows["motors"]["health"], rows["links"]["health"]) == ("unknown", "unknown")
        assert "sudo systemctl stop rover" in rows["motors"]["advice"]
    assert line.controller.outputs == [0.0, 0.0]


def test_a_serial_port_that_is_missing_or_in_use_is_found(tmp_path: Path) -> None:
    device, port = os.openpty()
    text = f'endpoints = ["serial:{os.ttyname(port)}:57600"]\n{SIMULATED}'
    code, rows, _ = examined(tmp_path, text)
    assert rows["serial_ports"] == {
        "row": "serial_ports", "health": "ok", "evidence": f"{os.ttyname(port)} is there and free", "advice": "",
    }  # fmt: skip
    with subprocess.Popen(["cat"], stdin=port) as reader:
        code, rows, _ = examined(tmp_path, text)
        reader.kill()
    assert (code, rows["serial_ports"]["health"]) == (7, "fault")
    assert rows["serial_ports"]["evidence"] == f"{os.ttyname(port)} is open in cat (pid {reader.pid})"
    os.close(device)
    os.close(port)
    code, rows, _ = examined(tmp_path, f'endpoints = ["serial:/dev/no-such-port:57600"]\n{SIMULATED}')
    assert (code, rows["serial_ports"]["evidence"]) == (7, "/dev/no-such-port is not there")


def test_a_folder_that_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "taken").touch()
    text = f'endpoints = ["udpout:127.0.0.1:9"]\n{SIMULATED}[log]\ntlog = "{tmp_path}/taken/logs"\n'
    code, rows, _ = examined(tmp_path, text)
    assert (code, rows["disk"]["health"]) == (7, "fault")
    assert rows["disk"]["evidence"] == f"{tmp_path}/taken is not a folder"
