"""Sockets that receive from one network interface and send to it only, also when the interface is made anew."""

from __future__ import annotations

import asyncio
import contextlib
import errno
import socket
from collections.abc import Callable

from link.endpoint import Endpoint
from link.transport.transport import LinkError

PERIOD = 1.0
"""s between two looks at the interface."""


def bind_to_device(sock: socket.socket, endpoint: Endpoint) -> None:
    """Bind a new socket to the interface of its endpoint, if it has one. Raises LinkError.

    An address alone keeps nobody out: Linux takes packets to it from every interface.
    """
    if not endpoint.device:
        return
    if not hasattr(socket, "SO_BINDTODEVICE"):
        sock.close()
        raise LinkError(f"{endpoint.text}: cannot be bound to interface {endpoint.device}: Linux is needed")
    try:
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_BINDTODEVICE, endpoint.device.encode())
    except OSError as error:
        sock.close()
        why = "Linux 5.7 or root is needed" if error.errno == errno.EPERM else str(error.strerror)
        raise LinkError(f"{endpoint.text}: cannot be bound to interface {endpoint.device}: {why}") from error


class DeviceWatch:
    """Calls `renew` when an interface has another index than before: a tunnel that restarts is a new interface.

    Sockets that were bound to the old one are deaf. `renew` returns False to be called again after PERIOD.
    """

    def __init__(self, device: str, loop: asyncio.AbstractEventLoop, renew: Callable[[], bool]) -> None:
        self._device, self._loop, self._renew = device, loop, renew
        self._index = _index(device)
        self._timer = loop.call_later(PERIOD, self._look)

    def close(self) -> None:
        """Look no more."""
        self._timer.cancel()

    def _look(self) -> None:
        index = _index(self._device)
        if index not in (0, self._index) and self._renew():
            self._index = index
        self._timer = self._loop.call_later(PERIOD, self._look)


def watch_device(endpoint: Endpoint, loop: asyncio.AbstractEventLoop, renew: Callable[[], bool]) -> DeviceWatch | None:
    """Return a watch for the interface of an endpoint; None if it has none."""
    return DeviceWatch(endpoint.device, loop, renew) if endpoint.device else None


def _index(device: str) -> int:
    """Return the index of an interface; 0: there is none."""
    with contextlib.suppress(OSError):
        return socket.if_nametoindex(device)
    return 0
