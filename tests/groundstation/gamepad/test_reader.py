"""The reader process with virtual gamepads: plugged in, unplugged, several of them, and what it tells the screen."""

from __future__ import annotations

import signal
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from groundstation.gamepad import child
from groundstation.gamepad.child import GamepadChild, missing_package
from groundstation.input.pad import PadFrame
from groundstation.input.pad_mapping import ANY, PadMapping
from tests.groundstation.gamepad.pads import FULL, Hand
from tests.groundstation.screen import running
from tests.waits import wait_until

pytestmark = pytest.mark.skipif(missing_package() is not None, reason="the extra [gamepad] is not installed")


class Bench:
    """A reader, and the frames that it has sent."""

    def __init__(self, hand: Hand, wanted: str = ANY) -> None:
        self.hand = hand
        self.frames: list[PadFrame] = []
        self.child = GamepadChild(PadMapping(), wanted)
        self.child.start(self.frames.append)
        hand.meet()

    @property
    def newest(self) -> PadFrame:
        return self.child.frame


@pytest.fixture
def bench(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Bench]:
    monkeypatch.setattr(child, "READER", "tests.groundstation.gamepad.virtual_reader")
    with Hand(tmp_path) as hand:
        made = Bench(hand)
        yield made
        made.child.stop()


def test_two_gamepads_of_which_one_drives(bench: Bench) -> None:
    hand = bench.hand
    hand.do("plug One", "button One rightshoulder 1")
    wait_until(lambda: bench.newest.names == ("One",))
    assert not bench.newest.held, "its button was held when it was plugged in"
    hand.do("button One rightshoulder 0")
    wait_until(lambda: bench.newest.read_at > time.monotonic() - 0.3)
    hand.do("button One rightshoulder 1")
    wait_until(lambda: bench.newest.held)
    hand.do(f"axis One lefty {-FULL}", "button One start 1")
    wait_until(lambda: bench.newest.throttle == 1.0 and bench.newest.buttons == ("start",))

    hand.do("plug Two", f"axis Two lefty {FULL}", "button Two rightshoulder 1")
    wait_until(lambda: bench.newest.names == ("One", "Two"))
    assert (bench.newest.name, bench.newest.throttle) == ("One", 1.0)
    steady = len(bench.frames)
    wait_until(lambda: len(bench.frames) > steady + 20)  # 1 s without any event: a held stick is legal while it is read
    assert {(frame.throttle, frame.held) for frame in bench.frames[steady:]} == {(1.0, True)}

    hand.do("unplug One")
    wait_until(lambda: bench.newest.names == ("Two",))
    assert not bench.newest.held, "its button was held before it drives"
    hand.do("button Two rightshoulder 0", "axis Two lefty 0", "plug Three")
    wait_until(lambda: len(bench.newest.names) == 2)
    bench.child.choose_next()
    wait_until(lambda: bench.newest.name == "Three")


def test_a_reader_that_hangs_or_is_killed_is_noticed(bench: Bench) -> None:
    bench.hand.do("plug One")
    wait_until(lambda: bench.newest.names == ("One",))
    assert bench.child.problem(time.monotonic()) == ""
    bench.hand.send_signal(signal.SIGSTOP)
    wait_until(lambda: bench.child.problem(time.monotonic()) == "its reader does not respond")
    bench.hand.send_signal(signal.SIGKILL)
    wait_until(lambda: "has ended" in bench.child.problem(time.monotonic()))
    assert bench.newest.names == ()
    wait_until(lambda: bench.frames[-1] == bench.newest)


def test_it_ends_with_the_screen(bench: Bench) -> None:
    assert running(bench.hand.reader)
    bench.child.stop()
    assert not running(bench.hand.reader)
