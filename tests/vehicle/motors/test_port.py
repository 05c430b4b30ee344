"""The serial port of a motor controller, on a real terminal line: it never blocks, and a frame is whole or not sent."""

from __future__ import annotations

import contextlib
import os
import pty
import tty
from collections.abc import Iterator
from pathlib import Path

import pytest

from vehicle.motors.port import MotorPort

FRAME = b"\x80\x00\x40\x40\x01"


class Line:
    """A pty under a name that can be unplugged."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.plug()

    def plug(self) -> None:
        self.far, self._near = pty.openpty()
        tty.setraw(self._near)
        os.set_blocking(self.far, False)
        self.path.symlink_to(os.ttyname(self._near))

    def unplug(self) -> None:
        self.path.unlink()
        os.close(self._near)
        os.close(self.far)

    def close(self) -> None:
        self.unplug()


@pytest.fixture
def line(tmp_path: Path) -> Iterator[Line]:
    line = Line(tmp_path / "motors")
    yield line
    line.close()


def opened(line: Line) -> MotorPort:
    port = MotorPort(str(line.path), 9600)
    assert port.open()
    return port


def test_frames_go_out_and_replies_come_in(line: Line) -> None:
    port = opened(line)
    port.write(FRAME)
    assert os.read(line.far, 100) == FRAME
    assert port.read() == b""
    os.write(line.far, b"ok")
    assert port.read(wait=10.0) == b"ok"
    os.write(line.far, b"old")
    port.discard_input()
    assert port.read() == b""
    port.close()


def test_open_tells_whether_it_opened(line: Line) -> None:
    port = MotorPort(str(line.path), 9600)
    assert not port.is_open
    assert [port.open(), port.open()] == [True, False]
    assert port.is_open
    port.close()
    port.close()
    assert not port.is_open
    assert port.open()
    port.close()


def fill(port: MotorPort) -> BlockingIOError:
    """Write until the line accepts no more; return the error."""
    for _ in range(1_000_000):
        try:
            port.write(FRAME)
        except BlockingIOError as error:
            return error
    raise AssertionError("the line is never full")


def emptied(line: Line) -> bytes:
    """Return all that the line holds."""
    data = b""
    with contextlib.suppress(BlockingIOError):
        while piece := os.read(line.far, 65536):
            data += piece
    return data


def test_line_that_does_not_send_is_an_error_and_not_waited_for(line: Line) -> None:
    """The port stays open, because the line may continue. Only whole frames are in it then."""
    port = opened(line)
    error = fill(port)
    assert str(line.path) in str(error)
    assert port.is_open
    port.discard_output()
    held = emptied(line)
    assert held == FRAME * (len(held) // len(FRAME))
    port.write(FRAME)
    assert os.read(line.far, 100) == FRAME
    port.close()


def test_lost_line_closes_the_port_which_reopens_under_its_name(line: Line) -> None:
    port = opened(line)
    line.unplug()
    with pytest.raises(OSError, match=str(line.path)):
        port.write(FRAME)
    assert not port.is_open
    with pytest.raises(OSError, match="not open"):
        port.write(FRAME)
    with pytest.raises(OSError, match=str(line.path)):
        port.open()
    line.plug()
    assert port.open()
    port.write(FRAME)
    assert os.read(line.far, 100) == FRAME
    port.close()


def test_a_second_program_may_not_write_between_our_frames(line: Line) -> None:
    port = opened(line)
    with pytest.raises(OSError, match=str(line.path)):
        MotorPort(str(line.path), 9600).open()
    port.close()
