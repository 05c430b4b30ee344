"""What ArduPilot reports of a compass calibration: MAG_CAL_PROGRESS while it measures, MAG_CAL_REPORT at the end.

libraries/AP_Compass/AP_Compass_Calibration.cpp of ArduPilot; MAG_CAL_STATUS in common.xml.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import msgspec

from dialects import messages as m

SUCCESS = 4
"""MAG_CAL_STATUS: done. Below it the calibration has not ended, above it has failed."""

FAILURES: Mapping[int, str] = {
    5: "failed", 6: "failed: its orientation is wrong", 7: "failed: the radius is not that of the earth's field",
    8: "failed: its offsets are too large", 9: "failed: its scaling is out of range",
    10: "failed: the residuals are too large",
}  # fmt: skip
"""MAG_CAL_STATUS -> how it ended."""


class CompassCalibration(msgspec.Struct):
    """The compasses of one vehicle by their number, from 0."""

    mask: int = 0
    """Bitmask of the compasses that are calibrated."""
    progress: dict[int, tuple[int, int]] = msgspec.field(default_factory=dict)
    """Percent and attempt of those that measure."""
    fits: dict[int, float] = msgspec.field(default_factory=dict)
    """RMS of the residuals of those that are done, mGauss; less is better."""
    failed: dict[int, str] = msgspec.field(default_factory=dict)
    saved: bool = False
    """The vehicle has written the result by itself."""

    def receive(self, message: m.Message) -> bool:
        """Handle a message; return whether it was about the calibration."""
        match message:
            case m.MagCalProgress():
                self._begin(message.compass_id, message.cal_mask)
                self.progress[message.compass_id] = min(100, message.completion_pct), message.attempt
            case m.MagCalReport() if message.cal_status >= SUCCESS:
                self._begin(message.compass_id, message.cal_mask)
                self._report(message)
            case _:
                return False
        return True

    @property
    def share(self) -> float | None:
        """Progress of the compass that is the last, 0..1; None while none measures."""
        if not self.progress:
            return None
        waiting = [number for number in range(8) if self.mask >> number & 1 and not self._has(number)]
        return 0.0 if waiting else min(percent for percent, _ in self.progress.values()) / 100

    @property
    def ready(self) -> bool:
        """All compasses have a result that waits to be written."""
        numbers = [number for number in range(8) if self.mask >> number & 1]
        return bool(self.fits) and not self.saved and all(number in self.fits for number in numbers)

    @property
    def ended(self) -> bool:
        """Every compass has reported."""
        numbers = [number for number in range(8) if self.mask >> number & 1]
        return all(number in self.fits or number in self.failed for number in numbers) and not self.progress

    @property
    def summary(self) -> str:
        """How each compass stands."""
        parts = {number: f"{percent} %" + _attempt(attempt) for number, (percent, attempt) in self.progress.items()}
        parts |= {number: f"fit {fit:.1f}" if math.isfinite(fit) else "fit --" for number, fit in self.fits.items()}
        parts |= self.failed
        return ", ".join(f"compass {number + 1} {text}" for number, text in sorted(parts.items()))

    def _has(self, number: int) -> bool:
        return number in self.progress or number in self.fits or number in self.failed

    def _begin(self, number: int, mask: int) -> None:
        """Forget what is known of a compass: it has begun anew, or has ended."""
        self.mask = mask or self.mask
        for known in (self.progress, self.fits, self.failed):
            known.pop(number, None)

    def _report(self, message: m.MagCalReport) -> None:
        if message.cal_status == SUCCESS:
            self.fits[message.compass_id] = message.fitness
            self.saved = bool(message.autosaved)
        else:
            self.failed[message.compass_id] = FAILURES.get(message.cal_status, FAILURES[SUCCESS + 1])


def _attempt(number: int) -> str:
    return f" (attempt {number})" if number > 1 else ""
