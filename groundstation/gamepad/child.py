"""The screen's end of the pipe to the gamepad's process: starts it, passes its frames on, tells when it is gone."""

from __future__ import annotations

import importlib.util
import subprocess

import msgspec

from groundstation.gamepad.frame_pipe import FramePipe, TakeFrame
from groundstation.input.pad import IDLE_PERIOD, PadFrame
from groundstation.input.pad_mapping import PadMapping
from link.runtime.child_process import end_process, start_module
from link.runtime.install_hint import install_command
from link.runtime.local_socket import open_pair

READER = "groundstation.gamepad.reader"
"""Module of the process."""

PACKAGES = ("sdl2", "sdl2dll")

NEXT = b"n"
"""To the reader: choose the next gamepad."""

SILENT_AFTER = 3 * IDLE_PERIOD
"""s without a frame after which the reader counts as hanging; what it held was neutral long before."""
CLOSE_TIMEOUT = 1.0


def missing_package() -> str | None:
    """Return the line for the user where the extra is not installed."""
    if all(importlib.util.find_spec(name) for name in PACKAGES):
        return None
    return f"--gamepad needs the packages PySDL2 and pysdl2-dll, which are not installed: {install_command('gamepad')}"


class GamepadChild:
    """One reader process."""

    touch, awake = False, True

    def __init__(self, mapping: PadMapping, wanted: str) -> None:
        """`wanted`: part of the name of the gamepad, or `any`."""
        self.mapping = mapping
        self._wanted = wanted
        self._frames = FramePipe()
        self._process: subprocess.Popen[bytes] | None = None

    @property
    def frame(self) -> PadFrame:
        """The newest frame; without names when there is no gamepad."""
        return self._frames.frame

    def start(self, take: TakeFrame) -> None:
        """Start the process; `take` is called with each frame, in another thread. Raises OSError."""
        ours, theirs = open_pair()
        with theirs:
            options = [f"--fd={theirs.fileno()}", f"--wanted={self._wanted}"]
            options.append(f"--mapping={msgspec.json.encode(self.mapping).decode()}")
            self._process = start_module(READER, options, pass_fds=[theirs.fileno()])
        self._frames.start(ours, take)

    def stop(self) -> None:
        """End the process: it ends with its end of the pipe."""
        if self._process is not None:
            self._frames.stop()
            end_process(self._process, CLOSE_TIMEOUT)

    def choose_next(self) -> None:
        """Let the next gamepad drive."""
        self._frames.send(NEXT)

    def problem(self, now: float) -> str:
        """Return why no gamepad can drive, "" if nothing is known to be wrong."""
        if self._frames.ended:
            return "its reader has ended: restart to drive with it"
        return "its reader does not respond" if now - self.frame.read_at > SILENT_AFTER else ""
