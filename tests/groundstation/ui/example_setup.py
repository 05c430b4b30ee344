"""Views of the Setup screen: well, with faults, empty, a motor that turns."""

from __future__ import annotations

from typing import Any

from groundstation.snapshot import Snapshot
from groundstation.views.doctor import (
    CalibrationRow,
    CheckText,
    DoctorRow,
    DoctorView,
    MotorRow,
    MotorTestView,
    ParamFix,
    SensorRow,
    StickRow,
)
from groundstation.views.requests import RequestLine
from link.runtime.diagnosis import Health

OK, WARNING, FAULT, UNKNOWN = Health.OK, Health.WARNING, Health.FAULT, Health.UNKNOWN


def row(name: str, title: str, health: Health, evidence: str, advice: str = "", action: str = "",
        fix: ParamFix | None = None) -> DoctorRow:  # fmt: skip
    """A row of the chain."""
    return DoctorRow(id=name, title=title, health=health, evidence=evidence, advice=advice, action=action, fix=fix)


ROWS = (
    row("keys", "keys", OK, "this terminal reports key releases, ping 5 ms"),
    row("station", "station", OK, "runs as system 255"),
    row("link", "link", OK, "udpin:127.0.0.1:14550: round trip 12 ms, 0.3% lost, 0 bad"),
    row("vehicle", "vehicle", OK, "ArduPilot rover 1, firmware 4.7.0, heard 0 s ago"),
    row("dialect", "dialect", OK, "common messages; 26% of the frames are messages unknown here"),
    row("our_id", "our id", OK, "255, nobody else has it"),
    row("control", "control", OK, "not managed by this vehicle: arming takes it"),
    row("pre_arm", "pre-arm", FAULT, "Compass not calibrated (+1)", "calibrate the compass, outdoors", "setup.checks"),
    row("mode", "mode", WARNING, "HOLD: arming changes to MANUAL", "set MANUAL", "vehicle.manual"),
    row("armed", "armed", UNKNOWN, "no", "arm it on Drive", "app.drive"),
    row("stop_bound", "stop bound", WARNING, "RC_OVERRIDE_TIME 3: drives on for 3 s when the link is lost",
        "set it to 0.5", "app.params", ParamFix("RC_OVERRIDE_TIME", 3.0, 0.5)),
    row("gcs_failsafe", "GCS failsafe", WARNING, "FS_GCS_ENABLE 0: no failsafe when the ground station is lost",
        "set it to 1", "app.params", ParamFix("FS_GCS_ENABLE", 0.0, 1.0)),
    row("failsafes", "failsafes", OK, "none acts"),
    row("fence", "fence", UNKNOWN, "none is loaded"),
    row("battery", "battery", OK, "12.1 V, 76%"),
    row("motors", "motors", UNKNOWN, "left wheel, right wheel: not tested in this session",
        "test them, wheels off the ground", "setup.motors"),
)  # fmt: skip

NO_VEHICLE = tuple(
    row(each.id, each.title, UNKNOWN, "after the vehicle is heard") if each.id not in ("keys", "station") else each
    for each in ROWS
)

CALIBRATIONS = (
    CalibrationRow("accel", "accelerometers", OK, "done"),
    CalibrationRow("level", "level", UNKNOWN, ""),
    CalibrationRow("gyro", "gyros", UNKNOWN, ""),
    CalibrationRow("pressure", "pressure", UNKNOWN, ""),
    CalibrationRow("compass", "compass", UNKNOWN, ""),
    CalibrationRow("sticks", "RC sticks", UNKNOWN, ""),
)


def doctor_view(**changes: Any) -> DoctorView:
    """An ArduPilot rover with a compass that is not calibrated."""
    values: dict[str, Any] = {
        "system": 1,
        "name": "ArduPilot rover 1",
        "rows": ROWS,
        "sensors": (
            SensorRow("gyros", OK), SensorRow("accelerometers", OK), SensorRow("compass", FAULT),
            SensorRow("GPS", OK), SensorRow("fence", UNKNOWN),
        ),
        "texts": (
            CheckText("Compass not calibrated", "calibrate the compass, outdoors", 2.0),
            CheckText("Throttle (RC3) is not neutral", "centre the throttle stick, or switch the transmitter off", 2.0),
            CheckText("Flux capacitor empty", "", 2.0),
        ),
        "checked": RequestLine(4, "accepted", "pre-arm checks", service="setup", system=1),
        "checked_ago": 2.0,
        "motors": (
            MotorRow(1, "left wheel", "SERVO1 73", 0.0, tested=True, reversal=ParamFix("SERVO1_REVERSED", 0.0, 1.0)),
            MotorRow(2, "right wheel", "SERVO3 74", None),
        ),
        "calibrations": CALIBRATIONS,
        "facts": (("firmware", "4.7.0"), ("system", "1/1"), ("dialect", "common"), ("demands", "MANUAL_CONTROL")),
    }  # fmt: skip
    return DoctorView(**(values | changes))


WELL = doctor_view(
    rows=tuple(
        row(each.id, each.title, OK if each.health in (FAULT, WARNING) else each.health, each.evidence) for each in ROWS
    ),
    texts=(),
)
TURNING = doctor_view(
    motors=(MotorRow(1, "left wheel", "SERVO1 73", 0.12), MotorRow(2, "right wheel", "SERVO3 74", 0.0)),
    test=MotorTestView(1, "turns at +12%", turning=True),
)
LAYING = doctor_view(calibration="lay it nose down, then ENTER (4 of 6)", waits_for_position=True)
COMPASS = doctor_view(
    calibration="compass 1 62 %, compass 2 40 % (attempt 2): turn it slowly about every axis; x cancels",
    calibration_share=0.4,
)
STICKS = doctor_view(
    calibration="move all sticks to their ends, centre them, then ENTER (moved: 1, 3)",
    sticks=(
        StickRow(1, 1102, 1898, 1504, moved=True), StickRow(2, 1450, 1550, 1500, moved=False),
        StickRow(3, 1100, 1901, 1100, moved=True), StickRow(4, 1500, 1500, 1500, moved=False),
    ),
)  # fmt: skip
ASKED = doctor_view(checked=RequestLine(4, "running", "pre-arm checks", service="setup", system=1), texts=())
UNANSWERED = doctor_view(
    checked=RequestLine(4, "no answer", "pre-arm checks", "after 6 tries", service="setup", system=1), texts=(),
)  # fmt: skip
LACKING = doctor_view(
    checked=RequestLine(4, "refused", "pre-arm checks", "UNSUPPORTED", service="setup", system=1), texts=(), sensors=(),
    motors=(), calibrations=tuple(CalibrationRow(each.kind, each.title, UNKNOWN, "cannot") for each in CALIBRATIONS),
)  # fmt: skip
EMPTY = DoctorView(rows=NO_VEHICLE)

SETUP_VIEWS = {
    "setup": doctor_view(), "setup_well": WELL, "setup_turning": TURNING, "setup_asked": ASKED,
    "setup_unanswered": UNANSWERED, "setup_lacking": LACKING, "setup_empty": EMPTY, "setup_laying": LAYING,
    "setup_compass": COMPASS, "setup_sticks": STICKS,
}  # fmt: skip
"""By the name of the golden frame, without its size."""

SMALL, WIDE, WIDEST = (80, 24), (140, 45), (200, 50)


def setup_frames(stands: Snapshot, waits: Snapshot) -> dict[str, tuple[tuple[int, int], Snapshot, tuple[str, ...]]]:
    """The golden frames: size, picture, keys."""
    opened = ("f8",)
    return {
        "setup_80x24": (SMALL, stands, opened),
        "setup_140x45": (WIDE, stands, opened),
        "setup_200x50": (WIDEST, stands, opened),
        "setup_well_80x24": (SMALL, stands, opened),
        "setup_turning_80x24": (SMALL, stands, ("f8", "m", "y")),
        "setup_turning_140x45": (WIDE, stands, ("f8", "m", "y")),
        "setup_laying_140x45": (WIDE, stands, opened),
        "setup_compass_140x45": (WIDE, stands, opened),
        "setup_sticks_80x24": (SMALL, stands, opened),
        "setup_sticks_140x45": (WIDE, stands, opened),
        "setup_asked_140x45": (WIDE, stands, opened),
        "setup_unanswered_140x45": (WIDE, stands, opened),
        "setup_lacking_140x45": (WIDE, stands, opened),
        "setup_empty_80x24": (SMALL, waits, opened),
    }


def setup_view(name: str) -> DoctorView:
    """The view of a golden frame."""
    return SETUP_VIEWS[name.removeprefix("ascii_").rpartition("_")[0]]
