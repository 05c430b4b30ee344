"""A vehicle that flies: altitude and place are ground truth. multicopters.py has the makes.

Motion is that of a point: a velocity that follows its demand, or a fall.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from dialects import messages as m
from dialects.enums import Autopilot, Command, LandedState, ModeFlag, Result
from dialects.kinds import DRIVEN
from dialects.messages import boot_ms
from link.core import Received
from tests.fakes.params import INT32, Param
from tests.fakes.vehicle import AnyCommand, FakeVehicle

QUADROTOR = 2
GRAVITY = 9.81
FORCED = 21196
HOME_ALTITUDE = 400.0
"""m above mean sea level."""
ACCELERATION = 2.5
"""m/s2 with which the climb follows its demand."""
BRAKING = 2.5
"""m/s2 with which the speed over ground follows its demand."""
REPORTS = 0.2
"""s between two reports of the place."""
LANDED_FOR = 1.0
"""s on the ground in a landing until it disarms itself."""
IDLE_FOR = 10.0
"""s armed on the ground until it disarms itself (DISARM_DELAY, COM_DISARM_PRFLT)."""
METRES = 1.113e5
"""m of a degree of latitude."""


class Sticks(NamedTuple):
    """Forward, right and turn in -1..1, and z of MANUAL_CONTROL."""

    forward: float = 0.0
    right: float = 0.0
    turn: float = 0.0
    z: int = 500


class FlyingVehicle(FakeVehicle):
    """What both have in common: the motion, take-off, landing, arming, reports."""

    def __init__(self, autopilot: int, mode: str, params: dict[str, float], whole: tuple[str, ...] = ()) -> None:
        self.table = DRIVEN["copter", Autopilot(autopilot)].modes
        super().__init__(autopilot=autopilot, driver=None, mode=self._number(mode))
        self.kind = QUADROTOR
        for name, value in params.items():
            self.params[name] = Param(value, INT32) if name in whole else Param(value)
        self.answers[Command.REQUEST_OPERATOR_CONTROL] = Result.UNSUPPORTED
        self.mute = False
        """It obeys, and sends nothing but acknowledgements, as one that has no place for the station."""
        self.altitude = self.climb = self.highest = 0.0
        self.north = self.east = self.heading = 0.0
        self.speed_north = self.speed_east = 0.0
        self.asked_for: set[int] = set()
        """Messages that were requested; it sends EXTENDED_SYS_STATE only so."""
        self.wind = (0.0, 0.0)
        """m/s, of what drifts."""
        self.hit_ground_at = 0.0
        """m/s of its hardest landing."""
        self.lowest_z = 1000
        """The least z of a MANUAL_CONTROL that arrived while it flew."""
        self.station_at = -math.inf
        """When the station was heard last."""
        self.sticks: Sticks | None = None
        """What it obeys now; None: nothing."""
        self.target = 0.0
        """m, of a take-off."""
        self._now = 0.0
        self._moved_at: float | None = None
        self._report_due = 0.0
        self._ground_since: float | None = None

    # ---- what a test asks ----

    @property
    def mode_name(self) -> str:
        return self.table.get(self.mode, "")

    @property
    def flies(self) -> bool:
        """It is off the ground."""
        return self.altitude > 0.0

    @property
    def speed(self) -> float:
        """m/s over ground."""
        return math.hypot(self.speed_north, self.speed_east)

    def set_mode(self, name: str) -> None:
        """Change the mode, as a failsafe or the transmitter's switch does; the next heartbeat follows at once."""
        self.change_mode(self._number(name), armed=self.armed)

    def lift(self, altitude: float) -> None:
        """Hover at this altitude."""
        self.armed, self.altitude, self.climb = True, altitude, 0.0

    # ---- core ----

    def receive(self, received: Received, now: float) -> None:
        """Take demands of its station; the rest as FakeVehicle."""
        message = received.message
        self._now = now
        if not (self.deaf or self.cut) and self._obeys(received.system):
            if isinstance(message, m.Heartbeat):
                self.station_at = now
            elif isinstance(message, m.ManualControl) and message.target == self.system:
                if self.flies:
                    self.lowest_z = min(self.lowest_z, message.z)
                self._demand(message, now)
        super().receive(received, now)

    def tick(self, now: float) -> None:
        """Move, watch its failsafes, report."""
        self._now = now
        seconds = min(0.1, now - (now if self._moved_at is None else self._moved_at))
        self._moved_at = now
        self._watch(now)
        self._move(seconds)
        self._disarm_itself(now)
        super().tick(now)
        if now >= self._report_due:
            self._report_due = now + REPORTS
            self._report(now)

    # ---- of each autopilot ----

    def _demand(self, message: m.ManualControl, now: float) -> None:
        raise NotImplementedError

    def _watch(self, now: float) -> None:
        raise NotImplementedError

    def _obeys(self, station: int) -> bool:
        """Return whether the demands of a station with this id count."""
        return True

    def _climb_of(self, z: int) -> float:
        """Return the climb in m/s that z asks for in a mode that holds altitude."""
        raise NotImplementedError

    @property
    def top_speed(self) -> float:
        """m/s at full deflection."""
        raise NotImplementedError

    # ---- motion ----

    def _move(self, seconds: float) -> None:
        sticks, mode = self.sticks or Sticks(), self.mode_name
        if not self.armed:
            self._fall(seconds, thrust=0.0)
        elif mode in THRUST:
            z = sticks.z if self.sticks is not None else 0
            self._fall(seconds, thrust=z / 500.0)
        else:
            self._fly(mode, sticks, seconds)
        self.altitude += self.climb * seconds
        self.highest = max(self.highest, self.altitude)
        if self.altitude <= 0.0:
            self.hit_ground_at = max(self.hit_ground_at, -self.climb)
            self.altitude = self.climb = self.speed_north = self.speed_east = 0.0
        self.north += self.speed_north * seconds
        self.east += self.speed_east * seconds

    def _fall(self, seconds: float, *, thrust: float) -> None:
        self.climb += GRAVITY * (thrust - 1.0) * seconds
        if not self.flies and self.climb < 0.0:
            self.climb = 0.0

    def _fly(self, mode: str, sticks: Sticks, seconds: float) -> None:
        north, east, climb = self._by_sticks(mode, sticks, seconds) if mode in FLOWN else self._by_itself(mode)
        if not self.flies and climb <= 0.0:
            return
        self.climb = _follow(self.climb, climb, ACCELERATION * seconds)
        self.speed_north = _follow(self.speed_north, north, BRAKING * seconds)
        self.speed_east = _follow(self.speed_east, east, BRAKING * seconds)

    def _by_sticks(self, mode: str, sticks: Sticks, seconds: float) -> tuple[float, float, float]:
        """Return the velocity north, east and up that the sticks ask for."""
        climb = self._climb_of(sticks.z)
        forward, right = sticks.forward * self.top_speed, sticks.right * self.top_speed
        north = forward * math.cos(self.heading) - right * math.sin(self.heading)
        east = forward * math.sin(self.heading) + right * math.cos(self.heading)
        self.heading = (self.heading + math.radians(90) * sticks.turn * seconds) % (2 * math.pi)
        if mode in DRIFTS and self.flies:
            north, east = north + self.wind[0], east + self.wind[1]
        if self.target and climb >= 0.0:
            climb = max(climb, min(1.0, self.target - self.altitude))
        if self.target and (climb < 0.0 or self.altitude >= self.target - 0.05):
            self.target = 0.0
        return north, east, climb

    def _by_itself(self, mode: str) -> tuple[float, float, float]:
        """Return the velocity in a mode that flies itself."""
        if mode in LANDS:
            return 0.0, 0.0, -0.7
        if mode in HOMEWARD:
            away = math.hypot(self.north, self.east)
            return (-3.0 * self.north / away, -3.0 * self.east / away, 0.0) if away > 0.5 else (0.0, 0.0, -0.7)
        if mode != "AUTO_TAKEOFF":
            return 0.0, 0.0, 0.0
        if self.target - self.altitude < 0.1:
            self.set_mode("HOLD")
        return 0.0, 0.0, min(1.5, self.target - self.altitude)

    def _disarm_itself(self, now: float) -> None:
        idle = self.armed and not self.flies
        if not idle:
            self._ground_since = None
            return
        self._ground_since = now if self._ground_since is None else self._ground_since
        landing = self.mode_name in LANDS | HOMEWARD
        if now - self._ground_since > (LANDED_FOR if landing else IDLE_FOR):
            self.armed = False
            self.beat()

    # ---- commands ----

    def _number(self, name: str) -> int:
        return next(number for number, each in self.table.items() if each == name)

    def _flags(self) -> int:
        return ModeFlag.CUSTOM | (ModeFlag.ARMED if self.armed else 0)

    def _command(self, message: AnyCommand, received: Received) -> None:
        if message.command == Command.COMPONENT_ARM_DISARM:
            self.answers[message.command] = self._arm_answer(arms=message.param1 == 1, forced=message.param2 == FORCED)
        elif message.command == Command.NAV_TAKEOFF:
            self.answers[message.command] = Result.ACCEPTED if self._may_take_off() else Result.FAILED
        super()._command(message, received)

    def _arm_answer(self, *, arms: bool, forced: bool) -> int | tuple[int, str]:
        if not arms:
            return Result.FAILED if self.flies and not forced else Result.ACCEPTED
        return self._arming_check()

    def _arming_check(self) -> int | tuple[int, str]:
        raise NotImplementedError

    def _may_take_off(self) -> bool:
        raise NotImplementedError

    def _begin_take_off(self, height: float) -> None:
        raise NotImplementedError

    def _obey(self, message: AnyCommand, source: int) -> bool:
        if message.command == Command.NAV_TAKEOFF:
            self._begin_take_off(message.param7 if isinstance(message, m.CommandLong) else message.z)
            return True
        if message.command == Command.SET_MESSAGE_INTERVAL:
            self.asked_for.add(int(message.param1))
            return False
        if message.command == Command.NAV_LAND:
            self.set_mode("LAND" if "LAND" in self.table.values() else "AUTO_LAND")
            return True
        if message.command == Command.DO_SET_MODE:
            self.target = 0.0
        return super()._obey(message, source)

    # ---- reports ----

    def beat(self) -> None:
        """Send a HEARTBEAT, unless mute."""
        if not self.mute:
            super().beat()

    def _report(self, now: float) -> None:
        if self.mute:
            return
        landed = LandedState.IN_AIR if self.flies else LandedState.ON_GROUND
        if m.ExtendedSysState.id in self.asked_for:
            self.send(m.ExtendedSysState(0, landed))
        place = (round((47.0 + self.north / METRES) * 1e7), round((8.0 + self.east / METRES / 0.682) * 1e7))
        height = round(1000 * self.altitude)
        speeds = (round(100 * self.speed_north), round(100 * self.speed_east), round(-100 * self.climb))
        heading = math.degrees(self.heading)
        self.send(
            m.GlobalPositionInt(
                boot_ms(now), *place, round(1000 * HOME_ALTITUDE) + height, height, *speeds, round(100 * heading)
            )
        )
        self.send(m.Attitude(boot_ms(now), 0.0, 0.0, self.heading, 0.0, 0.0, 0.0))
        self.send(m.VfrHud(0.0, self.speed, round(heading), 50, HOME_ALTITUDE + self.altitude, self.climb))


THRUST = frozenset({"STABILIZE", "ACRO", "MANUAL", "STABILIZED", "DRIFT"})
FLOWN = frozenset({"LOITER", "POSHOLD", "ALT_HOLD", "POSCTL", "ALTCTL"})
DRIFTS = frozenset({"ALT_HOLD", "ALTCTL"})
LANDS = frozenset({"LAND", "AUTO_LAND"})
HOMEWARD = frozenset({"RTL", "AUTO_RTL"})


def _follow(value: float, wanted: float, most: float) -> float:
    return value + max(-most, min(most, wanted - value))
