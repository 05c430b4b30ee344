"""The screen's end of a tab's thumb stick: what it inherits, and frames over the real socket."""

from __future__ import annotations

import os
import time

import msgspec
import pytest

from groundstation.gamepad.tab_stick import inherit_stick
from groundstation.input.pad import PadFrame
from groundstation.input.touch_stick import NAME, PIPE_VARIABLE
from link.runtime.local_socket import open_pair
from tests.waits import until

HELD = PadFrame(1.0, (NAME,), held=True, throttle=0.5)


async def test_frames_reach_the_screen_until_the_server_ends() -> None:
    server, screen = open_pair()
    environment = {PIPE_VARIABLE: str(screen.detach())}
    stick = inherit_stick(environment)
    assert stick is not None
    assert environment == {}, "a process of the screen must not take it over"
    assert not os.get_inheritable(stick._pipe.fileno())
    taken: list[PadFrame] = []
    stick.start(taken.append)
    assert not stick.awake
    server.send(b"\xff rubbish")
    server.send(msgspec.msgpack.encode(HELD))
    await until(lambda: taken)
    assert (taken, stick.frame, stick.awake) == ([HELD], HELD, True)
    server.close()
    await until(lambda: len(taken) == 2)
    assert not taken[1].held
    assert not taken[1].names
    assert stick.problem(time.monotonic()) == ""
    stick.choose_next()
    stick.stop()


@pytest.mark.parametrize("value", ["", "x", "-1", "99999", "1e3", " 3"])
def test_without_a_socket_there_is_no_stick(value: str) -> None:
    assert inherit_stick({PIPE_VARIABLE: value}) is None


def test_a_file_in_its_place_is_no_stick() -> None:
    reading, writing = os.pipe()
    assert inherit_stick({PIPE_VARIABLE: str(reading)}) is None
    os.close(reading)
    os.close(writing)


def test_an_ordinary_terminal_has_no_stick() -> None:
    assert inherit_stick({"TERM": "xterm"}) is None
