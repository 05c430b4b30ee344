"""The other terminals of a pupil: programs that the text of a lesson names, started and ended as a person does."""

from __future__ import annotations

import os
import re
import shlex
import signal
import subprocess
import sys
from pathlib import Path

from tests.ports import free_port
from tests.waits import PATIENCE

COMMAND = re.compile(r"(?:roscore|[a-z0-9_]{3,} .+)")
"""A key of the text that is a command, not a key."""
FILE = re.compile(r"\b\w+\.py\b")


def is_command(key: str) -> bool:
    """Return whether what stands in brackets is typed into another terminal."""
    return COMMAND.fullmatch(key) is not None or key.startswith("mavhelm ")


class OtherTerminals:
    """Each command has a terminal of its own, in one folder."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        programs = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
        self._master = str(free_port())
        master = {"ROS_MASTER_URI": f"http://127.0.0.1:{self._master}", "ROS_HOSTNAME": "127.0.0.1"}
        self._environment = {**os.environ, **master, "ROS_HOME": str(folder / "ros"), "PATH": programs}
        self._running: dict[str, subprocess.Popen[bytes]] = {}
        self.said = folder / "other_terminals.txt"
        """What the programs have printed."""

    def write_program(self, text: list[str]) -> None:
        """Write the lines behind "Write these lines into a file, NAME.py ...:" into that file."""
        before = next((at for at, line in enumerate(text) if line.endswith(":")), None)
        names = FILE.findall(" ".join(text))
        if before is not None and names:
            lines = [line for line in text[before + 1 :] if line]
            (self._folder / names[0]).write_text("\n".join(lines) + "\n")

    def run(self, command: str) -> None:
        """Type a command, unless it runs already."""
        process = self._running.pop(command, None)
        if process is None or process.poll() is not None:
            with self.said.open("ab") as said:
                port = ["-p", self._master] if command == "roscore" else []  # other tests have masters, too
                process = subprocess.Popen(
                    [*shlex.split(command), *port], cwd=self._folder, env=self._environment,
                    stdin=subprocess.DEVNULL, stdout=said, stderr=said, start_new_session=True,
                )  # fmt: skip
        self._running[command] = process  # the newest is the last

    def interrupt(self, command: str = "") -> None:
        """Press Ctrl-C in the terminal of the command that begins so; "": in the newest."""
        begun = [each for each in self._running if each.startswith(command)]
        if begun:
            _end(self._running.pop(begun[-1]), signal.SIGINT)

    def end(self) -> None:
        """Close all of them."""
        while self._running:
            _end(self._running.popitem()[1], signal.SIGTERM)


def _end(process: subprocess.Popen[bytes], first: signal.Signals) -> None:
    if process.poll() is None:
        os.killpg(process.pid, first)
        try:
            process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()


def last_command(text: list[str]) -> str:
    """Return the last command of a text, which may have several lines."""
    lines = [line.strip() for line in text if line.strip()]
    at = len(lines) - 1
    while at and lines[at - 1].endswith("\\"):
        at -= 1
    return " ".join(line.removesuffix("\\").strip() for line in lines[at:])
