"""The screen's end of the socket to the web server: the thumb stick of a browser's tab, in place of a gamepad."""

from __future__ import annotations

import os
import socket
from collections.abc import MutableMapping

from groundstation.gamepad.frame_pipe import FramePipe, TakeFrame
from groundstation.input.pad import PadFrame
from groundstation.input.pad_mapping import PadMapping
from groundstation.input.touch_stick import PIPE_VARIABLE, TOUCH
from link.runtime.local_socket import take_over


class TabStick:
    """The stick of one tab. Without a touch screen its page never sends a frame."""

    touch = True

    def __init__(self, pipe: socket.socket) -> None:
        """`pipe`: packets with frames."""
        self._pipe = pipe
        self._frames = FramePipe()

    @property
    def mapping(self) -> PadMapping:
        """What the stick and its buttons do."""
        return TOUCH

    @property
    def frame(self) -> PadFrame:
        """The newest frame; without names while the page has shown no stick."""
        return self._frames.frame

    @property
    def awake(self) -> bool:
        """Something is held, and the screen must follow it at once."""
        return self.frame.active

    def start(self, take: TakeFrame) -> None:
        """Read; `take` is called with each frame, in another thread."""
        self._frames.start(self._pipe, take)

    def stop(self) -> None:
        """Read no longer."""
        self._frames.stop()

    def choose_next(self) -> None:
        """Do nothing: a page has one stick."""

    def problem(self, now: float) -> str:
        """Return "": a page that is gone takes this screen along."""
        return ""


def inherit_stick(environment: MutableMapping[str, str] = os.environ) -> TabStick | None:
    """Return the stick of the tab for which the web server has started this screen; None in any other terminal."""
    number = environment.pop(PIPE_VARIABLE, "")
    if not number.isdecimal():
        return None
    try:
        os.set_inheritable(int(number), False)  # not for the processes of this screen
        return TabStick(take_over(int(number)))
    except OSError:  # not a socket: set by somebody else
        return None
