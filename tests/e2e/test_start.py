"""The start of the ground station, interrupted by a user who has changed his mind."""

from __future__ import annotations

import select
from pathlib import Path

import pytest

from tests.e2e.programs import GroundStation
from tests.ports import free_port
from tests.waits import PATIENCE, Patience

pytestmark = pytest.mark.e2e


def children(pid: int) -> str:
    return Path(f"/proc/{pid}/task/{pid}/children").read_text()


def test_ctrl_c_while_it_starts_prints_no_traceback(tmp_path: Path) -> None:
    """The station process exists, so the screen is being imported."""
    station = GroundStation(tmp_path, f"udpin:127.0.0.1:{free_port()}")
    try:
        patience = Patience(PATIENCE, station.process.pid)
        while not children(station.process.pid):
            assert not patience.ended
            select.select([], [], [], 0.001)
        station.type("\x03")
        assert station.ended() != 1
        assert b"Traceback" not in station.screen
        assert b"KeyboardInterrupt" not in station.screen
    finally:
        station.end()
