"""Parameters of a PX4 rover: what it does without us, whether it obeys keys, and which axes its frame uses.

Values and defaults: PX4's commander_params (https://docs.px4.io/main/en/advanced_config/parameter_reference.html).
By default a rover whose manual control is lost keeps the last demand for 0.5 s, holds a place for COM_FAIL_ACT_T and
then drives home. Hold does not stop a rover: simulated ones drove on around the place, at up to full steering and 0.97
throttle, until they were disarmed. Disarming stopped them 0.7 s after the last demand.
"""

from __future__ import annotations

from collections.abc import Mapping

from dialects.axes import PX4_FRAMES
from groundstation.vehicles.stops.autopilot_settings import AutopilotSettings, ParamCheck

LONGEST_LOSS_TIME = 1.0
"""s for which a vehicle may keep a demand that is not renewed before we warn."""

LONGEST_STATION_LOSS = 10.0
"""s, the default of COM_DL_LOSS_T."""

DISABLED, HOLD, RETURN, LAND, TERMINATE, DISARM = 0, 1, 2, 3, 5, 6
"""Values of NAV_RCL_ACT and NAV_DLL_ACT."""

LONGEST_HOLD = 5.0
"""s, the default of COM_FAIL_ACT_T, for which it holds before it drives home or selects land mode."""


def _manual_loss_time(value: float, system: int) -> str | None:
    if value <= LONGEST_LOSS_TIME:
        return None
    return f"COM_RC_LOSS_T {value:g}: drives on for {value:g} s when the link is lost; set it to 0.5"


def _station_loss_time(value: float, system: int) -> str | None:
    if value <= LONGEST_STATION_LOSS:
        return None
    return f"COM_DL_LOSS_T {value:g}: notices a lost ground station after {value:g} s; set it to 10"


_DISARM = "set it to 6 (disarm)"

_LINK_LOST: dict[int, str] = {
    DISABLED: "never stops when the link is lost",
    HOLD: "holds a place, and may drive for it",
    RETURN: "drives home when the link is lost",
    LAND: "land mode when the link is lost",
}
"""NAV_RCL_ACT -> what is wrong with it, where the loss of the link shall stop the rover."""

_STATION_LOST: dict[int, str] = {
    DISABLED: "no failsafe when the GCS is lost",
    RETURN: "drives home when the GCS is lost",
    LAND: "land mode when the GCS is lost",
}
"""NAV_DLL_ACT -> the same. It is what ends a mission, for which holding a place is as good as disarming."""


def _hold_time(value: float, system: int) -> str | None:
    if value <= LONGEST_HOLD:
        return None
    return f"COM_FAIL_ACT_T {value:g}: holds a place for {value:g} s before it acts; set it to 5"


def described(name: str, meanings: Mapping[int, str], remedy: str) -> ParamCheck:
    """Return the check of a parameter whose values mean something; those that are not in `meanings` are good."""

    def check(value: float, system: int) -> str | None:
        meaning = meanings.get(int(value))
        return None if meaning is None else f"{name} {value:g}: {meaning}; {remedy}"

    return check


def _frame(value: float, system: int) -> str | None:
    return None if value in PX4_FRAMES else f"CA_AIRFRAME {value:g} is not a rover: test the steering slowly"


_WITHOUT_LINK: dict[int, str] = {
    HOLD: "it holds a place after {after:g} s, and may drive for it",
    RETURN: "it holds a place after {after:g} s, and drives home {hold:g} s later",
    LAND: "it holds a place after {after:g} s, and selects land mode {hold:g} s later",
    TERMINATE: "it stops after {after:g} s (terminated)",
    DISARM: "it stops after {after:g} s (disarmed)",
}
"""NAV_RCL_ACT -> what a lost link means."""


def _link_loss_action(values: Mapping[str, float]) -> str | None:
    after, hold, action = (values.get(name) for name in ("COM_RC_LOSS_T", "COM_FAIL_ACT_T", "NAV_RCL_ACT"))
    if after is None or action is None:
        return None
    if action == DISABLED:
        return "by its settings it never stops"
    text = _WITHOUT_LINK.get(int(action))
    if text is None or (hold is None and "{hold" in text):
        return None
    return f"by its settings {text.format(after=after, hold=hold)}"


SOURCES: dict[int, str] = {
    0: "obeys RC only, keys do not drive",
    4: "ignores manual control, keys do not drive",
}
"""COM_RC_IN_MODE -> what is wrong with it."""

PX4 = AutopilotSettings(
    checks={
        "COM_RC_IN_MODE": described("COM_RC_IN_MODE", SOURCES, "set it to 1"),
        "COM_RC_LOSS_T": _manual_loss_time,
        "NAV_RCL_ACT": described("NAV_RCL_ACT", _LINK_LOST, _DISARM),
        "COM_FAIL_ACT_T": _hold_time,
        "COM_DL_LOSS_T": _station_loss_time,
        "NAV_DLL_ACT": described("NAV_DLL_ACT", _STATION_LOST, _DISARM),
        "CA_AIRFRAME": _frame,
    },
    link_loss_action=_link_loss_action,
    bytewise=True,
    frame="CA_AIRFRAME",
)
