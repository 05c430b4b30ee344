"""The list of the Replay screen while no log is open: which session is which."""

from __future__ import annotations

from pathlib import Path

from tests.groundstation.ui.files.test_log_summary import heartbeat, log, speed
from tests.groundstation.ui.pilots import console
from tests.waits import until


async def test_the_list_tells_drives_from_starts_and_how_long(tmp_path: Path) -> None:
    armed = [heartbeat(1, mode=128), speed(0.8)] * 50
    (tmp_path / "drive.tlog").write_bytes(log(armed, 754.0))
    (tmp_path / "garage.tlog").write_bytes(log([heartbeat(2), speed(0.0)] * 50, 95.0))
    (tmp_path / "start.tlog").write_bytes(log([heartbeat(1)] * 9, 5.0))
    async with console((140, 30), folder=tmp_path) as screen:
        await screen.press("ctrl+g", "0")
        await until(lambda: "not listed: 1 below 30 s" in screen.text)
        rows = [line for line in screen.text.splitlines() if ".tlog" in line]
        drive, garage = (next(line for line in rows if word in line) for word in ("drive.", "garage."))
        assert "id 1" in drive
        assert drive.count("12:34") == 2, "length and driven"
        assert "id 2" in garage
        assert "1:35" in garage
        assert " no " in garage
        assert "start.tlog" not in screen.text
