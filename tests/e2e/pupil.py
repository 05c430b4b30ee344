"""A pupil at a lesson in a real terminal. It knows what the pane says, presses those keys, and nothing else."""

from __future__ import annotations

import re
from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import suppress
from itertools import takewhile
from typing import NamedTuple

from tests.e2e.other_terminals import OtherTerminals, is_command, last_command
from tests.e2e.programs import LET_GO
from tests.e2e.test_in_tmux import Tmux
from tests.waits import PATIENCE, Patience

PANE_COLUMNS, PANE_ROWS = 40, 6
WIDE = 120
TMUX_NAMES = {"SPACE": "Space", "ENTER": "Enter", "TAB": "Tab", "ESC": "Escape", "END": "End", "BACKSPACE": "BSpace",
              "UP": "Up", "DOWN": "Down", "LEFT": "Left", "RIGHT": "Right", ";": "\\;"}  # fmt: skip
"""Key as the pane writes it -> tmux's name, where they differ."""
HOLD, UNTIL = 2.0, 15.0
"""s for which a key is held: without a time in the task, and until something has happened."""
PAGES = 8
"""Turns of the page after which the task must have been seen."""


SEEN = 1.0
"""s for a page to show its task, if it has one."""
REDRAWN = 0.3
"""s after another size of the terminal before its text is read."""
ARMS = "r"
"""The key that arms; when armed it disarms."""
ARMED_WITHIN = 5.0
"""s for which it is held, if the first line does not say ARMED before: a late machine counts none of its pauses."""

Size = tuple[int, int]
"""Columns and lines."""


class Deed(NamedTuple):
    """One thing that a task asks for."""

    what: str
    """"hold", "press" or "type"; in another terminal "run", "run the last" or "interrupt"."""
    key: str
    seconds: float = 0.0
    times: int = 1
    chooses: str = ""
    """The vehicle that the key chooses, as the first line names it: pressed again, the key would choose another."""


class Mistake(NamedTuple):
    """What is done first in place of a task, and what the pane says of it."""

    step: int
    key: str
    hint: str
    """Its beginning: the rest may be on another page."""
    held: bool = True


def read_deeds(task: str) -> list[Deed]:
    """Return what a task or a hint asks for, in its order."""
    return list(_find_deeds(task))


def _find_deeds(task: str) -> Iterator[Deed]:
    found = list(re.finditer(r"\[([^\[\]]+|\[|\])\]", task))
    verb = "press"
    ends = task.startswith("End it")
    if "type the last command" in task:
        yield Deed("run the last", "")
    for at, key in enumerate(found):
        if key[1] == "Ctrl-C":
            yield Deed("interrupt", "")
            continue
        if is_command(key[1]):
            yield Deed("interrupt" if ends else "run", key[1])
            continue
        before = task[found[at - 1].end() if at else 0 : key.start()].casefold()
        after = task[key.end() : found[at + 1].start() if at + 1 < len(found) else len(task)]
        verbs = re.findall(r"\b(hold|press|type)\b", before)
        verb = verbs[-1] if verbs else "press"
        if at and not verbs and not re.search(r"(^\W*(and)?|\bthen)\W*$", before):
            continue  # a key that is only named
        times = re.match(r" (\d+) times", after)
        if verb != "hold":
            chosen = re.match(r": rover (\d+) is chosen", after)
            chooses = f"Rover {chosen[1]} " if chosen else ""
            yield Deed(verb, key[1], times=int(times[1]) if times else 1, chooses=chooses)
        elif "until" in after:
            yield Deed("hold", key[1], UNTIL)
        else:
            seconds = re.search(r"for (a|\d+) s", after)
            yield Deed("hold", key[1], HOLD if seconds is None or seconds[1] == "a" else float(seconds[1]) + 0.5)


class Pupil:
    """Reads the pane and acts."""

    def __init__(
        self, terminal: Tmux, columns: int, others: OtherTerminals | None = None, sizes: Sequence[Size] = ()
    ) -> None:
        """`sizes`: those of the terminal, which takes the next one for each task."""
        self.terminal, self._columns, self._others = terminal, columns, others
        self.mistakes: list[Mistake] = []
        """Those that are still to be made."""
        self._sizes = deque(sizes)
        self._text: list[str] = []
        """The pages before the first task, for what is typed into other terminals."""
        self._command = ""
        """The newest command in another terminal."""
        self.log: list[str] = []

    def pane(self, screen: str) -> list[str]:
        """Return the lines of the pane."""
        lines = screen.split("\n")
        lines = lines[:-1] if lines and not lines[-1] else lines
        if self._columns >= WIDE:
            return [line.ljust(self._columns)[self._columns - PANE_COLUMNS :].rstrip() for line in lines]
        return lines[-PANE_ROWS:]

    def step(self, screen: str) -> int:
        """Return the number of the task that is due; 0 when all are done, -1 without a pane."""
        found = re.search(r"Lesson ?\d* · (?:task (\d+) of \d+|(done))", "\n".join(self.pane(screen)))
        return -1 if found is None else int(found[1] or 0)

    def marked(self, screen: str, mark: str) -> str:
        """Return the text behind a mark; "" where it is not on this page."""
        lines = self.pane(screen)
        at = next((number for number, line in enumerate(lines) if line.startswith(f" {mark} ")), None)
        if at is None:
            return ""
        text = [lines[at][3:]]
        for line in lines[at + 1 :]:
            if not line.startswith("   "):
                break
            text.append(line.strip())
        return " ".join(" ".join(text).split())

    def read_task(self) -> str:
        """Turn pages until the task is shown, and return it."""
        for _ in range(PAGES):
            with suppress(AssertionError):
                return self.marked(self.terminal.until(lambda screen: self.marked(screen, "›") != "", SEEN), "›")
            before = "\n".join(self.pane(self.terminal.screen()))
            self.terminal.press("C-l")
            self.terminal.until(lambda screen, before=before: "\n".join(self.pane(screen)) != before, PATIENCE)  # type: ignore[misc]
        raise AssertionError(self.terminal.screen())

    def learn(self) -> str:
        """Do every task, and return the last screen."""
        screen = self.terminal.until(lambda screen: self.step(screen) > 0, PATIENCE)
        self.terminal.until(lambda screen: "DISARMED" in screen or "Rover 1" in screen, PATIENCE)
        if self._others is not None:
            self._text = self.read_text()
            self._others.write_program(self._text)
        while (step := self.step(screen)) > 0:
            screen = self._do(step)
        return screen

    def read_text(self) -> list[str]:
        """Return the lines before the first task, page by page."""
        lines: list[str] = []
        while True:
            pane = self.pane(self.terminal.screen())
            lines += [line[1:].rstrip() for line in takewhile(lambda each: each[:3] != " › ", pane[1:])]
            page = re.search(r"page (\d+)/(\d+)", pane[0])
            if page is None or page[1] == page[2]:
                return lines
            turned = f"page {int(page[1]) + 1}/"
            self.terminal.press_until("C-l", lambda screen, turned=turned: turned in screen)  # type: ignore[misc]

    def _do(self, step: int) -> str:
        """Do one task, again where a late machine did not see it; return the screen when another one is due."""
        patience, tries, heeded = Patience(2 * PATIENCE), 0, ""
        self._take_next_size()
        for mistake in [each for each in self.mistakes if each.step == step]:
            self._make(mistake)
        while True:
            assert not patience.ended, "\n".join([*self.log, self.terminal.screen()])
            if self.step(screen := self.terminal.screen()) not in (step, -1):
                return screen  # by itself, or later than a late machine was waited for
            task, hint = self.read_task(), self.marked(self.terminal.screen(), "!")
            self.log.append(f"{step}: {hint or task}")
            heeded, hint = hint, "" if hint == heeded else hint  # one that was followed is followed by the task
            for deed in read_deeds(hint) or read_deeds(task):
                self._perform(deed, step)
            if tries and "Run it again" in task and self._others is not None:
                self._others.run(self._command)
            tries += 1
            with suppress(AssertionError):
                return self.terminal.until(lambda screen: self.step(screen) not in (step, -1), UNTIL)
            self.terminal.until(lambda screen: self.step(screen) != -1, PATIENCE)  # another program has the terminal

    def _make(self, mistake: Mistake) -> None:
        """Do what is wrong until the hint is seen. It stays, so that a late screen shows it, too."""

        def told(screen: str) -> bool:
            return self.marked(screen, "!").startswith(mistake.hint)

        if mistake.held:
            self.terminal.hold_until(mistake.key, told, 2 * PATIENCE)
        else:
            self.terminal.press_until(mistake.key, told)
        self.mistakes.remove(mistake)
        self.terminal.pause(LET_GO)

    def _take_next_size(self) -> None:
        if self._sizes:
            self._columns = self._sizes[0][0]
            self.terminal.resize(*self._sizes[0])
            self._sizes.rotate()
            self.terminal.pause(REDRAWN)
            self.terminal.until(lambda screen: self.step(screen) != -1, PATIENCE)

    def _perform(self, deed: Deed, step: int) -> None:
        key, header = self._tmux_name(deed.key), self.terminal.screen().split("\n", 1)[0]
        if deed.what == "hold" and key == ARMS and " ARMED " in header:
            return  # as the first line says
        if deed.chooses and deed.chooses in header:
            return
        if deed.what == "type":
            self.terminal.press(*("Space" if each == " " else each for each in deed.key))
        elif deed.what == "press":
            self.terminal.press(*[key] * deed.times)
        elif deed.what in ("run", "run the last", "interrupt"):
            self._use_another(deed)
        else:
            seconds = ARMED_WITHIN if key == ARMS else deed.seconds
            with suppress(AssertionError):
                self.terminal.until(lambda screen: self._is_done(screen, step, key), seconds, holding=key)
            self.terminal.pause(LET_GO)
        self.terminal.pause(0.8)

    def _is_done(self, screen: str, step: int, key: str) -> bool:
        """Return whether there is nothing to hold this key for any more."""
        return self.step(screen) != step or (key == ARMS and " ARMED " in screen.split("\n", 1)[0])

    def _use_another(self, deed: Deed) -> None:
        assert self._others is not None
        if deed.what == "interrupt":
            self._others.interrupt(deed.key)
            return
        self._command = deed.key if deed.what == "run" else last_command(self._text)
        self._others.run(self._command)

    @staticmethod
    def _tmux_name(key: str) -> str:
        if key.startswith("^") and len(key) == 2:
            return f"C-{key[1]}"
        return TMUX_NAMES.get(key, key)
