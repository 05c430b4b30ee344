"""The first command of the README in a real terminal: arm, hold a key, see the rover move, release it, see it stop."""

from __future__ import annotations

import fcntl
import itertools
import math
import os
import pty
import re
import select
import shlex
import struct
import subprocess
import sys
import termios
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest

from tests.e2e.programs import LET_GO
from tests.e2e.tmux_control import TmuxControl
from tests.e2e.tmux_marks import IN_TMUX
from tests.groundstation.held_key import event_times
from tests.groundstation.ui.wheel import modes, notch
from tests.ports import free_port
from tests.waits import PATIENCE, Patience

pytestmark = IN_TMUX

FOLDER = Path(__file__).parents[2]
HELD = 10.0
"""s for a held key to show; then it is pressed anew."""
SHOWN = 10.0
"""s for the charts to show what has been recorded."""
PRESSED_AGAIN = 10.0
"""s for a key to show, before it is pressed again: a screen ignores what was typed while it was frozen."""
PAUSE = 0.04
"""s between two repeats of a key."""
LOOK = 0.1
"""s between two looks at the screen."""


PANE = "screen:0.0"
"""Where the program runs. Held keys are typed from another session: the program asks who the clients of its own are."""
IN_PANE = ("capture-pane", "display-message", "send-keys", "resize-window")
PLAIN = re.compile(r"[A-Za-z0-9,.<>+-]+")
"""Names of keys that tmux's own parser takes as they are."""
HOLD = 3.0
"""s for which a key is held at once."""


class Tmux:
    """A tmux server of its own with one window."""

    def __init__(self, folder: Path, columns: int, lines: int, *arguments: str, shows: Path | None = None) -> None:
        """Run `mavhelm` with these arguments; or show what arrives at the end of a file, as a terminal does."""
        self._socket = str(folder / "tmux")
        self.send_keys: Callable[[Sequence[str], bool], object] = self._send_keys
        """Where keys go: to the program, or to that of which this is a picture. `held`: they are not let go."""
        self.longest_pause = 0.0
        """s between two presses, the longest since a test has set it to 0."""
        self._pressed_at = math.inf
        self._keyboard: subprocess.Popen[str] | None = None
        program = [sys.executable, "-m", "groundstation", *arguments, "--log-file", str(folder / "station.log")]
        size = ["-x", str(columns), "-y", str(lines)]
        runs = f"{shlex.join(program)}; echo EXIT CODE $?; exec cat"
        if shows is not None:
            runs = f"stty raw -echo; exec tail -c +1 -f {shlex.quote(str(shows))}"
        self._run("-f", "/dev/null", "new-session", "-d", "-s", PANE.partition(":")[0], *size, runs)
        server = self._run("display-message", "-p", "#{pid}").strip()
        self._server = int(server) if server.isdecimal() else os.getpid()
        """Process id of tmux, which has started the program."""
        self._control = TmuxControl(self._socket)

    def _run(self, command: str, *words: str) -> str:
        words = (command, *(("-t", PANE) if command in IN_PANE else ()), *words)
        done = subprocess.run(["tmux", "-S", self._socket, *words], capture_output=True, text=True, timeout=PATIENCE)
        return done.stdout

    def _send_keys(self, keys: Sequence[str], held: bool) -> None:
        """Press keys; one that is held by a program that goes on, because starting one for each takes long."""
        if not held or not all(map(PLAIN.fullmatch, keys)):
            self._run("send-keys", *keys)
            return
        if self._keyboard is None:
            self._keyboard = subprocess.Popen(
                ["tmux", "-S", self._socket, "-C", "new-session", "cat"],
                stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, text=True,
            )  # fmt: skip
        assert self._keyboard.stdin is not None
        self._keyboard.stdin.write(f"send-keys -t {PANE} {' '.join(keys)}\n")
        self._keyboard.stdin.flush()

    def screen(self) -> str:
        """Return the text on the screen."""
        return self._control.ask("capture-pane", "-t", PANE, "-p")

    def cursor(self) -> tuple[int, int, bool]:
        """Return column and line of the cursor, and whether it is shown."""
        column, line, shown = self._run("display-message", "-p", "#{cursor_x} #{cursor_y} #{cursor_flag}").split()
        return int(column), int(line), shown == "1"

    @property
    def tty(self) -> str:
        """Path of the terminal."""
        return self._run("display-message", "-p", "#{pane_tty}").strip()

    def press(self, *keys: str, held: bool = False) -> None:
        """Press keys, by tmux's names; or press, and repeat, one that is held."""
        self.send_keys(keys, held)
        now = time.monotonic()
        self.longest_pause = max(self.longest_pause, now - self._pressed_at)
        self._pressed_at = now

    def until(self, condition: Callable[[str], bool], within: float, holding: str | None = None) -> str:
        """Poll until the condition holds for the screen, with a key held meanwhile; return the screen."""
        if holding:
            with self.held(holding, (number * PAUSE for number in itertools.count())):
                return self.until(condition, within)
        patience = self._patience(within)
        while not condition(screen := self.screen()):
            assert not patience.ended, f"not within {within} s:\n{screen}"
            select.select([], [], [], LOOK)
        return screen

    @contextmanager
    def held(self, key: str, times: Iterable[float]) -> Iterator[Callable[[], float]]:
        """Hold a key: press it at these times (s). Yields what lets it go, and returns when it was pressed no more."""
        ended = threading.Event()

        def press() -> None:
            begun = time.monotonic()
            for at in times:
                if ended.wait(max(0.0, begun + at - time.monotonic())):
                    return
                self.press(key, held=True)

        thread = threading.Thread(target=press)
        thread.start()

        def release() -> float:
            ended.set()
            thread.join()
            return time.monotonic()

        try:
            yield release
        finally:
            release()

    def _patience(self, within: float = PATIENCE) -> Patience:
        """Return a wait for what must come, with the delays of the programs; or for one try of several."""
        return Patience(within, *([self._server] if within >= PATIENCE else []))

    def press_until(self, key: str, condition: Callable[[str], bool]) -> str:
        """Press a key, again after PRESSED_AGAIN s, until the condition holds for the screen; return the screen."""
        patience = self._patience()
        while True:
            self.press(key)
            with suppress(AssertionError):
                return self.until(condition, PRESSED_AGAIN)
            assert not patience.ended, self.screen()

    def pause(self, seconds: float) -> None:
        """Keep the hands off the keys for so long."""
        select.select([], [], [], seconds)

    def hold_until(self, key: str, condition: Callable[[str], bool], within: float) -> None:
        """Hold a key for HOLD s at a time until the condition holds for the screen."""
        patience = self._patience(within)
        while not condition(screen := self.screen()):
            assert not patience.ended, f"not within {within} s:\n{screen}"
            with suppress(AssertionError), self.held(key, event_times(HOLD)):
                self.until(condition, HOLD)  # not longer: another press of the key that arms disarms
            select.select([], [], [], LET_GO)

    def drive_until(self, condition: Callable[[str], bool]) -> None:
        """Hold `i` until the condition holds; in MANUAL and pressed anew where a late machine has stopped it."""
        patience = self._patience()
        while True:
            with suppress(AssertionError):
                self.until(condition, HELD, holding="i")
                return
            assert not patience.ended, self.screen()
            select.select([], [], [], LET_GO)
            self.press("1")

    def resize(self, columns: int, lines: int) -> None:
        """Change the size of the terminal."""
        self._run("resize-window", "-x", str(columns), "-y", str(lines))

    def end(self) -> None:
        """Close the terminal and everything in it."""
        self._run("kill-server")
        self._control.end()
        if self._keyboard is not None:
            self._keyboard.communicate(timeout=PATIENCE)


@pytest.fixture
def tmux(tmp_path: Path) -> Iterator[Callable[..., Tmux]]:
    """Return a function that opens a terminal; it is closed at the end of the test."""
    opened: list[Tmux] = []

    def build(columns: int, lines: int, *arguments: str) -> Tmux:
        opened.append(Tmux(tmp_path, columns, lines, *arguments))
        return opened[-1]

    yield build
    for each in opened:
        each.end()


def home_distance(screen: str) -> float:
    """Return the distance between the rover and its home as the map shows it, m."""
    found = re.search(r"home\s+([\d.]+) m", screen)
    return float(found[1]) if found else 0.0


def speed_shown(screen: str) -> bool:
    """Return whether the drive panel shows a motor output."""
    return bool(re.search(r"left\s.*\+[1-9]\d*%", screen))


@pytest.mark.parametrize(("columns", "lines"), [(80, 24), (140, 45)])
def test_the_first_drive(tmux: Callable[..., Tmux], columns: int, lines: int) -> None:
    terminal = tmux(columns, lines, "--sitl")
    terminal.until(lambda screen: "hold r to arm" in screen, PATIENCE)
    terminal.hold_until("r", lambda screen: "hold i to drive" in screen, PATIENCE)
    terminal.drive_until(lambda screen: home_distance(screen) > 1.0 and speed_shown(screen))
    terminal.until(
        lambda screen: re.search(r"left\s.*\+0%", screen) is not None and home_distance(screen) > 1.0, PATIENCE
    )
    terminal.press("r")
    terminal.until(lambda screen: "DISARMED" in screen, PATIENCE)
    terminal.press("C-q")
    ended = terminal.until(lambda screen: "EXIT CODE" in screen, PATIENCE)
    assert "EXIT CODE 0" in ended
    assert "Traceback" not in ended


def test_a_key_held_over_the_log_screen_does_not_drive(tmux: Callable[..., Tmux]) -> None:
    terminal = tmux(80, 24, "--sitl")
    terminal.until(lambda screen: "hold r to arm" in screen, PATIENCE)
    terminal.hold_until("r", lambda screen: "hold i to drive" in screen, PATIENCE)
    terminal.drive_until(speed_shown)
    terminal.press("F6")
    lines = ("live, newest below", "arm accepted", "neutral · F1 drives")
    terminal.until(lambda screen: all(each in screen for each in lines), PATIENCE, holding="i")
    terminal.press("F1")
    terminal.until(lambda screen: "one is held from before" in screen, PATIENCE, holding="i")
    for _ in range(20):
        terminal.until(lambda screen: not speed_shown(screen), PATIENCE, holding="i")
    select.select([], [], [], LET_GO)
    terminal.press("1")
    terminal.drive_until(speed_shown)


@pytest.mark.parametrize(("columns", "lines"), [(80, 24), (140, 45)])
def test_the_messages_of_the_simulator(tmux: Callable[..., Tmux], columns: int, lines: int) -> None:
    terminal = tmux(columns, lines, "--sitl")
    terminal.until(lambda screen: "hold r to arm" in screen, PATIENCE)
    terminal.press("F3")
    terminal.until(
        lambda screen: "1/1 Rover 1" in screen and re.search(r"ATTITUDE +[1-9]", screen) is not None, PATIENCE
    )
    terminal.press("/", "h", "e", "a", "r", "t", "Enter")
    terminal.until(lambda screen: "HEARTBEAT" in screen and "ATTITUDE" not in screen, PATIENCE)
    terminal.press("Down")
    terminal.until(lambda screen: "HEARTBEAT #0" in screen and "GROUND_ROVER" in screen, PATIENCE)
    terminal.until(lambda screen: "HEARTBEAT >" in screen and "this station" in screen, PATIENCE)
    terminal.press("Escape")  # clears the filter
    terminal.until(lambda screen: "ATTITUDE" in screen and "─ messages" in screen, PATIENCE)
    terminal.press("Escape")
    terminal.until(lambda screen: "hold r to arm" in screen, PATIENCE)


def test_charts_of_the_simulator_while_it_is_driven(tmux: Callable[..., Tmux]) -> None:
    terminal = tmux(140, 45, "--sitl")
    terminal.until(lambda screen: "hold r to arm" in screen, PATIENCE)
    terminal.press("F5")
    terminal.until(lambda screen: "1 speed" in screen and "groundspeed 0.00" in screen, PATIENCE)
    terminal.press("p", "Down", "p", "F1")  # two fields are recorded while the rover is driven
    terminal.until(lambda screen: "hold r to arm" in screen, PATIENCE)
    terminal.hold_until("r", lambda screen: " ARMED" in screen, PATIENCE)
    patience = Patience()
    while not shows_the_drive(terminal):  # again: a late machine has stopped it, or the window has left it behind
        assert not patience.ended, terminal.screen()
        terminal.press("F1", "1")


def shows_the_drive(terminal: Tmux) -> bool:
    """Drive, show the charts; return whether they have the speed, the mode and the key within a while."""
    terminal.drive_until(lambda screen: re.search(r"0\.[3-9]\d? m/s", screen) is not None)
    terminal.press("F5")
    recorded = re.compile(r"groundspeed +0\.00 +\d\.\d\d +0\.[3-9]")
    pressed = re.compile(r"marks .*\bi\b")
    with suppress(AssertionError):
        terminal.until(lambda screen: recorded.search(screen) is not None and "━ MANUAL ━" in screen, SHOWN)
        terminal.until(
            lambda screen: "━● groundspeed" in screen and "▲" in screen and bool(pressed.search(screen)), SHOWN
        )
        return True
    return False


def test_waiting_offers_the_simulator(tmux: Callable[..., Tmux]) -> None:
    port = free_port()
    terminal = tmux(80, 24, f"udpin:127.0.0.1:{port}")
    # The first frame may be drawn before the station has reported its links.
    terminal.until(lambda screen: "waiting for a vehicle" in screen and str(port) in screen, PATIENCE)
    terminal.until(lambda screen: "ENTER starts a simulated rover" in screen, PATIENCE)
    terminal.press("Enter")
    terminal.until(lambda screen: "DISARMED" in screen, PATIENCE)


class AttachedTmux:
    """A tmux with its default settings, attached to a terminal that this test plays."""

    def __init__(self, folder: Path, report: Path, *options: str) -> None:
        program = shlex.join([sys.executable, "-m", "tests.groundstation.ui.programs", str(report), *options])
        master, self._slave = pty.openpty()
        fcntl.ioctl(self._slave, termios.TIOCSWINSZ, struct.pack("HHHH", 30, 100, 0, 0))
        command = ["tmux", "-S", str(folder / "tmux"), "-f", "/dev/null", "new-session", program]
        self._client = subprocess.Popen(
            command, cwd=FOLDER, env={**os.environ, "TERM": "xterm-256color"}, start_new_session=True,
            stdin=self._slave, stdout=self._slave, stderr=self._slave,
        )  # fmt: skip
        self._master, self.drawn = master, b""

    def until(self, condition: Callable[[], bool]) -> None:
        """Read what tmux draws until the condition holds."""
        patience = Patience()
        while not condition():
            assert not patience.ended, self.drawn[-2000:]
            if select.select([self._master], [], [], PAUSE)[0]:
                self.drawn += os.read(self._master, 1 << 16)

    def type(self, data: bytes) -> None:
        """Send bytes as the terminal does."""
        os.write(self._master, data)

    def end(self, folder: Path) -> None:
        """End tmux and give the terminal back."""
        subprocess.run(["tmux", "-S", str(folder / "tmux"), "kill-server"], capture_output=True, timeout=60)
        os.close(self._slave)
        os.close(self._master)
        self._client.wait(PATIENCE)


@pytest.mark.parametrize("protected", [False, True], ids=["without protection", "with protection"])
def test_the_mouse_wheel_through_tmux(tmp_path: Path, protected: bool) -> None:
    """In tmux with the default `mouse off` the terminal turns the wheel into arrow keys, and tmux passes them on."""
    report = tmp_path / "report"
    report.touch()
    terminal = AttachedTmux(tmp_path, report, *([] if protected else ["--stock-mouse"]))
    try:
        terminal.until(lambda: b"MANUAL" in terminal.drawn and bool(modes(terminal.drawn).get(1049)))
        if protected:
            terminal.until(lambda: bool(modes(terminal.drawn).get(1000)))
        for _ in range(10):
            terminal.type(notch(terminal.drawn))
        terminal.type(b"-")  # a key that neither drives nor stops, behind the wheel
        terminal.until(lambda: "StepLimits" in report.read_text())
        assert ("DriveKeyDown" in report.read_text()) is not protected
    finally:
        terminal.end(tmp_path)
