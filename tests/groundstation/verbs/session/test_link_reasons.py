"""Why a verb hears no vehicle: refused, silent, absent, wrong baud rate, another sender; real sockets and terminals."""

from __future__ import annotations

import os
import pty
import socket
import threading
import time
import tty
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import pytest

from dialects import codec
from dialects import messages as m
from groundstation.verbs.common.exit_codes import ExitCode
from tests.groundstation.verbs.verb_runs import run_verb
from tests.ports import free_port
from tests.waits import PATIENCE

Capture = pytest.CaptureFixture[str]


def said(capsys: Capture, *endpoints: str, wait: float = 0.5, verb: str = "status") -> str:
    """Return what `mavhelm VERB` says that hears no vehicle."""
    run = run_verb(capsys, verb, *(word for each in endpoints for word in ("-e", each)), "--wait", str(wait))
    assert run.code == ExitCode.NO_VEHICLE
    [line] = run.err.splitlines()
    return line.removeprefix("mavhelm: ")


@contextmanager
def sending(send: Callable[[], object]) -> Iterator[None]:
    """Send again and again."""
    done = threading.Event()

    def repeat() -> None:
        while not done.wait(0.01):
            send()

    thread = threading.Thread(target=repeat)
    thread.start()
    try:
        yield
    finally:
        done.set()
        thread.join(PATIENCE)


def test_a_refused_connection(capsys: Capture) -> None:
    endpoint = f"tcpout:127.0.0.1:{free_port()}"
    line = said(capsys, endpoint)
    assert line == f"no vehicle on {endpoint} within 0.5 s: not connected (Connection refused)"
    assert said(capsys, endpoint, verb="doctor") == "no vehicle was heard: not connected (Connection refused)"


def test_a_port_to_which_nobody_sends(capsys: Capture) -> None:
    port = free_port()
    reason = f"nothing arrives; a vehicle must send to UDP port {port} of this computer"
    line = said(capsys, f"udpin:127.0.0.1:{port}")
    assert line == f"no vehicle on udpin:127.0.0.1:{port} within 0.5 s: {reason}"


def test_a_port_on_which_nobody_listens(capsys: Capture) -> None:
    """The refusal of the first message is known when the second one is sent, a second later."""
    endpoint, began = f"udpout:127.0.0.1:{free_port()}", time.monotonic()
    while "refused: nothing listens there" not in (line := said(capsys, endpoint, wait=2.5)):
        assert time.monotonic() - began < PATIENCE, line


def test_a_serial_port_that_is_not_there(capsys: Capture) -> None:
    line = said(capsys, "serial:/dev/ttyNONE:57600")
    assert line.endswith(" s: waiting for /dev/ttyNONE, it is not there; is it plugged in?")


def test_a_wrong_baud_rate(capsys: Capture) -> None:
    ours, theirs = pty.openpty()
    tty.setraw(ours)
    tty.setraw(theirs)
    with sending(lambda: os.write(ours, bytes(range(0x80, 0xD0)))):
        line = said(capsys, f"serial:{os.ttyname(theirs)}:57600", wait=2.5)
    os.close(ours)
    os.close(theirs)
    assert line.endswith(" s: bytes arrive, but no MAVLink frame; wrong baud rate?")


def test_a_sender_that_is_no_vehicle(capsys: Capture) -> None:
    port = free_port()
    beat = codec.frame(m.Heartbeat.id, codec.encode_payload(m.Heartbeat(6, 8, 0, 0, 4, 3)), 0, 77, 190)
    sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    with sock, sending(lambda: sock.sendto(beat, ("127.0.0.1", port))):
        line = said(capsys, f"udpin:127.0.0.1:{port}")
    assert line.endswith(" s: MAVLink arrives from system 77, but no HEARTBEAT of a vehicle")


def test_each_of_several_links_is_named(capsys: Capture) -> None:
    tcp, udp = f"tcpout:127.0.0.1:{free_port()}", f"udpin:127.0.0.1:{free_port()}"
    line = said(capsys, tcp, udp)
    assert f" s: {tcp}: not connected (Connection refused); {udp}: nothing arrives; " in line
