"""What a frame of video costs: CPU of one process and bytes to the terminal, for each way to draw, at 80x22 cells."""

from __future__ import annotations

import math
import random
import time
from collections.abc import Sequence

from groundstation.pictures.painters import PAINTERS, Area
from groundstation.pictures.picture import Picture
from groundstation.pictures.protocol import Protocol
from tests.benchmarks.figures import Goal, Options, Report, Table

AREA = Area(80, 22)
FRAMES = 30
RATE = 10.0
"""Frames a second, of which the share of a core is told."""
CORE_MAX = 12.0
"""% of a core for half blocks of a camera's picture at RATE: what the station and the screen may take together."""


def run(options: Options) -> Report:
    """Measure each painter."""
    table = Table("Video: a frame at 80x22", note="`noise` is the worst picture there is; a camera lies between.")
    report = Report([table])
    for protocol in Protocol:
        options.say(f"video_frames: {protocol}")
        for name, noise in (("camera", 6), ("noise", 255)):
            milliseconds, size = _measure(protocol, noise, 5 if options.quick else FRAMES)
            share = milliseconds * RATE / 10
            table.rows.append(
                {
                    "protocol": str(protocol),
                    "picture": name,
                    "CPU ms": milliseconds,
                    f"% of a core at {RATE:g}/s": share,
                    "kB": size / 1000,
                }
            )
            if (protocol, name) == (Protocol.BLOCKS, "camera"):
                report.goals.append(Goal("half blocks at 10 frames/s", share, CORE_MAX, "% of a core"))
    return report


def _measure(protocol: Protocol, noise: int, count: int) -> tuple[float, float]:
    """Return ms of CPU and bytes of a frame."""
    painter = PAINTERS[protocol]()
    width, height = painter.fit(AREA)
    frames = [_picture(width, height, noise, number) for number in range(count + 1)]
    painter.paint(frames[0], AREA, 0)
    began = time.process_time()
    sizes: Sequence[int] = [len(painter.paint(frame, AREA, 0).encode()) for frame in frames[1:]]
    return (time.process_time() - began) * 1000 / count, sum(sizes) / count


def _picture(width: int, height: int, noise: int, number: int) -> Picture:
    """Return a smooth picture that moves, with noise of so many levels, as a sensor adds it."""
    chance = random.Random(number).randbytes(3 * width * height)
    rgb = bytearray()
    for y in range(height):
        light = 128 + 100 * math.sin(3 * y / height + number / 10)
        for x in range(width):
            shade = light * (0.5 + x / width / 2)
            at = len(rgb)
            for channel in range(3):
                value = int(shade * (1 - channel / 5)) + chance[at + channel] * noise // 256
                rgb.append(value if noise < 255 and value < 256 else chance[at + channel])
    return Picture(width, height, bytes(rgb))
