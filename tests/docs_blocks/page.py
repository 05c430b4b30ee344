"""Type the shell blocks of a page, in order."""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from tests.docs_blocks.machine import MINE, Machines
from tests.docs_blocks.markdown import Block, find_blocks
from tests.docs_blocks.programs import NEEDS, Stays, find_asking, find_staying
from tests.docs_blocks.terminal import LineError, StuckError, Terminal

AGAIN, TRIES = 5.0, 10
"""s after which a key that has ended nothing is pressed again, and how often: ROS may lose a Ctrl-C at its start."""


class Command(NamedTuple):
    """What is typed up to the next prompt."""

    place: str
    lines: list[str]

    @property
    def text(self) -> str:
        """Return its first line, which names the program."""
        return self.lines[0].strip()


class Page:
    """A page that is read by one reader, with a terminal on each machine and one for each program that stays."""

    def __init__(self, path: Path, machines: Machines) -> None:
        self._path, self._machines = path, machines
        self._free: dict[str, Terminal] = {}
        self._all: list[Terminal] = []
        self._staying: list[tuple[str, Terminal, Stays]] = []
        self._printed: dict[str, str] = {}
        """Command -> what it has printed."""
        self.ran = self.explained = 0
        self.faults: list[str] = []

    def type_all(self) -> None:
        """Type every block; `faults` has what did not do what the page says."""
        for block in find_blocks(self._path.read_text()):
            if "output of" in block.notes:
                self._compare(block)
            elif block.is_shell and "not run" in block.notes:
                self.explained += 1
            elif block.is_shell:
                self._type_block(block)
                self.ran += 1

    def _type_block(self, block: Block) -> None:
        for program in filter(None, block.notes.get("ends", "").split(", ")):
            self._end_staying(program)
        before = f"{self._path.name}, before line {block.line}"
        for line in block.notes.get("first", "").splitlines():
            self._type(block, Command(before, [line.strip()]), stays=False)
        commands = list(_commands(block, self._path.name))
        for command in commands:
            self._type(block, command, stays="stays" in block.notes and command is commands[-1])

    def _end_staying(self, program: str) -> None:
        """End the programs that stay and whose command begins with this, as the reader does."""
        for each in [each for each in self._staying if each[0].startswith(program)]:
            self._staying.remove(each)
            command, terminal, row = each
            try:
                _end(terminal, row)
            except LineError as failed:
                self.faults.append(f"{self._path.name}: {command}\n{failed}")

    def _terminal(self, machine: str) -> Terminal:
        """Return the terminal on a machine in which no program runs."""
        if machine not in self._free:
            folder = self._machines.folder(machine)
            self._free[machine] = Terminal(folder, self._machines.environment(machine))
            self._all.append(self._free[machine])
        return self._free[machine]

    def _type(self, block: Block, command: Command, *, stays: bool) -> None:
        """Type a command and see it work. If it does not end, the next one has another terminal."""
        if missing := _missing(command.text):
            print(f"{command.place}: left out, {missing} is not installed: {command.text}", flush=True)
            return
        print(f"{command.place}: {command.text}", flush=True)
        machine = block.notes.get("on", MINE)
        terminal = self._terminal(machine)
        start = len(terminal.read())
        try:
            for line in command.lines[:-1]:
                terminal.run(line)
            self._see(terminal, command, stays)
        except LineError as failed:
            self.faults.append(
                f"{command.place}: {command.text}\n{failed}\n{terminal.read()[start:].strip()[-3000:]}\n"
            )
            stays = isinstance(failed, StuckError)
        self._printed[command.text.partition(" #")[0].rstrip()] = terminal.read()[start:]
        if stays:
            del self._free[machine]

    def _see(self, terminal: Terminal, command: Command, stays: bool) -> None:
        """Type the last line of a command, and wait until it has ended or shows that it works. Raises LineError."""
        row, asks = find_staying(command.text), find_asking(command.text)
        seen = re.compile(asks.prompt if asks else row.shows if row else r"(?!)", re.DOTALL)
        text, code = terminal.run(command.lines[-1], lambda text: seen.search(text) is not None)
        if row is not None and code == 0 and _is_background(command.lines[-1]):
            while not seen.search(text):
                text, _ = terminal.answer(lambda text: seen.search(text) is not None)
        elif code is None and asks is not None:
            terminal.type(asks.answer("".join(each.read() for each in self._all)))
            _, code = terminal.answer()
        elif code is None and row is not None and stays:
            self._staying.append((command.text, terminal, row))
            return
        elif code is None and row is not None:
            _end(terminal, row)
            return
        elif row is not None:
            raise LineError(f"it ended with exit code {code}, and should stay")
        if code != 0:
            raise LineError(f"exit code {code}")

    def _compare(self, block: Block) -> None:
        """See that a command has printed the lines of a block, with other numbers at most."""
        command, left_out = block.notes["output of"], block.notes.get("except")
        printed = _comparable(self._printed.get(command, ""))
        for number, line in enumerate(block.text.splitlines(), block.line):
            if _comparable(line) not in printed and not (left_out and left_out in line):
                self.faults.append(f"{self._path.name}:{number}: not in the output of {command}:\n{line}\n{printed}")


def _end(terminal: Terminal, row: Stays) -> None:
    """End a program with its keys, pressed again if it prints nothing: it may be starting. Raises LineError."""
    terminal.wait_for_program()
    for within in (None,) if row.shows else (*[AGAIN] * TRIES, None):
        terminal.type(row.ends)
        try:
            text, code = terminal.answer(within=within)
            break
        except StuckError:
            if within is None:
                raise
    if code not in row.codes and "KeyboardInterrupt" not in text:  # Python was still starting
        raise LineError(f"exit code {code} after {row.ends!r}")


def _is_background(line: str) -> bool:
    return line.partition(" #")[0].rstrip().endswith("&") and not line.partition(" #")[0].rstrip().endswith("&&")


def _missing(command: str) -> str | None:
    """Return the program for a command that this computer lacks; CI has to have them all."""
    need = next((program for begin, program in NEEDS if re.match(begin, command)), None)
    return need if need and shutil.which(need) is None and "MAVHELM_CI" not in os.environ else None


def _comparable(text: str) -> str:
    """Return text with one form of spaces, home folders and numbers."""
    text = re.sub(r"\S*/home/\w+", "~", text)
    return re.sub(r"[\d.]*\d", "0", re.sub(r"[ \t]+", " ", text)).strip()


def _commands(block: Block, page: str) -> Iterator[Command]:
    """Yield the commands of a block: a line, and those that go on with it."""
    lines: list[str] = []
    first = block.line
    for number, line in enumerate(block.text.splitlines(), block.line):
        if not lines:
            first = number
        if lines or line.strip():
            lines.append(line)
        if lines and not line.partition(" #")[0].rstrip().endswith(("\\", "&&", "||", "|")):
            yield Command(f"{page}:{first}", lines)
            lines = []
