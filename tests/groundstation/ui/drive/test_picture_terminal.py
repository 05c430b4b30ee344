"""The picture of Drive on terminals: a slow line, kitty graphics. Real programs on a pseudo-terminal."""

from __future__ import annotations

import re
import time
from pathlib import Path

import pytest

from tests.groundstation.pictures.decoders import KittyScreen
from tests.groundstation.ui.drive.picture_terminal import AGE, SIZE, PictureTerminal, picture_terminal
from tests.groundstation.video.ffmpeg_sources import NEEDS_FFMPEG
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
