"""`mavhelm video` in a real pseudo-terminal: cells are decoded as a terminal shows them, sources are real processes."""

from __future__ import annotations

import contextlib
import fcntl
import os
import re
import select
import signal
import struct
import subprocess
import sys
import termios
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.groundstation.pictures.decoders import CellScreen, KittyScreen, decode_sixel
from tests.groundstation.ui.ptys import attach_pty
from tests.groundstation.video.ffmpeg_sources import NEEDS_FFMPEG, camera
from tests.ports import free_port
from tests.waits import PATIENCE, wait_until

pytestmark = [pytest.mark.e2e, NEEDS_FFMPEG]

COMMAND = (sys.executable, "-m", "groundstation", "video")
DA1, PING = b"\x1b[c", b"\x1b[5n"
XTERM, XTERM_SIXEL, KITTY = b"\x1b[?64;1;2c", b"\x1b[?64;1;2;4c", b"\x1b_Gi=31;OK\x1b\\\x1b[6;16;8t\x1b[?62;c"


class Person:
    """The viewer, and a terminal that answers it."""

    def __init__(self, folder: Path, attributes: bytes, *arguments: str) -> None:
        self.process, self._master = attach_pty([*COMMAND, *arguments], folder)
        self.drawn = b""
        self._attributes = attributes

    def type(self, data: bytes) -> None:
        os.write(self._master, data)

    def read(self) -> None:
        with contextlib.suppress(OSError):
            if select.select([self._master], [], [], 0.02)[0]:
                data = os.read(self._master, 1 << 16)
                self.drawn += data
                self.type(self._attributes * data.count(DA1) + b"\x1b[0n" * data.count(PING))

    def wait(self, pattern: str) -> None:
        """Wait for a text of the newest line below the picture."""
        wait_until(
            lambda: re.search(pattern, self.status),
            lambda: self.drawn[-300:].decode(errors="replace"),
            each=self.read,
        )

    @property
    def status(self) -> str:
        """The newest line below the picture."""
        found = re.findall(r"\x1b\[\d+;1H\x1b\[0m((?:\x1b\[7m)?[^\x1b]+)\x1b\[0m", self.drawn.decode(errors="replace"))
        return found[-1] if found else ""

    @property
    def decoder(self) -> int:
        """The process id of ffmpeg; 0: none runs."""
        children = Path(f"/proc/{self.process.pid}/task/{self.process.pid}/children").read_text().split()
        return int(children[0]) if children else 0

    def resize(self, columns: int, rows: int) -> None:
        fcntl.ioctl(self._master, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))

    def screen(self) -> CellScreen:
        """What the terminal shows."""
        shown = CellScreen()
        shown.feed(self.drawn.decode(errors="replace"))
        return shown

    @property
    def echoes(self) -> bool:
        return bool(termios.tcgetattr(self._master)[3] & termios.ECHO)

    def end(self) -> None:
        self.process.kill()
        self.process.wait()
        os.close(self._master)


@contextlib.contextmanager
def viewing(folder: Path, attributes: bytes, *arguments: str) -> Iterator[Person]:
    person = Person(folder, attributes, *arguments)
    try:
        yield person
    finally:
        person.end()


def colours(screen: CellScreen, row: int) -> set[tuple[int, ...]]:
    """The colours of a row of 100 columns, without shades."""
    pixels = [pixel for column in range(1, 101) for pixel in screen.pixels(row, column)]
    return {tuple(part // 128 for part in pixel) for pixel in pixels}


def test_a_driver_sees_the_picture_its_age_and_its_end(tmp_path: Path) -> None:
    port = free_port()
    with camera("udp", port), viewing(tmp_path, XTERM, f"udp:127.0.0.1:{port}", "--protocol", "blocks") as person:
        person.wait(r"age 0\.\d s .* [1-9]\d*/s  blocks")
        assert {(1, 0, 0), (0, 1, 0), (0, 0, 1)} <= colours(person.screen(), 10)
        assert not person.echoes
        stopped = person.decoder
        os.kill(stopped, signal.SIGSTOP)
        person.wait(r"\x1b\[7m OLD \d\.\d s: do not drive by it")
        grey = wait_until(
            lambda: all(len({*pixel}) == 1 for at in (3, 50, 90) for pixel in person.screen().pixels(10, at)),
            each=person.read,
        )
        assert grey
        os.kill(stopped, signal.SIGKILL)
        person.wait(r"age 0\.\d s")
        assert person.decoder != stopped
        person.resize(60, 20)
        before = person.decoder
        person.wait(r"\x1b\[7m|age")
        wait_until(lambda: person.decoder not in (0, before), each=person.read)
        person.wait(r"age 0\.\d s")
        last = person.decoder
        person.type(b"q")
        wait_until(lambda: person.process.poll() is not None, each=person.read)
        assert person.process.returncode == 0
        assert person.echoes
        assert person.drawn.rstrip().endswith(b"\x1b[?7h\x1b[?25h\x1b[?1049l")
        assert not Path(f"/proc/{last}").exists()


@pytest.mark.parametrize("answer", [KITTY, XTERM_SIXEL], ids=["kitty", "sixel"])
def test_a_terminal_that_answers_gets_real_pixels(answer: bytes, tmp_path: Path) -> None:
    port = free_port()
    with camera("udp", port), viewing(tmp_path, answer, f"udp:127.0.0.1:{port}") as person:
        protocol = "kitty" if answer is KITTY else "sixel"
        person.wait(rf"age 0\.\d s .* [1-9]\d*/s  {protocol}")
        text = person.drawn.decode(errors="replace")
        if answer is KITTY:
            kitty = KittyScreen()
            kitty.feed(text[: text.rindex("\x1b[?2026l")].replace("\x1b_Gi=31,s=1,v=1,a=q,t=d,f=24;AAAA\x1b\\", ""))
            (picture,) = kitty.images.values()
            level = round(620 / picture.width)  # of 100 x 29 cells of 8 x 16 pixels; coarser where the reader is late
            assert level in (1, 2, 3)
            assert (picture.width, picture.height) == (620 // level, 360 // level)
        else:
            picture = decode_sixel(text)
            assert picture.height % 6 == 0
        row = picture.row(picture.height * 2 // 3)
        assert len({row[at : at + 3] for at in range(0, len(row), 3)}) >= 6
        person.process.send_signal(signal.SIGTERM)
        wait_until(lambda: person.process.poll() is not None, each=person.read)
        assert person.echoes
        assert person.process.returncode == 0


def test_a_killed_viewer_leaves_no_decoder(tmp_path: Path) -> None:
    port = free_port()
    with viewing(tmp_path, XTERM, f"udp:127.0.0.1:{port}") as person:  # no camera: ffmpeg never writes
        person.wait("NO PICTURE YET")
        decoder = wait_until(lambda: person.decoder, each=person.read)
        person.process.kill()
        person.process.wait()
        wait_until(lambda: not Path(f"/proc/{decoder}").exists() or "State:\tZ" in _status(decoder))


def test_a_slow_terminal_gets_at_most_its_bytes(tmp_path: Path) -> None:
    port = free_port()
    arguments = (f"udp:127.0.0.1:{port}", "--protocol", "blocks", "--bytes", "20000")
    with camera("udp", port), viewing(tmp_path, XTERM, *arguments) as person:
        person.wait(r"blocks, [123] coarser")
        person.wait(r"age \d\.\d s")


def test_mistakes_are_one_line(tmp_path: Path) -> None:
    (tmp_path / "there.png").touch()
    for words, code, said in (
        (["concat:a"], 2, "no kind of video source"),
        (["rtp:5600"], 2, "is not a terminal"),
        (["rtp:5600", "--snapshot", "there.png"], 2, "there.png exists"),
        (["there.png", "--snapshot", "new.png"], 1, "no picture within"),
        (["rtp:5600", "--rate", "0"], 2, "from 0.1 to 60"),
        (["rtp:5600", "--bytes", "1"], 2, "from 10000"),
    ):
        ended = subprocess.run(
            [*COMMAND, *words], cwd=tmp_path, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=PATIENCE
        )
        assert (ended.returncode, ended.stdout) == (code, ""), words
        assert said in ended.stderr
        assert len(ended.stderr.splitlines()) == 1
    assert not (tmp_path / "new.png").exists()


def test_without_a_decoder_its_package_is_named(tmp_path: Path) -> None:
    (tmp_path / "a.mp4").touch()
    ended = subprocess.run(
        [*COMMAND, "a.mp4"], cwd=tmp_path, env={**os.environ, "PATH": str(tmp_path)}, stdin=subprocess.DEVNULL,
        capture_output=True, text=True, timeout=PATIENCE,
    )  # fmt: skip
    assert ended.returncode == 2
    assert "apt-get install ffmpeg" in ended.stderr
    assert len(ended.stderr.splitlines()) == 1


def _status(pid: int) -> str:
    with contextlib.suppress(OSError):
        return Path(f"/proc/{pid}/status").read_text()
    return "State:\tZ"
