"""A log by FTP while somebody drives: what the download gets of the wire, and when demands reach the motors meanwhile.

The driver sends 20 demands a second on the line that the log comes through, and changes its demand at random moments.
The first part is the same without the download.
"""

from __future__ import annotations

import asyncio
import random
import time
from bisect import bisect_right
from dataclasses import dataclass, field
from pathlib import Path

from dialects.axes import Axes, build_manual_control
from dialects.messages import UINT16_MAX, RoverDriveStatus
from link.core import Outgoing, Received
from tests.benchmarks import service_jobs as jobs
from tests.benchmarks.figures import BenchmarkError, Goal, Row, Table, brief, spread
from tests.benchmarks.station import Station

PERIOD = 0.05
"""s between two demands."""
CHANGES = (0.2, 0.4)
"""s, random, between two changes of the demand."""
ALONE, QUICK_ALONE = 20.0, 4.0
"""s of driving without the download."""
LOG_SIZE, QUICK_LOG_SIZE = 60_000, 6_000
"""Bytes of the log."""
NEUTRAL = 1.0
"""s of neutral demands after arming; the vehicle accepts others only after them."""
SHARE = 30.0
"""% of the wire that the log is to have."""
CYCLE = 20.0
"""ms of a control cycle: a demand that is later than the slowest without a download by more counts as late."""
WITHOUT, WITH = "without a download", "with a download"


@dataclass(slots=True)
class Part:
    """What was seen without or with the download."""

    changes: list[int] = field(default_factory=list)
    """When the demand was changed, CLOCK_MONOTONIC ns."""
    ages: list[int] = field(default_factory=list)
    """ms of the demand in use, as the vehicle reported it."""


class Driver:
    """A client of `Station` that drives."""

    def __init__(self) -> None:
        self.part = Part()
        self.driving = False
        self._chance = random.Random(5)
        self._throttle = 0.0
        self._due = self._change_due = 0.0
        self._outgoing: list[Outgoing] = []

    def receive(self, received: Received, now: float) -> None:
        """Keep the age of the demand in use."""
        if self.driving and isinstance(received.message, RoverDriveStatus):
            self.part.ages.append(received.message.demand_age_ms)

    def tick(self, now: float) -> None:
        """Send the demand that is due."""
        if self.driving and now >= self._change_due:
            self._change_due, self._due = now + self._chance.uniform(*CHANGES), now
            self._throttle = 0.3 if self._throttle > 0.5 else 0.7
            self.part.changes.append(time.monotonic_ns())
        if now >= self._due:
            self._due = max(self._due + PERIOD, now)
            self._outgoing.append(Outgoing(build_manual_control(Axes(throttle=self._throttle), 1)))

    def messages_to_send(self) -> list[Outgoing]:
        """Return what to send now and clear the queue."""
        outgoing, self._outgoing = self._outgoing, []
        return outgoing


async def drive(station: Station, times: jobs.Times, *, quick: bool) -> dict[str, Part]:
    """Drive without and with a download by an armed vehicle."""
    driver = Driver()
    station.add_client(driver)
    await asyncio.sleep(NEUTRAL)
    driver.driving, alone = True, driver.part
    await asyncio.sleep(QUICK_ALONE if quick else ALONE)
    driver.part = both = Part()
    await jobs.fetch_log(station, times, QUICK_LOG_SIZE if quick else LOG_SIZE, jobs.DRIVEN_FILE, jobs.DRIVEN_LOG)
    driver.driving = False
    if not station.armed:
        raise BenchmarkError(f"the vehicle disarmed while it was driven; it says {station.texts[-3:]}")
    return {WITHOUT: alone, WITH: both}


def judge(parts: dict[str, Part], motors: Path, share: float, baud: int) -> tuple[Table, list[Goal]]:
    """Compare both parts by the vehicle's motor log. `share`: % of the wire that the log had."""
    stamps = [int(line.split()[0]) for line in motors.read_text().splitlines()]
    delays = {name: _delays(part.changes, stamps) for name, part in parts.items()}
    rows: list[Row] = []
    for name, part in parts.items():
        each, known = spread([delays[name]]), [age for age in part.ages if age != UINT16_MAX]
        rows.append(
            {"driver": name, "changes": each.samples, "p50": each.p50, "p99": each.p99, "max": each.max}
            | {"oldest demand reported": max(known), "log, % of the wire": share if name == WITH else None}
        )
    slowest = max(delays[WITHOUT])
    late = sum(delay > slowest + CYCLE for delay in delays[WITH])
    beside = f"slowest {WITHOUT}, {brief(slowest)} ms"
    goals = [
        Goal(f"{jobs.DRIVEN_FILE} at {baud} baud, share of the wire", share, SHARE, "%", True, "the wire"),
        Goal(f"demands late by a control cycle, {WITH}", late, 0, "", reference=beside),
    ]
    note = (
        "ms from a changed demand to the motors. `late`: more than a control cycle later than the slowest without it."
    )
    return Table(f"Driven at 20 Hz at {baud} baud", rows, note), goals


def _delays(changes: list[int], stamps: list[int]) -> list[float]:
    """Return the ms from each change of the demand to the next change of the motors."""
    found = [(bisect_right(stamps, change), change) for change in changes]
    delays = [(stamps[index] - change) / 1e6 for index, change in found if index < len(stamps)]
    if not delays:
        raise BenchmarkError("no demand reached the motors")
    return delays
