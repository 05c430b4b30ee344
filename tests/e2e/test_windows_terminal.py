"""Bytes that Windows Terminal 1.25 sends for keys, replayed into the real screen: it drives and stops exactly.

With all flags of the kitty keyboard protocol: a press has no event type, a repeat has 2 and a release 3, and only text
keys have text (microsoft/terminal, src/terminal/input/ut_kittyKeyboardProtocol.cpp, "AllFlags_FullSequence").
Each stop first sees the wheels turn.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from tests.e2e.programs import GroundStation, Vehicle
from tests.e2e.relay import Relay
from tests.groundstation.held_key import DELAY, GAP
from tests.waits import PATIENCE, Patience, Waits

pytestmark = pytest.mark.e2e

ASKED, ANSWER = b"\x1b[=31;1u\x1b[?u", "\x1b[?31u"
"""What the screen requests (all flags, and which are set), and the answer."""

FOCUS_IN, FOCUS_OUT = "\x1b[I", "\x1b[O"
KEYS = {
    "i": ("\x1b[105;;105u", "\x1b[105;1:2;105u", "\x1b[105;1:3u"),
    "r": ("\x1b[114;;114u", "\x1b[114;1:2;114u", "\x1b[114;1:3u"),
    "space": ("\x1b[32;;32u", "\x1b[32;1:2;32u", "\x1b[32;1:3u"),
    "up": ("\x1b[A", "\x1b[1;1:2A", "\x1b[1;1:3A"),
    "down": ("\x1b[B", "\x1b[1;1:2B", "\x1b[1;1:3B"),
    "escape": ("\x1b[27u", "\x1b[27;1:2u", "\x1b[27;1:3u"),
    "1": ("\x1b[49;;49u", "\x1b[49;1:2;49u", "\x1b[49;1:3u"),
    "i with Num Lock": ("\x1b[105;129;105u", "\x1b[105;129:2;105u", "\x1b[105;129:3u"),
}
"""Press, repeat and release."""
PRESS, REPEAT, RELEASE = range(3)

HOLDS = 1.6
"""s without an event: without reported releases a press would end after 1.1 s at most."""
RAMP, SLACK, TRY = 0.4, 0.15, 4.0
"""s of our rover from full to neutral, of the programs between, and for one try to arm or drive."""


class Rig:
    """The simulated rover, and the ground station in a terminal that answers as Windows Terminal does."""

    def __init__(self, folder: Path, stack: ExitStack) -> None:
        self.relay = Relay()
        stack.callback(self.relay.close)
        self.station = GroundStation(folder, f"udpin:127.0.0.1:{self.relay.ground_port}", "--no-record")
        stack.callback(self.station.end)
        self.vehicle = Vehicle(folder, self.relay.vehicle_port)
        stack.callback(self.vehicle.end)

    def begin(self) -> None:
        """Answer what the screen asks, and arm."""
        station = self.station
        station.wait_for(lambda: ASKED in station.screen, PATIENCE, "the screen requests key releases")
        station.type(ANSWER)
        station.type(FOCUS_IN)
        station.wait_for(lambda: b"disarmed:" in station.screen, PATIENCE, "the drive screen says how to arm")
        patience = Patience(PATIENCE, station.process.pid, self.vehicle.process.pid)
        while not self.relay.armed():
            assert not patience.ended, station.drawn()
            self.hold("r", self.relay.armed)
            station.type(KEYS["r"][RELEASE])
            station.look(0.5)

    def hold(self, key: str, until: Callable[[], bool]) -> None:
        """Hold a key with auto-repeat until the condition, or for TRY s; it stays down."""
        self.station.type(KEYS[key][PRESS])
        self.station.look(DELAY)
        end = time.monotonic() + TRY
        while not until() and time.monotonic() < end:
            self.station.type(KEYS[key][REPEAT])
            self.station.look(GAP)

    def press(self, key: str, *, repeats: int = 1) -> None:
        """Press a drive key, let it repeat a little, and see that it drives on until it is released."""
        patience = Patience(PATIENCE, self.station.process.pid, self.vehicle.process.pid)
        while True:
            self.station.type(KEYS[key][PRESS])
            self.station.look(DELAY)
            for _ in range(repeats):
                self.station.type(KEYS[key][REPEAT])
                self.station.look(GAP)
            self.station.look(HOLDS)
            if self.vehicle.at_full():
                return
            assert not patience.ended, f"{self.station.drawn()}\n{self.vehicle.errors.read_text()}"
            self.station.type(KEYS[key][RELEASE])
            self.station.look(1.2)
            self.station.type(KEYS["1"][PRESS] + KEYS["1"][RELEASE])  # a vehicle that was late is in HOLD
            self.station.look(0.6)

    def stops(self, data: str) -> None:
        """Send bytes while the wheels turn, and see them stop at once."""
        assert self.vehicle.turning()
        waits, at = Waits(self.station.process.pid, self.vehicle.process.pid), time.monotonic()
        self.station.type(data)
        self.station.wait_for(self.vehicle.stands, PATIENCE, "the wheels stop")
        fell, stopped = self.vehicle.falls_and_stops_after(at)
        assert fell < SLACK + waits.total()
        assert stopped < RAMP + SLACK + waits.total()


@pytest.fixture
def rig(tmp_path: Path) -> Iterator[Rig]:
    with ExitStack() as stack:
        made = Rig(tmp_path, stack)
        made.begin()
        yield made


def test_keys_and_focus_of_windows_terminal_drive_and_stop(rig: Rig) -> None:
    """One after the other with the same programs, because their start takes most of the time."""
    check_keys_drive_until_their_release(rig)
    check_a_lost_focus_stops_at_once(rig)
    check_stop_keys_stop_at_once(rig)


def check_keys_drive_until_their_release(rig: Rig) -> None:
    for key in ("i", "up", "down", "i with Num Lock"):
        rig.press(key)
        assert (rig.vehicle.outputs()[-1].throttles[0] > 0) == (key != "down")
        rig.stops(KEYS[key][RELEASE])


def check_stop_keys_stop_at_once(rig: Rig) -> None:
    for key in ("space", "escape"):
        rig.press("i")
        rig.stops(KEYS[key][PRESS])
        rig.station.type(KEYS[key][RELEASE])
        at = time.monotonic()
        for _ in range(10):
            rig.station.type(KEYS["i"][REPEAT])
            rig.station.look(GAP)
        rig.station.type(KEYS["i"][RELEASE])
        assert not rig.vehicle.moved_since(at), "a key that was held while another one stopped drives no more"


def check_a_lost_focus_stops_at_once(rig: Rig) -> None:
    rig.press("i")
    rig.stops(FOCUS_OUT)
    at = time.monotonic()
    rig.station.type(FOCUS_IN)
    for _ in range(10):
        rig.station.type(KEYS["i"][REPEAT])
        rig.station.look(GAP)
    assert not rig.vehicle.moved_since(at), "repeats of a key of before the focus drive nothing"
    rig.station.type(KEYS["i"][RELEASE])
    rig.press("i")
    rig.stops(KEYS["i"][RELEASE])
