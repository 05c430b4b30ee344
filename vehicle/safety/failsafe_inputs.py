"""What counts as a failure: one function a condition. What follows is vehicle/safety/failsafe.py, RULES.

What sensors and self-driving find wrong is in vehicle/safety/hazards.py.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

from dialects.enums import Failsafe
from vehicle.drive.control import Control
from vehicle.params import Params
from vehicle.safety.battery import BatteryMonitor
from vehicle.safety.pi_monitor import PiMonitor

CONTINUE_MISSION = 2
"""FS_GCS_ENABLE: a mission does not end with the ground station's voice."""


class FailsafeInputs(NamedTuple):
    """What the conditions look at, in each cycle while armed."""

    params: Params
    control: Control
    battery: BatteryMonitor
    computer: PiMonitor
    driven: bool
    """The mode obeys the driver's demand."""
    latched: Failsafe
    """What has put the mode away: it still counts, though the mode obeys no demand any more."""
    armed_at: float
    hazards: Mapping[Failsafe, float]
    """What sensors and self-driving found (hazards.py)."""
    alone: bool
    """The mode may go on without a ground station, where FS_GCS_ENABLE says so."""


def _manual_loss(scene: FailsafeInputs, now: float) -> float | None:
    control = scene.control
    if control.demand is None or not control.is_demand_stale(now) or not _matters(scene, Failsafe.MANUAL_LOSS):
        return None
    lost = control.demand.time + scene.params["MAN_TIMEOUT"]
    # A lost neutral changes nothing until HOLD is due: no alarm for two lost frames of a driver at rest.
    quiet = 0.0 if control.requests_motion() else scene.params["FS_TIMEOUT"]
    return lost if now - lost >= quiet else None


def _gcs_loss(scene: FailsafeInputs, now: float) -> float | None:
    enabled = scene.params["FS_GCS_ENABLE"]
    if not enabled or (enabled == CONTINUE_MISSION and scene.alone) or not scene.control.is_owner_lost(now):
        return None
    return now - scene.control.silence_duration(now) + scene.params["FS_GCS_TIMEOUT"]


def _operator(scene: FailsafeInputs, now: float) -> float | None:
    control = scene.control
    lost = (
        control.presence.is_lost(scene.params["OPR_TIMEOUT"], now)
        and control.requests_motion()
        and not control.is_demand_stale(now)
    )
    return now if lost and _matters(scene, Failsafe.OPERATOR) else None


def _battery_low(scene: FailsafeInputs, now: float) -> float | None:
    return _while_armed(scene, scene.battery.low_since(now))


def _battery_critical(scene: FailsafeInputs, now: float) -> float | None:
    return _while_armed(scene, scene.battery.critical_since(now))


def _overheat(scene: FailsafeInputs, now: float) -> float | None:
    return _while_armed(scene, scene.computer.failing_since()) if scene.params["FS_PI_ACT"] else None


def _while_armed(scene: FailsafeInputs, began: float | None) -> float | None:
    """Somebody who arms by force gets the whole countdown."""
    return None if began is None else max(began, scene.armed_at)


def _matters(scene: FailsafeInputs, cause: Failsafe) -> bool:
    return scene.driven or bool(scene.latched & cause)


CONDITIONS: dict[Failsafe, Callable[[FailsafeInputs, float], float | None]] = {
    Failsafe.MANUAL_LOSS: _manual_loss,
    Failsafe.GCS_LOSS: _gcs_loss,
    Failsafe.OPERATOR: _operator,
    Failsafe.BATTERY_LOW: _battery_low,
    Failsafe.BATTERY_CRITICAL: _battery_critical,
    Failsafe.OVERHEAT: _overheat,
}
"""Condition -> since when it holds, or None; asked each cycle while armed."""


def active_conditions(scene: FailsafeInputs, now: float) -> dict[Failsafe, float]:
    """The conditions that hold, each with the time it began."""
    began = {cause: find(scene, now) for cause, find in CONDITIONS.items()}
    return {cause: at for cause, at in began.items() if at is not None} | dict(scene.hazards)
