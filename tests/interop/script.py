"""pymavlink's mavutil, as a script uses it. mavutil repeats little by itself; on a lossy link `insist` does."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from functools import partial
from importlib import import_module
from typing import Any

from tests.waits import PATIENCE, Patience

os.environ["MAVLINK20"] = "1"  # read when mavutil is imported

mavftp: Any = import_module("pymavlink.mavftp")  # partly typed, so not checked
mavparm: Any = import_module("pymavlink.mavparm")
mavutil: Any = import_module("pymavlink.mavutil")
mavwp: Any = import_module("pymavlink.mavwp")

GCS, NO_AUTOPILOT, ACTIVE = 6, 8, 4
STICK = 0.05
"""s between two MANUAL_CONTROL."""
NEUTRALS = 8
"""Neutral messages before the stick moves: more than a lossy link loses in a row."""


class Script:
    """One connection, which sends its HEARTBEAT once a second while it receives."""

    def __init__(self, port: int, system: int = 255, component: int = 190) -> None:
        mavutil.set_dialect("common")
        self.link = mavutil.mavlink_connection(
            f"udpin:127.0.0.1:{port}", source_system=system, source_component=component
        )
        self._beat_due = 0.0
        assert self.link.wait_heartbeat(timeout=PATIENCE) is not None
        self._beat()

    def __enter__(self) -> Script:
        return self

    def __exit__(self, *_: object) -> None:
        """Close the port."""
        self.link.close()

    def hear(self, *types: str, within: float = 5.0) -> Any:
        """Return the next message of these types, or of any type if none is named; None if there is none."""
        deadline = time.monotonic() + within
        while (left := deadline - time.monotonic()) > 0:
            self._beat()
            message = self.link.recv_match(type=list(types) or None, blocking=True, timeout=min(left, 0.2))
            if message is not None:
                return message
        return None

    def listen(self, seconds: float) -> None:
        """Receive for a while."""
        deadline = time.monotonic() + seconds
        while (left := deadline - time.monotonic()) > 0:
            self.hear(within=left)

    def until(self, condition: Callable[[], bool], within: float = PATIENCE) -> None:
        """Receive until `condition`."""
        patience = Patience(within)
        while not condition():
            assert not patience.ended
            self.hear(within=0.1)

    def insist(self, act: Callable[[], object], condition: Callable[[], bool], within: float = PATIENCE) -> None:
        """Repeat an action each half second, until `condition`."""
        patience = Patience(within)
        while not condition():
            assert not patience.ended
            act()
            again = time.monotonic() + 0.5
            while not condition() and time.monotonic() < again:
                self.hear(within=0.1)

    def command(self, command: int, *params: float) -> int:
        """Send a COMMAND_LONG until it is acknowledged; return the result."""
        answers: list[int] = []

        def hook(_: Any, message: Any) -> None:
            if message.get_type() == "COMMAND_ACK" and message.command == command:
                answers.append(message.result)

        self.link.message_hooks.append(hook)
        full = (*params, *(0.0,) * (7 - len(params)))
        self.insist(lambda: self.link.mav.command_long_send(1, 1, command, 0, *full), lambda: bool(answers))
        self.link.message_hooks.remove(hook)
        return answers[0]

    def stick(self, throttle: int, until: Callable[[], bool], within: float = 5.0) -> None:
        """Hold the stick for a while: 20 MANUAL_CONTROL a second. The condition may stay false."""
        deadline = time.monotonic() + within
        while not until() and time.monotonic() < deadline:
            self.link.mav.manual_control_send(1, throttle, 0, 0, 0, 0)
            self.hear(within=STICK)

    def drive(self, throttle: int, until: Callable[[], bool]) -> None:
        """Send neutral, then the stick, until `until`; again and in MANUAL, if a pause has ended in HOLD."""
        patience = Patience()
        while not until():
            assert not patience.ended
            for _ in range(NEUTRALS):
                self.link.mav.manual_control_send(1, 0, 0, 0, 0, 0)
                self.hear(within=STICK)
            self.stick(throttle, until)
            if not until():
                self.link.set_mode("MANUAL")

    def upload(self, loader: Any) -> int:
        """Send a plan of mavwp's; return the type of the MISSION_ACK. Messages without an answer are repeated after a
        second."""
        last: Any = None
        while True:
            if last is None:
                self.link.waypoint_count_send(loader.count())
            asked = self.hear("MISSION_REQUEST", "MISSION_REQUEST_INT", "MISSION_ACK", within=1.0)
            if asked is not None and asked.get_type() == "MISSION_ACK":
                return int(asked.type)
            last = loader.wp(asked.seq) if asked is not None else last
            if last is not None:
                self.link.mav.send(last)

    def download(self) -> list[Any]:
        """Return the items of the mission in force."""
        count = self._answer(self.link.waypoint_request_list_send, "MISSION_COUNT").count
        return [self._item(number) for number in range(count)]

    def _item(self, number: int) -> Any:
        ask = partial(self.link.mav.mission_request_int_send, 1, 1, number)
        return self._answer(ask, "MISSION_ITEM_INT", lambda item: item.seq == number)

    def fetch(self, path: str) -> bytes:
        """Download a file by mavftp; empty if mavftp gave up."""
        ftp, came = mavftp.MAVFTP(self.link, 1, 1), list[bytes]()
        ftp.cmd_get([path], callback=lambda file: came.append(file.read() if file else b""))
        ftp.process_ftp_reply("OpenFileRO", timeout=PATIENCE)
        return came[0] if came else b""

    def _answer(self, ask: Callable[[], object], kind: str, good: Callable[[Any], bool] = lambda message: True) -> Any:
        for _ in range(round(PATIENCE / 0.5)):
            ask()
            message = self.hear(kind, within=0.5)
            if message is not None and good(message):
                return message
        raise AssertionError(f"no {kind}")

    def _beat(self) -> None:
        if time.monotonic() >= self._beat_due:
            self._beat_due = time.monotonic() + 1
            self.link.mav.heartbeat_send(GCS, NO_AUTOPILOT, 0, 0, ACTIVE)
