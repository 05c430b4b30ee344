"""A new driver is a class and one row in DRIVERS: init, check, schema, --help and the daemon work with it."""

from __future__ import annotations

import json
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tests.vehicle.cli import toy_drivers
from tests.vehicle.words import said_by
from vehicle.config.config import load

CONFIG = """\
endpoints = ["udpout:127.0.0.1:9"]
[motors]
driver = "toy"
port = "/dev/toy"
[[accessories.relays]]
driver = "toy"
number = 0
[sensors]
computer = false
"""


@pytest.fixture(autouse=True)
def _rows(monkeypatch: pytest.MonkeyPatch) -> None:
    toy_drivers.add_rows(monkeypatch.setitem)


def test_init_shows_it_with_every_key(tmp_path: Path) -> None:
    file = tmp_path / "rover.toml"
    assert said_by("init", str(file))[0] == 0
    text = file.read_text()
    block = re.search(r"^# ---- toy: a toy on a serial port\n((?:#.*\n)+)", text, re.MULTILINE)
    assert block is not None
    assert re.sub("^# .*\n", "", block[1], flags=re.MULTILINE) == '#driver = "toy"\n#port = "/dev/toy"\n#gain = 0.5\n'
    assert re.search(r'^# toy: a relay of a toy\. .*\n#driver = "toy"\n(#.*\n)*#number = 0$', text, re.MULTILINE)
    assert load(file).motors == {"driver": "simulated"}


def test_check_tries_it(tmp_path: Path) -> None:
    file = tmp_path / "rover.toml"
    file.write_text(CONFIG)
    code, out, error = said_by("check", str(file), "--state", str(tmp_path))
    assert (code, error) == (0, "")
    assert "ok    motors: toy with 2 motors, neutral and without power\n" in out
    assert "ok    relay 0: toy, off\n" in out


def test_check_reports_its_unknown_keys(tmp_path: Path) -> None:
    file = tmp_path / "rover.toml"
    file.write_text(CONFIG.replace("port", "prot"))
    code, out, _ = said_by("check", str(file))
    assert code == 2
    assert "motors.prot: unknown key; did you mean port?" in out


def test_the_schema_and_the_help_know_it() -> None:
    schema = json.loads(said_by("schema")[1])
    [toy] = [each for each in schema["properties"]["motors"]["oneOf"] if each.get("title") == "toy"]
    assert toy["required"] == ["driver", "port"]
    assert toy["properties"]["gain"]["description"] == "Gain of the toy."
    relays = schema["$defs"]["Accessories"]["properties"]["relays"]["items"]["oneOf"]
    assert "toy" in [each.get("title") for each in relays]
    assert re.search("^  toy +a toy on a serial port$", said_by("--help")[1], re.MULTILINE)


@pytest.mark.e2e
def test_the_vehicle_runs_with_it(tmp_path: Path) -> None:
    file = tmp_path / "rover.toml"
    file.write_text(CONFIG)
    command = [sys.executable, "-m", "tests.vehicle.cli.toy_drivers", "--config", str(file), "--state", str(tmp_path)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as vehicle:
        assert vehicle.stderr is not None
        assert vehicle.stderr.readline() == "vehicle: ready, system 1, udpout:127.0.0.1:9\n"
        vehicle.send_signal(signal.SIGTERM)
        assert vehicle.stderr.read().endswith("\nvehicle: stopped by SIGTERM, motors neutral\n")
        assert vehicle.wait(60) == 0
