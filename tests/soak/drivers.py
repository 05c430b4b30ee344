"""Who drives the stations of a soak: keys in a real terminal, and intents to a station without a screen.

`acts` of a driver is what it does for ever; each value is how long to wait, s. Nothing of it blocks.
"""

from __future__ import annotations

import os
import random
import signal
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Protocol

from groundstation.client import StationError
from groundstation.intents.base import Intent
from groundstation.intents.driving import DriveKeyDown, DriveKeyUp, Stop
from groundstation.intents.session import ReportKeyReleases
from groundstation.intents.vehicle import Arm, Disarm, GiveControl, ReleaseControl, RequestControl, SetMode
from groundstation.snapshot import VehicleView
from tests.e2e.programs import LET_GO, GroundStation
from tests.groundstation.held_key import DELAY, GAP
from tests.groundstation.screen import Screen

DRIVES, RESTS = (0.5, 4.0), (0.3, 2.0)
"""s, random: how long a key is held, and the pause after it."""
KEYS = {"i": (1, 0), ",": (-1, 0), "j": (0, -1), "l": (0, 1), "u": (1, -1)}
"""Drive keys -> throttle and steering."""
KEPT_SCREEN = 20_000
"""Bytes of the drawing that are kept."""
ASK_AGAIN = 1.0
"""s between two requests of the same."""


class Driver(Protocol):
    """A ground station and what drives it."""

    @property
    def pid(self) -> int:
        """Process id, or 0 while it does not run."""

    def start(self) -> None: ...

    def kill(self) -> None: ...

    def acts(self) -> Iterator[float]: ...


class KeyDriver:
    """The real program in a pseudo-terminal."""

    def __init__(self, folder: Path, port: int, system: int, seed: str, signing: bool) -> None:
        self._folder, self._port = folder, port
        self._options = ("--system", str(system), "--no-record", *(("--require-signing",) if signing else ()))
        self._chance = random.Random(seed)
        self._program: GroundStation | None = None

    @property
    def pid(self) -> int:
        return self._program.process.pid if self._program else 0

    def start(self) -> None:
        self._program = GroundStation(self._folder, f"udpout:127.0.0.1:{self._port}", *self._options)

    def kill(self) -> None:
        if self._program:
            self._program.end()
        self._program = None

    def acts(self) -> Iterator[float]:
        while self._program:
            yield from self._look(0.5)
            self._program.type(self._chance.choice("Yg"))  # gives control if it is asked, or asks for it
            yield from self._look(1.0)
            if not self._program.says_armed():
                yield from self._hold("r", 2.0)
            self._program.type("1")
            yield from self._look(0.3)
            for _ in range(3):
                yield from self._hold(self._chance.choice("i,jlu"), self._chance.uniform(*DRIVES))
                if self._chance.random() < 0.3:
                    self._program.type(" ")
                yield from self._look(self._chance.uniform(*RESTS) + LET_GO)

    def _hold(self, key: str, seconds: float) -> Iterator[float]:
        end = time.monotonic() + seconds
        wait = DELAY
        while self._program and time.monotonic() < end:
            self._program.type(key)
            self._trim()
            yield wait
            wait = GAP
        yield from self._look(LET_GO)

    def _look(self, seconds: float) -> Iterator[float]:
        end = time.monotonic() + seconds
        while self._program and time.monotonic() < end:
            self._program.look(0.0)
            self._trim()
            yield 0.05

    def _trim(self) -> None:
        if self._program:
            self._program.screen = self._program.screen[-KEPT_SCREEN:]


class SnapshotDriver:
    """A station process whose screen is this program."""

    def __init__(self, port: int, system: int, seed: str, signing: bool) -> None:
        self._port, self._system, self._signing = port, system, signing
        self._chance = random.Random(seed)
        self._screen: Screen | None = None
        self._asked: dict[type[Intent], float] = {}

    @property
    def pid(self) -> int:
        return self._screen.client.pid if self._screen else 0

    def start(self) -> None:
        try:
            endpoint = f"udpout:127.0.0.1:{self._port}"
            self._screen = Screen(endpoint, system=self._system, require_signing=self._signing)
        except StationError:  # a busy machine; the next kill starts it again
            self._screen = None
            return
        self._screen.client.send(ReportKeyReleases())

    def kill(self) -> None:
        if self._screen:
            os.kill(self._screen.client.pid, signal.SIGKILL)
            self._screen.freeze()
            self._screen.client.close()
        self._screen = None

    def acts(self) -> Iterator[float]:
        while self._screen:
            vehicle = self._vehicle()
            if vehicle is None or not self._ready(vehicle):
                yield 0.1
                continue
            yield from self._hold(self._chance.choice([*KEYS]), self._chance.uniform(*DRIVES))
            yield from self._rest(self._chance.uniform(*RESTS))
            if self._chance.random() < 0.1:
                yield from self._rest(2.0)
                self._ask(self._chance.choice((Stop(), Disarm(), SetMode("HOLD"), ReleaseControl())))
                yield from self._rest(self._chance.uniform(2.0, 8.0))

    def _vehicle(self) -> VehicleView | None:
        if self._screen:
            self._screen.snapshot = self._screen.client.receive() or self._screen.snapshot
            return self._screen.snapshot.vehicle
        return None

    def _ready(self, vehicle: VehicleView) -> bool:
        """Ask for what is missing, one after the other. Return whether keys drive."""
        if self._screen and self._screen.snapshot.handover is not None:
            self._ask(GiveControl())
        elif vehicle.driver not in (None, 0, self._system):
            if self._chance.random() < 0.02:
                self._ask(RequestControl())
        elif not vehicle.armed:
            self._ask(Arm(held=1.0))
        elif vehicle.mode != "MANUAL":
            self._ask(SetMode("MANUAL"))
        else:
            return True
        return False

    def _ask(self, intent: Intent) -> None:
        now = time.monotonic()
        if self._screen and now - self._asked.get(type(intent), 0.0) > ASK_AGAIN:
            self._asked[type(intent)] = now
            self._screen.client.send(intent)

    def _hold(self, key: str, seconds: float) -> Iterator[float]:
        throttle, steering = KEYS[key]
        yield from self._send(lambda screen: screen.client.send(DriveKeyDown(key, throttle, steering)))
        yield from self._rest(seconds)
        yield from self._send(lambda screen: screen.client.send(DriveKeyUp(key)))

    def _rest(self, seconds: float) -> Iterator[float]:
        end = time.monotonic() + seconds
        while self._screen and time.monotonic() < end:
            self._vehicle()
            yield 0.1

    def _send(self, act: Callable[[Screen], None]) -> Iterator[float]:
        if self._screen:
            act(self._screen)
        yield 0.0
