"""Calibrations of a vehicle: what can be calibrated by which command, and what the operator has to do meanwhile.

ArduPilot asks for the positions of the accelerometers by COMMAND_LONG ACCELCAL_VEHICLE_POS and reports the compass by
MAG_CAL_REPORT. PX4 reports both by STATUSTEXT "[cal] ..."
(https://docs.px4.io/main/en/config/compass.html, libraries/AP_AccelCal and AP_Compass of ArduPilot).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from dialects import messages as m
from dialects.enums import Autopilot, Command
from groundstation.views.doctor import CalibrationRow, Health
from groundstation.views.requests import RequestLine
from link.core import Outgoing, Received

ACCEL_POSITIONS = {
    1: "level", 2: "on its left side", 3: "on its right side", 4: "nose down", 5: "nose up", 6: "on its back",
}  # fmt: skip
"""ACCELCAL_VEHICLE_POS -> how the vehicle must lie."""
ACCEL_DONE, ACCEL_FAILED = 16777215, 16777216

MAG_SUCCESS, MAG_FAILED = 4, 5
"""MAG_CAL_STATUS; what is above MAG_FAILED failed, too."""

REQUEST = "calibrate "
"""What the requests are called, before the kind."""

SHORT = frozenset({"level", "gyro", "pressure"})
"""Kinds that are done when the vehicle has accepted; for the others that is the beginning."""

CALIBRATION_TEXT = "[cal] "
"""What PX4's texts about a calibration begin with."""


@dataclass(frozen=True, slots=True)
class CalibrationKind:
    """What can be calibrated."""

    title: str
    command: Command
    params: tuple[float, ...]
    autopilots: frozenset[int]
    """MAV_AUTOPILOT that can do it."""


_FOREIGN = frozenset({Autopilot.ARDUPILOT, Autopilot.PX4})
_PREFLIGHT = Command.PREFLIGHT_CALIBRATION

KINDS: Mapping[str, CalibrationKind] = {
    "accel": CalibrationKind("accelerometers", _PREFLIGHT, (0, 0, 0, 0, 1), _FOREIGN),
    "level": CalibrationKind("level", _PREFLIGHT, (0, 0, 0, 0, 2), _FOREIGN),
    "gyro": CalibrationKind("gyros", _PREFLIGHT, (1,), _FOREIGN | {Autopilot.GENERIC}),
    "pressure": CalibrationKind("pressure", _PREFLIGHT, (0, 0, 1), _FOREIGN),
    "compass": CalibrationKind("compass", Command.DO_START_MAG_CAL, (0, 0, 0, 0, 0), frozenset({Autopilot.ARDUPILOT})),
    "compass-px4": CalibrationKind("compass", _PREFLIGHT, (0, 1), frozenset({Autopilot.PX4})),
}
"""Name -> how it is begun. Parameters of DO_START_MAG_CAL: all compasses, no retry, the result waits for acceptance."""


def kind_for(name: str, autopilot: int) -> str | None:
    """Return the kind of this name that the autopilot can do, e.g. "compass-px4" for "compass"; None for none."""
    variants = (name, f"{name}-px4")
    return next((each for each in variants if each in KINDS and autopilot in KINDS[each].autopilots), None)


class CalibrationState:
    """What one vehicle asks for and reports. `ids` are ours, `target` is the vehicle's component."""

    def __init__(self, ids: tuple[int, int], target: tuple[int, int]) -> None:
        self._ids, self._target = ids, target
        self.position: int | None = None
        """The position of ACCEL_POSITIONS that it waits for."""
        self.text = ""
        """What to do, or how it ended."""
        self.fits: dict[int, str] = {}
        """Compass -> its result."""
        self.done: set[str] = set()
        """Kinds that were calibrated in this session."""
        self._outbox: list[Outgoing] = []

    @property
    def waits_for_acceptance(self) -> bool:
        """A compass has a result that is not written yet."""
        return bool(self.fits) and "compass" not in self.done

    def receive(self, received: Received) -> None:
        """Take what the vehicle asks for or reports."""
        match received.message:
            case m.CommandLong() as message if message.command == Command.ACCELCAL_VEHICLE_POS:
                self._ask_for(int(message.param1) if abs(message.param1) < 1e9 else 0)
            case m.MagCalReport() as message:
                self._report(message)

    def handle_text(self, text: str) -> None:
        """Take PX4's texts, which say what to do."""
        if text.startswith(CALIBRATION_TEXT):
            self.text = text.removeprefix(CALIBRATION_TEXT)

    def confirm_position(self) -> None:
        """Answer that the vehicle lies as asked; nothing happens if it has not asked."""
        if self.position is not None:
            self._send(Command.ACCELCAL_VEHICLE_POS, self.position)
            self.text, self.position = "measuring", None

    def end_compass(self, *, accept: bool) -> None:
        """Write the results of the compasses, or cancel their calibration."""
        self._send(Command.DO_ACCEPT_MAG_CAL if accept else Command.DO_CANCEL_MAG_CAL, 0)
        if accept and self.fits:
            self.done.add("compass")
        self.text = "compass: accepted; restart the vehicle" if accept else "compass: cancelled"
        self.fits = {}

    def begin(self) -> None:
        """Forget the calibration before."""
        self.position, self.text, self.fits = None, "", {}

    def messages_to_send(self) -> list[Outgoing]:
        """Return the messages to send now, and remove them."""
        outbox, self._outbox = self._outbox, []
        return outbox

    def rows(self, autopilot: int, requests: Iterable[RequestLine]) -> tuple[CalibrationRow, ...]:
        """Return what can be calibrated, and what cannot. `requests` show which short ones are done."""
        accepted = {line.what.removeprefix(REQUEST) for line in requests if line.state == "accepted"}
        self.done |= accepted & SHORT
        names = [name for name in KINDS if not name.endswith("-px4")]
        return tuple(self._row(name, kind_for(name, autopilot)) for name in names)

    def _row(self, name: str, kind: str | None) -> CalibrationRow:
        title = KINDS[name].title
        if kind is None:
            return CalibrationRow(name, title, Health.UNKNOWN, "cannot")
        done = kind in self.done
        return CalibrationRow(kind, title, Health.OK if done else Health.UNKNOWN, "done" if done else "")

    def _ask_for(self, position: int) -> None:
        if position in ACCEL_POSITIONS:
            self.position = position
            self.text = f"lay it {ACCEL_POSITIONS[position]}, then ENTER ({position} of {len(ACCEL_POSITIONS)})"
        elif position in (ACCEL_DONE, ACCEL_FAILED):
            self.position = None
            self.text = "accelerometers: done" if position == ACCEL_DONE else "accelerometers: failed, try again"
            if position == ACCEL_DONE:
                self.done.add("accel")

    def _report(self, message: m.MagCalReport) -> None:
        if message.cal_status < MAG_SUCCESS:
            return
        good = message.cal_status == MAG_SUCCESS
        self.fits[message.compass_id] = f"fit {message.fitness:.1f}" if good else "failed"
        shown = ", ".join(f"compass {number + 1} {text}" for number, text in sorted(self.fits.items()))
        self.text = f"{shown}: W writes it, x cancels" if good else f"{shown}: x cancels"
        if message.autosaved:
            self.done.add("compass")
            self.text = f"{shown}: written"

    def _send(self, command: Command, first: float) -> None:
        self._outbox.append(Outgoing(m.CommandLong(*self._target, command, 0, first, 0, 0, 0, 0, 0, 0)))
