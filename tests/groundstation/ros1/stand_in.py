"""A stand-in for the node, as an interpreter: it says what a test writes, and keeps what it is told."""

from __future__ import annotations

import json
import os
import sys
import time
from pathlib import Path
from typing import Any

SCRIPT = """\
#!{python}
import os, sys, threading
said = open({fifo!r})
def say():
    for line in said:
        if line == "END\\n":
            return
        sys.stdout.write(line)
        sys.stdout.flush()
def listen():
    with open({told!r}, "w") as told:
        for line in sys.stdin:
            told.write(line)
            told.flush()
    os._exit(0)
threading.Thread(target=listen, daemon=True).start()
say()
"""


class StandIn:
    """Makes an executable `python`; `say` is what the node writes."""

    def __init__(self, folder: Path) -> None:
        self.python = folder / "python"
        self._fifo, self._told = folder / "said", folder / "told"
        os.mkfifo(self._fifo)
        self.python.write_text(SCRIPT.format(python=sys.executable, fifo=str(self._fifo), told=str(self._told)))
        self.python.chmod(0o755)
        self._pipe = os.open(self._fifo, os.O_RDWR)  # neither end waits for the other one

    def say(self, **fields: Any) -> None:
        """Write a line of the node."""
        os.write(self._pipe, f"{json.dumps(fields)}\n".encode())

    def ready(self) -> None:
        """Say that it subscribes."""
        self.say(ready="/mavhelm_1", master="http://localhost:11311")

    def word(self, data: str, *, age: float = 0.0, sender: str = "/command_node") -> None:
        """Say that a String has arrived `age` s ago."""
        self.say(**{"topic": "command", "from": sender, "at": time.monotonic() - age, "values": {"data": data}})

    def twist(self, linear: float, angular: float) -> None:
        """Say that a Twist has arrived."""
        values = {"linear": {"x": linear, "y": 0.0, "z": 0.0}, "angular": {"x": 0.0, "y": 0.0, "z": angular}}
        self.say(**{"topic": "cmd_vel", "from": "/twist", "at": time.monotonic(), "values": values})

    def end(self) -> None:
        """End the process of the node."""
        os.write(self._pipe, b"END\n")

    def told(self) -> list[Any]:
        """Return what it was told to publish."""
        lines = self._told.read_text().rpartition("\n")[0].splitlines() if self._told.exists() else []
        return [json.loads(line) for line in lines]

    def close(self) -> None:
        """Close the pipe."""
        os.close(self._pipe)
