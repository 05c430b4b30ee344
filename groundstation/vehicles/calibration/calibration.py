"""Calibrations of a vehicle: what can be calibrated by which command, and what the operator has to do meanwhile.

ArduPilot asks for the positions of the accelerometers by COMMAND_LONG ACCELCAL_VEHICLE_POS; its compass is in
compass_calibration.py, its RC sticks in stick_calibration.py. PX4 reports both by STATUSTEXT "[cal] ..."
(https://docs.px4.io/main/en/config/compass.html, libraries/AP_AccelCal and AP_Compass of ArduPilot).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import msgspec

from dialects import messages as m
from dialects.enums import Autopilot, Command
from groundstation.vehicles.calibration.compass_calibration import CompassCalibration
from groundstation.vehicles.calibration.reported_calibration import CALIBRATION_TEXT, find_calibrated
from groundstation.vehicles.calibration.stick_calibration import RATE, StickCalibration
from groundstation.vehicles.probes.stream_requests import STREAM_RATES
from groundstation.views.doctor import STICKS, CalibrationRow
from groundstation.views.requests import RequestLine
from link.core import Outgoing, Received
from link.runtime.diagnosis import Health

ACCEL_POSITIONS = {
    1: "level", 2: "on its left side", 3: "on its right side", 4: "nose down", 5: "nose up", 6: "on its back",
}  # fmt: skip
"""ACCELCAL_VEHICLE_POS -> how the vehicle must lie."""
ACCEL_DONE, ACCEL_FAILED = 16777215, 16777216

REQUEST = "calibrate "
"""What the requests are called, before the kind."""

COMPASS_WRITTEN = "compass: written; restart the vehicle"

WRITE, CANCEL = "compass: write the result", "compass: cancel"
"""The same for the end of a compass calibration."""

MAG_CAL_RATE = 4.0
"""Hz of MAG_CAL_PROGRESS and MAG_CAL_REPORT while compasses are calibrated."""

SHORT = frozenset({"level", "gyro", "pressure"})
"""Kinds that are done when the vehicle has accepted; for the others, and for PX4, that is the beginning."""

STICKS_TEXT = "move all sticks to their ends, centre them, then ENTER"

PX4_KINDS: Mapping[str, str] = {
    "accel": "accel", "level": "level", "gyro": "gyro", "baro": "pressure", "mag": "compass-px4",
}  # fmt: skip
"""What PX4's texts call a calibration -> its kind."""


class CalibrationKind(msgspec.Struct, frozen=True):
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
    """What one vehicle asks for and reports; `outbox` gets what is sent to it.

    `ids` are ours, `target` is the vehicle's component.
    """

    def __init__(self, outbox: list[Outgoing], ids: tuple[int, int], target: tuple[int, int]) -> None:
        self._ids, self._target = ids, target
        self.position: int | None = None
        """The position of ACCEL_POSITIONS that it waits for."""
        self.text = ""
        """What to do, or how it ended."""
        self.compass = CompassCalibration()
        self.sticks = StickCalibration()
        self.done: set[str] = set()
        """Kinds that were calibrated in this session."""
        self._cancelled = False
        """Reports of the compass do not count: they were on the way when it was cancelled."""
        self._written = 0
        """Number of the newest request that has written a result of the compass."""
        self._outbox = outbox

    def receive(self, received: Received) -> None:
        """Handle a request or report of the vehicle."""
        match received.message:
            case m.CommandLong() as message if message.command == Command.ACCELCAL_VEHICLE_POS:
                self._ask_for(int(message.param1) if abs(message.param1) < 1e9 else 0)
            case m.MagCalProgress() | m.MagCalReport() as message if not self._cancelled:
                if self.compass.receive(message):
                    self._tell_compass()
            case m.RcChannels() as message if self.sticks.running:
                self.sticks.receive(message)
                self._tell_sticks()

    def handle_text(self, text: str) -> None:
        """Handle PX4's texts, which say what to do."""
        if text.startswith(CALIBRATION_TEXT):
            self.text = text.removeprefix(CALIBRATION_TEXT)
            if (calibrated := find_calibrated(self.text)) in PX4_KINDS:
                self.done |= {PX4_KINDS[calibrated]}

    def confirm_position(self) -> None:
        """Answer that the vehicle lies as asked; nothing happens if it has not asked."""
        if self.position is not None:
            self._send(Command.ACCELCAL_VEHICLE_POS, self.position)
            self.text, self.position = "measuring", None

    def begin(self, kind: str) -> None:
        """Forget the calibration before, and request the messages that report this one."""
        self.end_sticks("")
        self.position, self.text, self.compass, self._cancelled = None, "", CompassCalibration(), False
        if kind == "compass":
            self._request(m.MagCalProgress.id, MAG_CAL_RATE)
            self._request(m.MagCalReport.id, MAG_CAL_RATE)

    def begin_sticks(self) -> None:
        """Watch the RC channels from now on."""
        self.begin(STICKS)
        self.sticks.begin()
        self.text = STICKS_TEXT
        self._request(m.RcChannels.id, RATE)

    def end_sticks(self, text: str) -> None:
        """Watch them no more."""
        if self.sticks.running:
            self.sticks.end()
            self.text = text
            self._request(m.RcChannels.id, STREAM_RATES[m.RcChannels.id].rate)

    def end_compass(self, *, accept: bool) -> None:
        """Forget the results if they are cancelled; while they are written, the vehicle may still refuse."""
        if not accept:
            self.text, self.compass, self._cancelled = "", CompassCalibration(), True

    def rows(self, autopilot: int, requests: Iterable[RequestLine]) -> tuple[CalibrationRow, ...]:
        """Return what can be calibrated, and what cannot. `requests` show which ones are done."""
        accepted = [line for line in requests if line.state == "accepted"]
        if autopilot != Autopilot.PX4:
            self.done |= {line.what.removeprefix(REQUEST) for line in accepted} & SHORT
        written = max((line.number for line in accepted if line.what == f"{REQUEST}{WRITE}"), default=0)
        if written > self._written:
            self._written, self.text, self.compass = written, COMPASS_WRITTEN, CompassCalibration()
            self.done.add("compass")
        names = [name for name in KINDS if not name.endswith("-px4")]
        sticks = STICKS if autopilot == Autopilot.ARDUPILOT else None
        return (*(self._row(name, KINDS[name].title, kind_for(name, autopilot)) for name in names),
                self._row(STICKS, "RC sticks", sticks))  # fmt: skip

    def _row(self, name: str, title: str, kind: str | None) -> CalibrationRow:
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

    def _tell_compass(self) -> None:
        compass = self.compass
        if compass.share is not None:
            advice = "turn it slowly about every axis; x cancels"
        elif compass.saved:
            advice = "written"
            self.done.add("compass")
        else:
            advice = "W writes it, x cancels" if compass.ready else "x cancels"
        self.text = f"{compass.summary}: {advice}"

    def _tell_sticks(self) -> None:
        moved = ", ".join(map(str, self.sticks.moved))
        self.text = f"{STICKS_TEXT} (moved: {moved})" if moved else STICKS_TEXT

    def _request(self, message: int, rate: float) -> None:
        """Request a message at a rate, once: where that is lost it comes at the rate of its stream."""
        params = (message, round(1e6 / rate), 0, 0, 0, 0, 0)
        self._outbox.append(Outgoing(m.CommandLong(*self._target, Command.SET_MESSAGE_INTERVAL, 0, *params)))

    def _send(self, command: Command, first: float) -> None:
        self._outbox.append(Outgoing(m.CommandLong(*self._target, command, 0, first, 0, 0, 0, 0, 0, 0)))
