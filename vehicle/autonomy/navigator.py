"""Drives by itself: the estimate, the modes that need no driver, and what of them goes to the motors as a demand.

What it may do is not decided here: vehicle/safety/state_machine.py says which mode it is and whether it was begun after arming, and
the last gate (vehicle/drive/gate.py) lets a demand of its own through only while it is as fresh as the control cycle.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple, Protocol

from dialects.enums import Command, DriveType, Failsafe
from dialects.modes import Mode
from link.services.mission.items import MissionItem
from vehicle.autonomy.mission.executor import Mission
from vehicle.autonomy.modes.guided import Guided
from vehicle.autonomy.modes.homing import Done, Loiter, Retrace, Return, Trail
from vehicle.autonomy.setpoints import Course, Target
from vehicle.drive.demand import Demand
from vehicle.drive.drive import shape
from vehicle.drive.mixer import FOUR_WHEELS, MIXERS
from vehicle.modes import OFFERED, Need
from vehicle.navigation.estimate import Estimate
from vehicle.navigation.estimator import Estimator, sane_rate
from vehicle.navigation.fence_avoidance import Boundary
from vehicle.navigation.geo import Home, Origin, Point
from vehicle.navigation.guidance import Guide
from vehicle.navigation.rally import Havens
from vehicle.navigation.speed_control import STAND, Motion, Pilot
from vehicle.params import Params
from vehicle.readings import NO_READINGS, Readings
from vehicle.safety.hazards import Hazards, Look
from vehicle.safety.state_machine import Safety

USUAL_SPEED = -2.0
"""Speed of DO_CHANGE_SPEED that means the usual one."""


class PlanIds(NamedTuple):
    """The ids of the plans in force, 0 for an empty one (link/services/mission/plans.py)."""

    mission: int = 0
    fence: int = 0
    rally: int = 0


class Behaviour(Protocol):
    """One mode that drives by itself."""

    @property
    def goal(self) -> Point | None:
        """Where it goes."""

    def unready(self, estimate: Estimate) -> str | None:
        """Why it cannot begin, besides what its line in OFFERED needs."""

    def begin(self, estimate: Estimate, now: float) -> None:
        """It was chosen, or everything was armed or stopped."""

    def step(self, estimate: Estimate, speed: float, now: float) -> Motion | Done | None:
        """What it wants now; None where nothing that counts is asked of it."""


class Navigator:
    """`sense` and then `step` each cycle; `step` also when a setpoint came."""

    def __init__(self, params: Params, kind: DriveType) -> None:
        self.home: Home | None = None
        self.origin_altitude: float | None = None
        """m above the sea of local heights' zero; None: home's, as long as nobody says another."""
        self.demand: Demand | None = None
        """What the mode wants now; None where it wants nothing, or drives not by itself."""
        self.ended: str | None = None
        """Why the mode has nothing more to do."""
        self.wanted: Motion | None = None
        """What the mode wants, before it is a demand."""
        self.paused = False
        self.speed: float | None = None
        """m/s that somebody asked for instead of WP_SPEED."""
        self.guide = Guide(params, kind)
        self.guided = Guided(params, self.guide)
        self.boundary = Boundary(params, self._home_point)
        self.havens = Havens(params, self._home_point, self.boundary.trespass)
        self.mission = Mission(params, self.guide, self.havens.best, self._effect, self.boundary.barred)
        self.plan_ids = PlanIds()
        self._params = params
        aside = [side for _, _, side in FOUR_WHEELS] if MIXERS[kind].sideways else []
        self._estimator = Estimator(aside)
        self._readings = NO_READINGS
        self._pilot = Pilot(params, kind)
        self._hazards = Hazards(params)
        self._trail = Trail()
        self._behaviours: dict[Mode, Behaviour] = {
            Mode.AUTO: self.mission,
            Mode.GUIDED: self.guided,
            Mode.LOITER: Loiter(params, self.guide),
            Mode.RTL: Return(params, self.guide, self.havens.best),
            Mode.SMART_RTL: Retrace(params, self.guide, self._trail),
        }
        self._epoch = -1

    @property
    def estimate(self) -> Estimate:
        """Where it is."""
        return self._estimator.estimate

    @property
    def altitude(self) -> float | None:
        """m above the sea, where a sensor says it."""
        altitude = self._readings.altitude
        return altitude if altitude is not None and math.isfinite(altitude) else None

    @property
    def turn_rate(self) -> float | None:
        """rad/s as the gyro says it, its bias included; None without a gyro."""
        return sane_rate(self._readings)

    def set_gyro_bias(self, bias: float) -> bool:
        """It was measured, rad/s; False where it is none."""
        return self._estimator.set_bias(bias)

    def cruise(self) -> float:
        """m/s to drive at."""
        return min(self._params["WP_SPEED"] if self.speed is None else self.speed, self._params["SPEED_MAX"])

    def goal(self, mode: Mode) -> Point | None:
        """Where a mode drives to."""
        behaviour = self._behaviours.get(mode)
        return behaviour.goal if behaviour else None

    def course(self, mode: Mode) -> Course | None:
        """The velocity that somebody asks for in GUIDED, while it counts."""
        target = self.guided.target if mode is Mode.GUIDED and self.wanted is not None else None
        return target if isinstance(target, Course) else None

    def sense(self, readings: Readings, now: float) -> None:
        """Take the readings of this cycle; the first place on the globe is home."""
        self._readings = readings
        estimate = self._estimator.sense(readings, now)
        if self.home is None and estimate.globe is not None:
            self.home = Home(*estimate.globe, self.altitude or 0.0, *estimate.place)
        self.boundary.sense(estimate, now)

    def rebase(self, origin: Origin, altitude: float | None, safety: Safety, now: float) -> None:
        """Count metres from another place on the globe. Only while disarmed: then no way is kept but the mode's."""
        self.renew(safety, now)
        self.origin_altitude = altitude
        self._estimator.rebase(origin)
        if self.home is not None:
            point = origin.point(self.home.latitude, self.home.longitude)
            self.home = self.home._replace(north=point.north, east=point.east)
        self.guide.begin()
        behaviour = self._behaviours.get(safety.mode)
        if behaviour:
            behaviour.begin(self.estimate, now)
        self.boundary.sense(self.estimate, now)

    def offers(self, need: Need) -> bool:
        """There is a sensor for it, whether or not it is well at this moment: menus should not flicker."""
        has = {Need.GYRO: self._readings.yaw_rate is not None, Need.POSITION: self.estimate.origin is not None}
        return has.get(need, True)

    def unready(self, mode: Mode) -> str | None:
        """Why a mode cannot be chosen now, or None."""
        need, estimate = OFFERED[mode].need, self.estimate
        if need is Need.GYRO and estimate.yaw_rate is None:
            return "there is no gyro"
        if need is Need.POSITION and not estimate.good:
            return "position is not known"
        behaviour = self._behaviours.get(mode)
        if behaviour is None:
            return None
        homeward = mode in (Mode.RTL, Mode.SMART_RTL)
        return self.boundary.off_limits(homeward=homeward) or behaviour.unready(estimate)

    def take(self, target: Target, now: float) -> None:
        """A setpoint for GUIDED."""
        self.paused = False
        self.guided.take(target, self.estimate, now)

    def hazards(self, safety: Safety, throttles: Sequence[float], now: float) -> dict[Failsafe, float]:
        """What is wrong, since when. What has put a mode away still counts, though the mode is gone."""
        guided = safety.mode is Mode.GUIDED and safety.cleared
        placed = OFFERED[safety.mode].need is Need.POSITION or (guided and self.guided.goal is not None)
        latched = safety.failsafes.latched
        look = Look(
            readings=self._readings,
            estimate=self.estimate,
            throttles=throttles,
            needs_position=placed or bool(latched and latched & Failsafe.POSITION),
            guided_lost=self.guided.lost_since() if guided or (latched and latched & Failsafe.GUIDED_LOSS) else None,
            outside=self.boundary.beyond > 0.0,
        )
        return self._hazards.found(look, now)

    def step(self, safety: Safety, now: float) -> None:
        """What the mode wants at this moment."""
        self.renew(safety, now)
        behaviour = self._behaviours.get(safety.mode)
        self._remember(safety)
        self.wanted = self._motion(behaviour, now) if behaviour and safety.cleared else None
        if self.wanted is None:
            self.demand = None
            self.boundary.rest()
            return
        self.wanted = self.boundary.before(self.wanted, now)
        if self.boundary.stuck(now) and self.course(safety.mode) is None:
            self.ended = "the fence is in the way"
        throttle, steering = self._pilot.step(self.wanted, self.estimate, now)
        self.demand = Demand(throttle, steering, now, 0, 0, direct=True)

    def acro(self, demand: Demand | None, now: float) -> Demand | None:
        """ACRO: the driver's steering is a turn rate, which the gyro holds; throttle stays as it is in MANUAL."""
        if demand is None:
            return None
        throttle, steering, sideways = shape(demand, self._params)
        if not (throttle or steering or sideways):
            self.rest()
        else:
            rate = steering * math.radians(self._params["ACRO_TURN_RATE"])
            steering = self._pilot.turn(rate, self.estimate, now)
        return demand._replace(throttle=throttle, steering=steering, sideways=sideways, direct=True)

    def rest(self) -> None:
        """The motors may not follow: ramps and integrals begin anew."""
        self._pilot.reset()

    def renew(self, safety: Safety, now: float) -> None:
        """After a choice, an arming or an end nothing of before goes on; what was asked later does."""
        if safety.epoch == self._epoch:
            return
        self._epoch = safety.epoch
        self.paused = self.guide.reverse = False
        self.ended = None
        self._pilot.reset()
        if not safety.armed:
            self.speed = None
            self._trail.forget()
        behaviour = self._behaviours.get(safety.mode)
        if behaviour:
            behaviour.begin(self.estimate, now)

    def _motion(self, behaviour: Behaviour, now: float) -> Motion | None:
        if self.paused:
            return STAND
        wanted = behaviour.step(self.estimate, self.cruise(), now)
        if isinstance(wanted, Done):
            self.ended = self.ended or wanted.why  # a last item may have said why by itself
            return None
        return wanted

    def _remember(self, safety: Safety) -> None:
        if safety.armed and self.estimate.good and safety.mode is not Mode.SMART_RTL:
            self._trail.add(self.estimate.place)

    def _effect(self, item: MissionItem) -> None:
        """What a DO item of a mission says; its values have passed the rules of vehicle/autonomy/mission/rules.py."""
        first, second = item.params[:2]
        if item.command == Command.DO_CHANGE_SPEED:
            if second >= 0.0:
                self.speed = second
            elif second == USUAL_SPEED:
                self.speed = None
        elif item.command == Command.DO_SET_REVERSE:
            self.guide.reverse = bool(first)
        elif item.command == Command.DO_FENCE_ENABLE and first:
            self.ended = self.boundary.fence.enable(True) or self.boundary.fence.missing

    def _home_point(self) -> Point | None:
        return None if self.home is None else Point(self.home.north, self.home.east)
