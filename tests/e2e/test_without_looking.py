"""An operator who sees nothing: lines, speech and bell, with the real programs."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from tests.e2e.programs import GroundStation, Vehicle
from tests.groundstation.speech.spoken import Ear
from tests.ports import free_port
from tests.waits import PATIENCE, wait_until

PAGE = Path(__file__).parents[2] / "docs" / "accessibility.md"
STEP = re.compile(r"^\| `mavhelm ([^`]+)` \| `([^`]+)` \|$", re.MULTILINE)


@pytest.mark.e2e
@pytest.mark.xdist_group("verbs through a station")
def test_a_full_drive_from_the_transcript_alone_as_the_page_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ear = Ear(tmp_path)
    monkeypatch.setenv("PATH", str(ear.folder), prepend=os.pathsep)
    port, printed = free_port(), tmp_path / "printed"
    steps = STEP.findall(PAGE.read_text())
    assert [words.split()[0] for words, _ in steps] == ["arm", "drive", "turn", "stop", "disarm"]
    vehicle = Vehicle(tmp_path, port)
    program = [sys.executable, "-m", "groundstation"]
    with printed.open("w") as output:
        plain = subprocess.Popen(
            [*program, "--plain", "--speak", f"udpin:127.0.0.1:{port}"], stdout=output, stderr=output
        )
    try:
        wait_until(lambda: "link up" in printed.read_text(), "the vehicle is heard")
        for words, heard in steps:
            before = len(printed.read_text())
            done = subprocess.run([*program, *shlex.split(words)], capture_output=True, text=True, timeout=PATIENCE)
            assert done.returncode == 0, done.stderr
            wait_until(lambda: heard in printed.read_text()[before:] + done.stderr, f"{words}: {heard}")  # noqa: B023
            if words.startswith(("drive", "turn")):
                assert any(each.turning for each in vehicle.outputs())
        wait_until(vehicle.stands, "it stands")
        for each in ("armed", "stop: HOLD", "disarmed"):
            ear.wait_for(f"said: {each}")
    finally:
        plain.terminate()
        plain.wait()
        vehicle.end()


@pytest.mark.e2e
def test_the_screen_speaks_and_rings_when_the_link_is_lost(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ear = Ear(tmp_path)
    monkeypatch.setenv("PATH", str(ear.folder), prepend=os.pathsep)
    config = tmp_path / "groundstation.toml"
    config.write_text("speak = true\nbell = true\n")
    port = free_port()
    vehicle = Vehicle(tmp_path, port)
    station = GroundStation(tmp_path, f"udpin:127.0.0.1:{port}", "--config", str(config))
    try:
        station.wait_for(lambda: any("Rover 1: " in each for each in ear.heard), PATIENCE, "the vehicle is announced")
        rung = station.screen.count(b"\a")  # on a late machine the link may have been lost before
        vehicle.end()
        station.wait_for(lambda: "said: link lost" in ear.heard, PATIENCE, "link lost")
        station.wait_for(lambda: station.screen.count(b"\a") > rung, PATIENCE, "the bell")
        station.type('"')
        station.look(1.0)
        assert "said: speech is on" not in ear.heard
        station.type('"')
        station.wait_for(lambda: "said: speech is on" in ear.heard, PATIENCE, "speech is on")
    finally:
        station.end()
        vehicle.end()


@pytest.mark.e2e
@pytest.mark.parametrize("words", [["--sitl", "--speak"], ["--plain", "--speak"]])
def test_without_a_program_that_speaks_it_says_so(
    tmp_path: Path, words: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    command = [sys.executable, "-m", "groundstation", *words]
    if words[0] == "--sitl":  # a terminal is checked first
        station = GroundStation(tmp_path, *words)
        station.wait_for(lambda: station.process.poll() is not None, PATIENCE, "the end")
        station.look(0.2)
        code, said = station.process.returncode, station.screen.decode()
    else:
        command.append(f"udpin:127.0.0.1:{free_port()}")  # the one used last may still have its station
        done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE)
        code, said = done.returncode, done.stderr
    assert code == 2, said
    assert "none of spd-say, espeak-ng, say is installed" in said
