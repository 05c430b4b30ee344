"""A short run of the monkey that presses anything on every screen; by hand it runs for minutes."""

from __future__ import annotations

from pathlib import Path

from tests.groundstation.ui.screen_monkey import rampage

ACTS = 30
SEED = 6
"""A seed whose acts drive, too."""


async def test_only_drive_drives_and_stops_stop(tmp_path: Path) -> None:
    seen = await rampage(SEED, ACTS, tmp_path)
    assert seen.pop("turned") > 0, "it must have driven, or there is nothing to stop"
    assert len(seen) > 3, seen
