"""ScreenPort: the station's end of the connection to one screen."""

from __future__ import annotations

import asyncio
import logging
import socket
from typing import Protocol

import msgspec

from groundstation.ipc import MAX_PACKET, IntentBatch, decode_from_screen, encode
from groundstation.station_socket.packets import read_packet
from link.transport.receive_buffer import ReceiveBuffer

log = logging.getLogger(__name__)


class PortOwner(Protocol):
    """What takes the intents of a screen."""

    def handle_batch(self, port: ScreenPort, batch: IntentBatch, now: float) -> None:
        """Carry out the intents of one packet."""

    def handle_screen_end(self, port: ScreenPort, now: float) -> None:
        """Act on the end of the screen's process, for whatever reason. Called once."""

    def finish_read(self, port: ScreenPort, now: float) -> None:
        """Send what the packets that were read together have caused."""


class ScreenPort:
    """Reads intents, sends snapshots and views. Both never block."""

    def __init__(self, sock: socket.socket, owner: PortOwner) -> None:
        self._socket = sock
        self._owner = owner
        self._reading = False
        self._buffer = ReceiveBuffer(MAX_PACKET)

    def start(self) -> None:
        """Begin to read; the loop runs."""
        self._reading = True
        asyncio.get_running_loop().add_reader(self._socket, self._read)

    def stop(self) -> None:
        """Read no more."""
        if self._reading:
            self._reading = False
            asyncio.get_running_loop().remove_reader(self._socket)

    def close(self) -> None:
        """End the connection."""
        self.stop()
        self._socket.close()

    def send(self, message: msgspec.Struct) -> bool:
        """Send now or drop: a screen that does not read gets a newer snapshot later. Return whether it was sent."""
        try:
            self._socket.send(encode(message))
        except BlockingIOError:
            log.debug("the screen does not read")
        except OSError:
            log.debug("the screen has exited")  # _read sees the end of the pipe
        else:
            return True
        return False

    def _read(self) -> None:
        now = asyncio.get_running_loop().time()
        while self._reading and (packet := read_packet(self._socket, self._buffer)) is not None:
            if not packet:
                self.stop()
                self._owner.handle_screen_end(self, now)
            elif (batch := self._decode(packet)) is not None:
                self._owner.handle_batch(self, batch, now)
        self._owner.finish_read(self, now)

    @staticmethod
    def _decode(packet: bytes) -> IntentBatch | None:
        try:
            return decode_from_screen(packet)
        except msgspec.DecodeError:
            log.exception("invalid packet from the screen")
            return None
