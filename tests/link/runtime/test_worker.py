"""The worker thread: jobs run in order, a failed one stops nothing, and a hanging one delays no exit."""

from __future__ import annotations

import threading

import pytest

from link.runtime.worker import Worker
from tests.waits import PATIENCE


def test_a_job_that_fails_is_told_and_the_next_is_done(caplog: pytest.LogCaptureFixture) -> None:
    worker, done = Worker("test", 3), threading.Event()
    worker.submit(lambda: print(1 / 0))
    worker.submit(done.set)
    worker.close(PATIENCE)
    assert done.is_set()
    assert "'test' failed" in caplog.text


def test_the_end_does_not_wait_for_a_disk_that_hangs() -> None:
    worker, awake, slept = Worker("test", 1), threading.Event(), threading.Event()

    def sleeping() -> None:
        awake.wait(PATIENCE)
        slept.set()

    assert worker.submit(sleeping)
    while worker.submit(lambda: None):  # until it is full
        pass
    worker.close(0.01)
    assert not slept.is_set()
    awake.set()
    worker.close(PATIENCE)
    assert slept.is_set()


def test_a_worker_that_never_worked_ends_at_once() -> None:
    Worker("idle", 1).close(PATIENCE)
