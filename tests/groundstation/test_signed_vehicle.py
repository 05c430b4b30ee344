"""A vehicle that signs its frames (pymavlink, over UDP) and a real station process: the driver is told."""

from __future__ import annotations

import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from pymavlink.dialects.v20 import common

from groundstation.snapshot import Snapshot
from groundstation.vehicles.signing_watch import SIGNING
from tests.groundstation.screen import Screen

pytestmark = pytest.mark.e2e


class SigningVehicle:
    """Sends a HEARTBEAT of an ArduPilot rover ten times a second and answers nothing, as if we had the wrong key."""

    def __init__(self, endpoint: str) -> None:
        self.signing = True
        host, port = endpoint.removeprefix("udpin:").split(":")
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.connect((host, int(port)))
        self._mavlink = common.MAVLink(None, srcSystem=1, srcComponent=1)
        self._mavlink.signing.secret_key = bytes(range(32))
        self._mavlink.signing.link_id = 1
        self._mavlink.signing.timestamp = 10**12
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)

    @classmethod
    @contextmanager
    def running(cls, endpoint: str) -> Iterator[SigningVehicle]:
        """Send while the block runs."""
        vehicle = cls(endpoint)
        vehicle._thread.start()
        try:
            yield vehicle
        finally:
            vehicle._stopped.set()
            vehicle._thread.join()
            vehicle._socket.close()

    def _run(self) -> None:
        while not self._stopped.wait(0.1):
            self._mavlink.signing.sign_outgoing = self.signing
            beat = common.MAVLink_heartbeat_message(10, 3, 81, 0, 3, 3)
            self._socket.send(beat.pack(self._mavlink))


def warned(snapshot: Snapshot) -> bool:
    return snapshot.vehicle is not None and SIGNING in snapshot.vehicle.warnings


def test_signed_frames_are_named_first_and_only_while_they_are_signed() -> None:
    with Screen() as screen, SigningVehicle.running(screen.endpoint) as vehicle:
        seen = screen.see(warned)
        assert seen.vehicle is not None
        assert seen.vehicle.warnings[0] == SIGNING
        assert [line.severity for line in seen.texts if SIGNING in line.text] == [4], "logged once"
        vehicle.signing = False
        screen.see(lambda snapshot: snapshot.vehicle is not None and not warned(snapshot))
