"""The process that reads the gamepad and writes frames to the screen's process. Started by the screen, not by hand.

A process of its own: SDL is foreign code, and neither a crash nor a hang of it may take the screen, its lease or the
keys along. When it is killed, hangs or ends, no frames come, and the station is neutral after PAD_WINDOW.
"""

from __future__ import annotations

import argparse
import contextlib
import select
import signal
import socket
import time
from collections.abc import Sequence

import msgspec

from groundstation.gamepad.child import NEXT
from groundstation.gamepad.sdl import Gamepads, SdlError
from groundstation.input.pad import PadCore
from groundstation.input.pad_mapping import ANY, PadMapping
from link.runtime.local_socket import take_over

POLL, IDLE_POLL = 0.01, 0.25
"""s between two readings, and while there is no gamepad: 10 ms is what USB gamepads send at most."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Read until the screen has ended. Returns 1 if SDL does not start."""
    options = build_parser().parse_args(arguments)
    for number in (signal.SIGINT, signal.SIGTSTP):
        signal.signal(number, signal.SIG_IGN)  # keys of the terminal are for the screen
    with take_over(options.fd) as pipe:
        pipe.setblocking(False)
        mapping = msgspec.json.decode(options.mapping, type=PadMapping)
        try:
            return PadReader(pipe, Gamepads(), PadCore(mapping), options.wanted).run()
        except SdlError:
            return 1


def build_parser() -> argparse.ArgumentParser:
    """Return the parser."""
    parser = argparse.ArgumentParser(prog="groundstation.gamepad.reader")
    parser.add_argument("--fd", type=int, required=True, help="the end of the socket to the screen")
    parser.add_argument("--mapping", required=True, help="PadMapping as JSON")
    parser.add_argument("--wanted", default=ANY, help="part of the name of a gamepad, or `any`")
    return parser


class PadReader:
    """Reads the chosen gamepad, and writes frames until the other end is closed."""

    def __init__(self, pipe: socket.socket, pads: Gamepads, core: PadCore, wanted: str) -> None:
        self._pipe, self._pads, self._core = pipe, pads, core
        self._wanted = wanted.casefold()
        self._driving: int | None = None
        """Number of the gamepad that drives; None while there is none."""
        self._skip = 0

    def run(self) -> int:
        """Read until the screen has ended; return the exit code."""
        while self._wait(IDLE_POLL if self._driving is None else POLL):
            self._pads.poll()
            self._tell(time.monotonic())
        return 0

    def _wait(self, period: float) -> bool:
        """Wait for the time of the next reading, or a request. Returns False at the end of the screen."""
        if not select.select([self._pipe], [], [], period)[0]:
            return True
        try:
            packet = self._pipe.recv(16)
        except OSError:
            return False
        self._skip += packet == NEXT
        return bool(packet)

    def _tell(self, now: float) -> None:
        fitting = [pad for pad in self._pads.plugged if self._wanted == ANY or self._wanted in pad.name.casefold()]
        numbers = [pad.number for pad in fitting]
        self._choose(numbers)
        names = tuple(pad.name for pad in fitting)
        if self._driving is None:
            frame = self._core.update(names, 0, None, now)
        else:
            reading = self._pads.read(self._driving)
            frame = self._core.update(names, numbers.index(self._driving), reading, now)
        if frame is not None:
            with contextlib.suppress(OSError):  # the screen does not read: the next frame has the newer state
                self._pipe.send(msgspec.msgpack.encode(frame))

    def _choose(self, numbers: list[int]) -> None:
        """Keep the gamepad that drives while it is there; then the first one, whose button must be pressed anew."""
        if not numbers:
            self._driving = None
        elif self._driving not in numbers:
            self._driving = numbers[0]
        else:
            self._driving = numbers[(numbers.index(self._driving) + self._skip) % len(numbers)]
        self._skip = 0


if __name__ == "__main__":
    raise SystemExit(main())
