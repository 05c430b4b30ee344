"""Ten hours of pictures by a clock of the test: from packets to lines of cells nothing grows."""

from __future__ import annotations

import gc
import random
import sys
from collections.abc import Iterator

import pytest

from groundstation.pictures.cell_lines import INKS, LEVELS, CellLines, simplify
from groundstation.pictures.freshness import Freshness, PictureAge
from groundstation.pictures.kitty import KittyEncoder
from groundstation.pictures.line_budget import LineBudget
from groundstation.pictures.picture import Picture
from groundstation.pictures.protocol import Protocol
from groundstation.stream.rtp import Depacketizer
from groundstation.stream.sender_lock import SenderLock
from groundstation.ui.terminal.tty_ping import TerminalPing
from link.services.video_stream import PAYLOAD_TYPE

HOUR = 3600.0
WARM, END = 2 * HOUR, 10 * HOUR
"""s: caches are as full as they get at the first one."""
PERIOD = 1.0
"""s between two pictures: 36,000 in ten hours, of which each is drawn."""
WIDTH, HEIGHT = 4, 4
SHADES = bytes(value & 0xF0 for value in range(256))
"""4096 colours: each has come before WARM."""
CAMERA, STRANGER = "192.168.1.7", "192.168.1.66"
BLOCKS = 1000
"""Blocks of memory by which one moment differs from another; one for each 29th picture would be as many."""


class Chain:
    """What pictures go through, but for the programs."""

    def __init__(self) -> None:
        self.chance = random.Random(33)
        self.lock, self.depacketizer, self.age = SenderLock((CAMERA,)), Depacketizer(), PictureAge()
        self.lines, self.kitty = CellLines(INKS[Protocol.BLOCKS]), KittyEncoder()
        self.budget, self.ping = LineBudget(250_000), TerminalPing()
        self.units = self.drawn = self.refused = 0

    def packets(self, number: int) -> Iterator[tuple[str, bytes]]:
        """One picture in two packets; one in 20 gets lost, one in 20 comes late, and a stranger sends as well."""
        time = (number * 90000 + 0xFFFF0000 & 0xFFFFFFFF).to_bytes(4, "big")
        parts = [
            bytes([0x80, PAYLOAD_TYPE | marker]) + (2 * number + marker // 0x80 & 0xFFFF).to_bytes(2, "big")
            + time + b"cams" + bytes([0x65, number & 0xFF])
            for marker in (0, 0x80)
        ]  # fmt: skip
        if self.chance.random() < 0.05:
            parts.reverse()
        yield STRANGER, parts[0]
        yield from ((CAMERA, part) for part in parts if self.chance.random() >= 0.05)

    def show(self, number: int, now: float) -> None:
        """Receive one picture, and draw it if the line is free."""
        for host, packet in self.packets(number):
            if self.lock.passes(host, now):
                self.units += sum(1 for _ in self.depacketizer.take(packet, now))
            else:
                self.refused += 1
        picture = Picture(WIDTH, HEIGHT, self.chance.randbytes(3 * WIDTH * HEIGHT).translate(SHADES))
        if self.ping.next_due(now) and not self._mute(now):
            self.ping.handle_answer(now + 0.01)
        self.age.note(picture, now, now)
        assert self.age.judge(now).freshness is Freshness.FRESH
        if self.budget.may_draw(now):
            self._draw(picture, now)

    def _draw(self, picture: Picture, now: float) -> None:
        def lines(level: int) -> list[str]:
            return self.lines.draw(simplify(picture, WIDTH, HEIGHT // 2, level))

        level = self.budget.choose_level(lambda each: sum(map(len, lines(each))), len(LEVELS) - 1, now)
        size = sum(map(len, lines(level))) + len(self.kitty.encode(picture, WIDTH, HEIGHT // 2))
        self.budget.note_frame(size, now)
        self.ping.send_behind_frame(now)
        self.drawn += 1
        if not self._mute(now):
            self.ping.handle_answer(now + 0.03)
            if (took := self.ping.pop_frame_time()) is not None:
                self.budget.note_read(took, self.ping.quickest)

    @staticmethod
    def _mute(now: float) -> bool:
        """Return whether the terminal answers nothing now: 5 s of each 5 minutes."""
        return now % 300.0 < 5.0


def blocks() -> int:
    gc.collect()
    return sys.getallocatedblocks()


@pytest.mark.slow
def test_ten_hours_of_pictures_keep_nothing() -> None:
    chain, number, before = Chain(), 0, 0
    while (now := 1000.0 + number * PERIOD) < 1000.0 + END:
        chain.show(number, now)
        number += 1
        if number * PERIOD == WARM:
            before = blocks()
    assert abs(blocks() - before) < BLOCKS
    assert chain.units > 0.8 * number
    assert chain.refused > 0.9 * number
    assert chain.drawn > 0.9 * number
