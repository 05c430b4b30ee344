"""ScreenEnd: the watchdog's end of the socket to the screen."""

from __future__ import annotations

import contextlib
import socket

import msgspec

from groundstation.intents.session import Quit
from groundstation.ipc import MAX_PACKET, decode_from_screen, encode
from groundstation.snapshot import StationOutage


class ScreenEnd:
    """Shows what the watchdog does, and reads how the screen ends. It makes `screen` non-blocking."""

    def __init__(self, screen: socket.socket) -> None:
        screen.setblocking(False)
        self._socket = screen
        self._shown = StationOutage()
        self.gone = False
        """The screen's process has ended."""
        self.has_quit = False
        """The screen has said that it quits."""

    def fileno(self) -> int:
        """Return the descriptor of the socket."""
        return self._socket.fileno()

    def show(self, outage: StationOutage) -> None:
        """Tell the screen, if it does not know yet."""
        if outage != self._shown:
            with contextlib.suppress(OSError):  # a screen that does not read gets it later; one that is gone does not
                self._socket.send(encode(outage))
                self._shown = outage

    def read(self) -> None:
        """Read whether the screen quits, and whether its process has ended."""
        while not self.gone:
            try:
                packet = self._socket.recv(MAX_PACKET)
            except BlockingIOError:
                return
            except ConnectionResetError:  # raised once, if it has not read all that it was sent
                continue
            except OSError:
                packet = b""
            self.gone = not packet
            with contextlib.suppress(msgspec.DecodeError):
                if any(isinstance(each, Quit) for each in decode_from_screen(packet).intents):
                    self.has_quit = True
