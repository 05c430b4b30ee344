"""A tmux session without a client: real tmux, and a real client that is killed or detached."""

from __future__ import annotations

import os
import select
import shlex
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from dialects import messages as m
from dialects.enums import Command
from groundstation.ui.terminal.tmux import RELEASE_AFTER, TmuxSession, find_clients
from tests.e2e.programs import LET_GO
from tests.fakes.lines import on_line
from tests.fakes.rover import FakeArduPilot
from tests.fakes.vehicle import FakeVehicle
from tests.groundstation.held_key import GAP, event_times
from tests.groundstation.ui.ptys import attach_pty
from tests.waits import PATIENCE, Patience

FOLDER = Path(__file__).parents[4]

needs_tmux = pytest.mark.skipif(
    shutil.which("tmux") is None and "MAVHELM_CI" not in os.environ,
    reason="tmux is not installed: `sudo apt install tmux` to run this test",
)


def test_control_is_released_once_after_a_few_seconds() -> None:
    session = TmuxSession("%0")
    session.handle_control(True)
    session.update((os.getpid(),), 100.0)
    session.update((), 101.0)
    assert session.detached
    assert not session.pop_release(101.0 + RELEASE_AFTER - 0.1)
    session.update(None, 103.0)
    assert [session.pop_release(101.0 + RELEASE_AFTER) for _ in range(2)] == [True, False]
    session.update((os.getpid(), os.getppid()), 111.0)
    assert not session.detached
    assert session.away == 10.0


def test_client_that_comes_back_soon_finds_control_where_it_was() -> None:
    session = TmuxSession("%0")
    session.update((os.getpid(),), 99.0)
    session.update((), 100.0)
    session.update((os.getpid(),), 102.0)
    assert (session.pop_release(110.0), session.detached, session.away) == (False, False, None)


def test_a_session_that_never_had_a_client_is_driven_by_a_script() -> None:
    session = TmuxSession("%0")
    session.update((), 100.0)
    assert not session.detached
    assert not session.pop_release(110.0)


def test_without_control_nothing_is_released_or_claimed() -> None:
    session = TmuxSession("%0")
    session.handle_control(False)
    session.update((os.getpid(),), 99.0)
    session.update((), 100.0)
    assert session.detached
    assert not session.pop_release(110.0)
    session.update((os.getpid(),), 111.0)
    assert session.away is None
    other = TmuxSession("%0")
    other.handle_control(False, any_vehicle=True)
    other.update((os.getpid(),), 99.0)
    other.update((), 100.0)
    assert other.pop_release(110.0)


def test_the_notice_ends_when_we_are_in_control_again() -> None:
    session = TmuxSession("%0")
    session.handle_control(True)
    session.update((os.getpid(),), 99.0)
    session.update((), 100.0)
    assert session.pop_release(104.0)
    session.update((os.getpid(),), 105.0)
    session.handle_control(True)  # the vehicle has not reported the release yet
    assert session.away == 5.0
    for in_control in (False, True):
        session.handle_control(in_control)
    assert session.away is None


@pytest.mark.parametrize(
    ("environment", "asks"),
    [({}, False), ({"TMUX_PANE": "%1"}, False), ({"TMUX": "/tmp/x,1,0", "TMUX_PANE": "%1"}, True)],
)
def test_only_a_pane_of_tmux_is_asked_about(environment: dict[str, str], asks: bool) -> None:
    assert (TmuxSession.from_environment(environment)._pane is not None) is asks


async def test_without_tmux_nothing_is_known(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("TMUX", f"{tmp_path}/none,1,0")
    assert await find_clients("%0") is None
    monkeypatch.setenv("PATH", str(tmp_path))
    assert await find_clients("%0") is None


class Session:
    """A tmux server of its own with the ground station in it, and one client on a pseudo-terminal."""

    def __init__(self, folder: Path, endpoint: str) -> None:
        self._words = ["tmux", "-S", str(folder / "tmux"), "-f", "/dev/null"]
        program = [sys.executable, "-m", "groundstation", endpoint, "--log-file", str(folder / "station.log")]
        self._client: subprocess.Popen[bytes] | None = None
        self._master = -1
        self.attach("new-session", shlex.join(program))

    def attach(self, *words: str) -> None:
        """Attach a client."""
        self._client, self._master = attach_pty([*self._words, *(words or ["attach"])], FOLDER)

    def lose_client(self, *, kill: bool) -> None:
        """End the client as a lost connection does, or detach it."""
        assert self._client is not None
        self._client.send_signal(signal.SIGKILL) if kill else self.run("detach-client")
        self._client.wait(PATIENCE)
        os.close(self._master)
        self._client = None

    def run(self, *words: str) -> str:
        """Run a tmux command."""
        return subprocess.run([*self._words, *words], capture_output=True, text=True, timeout=PATIENCE).stdout

    def screen(self) -> str:
        """Return what the program shows."""
        return self.run("capture-pane", "-p")

    def until(self, condition: Callable[[], bool], what: str) -> None:
        """Wait."""
        patience = Patience()
        while not condition():
            assert not patience.ended, f"not within {PATIENCE} s: {what}\n{self.screen()}"
            self.look(GAP)

    def hold(self, key: bytes, condition: Callable[[], bool], what: str) -> None:
        """Hold a key for 2 s at a time until the condition holds."""
        deadline = time.monotonic() + PATIENCE
        while time.monotonic() < deadline:
            begun = time.monotonic()
            for at in event_times(2.0):
                self.look(begun + at - time.monotonic())
                if condition():
                    return
                os.write(self._master, key)
            self.look(LET_GO)
        raise AssertionError(f"not within {PATIENCE} s: {what}\n{self.screen()}")

    def look(self, seconds: float) -> None:
        """Read what tmux draws."""
        until = time.monotonic() + seconds
        masters = [self._master] if self._client else []
        while select.select(masters, [], [], max(0.0, until - time.monotonic()))[0]:
            os.read(self._master, 1 << 16)

    def end(self) -> None:
        """End the server and the client."""
        self.run("kill-server")
        if self._client is not None:
            self._client.wait(PATIENCE)
            os.close(self._master)


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    with ExitStack() as opened:
        yield opened


def asks_for_motion(vehicle: FakeVehicle) -> bool:
    """Return whether the newest demand that the vehicle got is not neutral."""
    demands = vehicle.all(m.ManualControl)
    newest = demands[-1][1] if demands else m.ManualControl(1, 0, 0, 0, 0, 0)
    return any(getattr(newest, axis) not in (0, m.INVALID_AXIS) for axis in "xyzr")


@needs_tmux
@pytest.mark.e2e
@pytest.mark.tmux
@pytest.mark.parametrize("kill", [True, False], ids=["client killed", "client detached"])
@pytest.mark.parametrize("rover", [FakeVehicle, FakeArduPilot])
def test_a_lost_client_means_neutral_then_control_is_released(
    rover: Callable[[], FakeVehicle], kill: bool, stack: ExitStack, tmp_path: Path
) -> None:
    vehicle = rover()
    line = stack.enter_context(on_line(vehicle, "udpin"))
    session = Session(tmp_path, line.endpoint)
    stack.callback(session.end)
    session.until(lambda: "DISARMED" in session.screen(), "a vehicle")
    while not vehicle.armed:  # again, if a late machine makes two presses of one, of which the second disarms
        session.hold(b"r", lambda: vehicle.armed, "arming")
        session.look(LET_GO)
    session.until(lambda: "you drive" in session.screen(), "control")
    session.hold(b"i", lambda: asks_for_motion(vehicle), "driving")
    session.lose_client(kill=kill)
    session.until(lambda: not asks_for_motion(vehicle), "neutral")
    control = Command.REQUEST_OPERATOR_CONTROL
    session.until(lambda: any(each.param1 == 0 for each in vehicle.commands(control)), "the release")
    session.until(lambda: "you drive" not in session.screen(), "the screen knows")
    assert "nobody is attached to tmux" in session.screen()
    session.attach()
    session.until(lambda: "tmux was detached for" in session.screen(), "the reason")
    session.hold(b"g", lambda: "you drive" in session.screen(), "control again")
