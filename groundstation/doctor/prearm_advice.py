"""ADVICE: what to do about a reason why a vehicle does not arm. A reason that is not in the table stands as it is.

Texts: ours are in vehicle/safety/arming.py; ArduPilot's in AP_Arming and AR_Arming
(https://ardupilot.org/rover/docs/common-prearm-safety-checks.html); PX4's in its health and arming checks
(https://docs.px4.io/main/en/flying/pre_flight_checks.html).
"""

from __future__ import annotations

import msgspec

PREFIXES = ("PreArm: ", "Preflight Fail: ", "Arm: ", "Arming denied: ")
"""What texts begin with that say why arming is refused: ArduPilot and our rover, PX4, ArduPilot, PX4."""


class Advice(msgspec.Struct, frozen=True):
    """What to do where a reason contains all `words`, in lower case."""

    words: tuple[str, ...]
    text: str


def _to(text: str, *words: str) -> Advice:
    return Advice(words, text)


ADVICE: tuple[Advice, ...] = (
    # Our rover
    _to("install a key: mavhelm sign install (docs/keys.md)", "not signed"),
    _to("restart the vehicle", "terminated"),
    _to("release the emergency stop on Drive", "emergency stop"),
    _to("check power and wiring of the motor driver, then restart", "motor driver"),
    _to("set one parameter; then all are saved anew", "using defaults"),
    _to("set BATT_CRT_VOLT below BATT_LOW_VOLT", "batt_crt_volt"),
    _to("set FS_DISARM_T above FS_TIMEOUT", "fs_disarm_t"),
    _to("release the sticks and keys", "not neutral", "throttle or steering"),
    _to("set mode MANUAL", "mode not available"),
    _to("wait until it has started", "vehicle is in state"),
    _to("give the Pi a stronger power supply", "pi under-voltage"),
    _to("let the Pi cool down", "pi too hot"),
    # ArduPilot and PX4, by subject
    _to("restart the vehicle: the calibration counts then", "compass calibrated requires reboot"),
    _to("calibrate the compass, outdoors", "compass", "calibrat"),
    _to("move away from metal and cables, or calibrate the compass", "compass", "inconsistent"),
    _to("move away from metal and cables", "compass"),
    _to("calibrate the accelerometers", "accel", "calib"),
    _to("calibrate the accelerometers", "accel", "inconsistent"),
    _to("let it stand still, or calibrate the gyros", "gyro"),
    _to("set it level, or calibrate the level", "level"),
    _to("wait until the estimator has settled, outdoors", "ekf"),
    _to("wait until the estimator has settled, outdoors", "ahrs"),
    _to("let the keys go and arm from Drive: PX4 wants the throttle centred", "throttle", "safe position"),
    _to("wait for a position, outdoors; or use a mode that needs none", "gps"),
    _to("wait for a position, outdoors; or use a mode that needs none", "position"),
    _to("wait until home is set, by the first position", "home"),
    _to("calibrate the transmitter", "rc not calibrated"),
    _to("centre the throttle stick, or switch the transmitter off", "throttle", "not neutral"),
    _to("centre the throttle stick, or switch the transmitter off", "not neutral"),
    _to("switch the transmitter on, or set RC_PROTOCOLS and FS_THR_ENABLE for keys only", "rc not found"),
    _to("switch the transmitter on, then check again", "radio failsafe"),
    _to("switch the transmitter on, then check again", "throttle failsafe"),
    _to("charge or change the battery", "battery"),
    _to("check the power supply", "board", "voltage"),
    _to("`estop --clear` or t on Drive ends an emergency stop; else press the safety switch", "safety switch"),
    _to("`estop --clear` or t on Drive ends an emergency stop; else press the safety switch", "safety button"),
    _to("release the emergency stop switch of the transmitter", "estop"),
    _to("free space on the card, or set LOG_BACKEND_TYPE", "logging"),
    _to("insert a card, or set LOG_BACKEND_TYPE 0", "sd card"),
    _to("upload the fence again, or set FENCE_ENABLE 0", "fence"),
    _to("upload the mission again", "mission"),
    _to("set SERVOn_FUNCTION of the motors in Params", "check servo"),
    _to("set SERVOn_FUNCTION of the motors in Params", "no motor"),
    _to("change to MANUAL: this mode does not arm", "mode", "armable"),
    _to("change to another mode", "mode", "not"),
    _to("wait: the vehicle is starting", "initialising"),
    _to("restart the vehicle", "reboot"),
    _to("wait until the computer on board is less busy", "cpu load"),
    _to("arm from Drive: it sends MANUAL_CONTROL first", "manual control"),
    _to("the vehicle lacks a link to us: check Links", "ground control station"),
    _to("correct the parameter in Params", "param"),
)
"""The first that matches counts."""


def reason_of(text: str) -> str | None:
    """Return the reason in a STATUSTEXT, e.g. "Compass not calibrated"; None for any other text."""
    return next((text.removeprefix(prefix).strip() for prefix in PREFIXES if text.startswith(prefix)), None)


def find_advice(reason: str) -> str:
    """Return what to do about a reason; "" if that is not known."""
    low = reason.lower()
    return next((each.text for each in ADVICE if all(word in low for word in each.words)), "")
