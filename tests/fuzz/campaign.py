"""All targets in turn, each turn in a process of its own, with the processor time and the inputs of each target."""

from __future__ import annotations

import itertools
import json
import os
import re
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from tests.fuzz import engine

EXECUTED = re.compile(rb"stat::number_of_executed_units:\s*(\d+)")


@dataclass
class Tally:
    """What all turns of one target came to."""

    turns: int = 0
    inputs: int = 0
    """Inputs of turns that came to their end."""
    cpu: float = 0.0
    """Processor time, s; on a busy machine much less than the time that has passed."""
    failed: int = 0
    """Turns that an input has ended."""


class Campaign:
    """Goes round the targets; `report` is written after each turn."""

    def __init__(self, targets: Sequence[str], seed: int, grown: Path, memory: int, report: Path | None) -> None:
        self.tallies = {target: Tally() for target in targets}
        self._seed, self._grown, self._memory, self._report = seed, grown, memory, report

    @property
    def failed(self) -> bool:
        """Whether an input has raised."""
        return any(each.failed for each in self.tallies.values())

    def run(self, minutes: float, turn: float) -> None:
        """Fuzz all targets for `minutes`, in turns of `turn` minutes."""
        ends = time.monotonic() + minutes * 60
        for number, target in enumerate(itertools.cycle(self.tallies)):
            left = (ends - time.monotonic()) / 60
            if left <= 0.0:
                break
            self._turn(target, min(turn, left), self._seed + number)
            if self._report:
                text = json.dumps({name: asdict(each) for name, each in self.tallies.items()}, indent=2)
                self._report.write_text(text + "\n")

    def table(self) -> str:
        """Return the figures as lines of text."""
        return "\n".join(
            f"{target:16} {each.turns:3} turns, {each.cpu / 60:6.1f} min of a processor, {each.inputs:9} inputs"
            for target, each in self.tallies.items()
        )

    def _turn(self, target: str, minutes: float, seed: int) -> None:
        """Fuzz a target in a child, which has all imports of this process already."""
        with tempfile.TemporaryFile() as said:
            child = os.fork()
            if not child:
                os.dup2(said.fileno(), 1)
                os.dup2(said.fileno(), 2)
                engine.run(target, minutes, seed, self._grown, self._memory)
                os._exit(0)
            _, status, used = os.wait4(child, 0)
            said.seek(0)
            text = said.read()
        tally, executed = self.tallies[target], EXECUTED.search(text)
        tally.turns += 1
        tally.inputs += int(executed[1]) if executed else 0
        tally.cpu += used.ru_utime + used.ru_stime
        if os.waitstatus_to_exitcode(status):
            tally.failed += 1
            print(target, text[-4000:].decode(errors="replace"), sep="\n", file=sys.stderr)
