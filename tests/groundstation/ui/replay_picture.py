"""Picture of the Replay screen for the documents: a recorded ArduRover, in the real app."""

from __future__ import annotations

from groundstation.replay.log_replay import LogReplay
from tests.groundstation.recorded_station import RECORDINGS
from tests.groundstation.replay.logs import BytesSource, build_station, finish
from tests.groundstation.ui import frames
from tests.groundstation.ui.replay_station import replay_console

MOMENT = "1:12"


async def replay(size: tuple[int, int]) -> dict[str, frames.Picture]:
    """Return the picture of a moment in the recording."""
    data = (RECORDINGS / "ardurover.tlog").read_bytes()
    desk = LogReplay("ardurover.tlog", BytesSource(data), build_station, at=MOMENT)
    finish(desk)
    async with replay_console(desk, size) as screen:
        await screen.press("m", "shift+right", "m")
        return {"replay": frames.cells(screen.app)}
