"""An autopilot with ArduPilot's rules of signing, made with pymavlink, at the end of a serial cable."""

from __future__ import annotations

import os
import select
import threading
import tty
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mav

BEAT_EVERY = 0.2


class _Port:
    """What pymavlink writes to."""

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor

    def write(self, data: bytes) -> None:
        os.write(self._descriptor, data)


class SigningAutopilot:
    """Takes a key with SETUP_SIGNING and signs with it from then on; `listens` False ignores it.

    `key`: signs with this one from the beginning.
    """

    def __init__(self, path: str, *, listens: bool = True, key: bytes | None = None) -> None:
        self._descriptor = os.open(path, os.O_RDWR | os.O_NOCTTY)
        tty.setraw(self._descriptor)
        self._mav: Any = mav.MAVLink(_Port(self._descriptor), srcSystem=1, srcComponent=1)
        self._mav.robust_parsing = True
        self._listens = listens
        self._ended = threading.Event()
        self.key: bytes | None = None
        if key is not None:
            self._use(key, 1)
        self._thread = threading.Thread(target=self._run, name="autopilot", daemon=True)
        self._thread.start()

    def close(self) -> None:
        self._ended.set()
        self._thread.join(5)
        os.close(self._descriptor)

    def _run(self) -> None:
        while not self._ended.is_set():
            self._mav.heartbeat_send(mav.MAV_TYPE_GROUND_ROVER, mav.MAV_AUTOPILOT_ARDUPILOTMEGA, 0, 0, 4)
            if select.select([self._descriptor], [], [], BEAT_EVERY)[0]:
                for message in self._mav.parse_buffer(os.read(self._descriptor, 4096)) or ():
                    self._handle(message)

    def _handle(self, message: Any) -> None:
        if message.get_type() != "SETUP_SIGNING" or not self._listens or message.target_system != 1:
            return
        self._use(bytes(message.secret_key), message.initial_timestamp)

    def _use(self, key: bytes, timestamp: int) -> None:
        self.key, signing = key, self._mav.signing
        signing.secret_key, signing.sign_outgoing = key, True
        signing.timestamp = max(signing.timestamp, timestamp)
        signing.allow_unsigned_callback = lambda mav, number: True  # as ArduPilot does over USB
