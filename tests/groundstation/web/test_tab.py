"""A tab's terminal: what its program sees of it, and how each of them ends."""

from __future__ import annotations

import asyncio
import os
import signal
import sys
from contextlib import suppress
from pathlib import Path

import pytest

from groundstation.web.tab import Tab, screen_command
from tests.groundstation.screen import children, running
from tests.waits import until

PATIENCE = 10.0
SIZES = (
    "import fcntl, struct, termios as t; print(struct.unpack('4H', fcntl.ioctl(0, t.TIOCGWINSZ, bytes(8))), flush=True)"
)
SHOWS_SIZE = ("sh", "-c", f'echo ready; while read -r line; do {sys.executable} -ISc "{SIZES}"; done')
COUNT = """\
import collections, os, signal, tty
tty.setraw(0)
print(f"pid={os.getpid()}.")
os.kill(os.getpid(), signal.SIGSTOP)
read = b""
while not read.endswith(b"."):
    read += os.read(0, 1 << 16)
print(dict(collections.Counter(read.decode())))
"""
COUNTS = (sys.executable, "-ISuc", COUNT)
"""A program that stops itself, and counts the characters up to a dot when it goes on."""


class Shown:
    """A tab, and what its program has drawn."""

    def __init__(self, *command: str, size: tuple[int, int] = (80, 24)) -> None:
        self.tab = Tab.open(command, size)
        self.drawn = ""
        self.showing = asyncio.create_task(self.tab.show(self._take))

    async def until(self, text: str) -> str:
        await until(lambda: text in self.drawn or self.showing.done(), PATIENCE)
        assert text in self.drawn
        return self.drawn

    async def pid(self) -> int:
        return int((await self.until(".")).partition("pid=")[2].partition(".")[0])

    async def close(self) -> None:
        self.showing.cancel()
        with suppress(asyncio.CancelledError):
            await self.showing
        await self.tab.close()

    def is_writing(self) -> bool:
        """Does the loop look whether the terminal takes more? (It does no longer, after this.)"""
        return asyncio.get_running_loop().remove_writer(self.tab._terminal)

    async def _take(self, data: bytes) -> None:
        self.drawn += data.decode()


def open_files() -> list[str]:
    """What the descriptors of this process are."""
    found = []
    for each in Path("/proc/self/fd").iterdir():
        with suppress(FileNotFoundError):  # that of the folder
            found.append(os.readlink(each))
    return sorted(each for each in found if "/fd" not in each)


def state(pid: int) -> str:
    """The state of a process, as ps shows it."""
    return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]


@pytest.mark.parametrize(
    ("asked", "size"),
    [
        ((100, 30), (30, 100)),
        ((0, 0), (5, 20)),
        ((20, 5), (5, 20)),
        ((-1, -1), (5, 20)),
        ((500, 200), (200, 500)),
        ((10**30, 10**30), (200, 500)),
    ],
)
async def test_a_program_sees_the_size(asked: tuple[int, int], size: tuple[int, int]) -> None:
    at_first, later = Shown(*SHOWS_SIZE, size=asked), Shown(*SHOWS_SIZE)
    await later.until("ready")
    later.tab.resize(asked)
    for shown in (at_first, later):
        shown.tab.type("\r")
        await shown.until(f"{(*size, 0, 0)}")
        await shown.close()


async def test_a_program_sees_the_terminal_of_the_browser(monkeypatch: pytest.MonkeyPatch) -> None:
    theirs = ("TMUX", "TMUX_PANE", "STY", "COLUMNS", "LINES", "TERM_PROGRAM", "NO_COLOR", "TERM", "COLORTERM")
    for name in (*theirs, "MAVHELM_OTHER"):
        monkeypatch.setenv(name, "of the start")
    shown = Shown("env")
    async with asyncio.timeout(PATIENCE):
        await shown.showing
    lines = dict(line.partition("=")[::2] for line in shown.drawn.splitlines())
    assert {name: lines.get(name) for name in (*theirs, "MAVHELM_OTHER", "PATH")} == {
        **dict.fromkeys(theirs), "TERM": "xterm-256color", "COLORTERM": "truecolor", "MAVHELM_OTHER": "of the start",
        "PATH": os.environ["PATH"],
    }  # fmt: skip
    await shown.close()


async def test_a_program_has_a_session_of_its_own() -> None:
    """Ctrl-C where the server was started is not for it."""
    shown = Shown(sys.executable, "-ISuc", "import os; print(os.getsid(0) == os.getpid(), os.isatty(0), os.isatty(2))")
    await shown.until("True True True")
    await shown.close()


@pytest.mark.parametrize("command", [("/no/such/program",), ("/",)])
async def test_a_program_that_cannot_start_leaves_nothing(command: tuple[str, ...]) -> None:
    before = open_files()
    with pytest.raises(OSError):
        Tab.open(command, (80, 24))
    assert open_files() == before


async def test_after_a_tab_nothing_is_left() -> None:
    before, processes = open_files(), children(os.getpid())
    shown = Shown("sh", "-c", "stty raw; echo here; exec sleep 600")
    await shown.until("here")
    shown.tab.type("x" * 60_000)
    assert open_files() != before
    shown.tab.hang_up()
    await shown.close()
    assert not shown.is_writing()
    assert open_files() == before
    await until(lambda: children(os.getpid()) == processes)  # a screen that had to be killed is reaped a moment later


async def test_all_that_a_program_draws_is_shown_to_its_end() -> None:
    shown = Shown("sh", "-c", "stty raw; head -c 300000 /dev/zero | tr '\\0' x")
    async with asyncio.timeout(PATIENCE):
        await shown.showing
    assert shown.drawn == "x" * 300_000
    shown.tab.type("no longer")
    shown.tab.resize((90, 30))
    assert not shown.is_writing()
    await shown.close()


async def test_a_slow_browser_makes_the_screen_wait() -> None:
    free, sent = asyncio.Event(), list[bytes]()

    async def send(data: bytes) -> None:
        sent.append(data)
        await free.wait()

    tab = Tab.open(("sh", "-c", "stty raw; echo; exec head -c 300000 /dev/zero"), (80, 24))
    showing = asyncio.create_task(tab.show(send))
    await until(lambda: sent, PATIENCE)
    free.set()
    async with asyncio.timeout(PATIENCE):
        await showing
    assert sum(map(len, sent)) > 300_000
    await tab.close()


@pytest.mark.parametrize(
    ("typed", "read"),
    [
        (["a" * 65_535, "."], {"a": 65_535, ".": 1}),
        (["a" * 65_536, "b" * 60_000, "c" * 1000, "."], {"a": 65_536, "c": 1000, ".": 1}),
        (["b" * 65_537, "a", "."], {"a": 1, ".": 1}),
        (["\ud800a", "."], {"a": 1, ".": 1}),
    ],
)
async def test_input_that_waits_is_whole_messages(typed: list[str], read: dict[str, int]) -> None:
    """A screen that hangs finds what came first, and no half of a paste."""
    shown = Shown(*COUNTS)
    pid = await shown.pid()
    await until(lambda: state(pid) == "T", PATIENCE)
    for text in typed:
        shown.tab.type(text)
    os.kill(pid, signal.SIGCONT)
    await shown.until(f"{read}")
    await shown.close()


async def test_keys_reach_a_screen_after_it_has_read_a_paste() -> None:
    shown = Shown("sh", "-c", "stty raw -echo; echo ready; head -c 60000 | wc -c; stty -raw; exec cat")
    await shown.until("ready")
    shown.tab.type("x" * 60_000)
    await shown.until("60000")
    assert not shown.is_writing()
    shown.tab.type("key\r")
    await shown.until("key")
    await shown.close()


@pytest.mark.parametrize("ignored", ["", "trap '' HUP; "])
async def test_a_closed_tab_ends_its_program(ignored: str) -> None:
    """One that does not read its terminal is killed, in the time that is given to it."""
    shown = Shown("sh", "-c", f"{ignored}echo pid=$$.; exec sleep 600")
    pid = await shown.pid()
    shown.showing.cancel()
    await shown.tab.close(0.1)
    await until(lambda: not running(pid), PATIENCE)


async def test_a_program_that_ends_in_time_is_not_killed(tmp_path: Path) -> None:
    told = tmp_path / "told"
    shown = Shown("sh", "-c", f"echo pid=$$.; cat; echo $? > {told}")
    await shown.pid()
    await shown.close()
    assert told.read_text()


async def test_a_hang_up_ends_a_program() -> None:
    shown = Shown("sh", "-c", "trap 'echo neutral; exit' HUP; echo pid=$$.; while read -r line; do :; done")
    await shown.pid()
    shown.tab.hang_up()
    async with asyncio.timeout(PATIENCE):
        await shown.showing
    assert "neutral" in shown.drawn
    await shown.close()
    shown.tab.hang_up()


async def test_the_screen_is_a_groundstation() -> None:
    shown = Shown(*screen_command(["--version"]))
    async with asyncio.timeout(PATIENCE):
        await shown.showing
    assert shown.drawn.startswith("mavhelm 0.")
    await shown.close()
