"""Inbox: frames that fit their keys, until they are handed over: bounded, and the newest wins. Sans-IO.

One queue for each sender, as for a slow line (link/transport/priority_queue.py): of demands and heartbeats only the
newest waits, telemetry is dropped when it is full, and so is what has waited longer than the vehicle uses a demand.
"""

from __future__ import annotations

from link.transport.priority_queue import TransmitQueue

BULK = 65536
"""Bytes of telemetry and transfers that may wait for the loop, of each sender."""
MAX_SENDERS = 256
"""Senders of which something waits."""
BATCH = 64
"""Frames handed over in one turn of the event loop: a flood must not starve the control loop."""


class Inbox:
    """Waiting frames by the address of their sender."""

    def __init__(self) -> None:
        self._queues: dict[str, TransmitQueue] = {}
        self._gone = 0

    def put(self, address: str, data: bytes, now: float) -> None:
        """Add a frame that came at `now`."""
        queue = self._queues.get(address)
        if queue is None:
            if len(self._queues) >= MAX_SENDERS:
                self._gone += 1
                return
            queue = self._queues[address] = TransmitQueue(BULK)
        queue.push(data, now)

    def take(self, now: float) -> tuple[list[tuple[bytes, str]], bool]:
        """Return frames with their senders in turn, BATCH at most, and whether more wait."""
        taken: list[tuple[bytes, str]] = []
        waiting = dict(self._queues)
        while waiting and len(taken) < BATCH:
            for address, queue in list(waiting.items()):
                if data := queue.pop(now):
                    taken.append((data, address))
                else:
                    self._gone += queue.dropped
                    del waiting[address], self._queues[address]
        return taken, bool(waiting)

    @property
    def is_empty(self) -> bool:
        """Whether nothing waits."""
        return not self._queues

    def forget(self, address: str) -> None:
        """Drop what waits of a sender that has gone."""
        if queue := self._queues.pop(address, None):
            self._gone += queue.dropped

    @property
    def dropped(self) -> int:
        """Frames dropped because they were overtaken, too many or too old."""
        return self._gone + sum(each.dropped for each in self._queues.values())
