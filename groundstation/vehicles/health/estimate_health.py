"""Health of the estimator in words: EKF_STATUS_REPORT of ArduPilot, ESTIMATOR_STATUS of PX4 and our vehicle."""

from __future__ import annotations

import math

from dialects import messages as m
from dialects.enums import EstimatorFlag
from groundstation.snapshot.drive import HealthLine

FAIR = 0.5
"""Variances and test ratios from which on to look: from 0.8 on (FS_EKF_THRESH) ArduRover's failsafe counts."""

NO_POSITION, UNINITIALIZED = 1 << 7, 1 << 10
"""EKF_CONST_POS_MODE and EKF_UNINITIALIZED of EKF_STATUS_REPORT."""

GPS_GLITCH, ACCEL_ERROR = 1 << 10, 1 << 11
"""Of ESTIMATOR_STATUS."""


def ekf_line(message: m.EkfStatusReport) -> HealthLine:
    """Return the line of an EKF_STATUS_REPORT."""
    if message.flags & UNINITIALIZED:
        return HealthLine("estimate", "not initialised", False)
    lacks = _lacks(message.flags, const_position=bool(message.flags & NO_POSITION))
    worst = {
        "velocity": message.velocity_variance, "position": message.pos_horiz_variance,
        "compass": message.compass_variance,
    }  # fmt: skip
    return _line(lacks, worst, "variance", math.nan)


def estimator_line(message: m.EstimatorStatus) -> HealthLine:
    """Return the line of an ESTIMATOR_STATUS."""
    lacks = _lacks(message.flags, const_position=bool(message.flags & NO_POSITION))
    lacks += ["GPS glitch"] if message.flags & GPS_GLITCH else []
    lacks += ["accelerometer error"] if message.flags & ACCEL_ERROR else []
    worst = {"velocity": message.vel_ratio, "position": message.pos_horiz_ratio, "compass": message.mag_ratio}
    return _line(lacks, worst, "ratio", message.pos_horiz_accuracy)


def _lacks(flags: int, *, const_position: bool) -> list[str]:
    holds = {
        "attitude": flags & EstimatorFlag.ATTITUDE,
        "velocity": flags & EstimatorFlag.VELOCITY,
        "position": flags & (EstimatorFlag.POSITION_RELATIVE | EstimatorFlag.POSITION_ABSOLUTE) and not const_position,
    }
    missing = [name for name, held in holds.items() if not held]
    return [f"no {', '.join(missing)}"] if missing else []


def _line(lacks: list[str], ratios: dict[str, float], what: str, accuracy: float) -> HealthLine:
    name, worst = max(ratios.items(), key=lambda item: item[1] if math.isfinite(item[1]) else -1.0)
    if math.isfinite(worst) and worst >= FAIR:
        lacks = [*lacks, f"{name} {what} {worst:.2f}"]
    if lacks:
        return HealthLine("estimate", "; ".join(lacks), False)
    within = f", within {accuracy:.1f} m" if math.isfinite(accuracy) and accuracy > 0 else ""
    shown = f", worst {what} {worst:.2f}" if math.isfinite(worst) and worst > 0 else ""
    return HealthLine("estimate", f"good{within}{shown}", True)
