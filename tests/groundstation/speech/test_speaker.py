"""Speech with a program that writes down what it is told: order, priorities, mute, and nothing waits for it."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from groundstation.speech.announcements import Announcement, Priority
from groundstation.speech.programs import LONGEST, PROGRAMS, find_program, safe_text
from groundstation.speech.speaker import Speaker
from tests.groundstation.speech.spoken import Ear


@contextmanager
def speaker(ear: Ear, monkeypatch: pytest.MonkeyPatch) -> Iterator[Speaker]:
    monkeypatch.setenv("PATH", str(ear.folder), prepend=":")
    program = find_program()
    assert program is PROGRAMS[0]
    speaking = Speaker(program)
    try:
        yield speaking
    finally:
        speaking.close()


def say(speaking: Speaker, priority: Priority, text: str) -> None:
    began = time.monotonic()
    speaking.say(Announcement(priority, text))
    assert time.monotonic() - began < 0.05, "whoever says something never waits"


@pytest.mark.slow
def test_what_is_urgent_ends_what_is_not(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ear = Ear(tmp_path, seconds=60)
    with speaker(ear, monkeypatch) as speaking:
        say(speaking, Priority.CHANGE, "mode MANUAL")
        ear.wait_for("said: mode MANUAL")
        for each in ("armed", "in control: you"):
            say(speaking, Priority.CHANGE, each)
        say(speaking, Priority.CHATTER, "EKF has an origin")
        say(speaking, Priority.URGENT, "link lost")
        ear.wait_for("said: link lost")
        say(speaking, Priority.CHANGE, "mode AUTO")
        say(speaking, Priority.URGENT, "failsafe: gcs loss")
        speaking.mute(True)
        ear.wait_for("ended: link lost")
        say(speaking, Priority.URGENT, "not heard")
        speaking.mute(False)
        say(speaking, Priority.CHANGE, "mode HOLD")
        ear.wait_for("said: mode HOLD")
    assert [each for each in ear.heard if each.startswith("said")] == [
        "said: mode MANUAL", "said: link lost", "said: mode HOLD",
    ]  # fmt: skip
    assert ear.heard.index("ended: mode MANUAL") < ear.heard.index("said: link lost")
    assert ear.heard.count("cancelled") == 3, "a server that goes on is silenced, too"


@pytest.mark.slow
def test_announcements_are_said_in_turn(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ear = Ear(tmp_path, seconds=0.1)
    with speaker(ear, monkeypatch) as speaking:
        for number in range(9):
            say(speaking, Priority.URGENT if number == 8 else Priority.CHANGE, f"number {number}")
        ear.wait_for("said: number 8")
        (ear.folder / "spd-say").unlink()
        say(speaking, Priority.CHANGE, "the program is gone")


@pytest.mark.parametrize(
    ("text", "spoken"),
    [
        ("--version", "version"),
        ("[[slnc 60000]] <speak>low\x1b[2J", "slnc 60000 speak low 2J"),
        ("a\n\nb", "a b"),
        ("x" * 999, "x" * LONGEST),
    ],
)
def test_texts_of_a_vehicle_are_neither_options_nor_commands(text: str, spoken: str) -> None:
    assert safe_text(text) == spoken
