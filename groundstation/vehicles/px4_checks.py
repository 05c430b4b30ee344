"""Parameters of a PX4 rover: what it does without us, whether it obeys keys, and which axes its frame uses.

Values and defaults: PX4's commander_params (https://docs.px4.io/main/en/advanced_config/parameter_reference.html).
By default a rover whose manual control is lost keeps the last demand for 0.5 s and then drives home.
"""

from __future__ import annotations

from collections.abc import Mapping

from dialects.axes import PX4_FRAMES
from groundstation.vehicles.autopilot_settings import AutopilotSettings, ParamCheck

LONGEST_LOSS_TIME = 1.0
"""s for which a vehicle may keep a demand that is not renewed before we warn."""

LONGEST_STATION_LOSS = 10.0
"""s, the default of COM_DL_LOSS_T."""

DISABLED, RETURN, LAND = 0, 2, 3
"""Values of NAV_RCL_ACT and NAV_DLL_ACT. 1 is hold, 5 terminate, 6 disarm."""


def _manual_loss_time(value: float, system: int) -> str | None:
    if value <= LONGEST_LOSS_TIME:
        return None
    return f"COM_RC_LOSS_T {value:g}: drives on for {value:g} s when the link is lost; set it to 0.5"


def _station_loss_time(value: float, system: int) -> str | None:
    if value <= LONGEST_STATION_LOSS:
        return None
    return f"COM_DL_LOSS_T {value:g}: notices a lost ground station after {value:g} s; set it to 10"


def _loss_action(name: str, disabled: str, lost: str) -> ParamCheck:
    """Return the check of what the vehicle does when the link, or the ground station, is lost."""
    actions = {
        DISABLED: f"{disabled} when the {lost} is lost",
        RETURN: f"drives home when the {lost} is lost",
        LAND: f"selects land mode when the {lost} is lost",
    }
    return _described(name, actions, "set it to 1 (hold)")


def _described(name: str, meanings: Mapping[int, str], remedy: str) -> ParamCheck:
    def check(value: float, system: int) -> str | None:
        meaning = meanings.get(int(value))
        return None if meaning is None else f"{name} {value:g}: {meaning}; {remedy}"

    return check


def _frame(value: float, system: int) -> str | None:
    return None if value in PX4_FRAMES else f"CA_AIRFRAME {value:g} is not a rover: test the steering slowly"


def _without_link(values: Mapping[str, float]) -> str | None:
    after, action = values.get("COM_RC_LOSS_T"), values.get("NAV_RCL_ACT")
    if after is None or action is None or action == LAND:
        return None
    if action == DISABLED:
        return "by its settings it never stops"
    return f"by its settings it {'drives home' if action == RETURN else 'stops'} after {after:g} s"


_SOURCES: dict[int, str] = {
    0: "obeys RC only, keys do not drive",
    4: "ignores manual control, keys do not drive",
}
"""COM_RC_IN_MODE -> what is wrong with it."""

PX4 = AutopilotSettings(
    checks={
        "COM_RC_IN_MODE": _described("COM_RC_IN_MODE", _SOURCES, "set it to 1"),
        "COM_RC_LOSS_T": _manual_loss_time,
        "NAV_RCL_ACT": _loss_action("NAV_RCL_ACT", "never stops", "link"),
        "COM_DL_LOSS_T": _station_loss_time,
        "NAV_DLL_ACT": _loss_action("NAV_DLL_ACT", "no failsafe", "GCS"),
        "CA_AIRFRAME": _frame,
    },
    without_link=_without_link,
    bytewise=True,
    frame="CA_AIRFRAME",
)
