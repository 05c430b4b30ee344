"""Every screen with the recorded traffic of a real ArduRover."""

from __future__ import annotations

from groundstation.input.keymap import KEYMAPS, Keymap
from groundstation.screens import SCREENS
from groundstation.ui.app.app import ConsoleApp
from groundstation.ui.keys.key_gate import STARTING
from groundstation.ui.look.appearance import PLAIN
from tests.groundstation.recorded_station import RecordedStation
from tests.groundstation.ui import frames
from tests.groundstation.ui.settling import painted_when_seen
from tests.waits import until

FACTS = {
    "drive": ("ArduPilot rover 1", "MANUAL", "ARMED", "RTK fixed, 10 satellites", "servo 1"),
    "map": ("ArduPilot rover 1", "home 0.0 m"),
    "messages": ("EKF_STATUS_REPORT", "GPS2_RAW", "FLIGHT_INFORMATION"),
    "params": ("AHRS_EKF_TYPE", "ARMING_MIS_ITEMS"),
    "charts": ("speed",),
    "log": ("ArduRover V4.7.0-dev (2598e9d4)", "EKF variance", "EKF failsafe cleared"),
    "links": ("4.7.0", "255/190"),
    "setup": ("armed: keys drive on Drive", "110 known"),
    "files": ("no answer",),
    "replay": ("no log is open",),
    "connect": ("heard",),
}
"""Screen: what it shows near the end of the recording."""

STEPS = 3
STEP = 2.0
"""s of the recording, of which each screen sees three at a time."""


async def test_every_screen_shows_the_recorded_vehicle() -> None:
    station = RecordedStation("ardurover.tlog")
    app = ConsoleApp(station.screen, Keymap("standard", KEYMAPS["standard"]), look=PLAIN)
    shown: dict[str, str] = {}
    try:
        with painted_when_seen(app):
            async with app.run_test(size=(80, 24)) as pilot:
                await until(lambda: app.gate.closure != STARTING)
                for size in ((80, 24), (140, 45)):
                    await pilot.resize_terminal(*size)
                    for row in (each for each in SCREENS if each.in_tabs):
                        await pilot.press("ctrl+g", row.digit)
                        for _ in range(STEPS):
                            station.run(STEP)
                            await pilot.pause(0.02)
                        shown[row.id] = frames.text(app)
    finally:
        station.screen.close()
    assert station.ended
    assert station.heard > 1900
    missing = {name: [fact for fact in facts if fact not in shown[name]] for name, facts in FACTS.items()}
    assert not any(missing.values()), missing
