"""A TCP connection between two real programs that can be cut: a relay that copies bytes, closes, and refuses."""

from __future__ import annotations

import contextlib
import selectors
import socket
import threading

from tests.ports import free_port

STEP = 0.005
"""s at most between two polls."""


class TcpCable:
    """Programs connect to `port`; the bytes go to the listener on `target` of this machine, and back."""

    def __init__(self, target: int) -> None:
        self._target = target
        self._running = True
        self.port = free_port()
        self._listener = _listening(self.port)
        self._pairs: dict[socket.socket, socket.socket] = {}
        self._lock = threading.Lock()
        self._turn = threading.Event()
        self._thread = threading.Thread(target=self._run, name="tcp cable", daemon=True)
        self._thread.start()

    def unplug(self) -> None:
        """Close every connection and refuse new ones."""
        with self._lock:
            self._listener.close()
            for one in list(self._pairs):
                self._end(one)

    def plug(self) -> None:
        """Accept connections again, on the same port."""
        with self._lock:
            self._listener = _listening(self.port)

    def close(self) -> None:
        """Close the cable."""
        self._running = False
        self._thread.join(5)
        self.unplug()

    def _run(self) -> None:
        while self._running:
            with self._lock, selectors.DefaultSelector() as watch:
                for each in (self._listener, *self._pairs):
                    if each.fileno() >= 0:
                        watch.register(each, selectors.EVENT_READ)
                ready = watch.select(STEP) if watch.get_map() else []
                for key, _ in ready:
                    self._serve(key.fileobj)  # type: ignore[arg-type]
            self._turn.wait(0.001)  # so that unplug() gets the lock

    def _serve(self, ready: socket.socket) -> None:
        if ready is self._listener:
            self._join()
            return
        if ready not in self._pairs:
            return
        with contextlib.suppress(OSError):
            data = ready.recv(65536)
            if data:
                self._pairs[ready].sendall(data)
                return
        self._end(ready)

    def _join(self) -> None:
        one, _ = self._listener.accept()
        try:
            other = socket.create_connection(("127.0.0.1", self._target), timeout=1.0)
        except OSError:
            one.close()  # no program listens there yet
            return
        self._pairs |= {one: other, other: one}

    def _end(self, one: socket.socket) -> None:
        other = self._pairs.pop(one, None)
        if other is not None:
            self._pairs.pop(other, None)
            with contextlib.suppress(OSError):
                other.close()
        one.close()


def _listening(port: int) -> socket.socket:
    sock = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    sock.bind(("127.0.0.1", port))
    sock.listen(4)
    return sock
