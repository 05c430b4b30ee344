"""The end of a calibration of PX4, whose COMMAND_ACK comes when it begins: texts "[cal] ..." and MAV_STATE report it.

https://docs.px4.io/main/en/middleware/mavlink.html; src/modules/commander/calibration_messages.h of PX4.
"""

from __future__ import annotations

from dialects.enums import SystemState

CALIBRATION_TEXT = "[cal] "
"""What PX4's texts about a calibration begin with."""

UNREPORTED_AFTER = 5.0
"""s without a text and without CALIBRATING after which an accepted calibration counts as not reported."""

TEXT_WITHIN = 2.0
"""s between the end in the HEARTBEAT and the text that says how it ended."""

GIVE_UP_AFTER = 60.0
"""s in which PX4 ends every calibration at rest: it repeats one that is disturbed a few times."""

_DONE, _FAILED = "calibration done:", ("calibration failed:", "calibration cancelled", "calibration canceled")


def find_calibrated(text: str) -> str:
    """Return what a text of PX4, without CALIBRATION_TEXT, reports as calibrated, e.g. "gyro"; "" for any other."""
    return text.removeprefix(_DONE).strip() if text.startswith(_DONE) else ""


class ReportedCalibration:
    """How one calibration stands. Time is an argument; `began` is when the vehicle has accepted."""

    def __init__(self, began: float) -> None:
        self.ended = False
        self.failure = ""
        """Why it is not calibrated, or not known to be; "" if it is, or goes on."""
        self.silent = False
        """The end was not reported, so that nobody knows how it ended."""
        self.text = ""
        """The newest text of the vehicle about it."""
        self._began = began
        self._calibrating = False
        self._left_at: float | None = None

    def handle_text(self, text: str) -> None:
        """Handle a whole STATUSTEXT of the vehicle."""
        if self.ended or not text.startswith(CALIBRATION_TEXT):
            return
        self.text = text.removeprefix(CALIBRATION_TEXT)
        if self.text.startswith(_DONE):
            self.ended = True
        elif self.text.startswith(_FAILED):
            self.ended, self.failure = True, self.text

    def handle_status(self, status: int, now: float) -> None:
        """Handle MAV_STATE of the newest HEARTBEAT, and what is overdue."""
        if self.ended:
            return
        if status == SystemState.CALIBRATING:
            self._calibrating, self._left_at = True, None
        elif self._calibrating and self._left_at is None:
            self._left_at = now
        if self._left_at is not None and now - self._left_at > TEXT_WITHIN:
            self._give_up("it has ended, and its text was lost: calibrate again")
        elif now - self._began > (GIVE_UP_AFTER if self._calibrating or self.text else UNREPORTED_AFTER):
            self._give_up(f"accepted, but no end is reported after {now - self._began:.0f} s")

    def _give_up(self, why: str) -> None:
        self.ended, self.failure, self.silent = True, why, True
