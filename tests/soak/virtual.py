"""The same in virtual time: both cores in this process, with keys, screen, station and link in any order, for hours."""

from __future__ import annotations

import random
import time

from dialects.modes import Mode
from tests.soak.census import HOUR, MAX_GROWTH
from tests.soak.heap import Heap
from tests.soak.soak import Findings
from tests.soak.strict import StrictMonkey
from tests.test_signed_stops import sign

WELL = {
    "station_runs": True,
    "screen": True,
    "link": True,
    "delay": 0.0,
    "loss": 0.0,
    "gate": True,
    "key": False,
    "mode": Mode.MANUAL,
    "arm": True,
}
"""Acts of the monkey after which it drives as soon as a key is held."""
BAD = {
    "key": (True, False),
    "stop_key": (True,),
    "screen": (True, False),
    "gate": (True, False),
    "station_runs": (True, False),
    "link": (True, False),
    "delay": (0.02, 0.15, 0.4, 1.5),
    "loss": (0.1, 0.4),
    "mode": (Mode.MANUAL, Mode.HOLD),
    "arm": (True, False),
}
"""Acts of the monkey while it drives, and their arguments."""
READY, DRIVES = 2.5, (0.5, 3.0)
"""s until a rover that may have been lost drives again, and s, random, for which it does before anything is bad."""
PAUSES = (0.01, 0.1, 0.35, 0.6, 1.2, 3.0)
"""s between two acts."""
LEAST_POWER = 0.1
"""Share of the time for which motors must have power, or there was nothing to stop."""
BLOCKS_PER_HOUR = 5000
"""Blocks of memory more after an hour, at most; one for each of 20 demands a second would be 72,000."""
LOOKED = 600.0
"""s between two samples of memory; at most a twelfth of the run."""


class VirtualSoak:
    """`run` it once, then read `report`."""

    def __init__(self, seconds: float, seed: int, *, signing: bool = False, trace: bool = False) -> None:
        """`signing`: both ends sign, and ignore what is not signed.

        `trace` the memory that Python allocates, which takes three times as long.
        """
        self._seconds, self._seed, self._signing = seconds, seed, signing
        self._chance = random.Random(seed)
        self.findings, self.heap = Findings(), Heap(trace=trace)
        self._monkey: StrictMonkey | None = None
        self._lasted = self._took = 0.0

    def run(self) -> None:
        """Run it to its end, to the first fault, or to Ctrl+C."""
        begun = time.process_time()
        self.heap.start()
        try:
            self._go_on()
        except AssertionError as error:
            self.findings.tell(self._lasted, f"{error!r}")
        except KeyboardInterrupt:
            pass  # the report says how long it was
        finally:
            self.heap.stop()
        self._took = time.process_time() - begun
        self._conclude()

    def _go_on(self) -> None:
        monkey = self._monkey = StrictMonkey("hold")
        if self._signing:
            sign(monkey)
        monkey.get_going()
        start, looks = monkey.world.now, 0
        while self._lasted < self._seconds:
            self._episode(monkey)
            self._lasted = monkey.world.now - start
            self.findings.turned = monkey.turned
            if self._lasted >= looks * min(LOOKED, self._seconds / 12):
                looks += 1
                self.heap.look(self._lasted)

    def _conclude(self) -> None:
        """Add what only the end shows; histories need half an hour to fill up."""
        if self.findings.turned < self._lasted * LEAST_POWER:
            self.findings.tell(self._lasted, f"motors had power for {self.findings.turned:.1f} s: this proves nothing")
        growth = self.heap.growth()
        if growth is None or self._lasted < HOUR:
            return
        traced, blocks, _ = growth
        if traced > MAX_GROWTH or blocks > BLOCKS_PER_HOUR:
            self.findings.tell(self._lasted, f"memory grows by {traced:.2f} MB and {blocks:.0f} blocks in an hour")

    def _episode(self, monkey: StrictMonkey) -> None:
        """Drive, then do a few things in any order."""
        for name, argument in WELL.items():
            getattr(monkey, name)(argument)
        monkey.run(READY)
        monkey.key(True)
        monkey.run(self._chance.uniform(*DRIVES))
        for name in self._chance.choices([*BAD], k=self._chance.randint(1, 4)):
            getattr(monkey, name)(self._chance.choice(BAD[name]))
            monkey.run(self._chance.choice(PAUSES))
        monkey.forget()

    @property
    def oldest_obeyed(self) -> tuple[float, float]:
        """Return the largest age of a demand of motion that was obeyed, s: since it arrived, and since it was sent."""
        return (self._monkey.oldest_obeyed, self._monkey.oldest_sent) if self._monkey else (0.0, 0.0)

    def report(self) -> dict[str, object]:
        """Return all figures, and the faults."""
        growth = self.heap.growth()
        return {
            "virtual hours": round(self._lasted / HOUR, 2),
            "of": round(self._seconds / HOUR, 2),
            "seed": self._seed,
            "cpu, s": round(self._took, 1),
            "faults": self.findings.faults,
            "motors had power, s": round(self.findings.turned, 1),
            "signing": self._signing,
            "oldest obeyed demand, s since it arrived, was sent": [round(each, 4) for each in self.oldest_obeyed],
            "traced MB, blocks, rss MB per hour": [round(each, 3) for each in growth] if growth else None,
            "hour, traced MB, blocks, rss MB": [each.row() for each in self.heap.samples],
        }
