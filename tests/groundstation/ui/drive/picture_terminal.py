"""A terminal that reads no faster than a line carries, with a ground station in it whose rover has a camera."""

from __future__ import annotations

import contextlib
import os
import re
import select
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

from tests.groundstation.ui.ptys import attach_pty
from tests.ports import free_port
from tests.waits import wait_until

GROUND, VEHICLE = ([sys.executable, "-m", name] for name in ("groundstation", "vehicle"))
CAMERA = "[camera]\nkind = 'rpicam'\nwidth = 320\nheight = 180\nrate = 15\nport = {port}\n"
RPICAM = """#!/bin/sh
exec ffmpeg -loglevel error -re -f lavfi -i mandelbrot=size=320x180:rate=15 -pix_fmt yuv420p -f rawvideo pipe:1
"""
"""In place of the program of a Raspberry Pi: pictures that move, to which the daemon adds their time."""
SIZE = (162, 50)
DA1, PING, PONG = b"\x1b[c", b"\x1b[5n", b"\x1b[0n"
AGE = re.compile(r"picture (\d+\.\d) s")
"""The age of the picture in the line below it."""
STEP = 0.02
"""s between two reads of a slow line."""


class PictureTerminal:
    """`attributes`: its answer to DA1 and what stands before it. `rate`: bytes a second; 0: as fast as it can.

    `camera`: script in place of rpicam-vid. `ports`: of the ground station, where the vehicle and its camera send to.
    """

    def __init__(
        self,
        folder: Path,
        attributes: bytes,
        rate: int = 0,
        size: tuple[int, int] = SIZE,
        camera: str = RPICAM,
        ports: tuple[int, int, int] | None = None,
    ) -> None:
        if ports is None:
            ports = (port := free_port()), port, free_port()
        ground, sends_to, pictures = ports
        self.process, self._master = attach_pty(
            [*GROUND, f"udpin:127.0.0.1:{ground}"], folder, size, COLORTERM="truecolor"
        )
        (folder / "rover.toml").write_text(CAMERA.format(port=pictures))
        program = folder / "rpicam-vid"
        program.write_text(camera)
        program.chmod(0o700)
        self.vehicle = subprocess.Popen(
            [*VEHICLE, "--config", "rover.toml", "--motors", "simulated", f"udpout:127.0.0.1:{sends_to}"],
            cwd=folder, env=os.environ | {"PATH": f"{folder}:{os.environ['PATH']}"},
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        self.rate = rate
        self.drawn = bytearray()
        self._attributes = attributes
        self._tail = b""
        self._next_read = 0.0

    def type(self, data: bytes) -> None:
        os.write(self._master, data)

    def read(self) -> None:
        """Read what the line carries, and answer what was read."""
        if self.rate:
            select.select([], [], [], max(0.0, self._next_read - time.monotonic()))
        with contextlib.suppress(OSError):
            if select.select([self._master], [], [], STEP)[0]:
                data = os.read(self._master, int(self.rate * STEP) or 1 << 16)
                if self.rate:  # a late reader makes up for nothing
                    self._next_read = time.monotonic() + len(data) / self.rate
                self.drawn += data
                seen = self._tail + data
                self._tail = seen[-3:]
                self.type(self._attributes * seen.count(DA1) + PONG * seen.count(PING))

    def wait(self, pattern: str, since: int = 0) -> int:
        """Wait for a text that is drawn after so many bytes. Return where it ends."""
        return wait_until(
            lambda: self._find(pattern, since), lambda: f"{pattern}: {self.text(-3000)[-800:]}", each=self.read
        )

    def _find(self, pattern: str, since: int) -> int:
        return len(self.drawn) if re.search(pattern, self.text(since)) else 0

    def text(self, since: int) -> str:
        """What was drawn since then, without escape sequences."""
        raw = bytes(self.drawn[since:]).decode(errors="replace")
        return re.sub(r"\x1b(?:\[[0-9:;<=>?]*[ -/]*[@-~]|[P_][^\x1b]*\x1b\\|[78])", "", raw)

    def ages(self, since: int) -> list[float]:
        """The ages of the pictures that were drawn since then, s."""
        return [float(each) for each in AGE.findall(self.text(since))]

    def end(self) -> None:
        self.vehicle.terminate()
        self.vehicle.wait()
        self.process.terminate()
        wait_until(lambda: self.process.poll() is not None, each=self.read)
        os.close(self._master)


@contextlib.contextmanager
def picture_terminal(
    folder: Path, attributes: bytes, rate: int = 0, ports: tuple[int, int, int] | None = None
) -> Iterator[PictureTerminal]:
    """A terminal on which the picture fills the screen."""
    terminal = PictureTerminal(folder, attributes, rate, ports=ports)
    try:
        terminal.wait("DISARMED")
        terminal.type(b"f")
        terminal.wait(AGE.pattern)
        yield terminal
    finally:
        terminal.end()
