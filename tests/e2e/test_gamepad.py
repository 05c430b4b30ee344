"""A gamepad drives the real programs: what stops the wheels. Only the device is virtual (SDL's own)."""

from __future__ import annotations

import signal
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from groundstation.gamepad.child import missing_package
from tests.e2e.programs import GroundStation, Vehicle
from tests.e2e.relay import Relay
from tests.groundstation.gamepad.pads import FULL, Hand
from tests.waits import PATIENCE, Patience, Waits

pytestmark = [
    pytest.mark.e2e,
    pytest.mark.skipif(missing_package() is not None, reason="the extra [gamepad] is not installed"),
]

RAMP = 0.4
"""s of our rover from full to neutral."""
SLACK = 0.1
TRY = 3.0
DELAYED = 0.1
"""s of the machine in 2 s; with less than that the wheels turn all the time."""


class Rig:
    """The simulated rover, the ground station in a pty, and a hand on the gamepad."""

    def __init__(self, folder: Path, stack: ExitStack) -> None:
        self.hand = stack.enter_context(Hand(folder))
        self.relay = Relay()
        stack.callback(self.relay.close)
        endpoint = f"udpin:127.0.0.1:{self.relay.ground_port}"
        module = "tests.groundstation.gamepad.with_virtual_pad"
        self.station = GroundStation(folder, endpoint, "--gamepad", "any", module=module)
        stack.callback(self.station.end)
        self.vehicle = Vehicle(folder, self.relay.vehicle_port)
        stack.callback(self.vehicle.end)
        self.hand.meet()
        self.seen = 0

    def arm(self) -> None:
        """Plug the gamepad in and hold its button START."""
        self.hand.do("plug Virtual")
        self.sees("gamepad: hold START (Virtual)")
        patience = Patience(PATIENCE, self.station.process.pid, self.vehicle.process.pid)
        while not self.relay.armed():  # again, if a busy machine made a hold of two presses
            assert not patience.ended, self.station.drawn()
            self.hand.do("button Virtual start 1")
            self.station.soon(self.relay.armed, TRY)
            self.hand.do("button Virtual start 0")
        self.sees("gamepad: hold RB (Virtual)")

    def drive(self) -> None:
        """Hold the dead-man button, push the stick, and see the wheels turn."""
        patience = Patience(PATIENCE, self.station.process.pid, self.vehicle.process.pid)
        self.seen = len(self.station.screen)
        while True:
            self.hand.do("axis Virtual lefty 0", "button Virtual rightshoulder 0")
            self.station.look(0.3)
            self.hand.do("button Virtual rightshoulder 1")
            self.station.look(0.1)
            self.hand.do(f"axis Virtual lefty {-FULL}")
            if self.station.soon(self.vehicle.at_full, TRY):
                return
            assert not patience.ended, f"{self.station.drawn()}\n{self.vehicle.errors.read_text()}"

    def drives_on(self, seconds: float) -> None:
        """See the wheels turn for so long without any event; again if the machine has delayed a program meanwhile."""
        deadline = time.monotonic() + PATIENCE
        while True:
            self.drive()
            waits, at = Waits(self.station.process.pid, self.vehicle.process.pid), time.monotonic()
            self.station.look(seconds)
            if all(output.turning for output in self.vehicle.outputs() if output.at > at):
                return
            assert waits.total() > DELAYED, "held without any event"
            assert time.monotonic() < deadline, "the machine has delayed the programs all the time"

    def stops(self, within: float, act: Callable[[], None]) -> float:
        """Drive, act, and see the wheels stop `within` s; return when that was asked for."""
        self.drive()
        waits = Waits(self.station.process.pid, self.vehicle.process.pid)
        at = time.monotonic()
        act()
        self.station.wait_for(self.vehicle.stands, PATIENCE, "the wheels stop")
        _, stopped = self.vehicle.falls_and_stops_after(at)
        assert stopped < within + RAMP + SLACK + waits.total()
        return at

    def sees(self, text: str) -> None:
        """Wait until the screen has shown a text since the last drive."""
        self.station.wait_for(lambda: text.encode() in self.station.screen[self.seen :], PATIENCE, text)


@pytest.fixture
def rig(tmp_path: Path) -> Iterator[Rig]:
    with ExitStack() as stack:
        yield Rig(tmp_path, stack)


def test_what_ends_a_drive_with_the_gamepad(rig: Rig) -> None:
    rig.arm()
    rig.drives_on(2.0)

    rig.stops(0.0, lambda: rig.hand.do("button Virtual rightshoulder 0"))
    rig.stops(0.0, lambda: rig.hand.do("unplug Virtual"))
    rig.sees("gamepad unplugged: neutral")
    rig.hand.do("plug Virtual")

    at = rig.stops(0.25, lambda: rig.hand.send_signal(signal.SIGSTOP))
    rig.hand.send_signal(signal.SIGCONT)  # the button and the stick are still held
    rig.station.look(1.0)
    assert not rig.vehicle.moved_since(at + 0.25 + RAMP + SLACK + 0.5)

    rig.stops(0.0, lambda: rig.hand.send_signal(signal.SIGKILL))
    rig.sees("its reader has ended")
