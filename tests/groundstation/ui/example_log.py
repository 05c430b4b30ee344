"""Lines of the log with a refused command in them, for tests of the Log screen."""

from __future__ import annotations

from groundstation.snapshot import LogLine
from groundstation.snapshot.log_origin import LogOrigin
from groundstation.views.log import LogPage
from tests.groundstation.ui.examples import NOON

ROVER = LogOrigin(1, 1, "ArduPilot rover 1")
OTHER = LogOrigin(2, 1, "Rover 2")
DENIED = LogOrigin(1, 0, "ArduPilot rover 1", result=4)

FOUND, ARM, ARMED, THROTTLE, CARD, MODE, REFUSED, REASON, OTHERS, BACK = (
    LogLine(time=NOON + at, severity=severity, label=label, text=text, number=number, origin=origin)
    for number, (at, severity, label, text, origin) in enumerate(
        [
            (0.0, 5, "station", "ArduPilot rover 1 found", None),
            (3.0, 6, "you", "arm", None),
            (3.2, 6, "ack", "arm accepted", LogOrigin(1, 0, "ArduPilot rover 1", result=0)),
            (3.3, 5, "vehicle", "Throttle armed", ROVER),
            (20.0, 4, "vehicle", "Logging failed: no space on card", ROVER),
            (52.3, 6, "you", "mode GUIDED", None),
            (52.4, 4, "ack", "mode GUIDED failed", DENIED),
            (52.5, 2, "vehicle", "Mode change to GUIDED failed: requires position, and the estimate has none", ROVER),
            (52.6, 4, "vehicle", "battery low", OTHER),
            (58.0, 5, "state", "ArduPilot rover 1: HOLD", LogOrigin(1, 0, "ArduPilot rover 1")),
        ],
        start=1,
    )
)  # fmt: skip
REPEATED = LogLine(
    time=CARD.time, severity=4, label="vehicle", text=CARD.text, number=CARD.number, origin=ROVER, count=3,
    first=NOON + 12.5,
)  # fmt: skip
LINES = (FOUND, ARM, ARMED, THROTTLE, REPEATED, MODE, REFUSED, REASON, OTHERS, BACK)
REFUSAL_PAGE = LogPage(LINES, state=12)
