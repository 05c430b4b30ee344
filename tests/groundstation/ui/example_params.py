"""Examples of the Parameters screen: pages of an ArduPilot rover with groups, texts, and a file to compare."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec

from groundstation.views.base import View
from groundstation.views.params import ParamDiff, ParamGroup, ParamInfo, ParamInfos, ParamPage, ParamRow
from groundstation.views.requests import RequestLine

INFOS = (
    ParamInfo(
        "FS_ACTION", "Failsafe Action", "What to do on a failsafe event", value=2.0, kind="INT8", index=411,
        default=2.0, low=0.0, high=6.0,
        values=(
            (0.0, "Nothing"), (1.0, "RTL"), (2.0, "Hold"), (3.0, "SmartRTL or RTL"), (4.0, "SmartRTL or Hold"),
            (5.0, "Terminate"), (6.0, "Loiter or Hold"),
        ),
    ),
    ParamInfo("FS_GCS_ENABLE", "GCS failsafe enable", value=0.0, kind="INT8", index=414, default=0.0,
              values=((0.0, "Disabled"), (1.0, "Enabled"), (2.0, "Enabled Continue with Mission in Auto"))),
    ParamInfo("FS_OPTIONS", "Failsafe Options", value=1.0, kind="INT32", index=419, default=0.0,
              bits=((0, "Failsafe enabled in Hold mode"), (1, "Ignore in manual"))),
    ParamInfo(
        "RC_OVERRIDE_TIME", "RC override timeout",
        "Timeout after which RC overrides will no longer be used, and RC input will resume.", "s", 0.0, 120.0, 0.1,
        default=3.0, value=3.0, kind="REAL32", index=1043, file=0.5,
    ),
)  # fmt: skip
ROWS = (
    ParamRow("FS_ACTION", 2.0, "INT8", 2.0, False, "", "Hold"),
    ParamRow("FS_CRASH_CHECK", 0.0, "INT8", 0.0, False, "", "Disabled"),
    ParamRow("FS_EKF_THRESH", 0.8, "REAL32", 0.8, False),
    ParamRow("FS_GCS_ENABLE", 0.0, "INT8", 0.0, False, "", "Disabled"),
    ParamRow("FS_GCS_TIMEOUT", 5.0, "REAL32", 5.0, False, "s"),
    ParamRow("FS_OPTIONS", 1.0, "INT32", 0.0, True, "", "Failsafe enabled in Hold mode"),
    ParamRow("FS_THR_VALUE", 910.0, "INT16", 910.0, False, "PWM"),
    ParamRow("RC_OVERRIDE_TIME", 3.0, "REAL32", 3.0, False, "s", "", 0.5),
    ParamRow("SERVO1_FUNCTION", 73.0, "INT16", 26.0, True, "", "Throttle Left"),
    ParamRow("BARO1_DEVID\\xff", 388_409.0, "INT32", None, False),
)  # fmt: skip
GROUPS = (
    ParamGroup("AHRS", 22, 0), ParamGroup("ARMING", 7, 0), ParamGroup("ATC", 34, 3), ParamGroup("BATT", 42, 5),
    ParamGroup("FS", 10, 1), ParamGroup("RC", 187, 0), ParamGroup("SERVO", 143, 2),
)  # fmt: skip
DIFF = ParamDiff(
    1, "rover-safe.param", 1214,
    (("ATC_STR_RAT_FF", 0.2, 0.75), ("COMPASS_OFS_X", -31.4, 12.9), ("RC_OVERRIDE_TIME", 3.0, 0.5)), 17,
    ("EK3_OLD", "GPS_OLD"),
)  # fmt: skip
PAGE = ParamPage(
    1, ROWS, 0, len(ROWS), 1235, 1235, has_defaults=True, running=(), ended=(), groups=GROUPS, changed=41,
    autopilot="ardupilot", texts="apm.pdef.xml",
)  # fmt: skip


def page(**changes: object) -> ParamPage:
    """Return the page with other fields."""
    return msgspec.structs.replace(PAGE, **changes)


EMPTY = page(rows=(), matching=0, known=0, total=None, groups=(), changed=0)
LOADING = page(known=610, running=(RequestLine(1, "running", "fetch parameters", done=610, total=1235),))
HOLES = page(known=1226, missing=9, gaps=(17, 18, 19, 400, 401, 402, 403, 1200, 1201))
SILENT = page(
    rows=(), matching=0, known=0, total=None, groups=(), changed=0, texts="",
    ended=(RequestLine(1, "no answer", "fetch parameters", "no list after 8 tries"),),
)  # fmt: skip

STATES: dict[str, tuple[Sequence[View], tuple[str, ...]]] = {
    "empty": ((EMPTY,), ()),
    "loading": ((LOADING, ParamInfos(1, INFOS)), ()),
    "holes": ((HOLES, ParamInfos(1, INFOS)), ()),
    "lacking": ((SILENT,), ()),
    "compare": ((page(file=DIFF.file), ParamInfos(1, INFOS), DIFF), ("tab", "tab", "down")),
    "pending": (
        (PAGE, ParamInfos(1, INFOS)),
        ("down", "down", "down", "enter", "end", "backspace", "1", "enter", "end", "up", "up", "enter", "end",
         "backspace", "0", "full_stop", "5", "enter"),
    ),
    "enum": ((PAGE, ParamInfos(1, INFOS)), ("enter", "end", "backspace", *"rtl", "down")),
    "bits": ((PAGE, ParamInfos(1, INFOS)), (*["down"] * 5, "enter", "down", "tab")),
    "groups": ((PAGE, ParamInfos(1, INFOS)), ("tab", "down", "down")),
}  # fmt: skip
"""State -> what the station sends, and the keys that lead to it."""
