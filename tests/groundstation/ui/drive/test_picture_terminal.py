"""The picture of Drive on terminals: a slow line, kitty graphics. Real programs on a pseudo-terminal."""

from __future__ import annotations

import contextlib
import os
import re
import socket
import time
from collections.abc import Iterator
from pathlib import Path
from threading import Thread

import pytest

from tests.benchmarks.camera_relay import CameraRelay
from tests.groundstation.pictures.decoders import KittyScreen
from tests.groundstation.ui.drive.picture_terminal import AGE, SIZE, PictureTerminal, picture_terminal
from tests.groundstation.video.ffmpeg_sources import NEEDS_FFMPEG
from tests.ports import free_port
from tests.waits import Waits, wait_until

pytestmark = [pytest.mark.e2e, NEEDS_FFMPEG]

XTERM = b"\x1b[?64;1;2;4c"
"""It has sixel, which Drive does not use."""
KITTY = b"\x1b_Gi=31;OK\x1b\\\x1b[6;16;8t\x1b[?62;c"
SLOW = 200_000
"""Bytes a second of the slow line."""
LATE = 0.7
"""s for the vehicle to change its mode and say so, and for the snapshot that shows it."""
WATCHED = 3.0
HOLD, MANUAL = b"2", b"1"


def test_a_slow_line_has_room_for_keys(tmp_path: Path) -> None:
    with picture_terminal(tmp_path, XTERM, SLOW) as terminal:
        terminal.wait(r"picture \d\.\d s [^\n]*[1-4] coarser")
        waits = Waits(terminal.process.pid)
        begun = len(terminal.drawn)
        for key, mode in ((HOLD, "HOLD"), (MANUAL, "MANUAL")) * 2:
            typed, since = time.monotonic(), len(terminal.drawn)
            terminal.type(key)
            terminal.wait(rf"Rover 1 +{mode}", since)
            assert time.monotonic() - typed < LATE + waits.total(), mode
        end = time.monotonic() + WATCHED
        wait_until(lambda: time.monotonic() > end, each=terminal.read)
        ages = terminal.ages(begun)
        assert len(ages) > 10
        assert max(ages) < 0.5 + waits.total()


KITTY_START = r"\x1b7\x1b\[(\d+);(\d+)H\x1b_G"
"""The beginning of a picture, with its row and column."""


def starts(terminal: PictureTerminal, since: int) -> list[tuple[str, str]]:
    return re.findall(KITTY_START, terminal.drawn[since:].decode(errors="replace"))


def test_a_terminal_with_kitty_graphics_gets_pixels(tmp_path: Path) -> None:
    with picture_terminal(tmp_path, KITTY) as terminal:
        wait_until(lambda: len(starts(terminal, 0)) > 12, each=terminal.read)
        terminal.wait(AGE.pattern, len(terminal.drawn))
        text = terminal.drawn.decode(errors="replace")
        screen = KittyScreen()
        screen.feed(text[: text.rindex("\x1b8")].replace("\x1b_Gi=31,s=1,v=1,a=q,t=d,f=24;AAAA\x1b\\", ""))
        [placed], [picture] = screen.placed.values(), screen.images.values()
        assert int(placed["c"]) == SIZE[0] - 2
        assert len({picture.rgb[at : at + 3] for at in range(0, len(picture.rgb), 3)}) > 100
        opened = len(terminal.drawn)
        terminal.type(b"?")
        terminal.wait("Mode HOLD", opened)  # the list of keys lies over Drive
        assert b"\x1b_Ga=d,d=I,i=7301" in terminal.drawn[opened:]
        gone, end = len(terminal.drawn), time.monotonic() + 1.0
        wait_until(lambda: time.monotonic() > end, each=terminal.read)
        assert not starts(terminal, gone)
        terminal.type(b"\x1b")
        assert wait_until(lambda: starts(terminal, gone), each=terminal.read)


FRESH = r"picture 0\.[0-3] s ±"
RTP_HEADER, MARKER = 12, 0x80
STOPPED = 2.0
"""s for which a terminal reads nothing: longer than the silence that locks the keys."""
STILL_FRESH = 20
"""Times that the line may say a fresh age after the last whole picture: it does for half a second."""
MOST_WAITING = 400_000
"""Bytes that a terminal which reads again gets before a fresh picture: a few pictures, and what the kernel keeps."""


@contextlib.contextmanager
def relay() -> Iterator[tuple[CameraRelay, tuple[int, int, int]]]:
    """A relay of a vehicle and its pictures, and the ports for picture_terminal."""
    ground, vehicle, camera, pictures = (free_port() for _ in range(4))
    between = CameraRelay((vehicle, ground, camera, pictures), 0.0, 0.0)
    thread = Thread(target=between.run, daemon=True)
    thread.start()
    try:
        yield between, (ground, vehicle, camera)
    finally:
        between.runs = False
        with contextlib.closing(between), socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as waker:
            waker.sendto(b"", ("127.0.0.1", camera))
            thread.join()


def garble(packet: bytes) -> bytes:
    return packet[:RTP_HEADER] + os.urandom(len(packet) - RTP_HEADER)


def lose(packet: bytes) -> bytes:
    """Lose the last packet of each picture: a decoder fills in the bottom, and the time at the top is whole."""
    return b"" if packet[1] & MARKER else packet


def test_a_corrupted_stream_is_old_until_it_is_whole(tmp_path: Path) -> None:
    with relay() as (between, ports), picture_terminal(tmp_path, XTERM, ports=ports) as terminal:
        terminal.wait(FRESH)
        for change, key, mode in ((garble, HOLD, "HOLD"), (lose, MANUAL, "MANUAL")):
            between.change_picture = change
            changed = len(terminal.drawn)
            terminal.wait(r"OLD: picture [1-9]\d*\.\d s", changed)
            assert sum(age < 0.5 for age in terminal.ages(changed)) < STILL_FRESH
            terminal.type(key)
            terminal.wait(rf"Rover 1 +{mode}", changed)
            between.change_picture = lambda packet: packet
            terminal.wait(FRESH, len(terminal.drawn))


def test_a_stopped_terminal_gets_no_old_pictures(tmp_path: Path) -> None:
    with picture_terminal(tmp_path, XTERM) as terminal:
        terminal.wait(FRESH)
        waits = Waits(terminal.process.pid)
        end, waiting = time.monotonic() + STOPPED, len(terminal.drawn)
        wait_until(lambda: time.monotonic() > end)
        terminal.wait(FRESH, waiting)
        assert len(terminal.drawn) - waiting < MOST_WAITING
        assert max(terminal.ages(waiting)) < 0.5 + STOPPED + waits.total()
        terminal.type(HOLD)
        terminal.wait(r"Rover 1 +HOLD", waiting)
        terminal.wait(FRESH, len(terminal.drawn))
