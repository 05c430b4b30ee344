"""The programs that speak, as Debian has them: they take the very words that the ground station starts them with.

No sound card is needed: espeak-ng writes a file, and speech-dispatcher plays into a driver that drops all sound.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import wave
from collections.abc import Iterator
from pathlib import Path

import pytest

from groundstation.speech.announcements import Announcement, Priority
from groundstation.speech.programs import LONGEST, PROGRAMS, SpeechProgram, safe_text
from groundstation.speech.speaker import Speaker
from tests.waits import PATIENCE, wait_until

pytestmark = pytest.mark.e2e

SPD_SAY, ESPEAK = (next(each for each in PROGRAMS if each.words[0] == name) for name in ("spd-say", "espeak-ng"))
HOSTILE = (
    "--version",
    "-w /tmp/mavhelm-must-not-exist.wav",
    "[[slnc 60000]] <speak>$(reboot)`x`\x1b[2J; \"'",
    "x" * 9999,
)
CONFIGURATION = """\
LogLevel 5
AudioOutputMethod "libao"
AddModule "dummy" "sd_dummy" ""
DefaultModule dummy
"""


def needs(program: SpeechProgram, package: str) -> pytest.MarkDecorator:
    name = program.words[0]
    return pytest.mark.skipif(
        shutil.which(name) is None and "MAVHELM_CI" not in os.environ,
        reason=f"{name} is not installed: `sudo apt install {package}` to run this test",
    )


def seconds_of(text: str, folder: Path) -> float:
    """Return how long espeak-ng speaks a text, with the words of the table and a file in place of the sound card."""
    spoken = folder / "spoken.wav"
    program, end = ESPEAK.words
    done = subprocess.run([program, "-w", str(spoken), end, safe_text(text)], capture_output=True, timeout=PATIENCE)
    assert (done.returncode, done.stdout, done.stderr) == (0, b"", b"")
    with wave.open(str(spoken)) as sound:
        frames: int = sound.getnframes()
        return frames / int(sound.getframerate())


@needs(ESPEAK, "espeak-ng")
def test_espeak_ng_speaks_every_text_and_no_longer(tmp_path: Path) -> None:
    short = seconds_of("link lost", tmp_path)
    assert 0.4 < short < 3.0
    assert seconds_of("link lost, failsafe: no ground station", tmp_path) > 1.5 * short
    for text in HOSTILE:
        assert 0.2 < seconds_of(text, tmp_path) < 90.0, "a pause of 60 s is not obeyed"
    assert not Path("/tmp/mavhelm-must-not-exist.wav").exists()
    assert len(safe_text(HOSTILE[-1])) == LONGEST


@pytest.fixture
def dispatcher(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A speech-dispatcher of its own that plays into nothing; yields its log."""
    for name, text in (("conf/speechd.conf", CONFIGURATION), ("home/.libao", "default_driver=null\n")):
        (tmp_path / name).parent.mkdir(parents=True)
        (tmp_path / name).write_text(text)
    (tmp_path / "conf" / "modules").mkdir()
    address = tmp_path / "socket"
    monkeypatch.setenv("SPEECHD_ADDRESS", f"unix_socket:{address}")
    command = [
        "speech-dispatcher",
        "-s",
        "-C",
        str(tmp_path / "conf"),
        "-L",
        str(tmp_path),
        "-P",
        str(tmp_path / "pid"),
    ]
    running = subprocess.Popen(
        [*command, "-c", "unix_socket", "-S", str(address)],
        env={**os.environ, "HOME": str(tmp_path / "home")},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    log = tmp_path / "speech-dispatcher.log"
    try:
        wait_until(address.exists, lambda: log.read_text() if log.exists() else "speech-dispatcher has no log")
        yield log
    finally:
        running.terminate()
        running.wait()


@needs(SPD_SAY, "speech-dispatcher")
def test_spd_say_takes_our_words_and_says_every_text(dispatcher: Path) -> None:
    for text in ("link lost", *HOSTILE):
        done = subprocess.run([*SPD_SAY.words, safe_text(text)], capture_output=True, text=True, timeout=PATIENCE)
        assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert subprocess.run(SPD_SAY.cancel, timeout=PATIENCE).returncode == 0

    speaker = Speaker(SPD_SAY)
    try:
        before = dispatcher.read_text(errors="replace").count("SPEAK")
        assert before, "it logs what clients ask it to speak"
        speaker.say(Announcement(Priority.CHANGE, "mode MANUAL"))
        speaker.say(Announcement(Priority.URGENT, "link lost"))
        wait_until(lambda: dispatcher.read_text(errors="replace").count("SPEAK") > before, "it speaks")
    finally:
        speaker.close()
