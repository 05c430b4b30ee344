"""The facts that the failsafe conditions evaluate, collected once a cycle."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from dialects.enums import Failsafe
from vehicle.drive.control import Control
from vehicle.navigation.estimate import Estimate
from vehicle.params import Params
from vehicle.readings import Readings
from vehicle.safety.battery import BatteryMonitor
from vehicle.safety.pi_monitor import PiMonitor


class MotionInputs(NamedTuple):
    """What sensors, the estimator and the autonomous modes report."""

    readings: Readings
    estimate: Estimate
    throttles: Sequence[float]
    """Throttle of each driven wheel, -1..1, positive forward."""
    needs_position: bool
    """The mode or the setpoint in use depends on the position estimate."""
    setpoint_expires: float | None
    """Time when the velocity setpoint of GUIDED expired or will expire; None without one."""
    outside_fence: bool


class FailsafeInputs(NamedTuple):
    """Everything that a failsafe condition may depend on."""

    params: Params
    control: Control
    battery: BatteryMonitor
    computer: PiMonitor
    motion: MotionInputs
    manual: bool
    """The mode follows the operator's demand."""
    mission_running: bool
    """The mode is AUTO, which may continue without a ground station (FS_GCS_ENABLE 2)."""
    latched: Failsafe
    """Conditions that have already changed the mode. They stay active although the new mode follows no demand."""
    armed_at: float
