"""Worker thread for slow jobs such as disk writes: jobs run in order, and the caller never waits."""

from __future__ import annotations

import logging
import queue
import threading
from collections.abc import Callable

log = logging.getLogger(__name__)

WorkItem = Callable[[], None]


class Worker:
    """Runs jobs in order. The thread starts with the first job and does not keep the program alive."""

    def __init__(self, name: str, limit: int) -> None:
        """`limit`: jobs that may wait; 0: any number, where the caller bounds them."""
        self._name = name
        self._jobs: queue.Queue[WorkItem | None] = queue.Queue(limit)
        self._thread: threading.Thread | None = None

    def submit(self, job: WorkItem) -> bool:
        """Queue `job`; return False if the queue is full."""
        try:
            self._jobs.put_nowait(job)
        except queue.Full:
            return False
        if self._thread is None:
            self._thread = threading.Thread(target=self._work, name=self._name, daemon=True)
            self._thread.start()
        return True

    def close(self, patience: float) -> None:
        """Run what waits and end the thread, within `patience` s; a slower disk is broken."""
        if self._thread is None:
            return
        try:
            self._jobs.put(None, timeout=patience)
        except queue.Full:
            return
        self._thread.join(patience)

    def _work(self) -> None:
        while (job := self._jobs.get()) is not None:
            try:
                job()
            except Exception:
                log.exception("a job of the thread %r failed", self._name)
