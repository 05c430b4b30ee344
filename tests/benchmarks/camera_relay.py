"""A bad network between a vehicle with a camera and a ground station: it loses and delays the pictures as well.

Usage: python -m tests.benchmarks.camera_relay VEHICLE_SIDE GROUND CAMERA PICTURES LOSS DELAY

All on loopback: the vehicle sends to VEHICLE_SIDE, and its pictures to CAMERA. The relay passes them to GROUND and
PICTURES, and writes that port into VIDEO_STREAM_INFORMATION: two programs of one machine cannot have the same one.
"""

from __future__ import annotations

import contextlib
import select
import socket
import sys
import time
from collections.abc import Callable

from dialects import codec
from dialects.messages import VideoStreamInformation
from link.protocol.frame import read_header
from link.transport.memory import LossyPipe
from tests.benchmarks.lossy_relay import LOCALHOST, STEP


def change_port(datagram: bytes, port: int) -> bytes:
    """Return a datagram of whole frames, with this port where one announces a stream."""
    changed, rest = b"", datagram
    while rest and (header := read_header(rest)) is not None:
        raw, rest = rest[: header.size], rest[header.size :]
        changed += _announce(raw, port) if header.message_id == VideoStreamInformation.id else raw
    return changed + rest


def _announce(raw: bytes, port: int) -> bytes:
    message = codec.decode_frame(VideoStreamInformation.id, raw)
    assert isinstance(message, VideoStreamInformation)
    message._uri_raw = str(port).encode()  # what pymavlink encodes
    sequence, system, component = raw[4:7]
    return codec.frame(message.id, codec.encode_payload(message), sequence, system, component)


class CameraRelay:
    """`ports`: those of the usage."""

    def __init__(self, ports: tuple[int, int, int, int], loss: float, delay: float) -> None:
        vehicle, ground, camera, self._port = ports
        self._sockets = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(3)]
        self._vehicle, self._ground, self._camera = self._sockets
        self._vehicle.bind((LOCALHOST, vehicle))
        self._ground.connect((LOCALHOST, ground))
        self._camera.bind((LOCALHOST, camera))
        self._pipes = [LossyPipe[bytes](loss=loss, delay=delay, seed=seed) for seed in (1, 2, 3)]
        self._up, self._down, self._pictures = self._pipes
        self._address: tuple[str, int] | None = None
        self.change_picture: Callable[[bytes], bytes] = lambda packet: packet
        """Changes each packet of the pictures."""
        self.runs = True

    def close(self) -> None:
        """Close the sockets, after run()."""
        for each in self._sockets:
            each.close()

    def run(self) -> None:
        """Run until killed, or until `runs` is False and something comes."""
        while self.runs:
            now = time.monotonic()
            due = [each.next_arrival for each in self._pipes if each.next_arrival is not None]
            ready, _, _ = select.select(self._sockets, [], [], max(STEP, min(due) - now) if due else None)
            with contextlib.suppress(ConnectionRefusedError):  # the ground station is not there yet
                self._take(ready, time.monotonic())
                self._pass_on(time.monotonic())

    def _take(self, ready: list[socket.socket], now: float) -> None:
        if self._vehicle in ready:
            data, self._address = self._vehicle.recvfrom(65536)
            self._down.send(change_port(data, self._port), now)
        if self._camera in ready:
            self._pictures.send(self.change_picture(self._camera.recv(65536)), now)
        if self._ground in ready:
            self._up.send(self._ground.recv(65536), now)

    def _pass_on(self, now: float) -> None:
        if self._address is not None:
            for data in self._up.receive(now):
                self._vehicle.sendto(data, self._address)
        for data in self._pictures.receive(now):
            self._camera.sendto(data, (LOCALHOST, self._port))
        for data in self._down.receive(now):
            self._ground.send(data)


if __name__ == "__main__":
    first, second, third, fourth = map(int, sys.argv[1:5])
    relay = CameraRelay((first, second, third, fourth), *map(float, sys.argv[5:7]))
    print("relay ready", flush=True)
    relay.run()
