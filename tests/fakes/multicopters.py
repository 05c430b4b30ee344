"""ArduCopter and a PX4 quad as stand-ins: throttle maps, and failsafes that follow their own parameters.

Written after their sources; no real one has been compared. ArduCopter: GCS_MAVLink_Copter.cpp (MANUAL_CONTROL),
radio.cpp and events.cpp (failsafes), AP_Arming_Copter.cpp, mode.cpp (get_pilot_desired_climb_rate). PX4:
mavlink_receiver.cpp, Commander.cpp, failsafe.cpp. Motion is that of flying.py.
"""

from __future__ import annotations

import math

from dialects import messages as m
from dialects.enums import Autopilot, Command, Result
from dialects.messages import INVALID_AXIS
from tests.fakes.flying import FLOWN, HOME_ALTITUDE, HOMEWARD, LANDS, THRUST, FlyingVehicle, Sticks

SAFE_COPTER: dict[str, float] = {
    "RC_OVERRIDE_TIME": 3.0, "FS_THR_ENABLE": 1, "FS_GCS_ENABLE": 5, "FS_GCS_TIMEOUT": 5.0, "FS_OPTIONS": 0,
    "MAV_GCS_SYSID": 255, "LOIT_SPEED": 1250.0, "PILOT_SPEED_UP": 250.0, "PILOT_Y_RATE": 202.5, "THR_DZ": 100,
    "FENCE_ENABLE": 0, "FENCE_AUTOENABLE": 0, "FENCE_TYPE": 7, "FENCE_ALT_MAX": 100.0,
}  # fmt: skip
"""Defaults of ArduCopter, but for FS_GCS_ENABLE (0) and FS_OPTIONS (16: pilot control goes on without a station)."""

CONTINUES = 16
"""FS_OPTIONS: pilot-controlled modes go on when the station is lost."""
ACTIONS = {1: "RTL", 3: "RTL", 4: "RTL", 5: "LAND", 7: "BRAKE"}
"""FS_GCS_ENABLE -> mode; FS_THR_ENABLE has LAND for 3."""


class ArduCopter(FlyingVehicle):
    """ArduCopter 4.x: z as the throttle channel, overrides that last RC_OVERRIDE_TIME, two failsafes."""

    def __init__(self, mode: str = "LOITER", **params: float) -> None:
        super().__init__(Autopilot.ARDUPILOT, mode, SAFE_COPTER | params)
        self.receiver: Sticks | None = None
        """What its transmitter asks for; None: it has no RC receiver."""
        self._override = Sticks()
        self._override_at = -math.inf
        self._radio_failed = self._station_failed = False

    @property
    def top_speed(self) -> float:
        return self.params["LOIT_SPEED"].value / 100

    def _obeys(self, station: int) -> bool:
        return station == int(self.params["MAV_GCS_SYSID"].value)

    def _demand(self, message: m.ManualControl, now: float) -> None:
        self.station_at = now
        if self.params["RC_OVERRIDE_TIME"].value == 0 or message.z < 0:
            return
        axes = (0 if axis == INVALID_AXIS else axis for axis in (message.x, message.y, message.r))
        forward, right, turn = (axis / 1000 for axis in axes)
        self._override, self._override_at = Sticks(forward, right, turn, message.z), now
        self._radio_failed = False

    def _watch(self, now: float) -> None:
        kept = self.params["RC_OVERRIDE_TIME"].value
        silent = now - self._override_at
        if self._override_at > -math.inf and (kept < 0 or silent <= kept):
            self.sticks = self._override
        elif self.receiver is not None:
            self.sticks = self.receiver
        elif self._override_at > -math.inf and silent > kept + 0.5 and self.params["FS_THR_ENABLE"].value:
            self.sticks = None
            self._fail("_radio_failed", {3: "LAND"}.get(int(self.params["FS_THR_ENABLE"].value), "RTL"))
        # else the channels keep their last values
        enabled = int(self.params["FS_GCS_ENABLE"].value)
        lost = now - self.station_at > self.params["FS_GCS_TIMEOUT"].value and self.station_at > -math.inf
        if not lost:
            self._station_failed = False
        elif enabled:
            self._override_at = -math.inf
            pilot = int(self.params["FS_OPTIONS"].value) & CONTINUES and self.mode_name in FLOWN | THRUST
            self._fail("_station_failed", "" if pilot else ACTIONS.get(enabled, "RTL"))

    def _fail(self, which: str, mode: str) -> None:
        if getattr(self, which) or not self.armed:
            return
        setattr(self, which, True)
        if not self.flies:
            self.armed = False
            self.beat()
        elif mode and self.mode_name != "LAND":
            self.set_mode(mode)

    def _climb_of(self, z: int) -> float:
        dead, fastest = int(self.params["THR_DZ"].value), self.params["PILOT_SPEED_UP"].value / 100
        away = abs(z - 500) - dead
        return 0.0 if away <= 0 else math.copysign(fastest * away / (500 - dead), z - 500)

    def _arming_check(self) -> int | tuple[int, str]:
        sticks = self.sticks or Sticks(z=0)
        high = sticks.z > 0 if self.mode_name in THRUST else self._climb_of(sticks.z) > 0.0
        return (Result.FAILED, "Arm: Throttle too high") if high else Result.ACCEPTED

    def _may_take_off(self) -> bool:
        return self.armed and not self.flies and self.mode_name in FLOWN | {"GUIDED"}

    def _begin_take_off(self, height: float) -> None:
        self.target = height


SAFE_QUAD: dict[str, float] = {
    "COM_RC_IN_MODE": 1, "COM_RC_LOSS_T": 0.5, "NAV_RCL_ACT": 2, "COM_FAIL_ACT_T": 5.0, "COM_DL_LOSS_T": 10,
    "NAV_DLL_ACT": 2, "MIS_TAKEOFF_ALT": 2.5, "MPC_VEL_MANUAL": 10.0, "MPC_Z_VEL_MAX_UP": 3.0,
    "MPC_Z_VEL_MAX_DN": 1.5, "MPC_MAN_Y_MAX": 150.0,
    "GF_ACTION": 2, "GF_MAX_VER_DIST": 0.0,
}  # fmt: skip
"""Defaults of PX4, but for NAV_DLL_ACT (0)."""
WHOLE = ("COM_RC_IN_MODE", "NAV_RCL_ACT", "COM_DL_LOSS_T", "NAV_DLL_ACT", "GF_ACTION")
FALLS = (5, 6)
"""Terminate, disarm."""


class Px4Quad(FlyingVehicle):
    """PX4 1.16: z over 500 as the throttle stick, manual control that is lost after COM_RC_LOSS_T."""

    def __init__(self, mode: str = "POSCTL", **params: float) -> None:
        super().__init__(Autopilot.PX4, mode, SAFE_QUAD | params, WHOLE)
        self._manual = Sticks()
        self._manual_at = -math.inf
        self._lost_at: float | None = None
        self._acted = False
        self.answers[Command.DO_SET_SAFETY_SWITCH_STATE] = Result.UNSUPPORTED

    @property
    def top_speed(self) -> float:
        return self.params["MPC_VEL_MANUAL"].value

    def _demand(self, message: m.ManualControl, now: float) -> None:
        if self.params["COM_RC_IN_MODE"].value in (0, 4):
            return
        axes = (axis / 1000 if abs(axis) <= 1000 else 0.0 for axis in (message.x, message.y, message.r))
        forward, right, turn = axes
        self._manual = Sticks(forward, right, turn, message.z if 0 <= message.z <= 1000 else 500)
        self._manual_at = now

    @property
    def _has_manual(self) -> bool:
        return self._now - self._manual_at <= self.params["COM_RC_LOSS_T"].value

    def _watch(self, now: float) -> None:
        if self._manual_at > -math.inf:
            self.sticks = self._manual
        self._watch_station(now)
        action = int(self.params["NAV_RCL_ACT"].value)
        if self._has_manual:
            self._lost_at, self._acted = None, False
        elif self.armed and self._manual_at > -math.inf and self.mode_name in FLOWN | THRUST and action:
            self._lost_at = now
            self._act(action)
        elif self._lost_at is not None and not self._acted and self.mode_name == "HOLD" and action in (2, 3):
            if now - self._lost_at <= self.params["COM_FAIL_ACT_T"].value:
                return
            self._acted = True
            self.set_mode("AUTO_RTL" if action == 2 else "AUTO_LAND")

    def _watch_station(self, now: float) -> None:
        action = int(self.params["NAV_DLL_ACT"].value)
        lost = now - self.station_at > self.params["COM_DL_LOSS_T"].value and self.station_at > -math.inf
        if lost and action and self.armed and self.mode_name not in LANDS | HOMEWARD:
            self._act(action, at_once=True)

    def _act(self, action: int, *, at_once: bool = False) -> None:
        if not self.flies or action in FALLS:
            self.armed = False
            self.beat()
        elif at_once and action in (2, 3):
            self.set_mode("AUTO_RTL" if action == 2 else "AUTO_LAND")
        else:
            self.set_mode("HOLD")

    def _climb_of(self, z: int) -> float:
        stick = (z - 500) / 500
        away = max(0.0, abs(stick) - 0.1) / 0.9
        name = "MPC_Z_VEL_MAX_UP" if stick > 0 else "MPC_Z_VEL_MAX_DN"
        return math.copysign(away * self.params[name].value, stick)

    def _arming_check(self) -> int | tuple[int, str]:
        if self.mode_name in FLOWN | THRUST and not self._has_manual:
            return Result.TEMPORARILY_REJECTED, "Arming denied: manual control lost"
        high = self._manual.z > 50 if self.mode_name in THRUST else self._manual.z > 600
        return (Result.DENIED, "Arming denied: throttle above center") if high else Result.ACCEPTED

    def _may_take_off(self) -> bool:
        return not self.flies

    def _begin_take_off(self, height: float) -> None:
        default = self.params["MIS_TAKEOFF_ALT"].value
        self.target = default if math.isnan(height) else max(default, height - HOME_ALTITUDE)
        self.set_mode("AUTO_TAKEOFF")
