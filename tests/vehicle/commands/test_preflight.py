"""DO_SEND_BANNER."""

from __future__ import annotations

from dialects.enums import Command, Result
from tests.vehicle.bench import OTHER, Bench


def test_the_banner() -> None:
    bench = Bench(DRIVE_TYPE=2)
    assert bench.command(Command.DO_SEND_BANNER, introduced=False) is Result.TEMPORARILY_REJECTED
    assert bench.texts == []
    assert bench.command(Command.DO_SEND_BANNER, system=OTHER) is Result.ACCEPTED
    bench.wait(0.1)
    assert bench.texts == ["mavhelm 0.1.0, ackermann drive, mode MANUAL"]
