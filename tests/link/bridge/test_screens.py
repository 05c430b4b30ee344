"""The outputs of the bridge's status: what is logged when, and a reader that goes away or does not read."""

from __future__ import annotations

import logging
import threading

import pytest
from msgspec.structs import replace

from link.bridge.screens import StatusLogger, StatusWriter
from link.bridge.status import BridgeStatus, LinkStatus
from tests.waits import PATIENCE

LINK = LinkStatus("serial:/dev/ttyUSB0:57600", None, 1, 1.0, 20.0, 1.0, 20.0, 0.0, 0, 0, 0, 0, 0)


def status(problem: str | None = None, number: int = 0) -> BridgeStatus:
    return BridgeStatus((replace(LINK, problem=problem),), (), number, 0)


def test_problem_is_logged_once_at_its_begin_and_once_at_its_end(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO)
    logger = StatusLogger()
    for problem in (None, None, f"{LINK.endpoint}: unplugged", f"{LINK.endpoint}: unplugged", None, None):
        logger.update(status(problem))
    begun, over = caplog.records
    assert (begun.levelno, over.levelno) == (logging.WARNING, logging.INFO)
    assert begun.getMessage().count(LINK.endpoint) == 1
    assert "unplugged" in begun.getMessage()
    assert LINK.endpoint in over.getMessage()


def test_blocked_output_delays_nobody_and_continues_with_newest() -> None:
    drawn: list[int] = []
    begun, free, ended = threading.Event(), threading.Event(), threading.Event()

    def draw(status: BridgeStatus) -> None:
        drawn.append(status.duplicates)
        begun.set()
        assert free.wait(PATIENCE)
        if status.duplicates == 99:
            ended.set()

    writer = StatusWriter(draw)
    writer.update(status(number=0))
    assert begun.wait(PATIENCE)
    for number in range(1, 100):
        writer.update(status(number=number))
    free.set()
    assert ended.wait(PATIENCE)
    assert drawn == [0, 99]


def test_a_closed_output_is_logged_and_the_bridge_goes_on(caplog: pytest.LogCaptureFixture) -> None:
    tried = threading.Event()

    def draw(status: BridgeStatus) -> None:
        tried.set()
        raise BrokenPipeError

    before = set(threading.enumerate())
    writer = StatusWriter(draw)
    [thread] = set(threading.enumerate()) - before
    writer.update(status())
    assert tried.wait(PATIENCE)
    thread.join(PATIENCE)
    assert not thread.is_alive()
    assert "the status output was closed; the bridge continues" in caplog.text
    for number in range(3):
        writer.update(status(number=number))  # neither raises nor waits
