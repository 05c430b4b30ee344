"""Somebody who types the lines of README in one terminal, and looks at what they do."""

from __future__ import annotations

import re
import time
from collections.abc import Iterator

from tests.docs_blocks.markdown import Block
from tests.docs_blocks.terminal import LineError, Terminal
from tests.stranger.computers import Computer

TYPED_BY_ROOT = "root"
TYPED = ("", "network", "time", TYPED_BY_ROOT)
"""Kinds of reasons for not running a block that do not hold here: this installs and downloads."""
SITL = "mavhelm --sitl"
FIRST_SCREEN = "F1 Drive"
READY = re.compile(r"DISARMED.*hold r", re.DOTALL)
ARMED = re.compile(r"(?<!DIS)ARMED")
WHEELS = re.compile(r"left wheel [^\n]*\+[1-9]\d*%")
QUIT = "\x11"
KEY_EVERY = 0.03
"""s between two repeats of a held key."""
HELD, RESTED = 6.0, 2.0
"""s for which a key is held and then released, in turn."""
ARM_WITHIN = 60.0
COLLECT = "pytest --suite all --collect-only -q -p no:cacheprovider | tail -n 1; (exit ${PIPESTATUS[0]})"
"""Import every test, those of the long suite too: they may need no package that README does not install."""
WARNING = re.compile(r"^(?!WARNING: Retrying ).*\bwarnings?\b.*$", re.IGNORECASE | re.MULTILINE)
"""Of anything but a slow package index."""
SKIPPED = re.compile(r"^=.*\b(\d+ skipped)\b.*=$", re.MULTILINE)
PROGRESS = "━"
"""In the bars that pip draws one over the other."""
TAIL, WIDTH = 12, 200
"""Lines of a command's output that are shown, and characters of each."""


class Reader:
    """Types all lines in one terminal, so that `cd` and an activated environment last."""

    def __init__(self, computer: Computer, no_skips: bool) -> None:
        self._computer = computer
        self._no_skips = no_skips
        self._terminals: dict[str, Terminal] = {}
        """For root, and for anybody."""
        self.typed = 0

    def type_block(self, block: Block) -> None:
        """Type the lines of a block, unless it needs hardware or a root that is not there. Raises LineError."""
        kind = block.notes.get("not run", "").partition(":")[0]
        as_root = kind == TYPED_BY_ROOT
        if not block.is_shell or kind not in TYPED or (as_root and not self._computer.bare):
            return
        for line in _commands(block.text):
            self._type(self._terminal(as_root), line)

    def collect_all(self) -> None:
        """Import all tests with what README has installed. Raises LineError."""
        self._type(self._terminal(), COLLECT)

    def close(self) -> None:
        """Close the terminals."""
        for terminal in self._terminals.values():
            terminal.close()

    def _terminal(self, as_root: bool = False) -> Terminal:
        user = TYPED_BY_ROOT if as_root else ""
        if user not in self._terminals:
            self._terminals[user] = self._computer.open_terminal(as_root)
        return self._terminals[user]

    def _type(self, terminal: Terminal, line: str) -> None:
        print(f"$ {line}", flush=True)
        began, before = time.monotonic(), _cpu(terminal)
        printed, code = terminal.run(line, _is_ready if SITL in line else _never)
        if code is None:
            printed = printed.partition(FIRST_SCREEN)[0]
            code = _drive(terminal)
        shown = "\n".join([each[-WIDTH:] for each in printed.rstrip().splitlines() if PROGRESS not in each][-TAIL:])
        took, cpu = time.monotonic() - began, _cpu(terminal) - before
        print(f"{shown}\n# exit code {code}, {took:.0f} s, {cpu:.0f} s of CPU", flush=True)
        self._judge(line, printed, code)
        self.typed += 1

    def _judge(self, line: str, printed: str, code: int | None) -> None:
        if code != 0:
            raise LineError(f"{line}: exit code {code}\n{printed[-20_000:]}")
        if warning := WARNING.search(printed):
            raise LineError(f"{line}: {warning[0].strip()}")
        if self._no_skips and (skipped := SKIPPED.search(printed)):
            raise LineError(f"{line}: {skipped[1]}; leave them to the long suite, tests/suite.py\n{printed[-20_000:]}")


def _commands(text: str) -> Iterator[str]:
    """Yield the commands of a block without their comments."""
    for line in text.replace("\\\n", " ").splitlines():
        if command := line.partition(" #")[0].strip():
            yield command


def _drive(terminal: Terminal) -> int | None:
    """Arm, drive until the wheels turn, and quit; return the exit code. Raises LineError."""
    _hold(terminal, "r", ARMED)
    _hold(terminal, "i", WHEELS)
    terminal.type(QUIT)
    return terminal.answer()[1]


def _hold(terminal: Terminal, key: str, until: re.Pattern[str]) -> None:
    """Hold a key until a text is shown, with rests: a busy screen asks to release the keys. Raises LineError."""
    start, began = len(terminal.read()), time.monotonic()
    while not until.search(terminal.read()[start:]):
        passed = time.monotonic() - began
        if passed > ARM_WITHIN:
            raise LineError(f"{key!r} held for {ARM_WITHIN:.0f} s, and no {until.pattern!r} on the screen")
        if passed % (HELD + RESTED) < HELD:
            terminal.type(key)
        terminal.wait(KEY_EVERY)


def _cpu(terminal: Terminal) -> float:
    """Return s of CPU of all that has ended in the terminal."""
    printed, _ = terminal.run("times")
    minutes = re.findall(r"(\d+)m([\d.]+)s", printed)
    return sum(60 * int(whole) + float(rest) for whole, rest in minutes)


def _is_ready(printed: str) -> bool:
    return READY.search(printed) is not None


def _never(_: str) -> bool:
    return False
