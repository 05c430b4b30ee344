"""The station's end of the process that receives pictures: starts it, tells it what to do, and never waits for it."""

from __future__ import annotations

import contextlib
import math
import socket
import subprocess

import msgspec

from groundstation.stream.orders import StreamOrders, StreamReport
from link.runtime.child_process import end_process, start_module
from link.runtime.local_socket import open_pair
from link.transport.backoff import Backoff

MODULE = "groundstation.stream.receiver"
IDLE = 5.0
"""s without a screen that watches after which the process is ended."""
STEADY = 30.0
"""s that it must run for the next fault to count as a first one."""
END_TIMEOUT = 1.5
"""s to write the rest, after which it is killed."""
REPORT_MAX = 4096


class ReceiverLink:
    """One process, started again after it has ended. `limit`: MB of all recorded pictures."""

    def __init__(self, limit: int) -> None:
        self.report = StreamReport()
        """The newest one."""
        self.starts = 0
        """How often the process was started."""
        self._limit = limit
        self._pipe: socket.socket | None = None
        self._process: subprocess.Popen[bytes] | None = None
        self._sent: StreamOrders | None = None
        self._backoff = Backoff()
        self._start_at = -math.inf
        self._started_at = self._wanted_at = 0.0

    @property
    def pid(self) -> int | None:
        """Process id, while it runs."""
        return None if self._process is None else self._process.pid

    def update(self, orders: StreamOrders, now: float) -> None:
        """Have these orders obeyed; ten times a second."""
        if orders.port:
            self._wanted_at = now
        if self._process is not None:
            self._follow(orders, now)
        elif orders.port and now >= self._start_at:
            self._start(now)
            self._send(orders)

    def close(self) -> None:
        """End the process: it writes the rest, and ends with its end of the socket."""
        if self._pipe is not None:
            self._pipe.close()
            self._pipe = None
        if self._process is not None:
            end_process(self._process, END_TIMEOUT)
            self._process = None

    def _start(self, now: float) -> None:
        self._start_at, self._started_at = now + self._backoff.next_delay(), now
        self.starts += 1
        ours, theirs = open_pair()
        ours.setblocking(False)
        with theirs:
            options = [f"--fd={theirs.fileno()}", f"--limit={self._limit}"]
            try:
                self._process = start_module(
                    MODULE, options, pass_fds=[theirs.fileno()], new_session=True, ends_with_us=True
                )
            except OSError as error:
                ours.close()
                self.report = StreamReport(problem=f"pictures cannot be received: {error.strerror}")
                return
        self._pipe, self._sent = ours, None

    def _follow(self, orders: StreamOrders, now: float) -> None:
        assert self._process is not None
        if self._process.poll() is not None:
            self._lose("the process that receives pictures has ended and is started again")
            self._start_at = now + self._backoff.next_delay()
        elif not orders.port and now - self._wanted_at > IDLE:
            self._lose("")  # its end of the socket ends it
        else:
            if now - self._started_at > STEADY:
                self._backoff.reset()
            self._take_reports()
            self._send(orders)

    def _lose(self, problem: str) -> None:
        if self._pipe is not None:
            self._pipe.close()
        self._pipe = self._process = None
        self.report = StreamReport(problem=problem)

    def _send(self, orders: StreamOrders) -> None:
        if self._pipe is not None and orders != self._sent:
            with contextlib.suppress(OSError):  # it stands still or has ended
                self._pipe.send(msgspec.json.encode(orders))
                self._sent = orders

    def _take_reports(self) -> None:
        while self._pipe is not None:
            try:
                data = self._pipe.recv(REPORT_MAX)
            except OSError:
                return
            if not data:
                return
            self.report = msgspec.json.decode(data, type=StreamReport)
