"""Drives by itself: the estimate, the modes that need no driver, and what of them goes to the motors as a demand.

What it may do is not decided here: vehicle/safety/state_machine.py says which mode it is and whether it was begun after arming, and
the last gate (vehicle/drive/gate.py) lets a demand of its own through only while it is as fresh as the control cycle.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple, Protocol

from dialects.enums import DriveType, Failsafe
from dialects.modes import Mode
from vehicle.autonomy.mission.executor import MissionExecutor
from vehicle.autonomy.modes.guided import GuidedMode
from vehicle.autonomy.modes.homing import LoiterMode, ModeFinished, RtlMode, SmartRtlMode, Trail
from vehicle.autonomy.setpoints import Target, VelocityTarget
from vehicle.drive.demand import Demand
from vehicle.drive.drive import shape_demand
from vehicle.drive.mixer import FOUR_WHEELS, MIXERS
from vehicle.modes import MODES, ModeRequirement
from vehicle.navigation.estimate import Estimate
from vehicle.navigation.estimator import Estimator, valid_yaw_rate
from vehicle.navigation.fence_avoidance import FenceAvoidance
from vehicle.navigation.geo import Home, Origin, Point
from vehicle.navigation.guidance import PathFollower
from vehicle.navigation.rally import ReturnPoints
from vehicle.navigation.speed_control import STATIONARY, DesiredMotion, SpeedTurnController
from vehicle.params import Params
from vehicle.readings import NO_READINGS, Readings
from vehicle.safety.hazards import HazardInputs, HazardMonitor
from vehicle.safety.state_machine import Safety


class PlanIds(NamedTuple):
    """The ids of the plans in force, 0 for an empty one (link/services/mission/plans.py)."""

    mission: int = 0
    fence: int = 0
    rally: int = 0


class AutonomousMode(Protocol):
    """One mode that drives by itself."""

    @property
    def goal(self) -> Point | None:
        """Where it goes."""

    def unready(self, estimate: Estimate) -> str | None:
        """Why it cannot begin, besides what its line in OFFERED needs."""

    def begin(self, estimate: Estimate, now: float) -> None:
        """It was chosen, or everything was armed or stopped."""

    def step(self, estimate: Estimate, speed: float, now: float) -> DesiredMotion | ModeFinished | None:
        """What it wants now; None where nothing that counts is asked of it."""


class Navigator:
    """`sense` and then `step` each cycle; `step` also when a setpoint came."""

    def __init__(self, params: Params, kind: DriveType) -> None:
        self.home: Home | None = None
        self.origin_altitude: float | None = None
        """m above the sea of local heights' zero; None: home's, as long as nobody says another."""
        self.demand: Demand | None = None
        """What the mode wants now; None where it wants nothing, or drives not by itself."""
        self.end_reason: str | None = None
        """Why the mode has nothing more to do."""
        self.desired_motion: DesiredMotion | None = None
        """What the mode wants, before it is a demand."""
        self.paused = False
        self.speed_override: float | None = None
        """m/s that somebody asked for instead of WP_SPEED."""
        self.guide = PathFollower(params, kind)
        self.guided = GuidedMode(params, self.guide)
        self.fence_avoidance = FenceAvoidance(params, self._home_point)
        self.return_points = ReturnPoints(params, self._home_point, self.fence_avoidance.breach_distance_at)
        self.mission = MissionExecutor(params, self.guide, self.return_points.nearest, self.fence_avoidance.rejection)
        self.plan_ids = PlanIds()
        self._params = params
        aside = [side for _, _, side in FOUR_WHEELS] if MIXERS[kind].sideways else []
        self._estimator = Estimator(aside)
        self._readings = NO_READINGS
        self._controller = SpeedTurnController(params, kind)
        self._hazards = HazardMonitor(params)
        self._trail = Trail()
        self._behaviours: dict[Mode, AutonomousMode] = {
            Mode.AUTO: self.mission,
            Mode.GUIDED: self.guided,
            Mode.LOITER: LoiterMode(params, self.guide),
            Mode.RTL: RtlMode(params, self.guide, self.return_points.nearest),
            Mode.SMART_RTL: SmartRtlMode(params, self.guide, self._trail),
        }
        self._mode_generation = -1

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
        return valid_yaw_rate(self._readings)

    def set_gyro_bias(self, bias: float) -> bool:
        """It was measured, rad/s; False where it is none."""
        return self._estimator.set_gyro_bias(bias)

    def cruise_speed(self) -> float:
        """m/s to drive at."""
        return min(
            self._params["WP_SPEED"] if self.speed_override is None else self.speed_override, self._params["SPEED_MAX"]
        )

    def goal(self, mode: Mode) -> Point | None:
        """Where a mode drives to."""
        behaviour = self._behaviours.get(mode)
        return behaviour.goal if behaviour else None

    def velocity_target(self, mode: Mode) -> VelocityTarget | None:
        """The velocity that somebody asks for in GUIDED, while it counts."""
        target = self.guided.target if mode is Mode.GUIDED and self.desired_motion is not None else None
        return target if isinstance(target, VelocityTarget) else None

    def sense(self, readings: Readings, now: float) -> None:
        """Take the readings of this cycle; the first place on the globe is home."""
        self._readings = readings
        estimate = self._estimator.update(readings, now)
        if self.home is None and estimate.lat_lon is not None:
            self.home = Home(*estimate.lat_lon, self.altitude or 0.0, *estimate.place)
        self.fence_avoidance.update(estimate, now)

    def set_origin(self, origin: Origin, altitude: float | None, safety: Safety, now: float) -> None:
        """Count metres from another place on the globe. Only while disarmed: then no way is kept but the mode's."""
        self.restart_mode(safety, now)
        self.origin_altitude = altitude
        self._estimator.set_origin(origin)
        if self.home is not None:
            point = origin.to_local(self.home.latitude, self.home.longitude)
            self.home = self.home._replace(north=point.north, east=point.east)
        self.guide.reset()
        behaviour = self._behaviours.get(safety.mode)
        if behaviour:
            behaviour.begin(self.estimate, now)
        self.fence_avoidance.update(self.estimate, now)

    def has_sensor_for(self, need: ModeRequirement) -> bool:
        """There is a sensor for it, whether or not it is well at this moment: menus should not flicker."""
        has = {
            ModeRequirement.GYRO: self._readings.yaw_rate is not None,
            ModeRequirement.POSITION: self.estimate.origin is not None,
        }
        return has.get(need, True)

    def unready_reason(self, mode: Mode) -> str | None:
        """Why a mode cannot be chosen now, or None."""
        need, estimate = MODES[mode].requirement, self.estimate
        if need is ModeRequirement.GYRO and estimate.yaw_rate is None:
            return "there is no gyro"
        if need is ModeRequirement.POSITION and not estimate.good:
            return "position is not known"
        behaviour = self._behaviours.get(mode)
        if behaviour is None:
            return None
        homeward = mode in (Mode.RTL, Mode.SMART_RTL)
        return self.fence_avoidance.block_reason(homeward=homeward) or behaviour.unready(estimate)

    @property
    def fence_unenforceable_reason(self) -> str | None:
        """Why an enabled fence would stop nothing, or None."""
        return self.fence_avoidance.unenforceable_reason

    def pause(self) -> None:
        """Stand still in the mode that drives now, until `resume`."""
        self.paused = True

    def resume(self) -> None:
        """End a pause."""
        self.paused = False

    def set_speed(self, speed: float | None) -> None:
        """Set the cruise speed in m/s; None restores WP_SPEED."""
        self.speed_override = speed

    def set_reverse(self, reverse: bool) -> None:
        """Drive paths backwards, or forwards."""
        self.guide.set_reverse(reverse)

    def set_home(self, home: Home) -> None:
        """Set the home position."""
        self.home = home

    def set_plan_ids(self, plan_ids: PlanIds) -> None:
        """Set the ids of the plans in force, for MISSION_CURRENT."""
        self.plan_ids = plan_ids

    def end_mode(self, reason: str) -> None:
        """Request the end of the mode that drives now; the same cycle changes to HOLD."""
        self.end_reason = reason

    def set_target(self, target: Target, now: float) -> None:
        """A setpoint for GUIDED."""
        self.resume()
        self.guided.set_target(target, self.estimate, now)

    def find_hazards(self, safety: Safety, throttles: Sequence[float], now: float) -> dict[Failsafe, float]:
        """What is wrong, since when. What has put a mode away still counts, though the mode is gone."""
        guided = safety.mode is Mode.GUIDED and safety.autonomy_confirmed
        placed = MODES[safety.mode].requirement is ModeRequirement.POSITION or (guided and self.guided.goal is not None)
        latched = safety.failsafes.latched
        look = HazardInputs(
            readings=self._readings,
            estimate=self.estimate,
            throttles=throttles,
            needs_position=placed or bool(latched and latched & Failsafe.POSITION),
            guided_lost=self.guided.expires_at() if guided or (latched and latched & Failsafe.GUIDED_LOSS) else None,
            outside=self.fence_avoidance.breach_distance > 0.0,
        )
        return self._hazards.update(look, now)

    def step(self, safety: Safety, now: float) -> None:
        """What the mode wants at this moment."""
        self.restart_mode(safety, now)
        behaviour = self._behaviours.get(safety.mode)
        self._record_trail(safety)
        self.desired_motion = self._motion(behaviour, now) if behaviour and safety.autonomy_confirmed else None
        if self.desired_motion is None:
            self.demand = None
            self.fence_avoidance.reset()
            return
        self.desired_motion = self.fence_avoidance.limit_speed(self.desired_motion, now)
        if self.fence_avoidance.is_stuck(now) and self.velocity_target(safety.mode) is None:
            self.end_reason = "the fence is in the way"
        throttle, steering = self._controller.step(self.desired_motion, self.estimate, now)
        self.demand = Demand(throttle, steering, now, 0, 0, direct=True)

    def acro_demand(self, demand: Demand | None, now: float) -> Demand | None:
        """ACRO: the driver's steering is a turn rate, which the gyro holds; throttle stays as it is in MANUAL."""
        if demand is None:
            return None
        throttle, steering, sideways = shape_demand(demand, self._params)
        if not (throttle or steering or sideways):
            self.reset_controller()
        else:
            rate = steering * math.radians(self._params["ACRO_TURN_RATE"])
            steering = self._controller.steering_for_rate(rate, self.estimate, now)
        return demand._replace(throttle=throttle, steering=steering, sideways=sideways, direct=True)

    def reset_controller(self) -> None:
        """The motors may not follow: ramps and integrals begin anew."""
        self._controller.reset()

    def restart_mode(self, safety: Safety, now: float) -> None:
        """After a choice, an arming or an end nothing of before goes on; what was asked later does."""
        if safety.mode_generation == self._mode_generation:
            return
        self._mode_generation = safety.mode_generation
        self.resume()
        self.set_reverse(False)
        self.end_reason = None
        self._controller.reset()
        if not safety.armed:
            self.speed_override = None
            self._trail.clear()
        behaviour = self._behaviours.get(safety.mode)
        if behaviour:
            behaviour.begin(self.estimate, now)

    def _motion(self, behaviour: AutonomousMode, now: float) -> DesiredMotion | None:
        if self.paused:
            return STATIONARY
        wanted = behaviour.step(self.estimate, self.cruise_speed(), now)
        if isinstance(wanted, ModeFinished):
            self.end_reason = self.end_reason or wanted.reason  # a last item may have said why by itself
            return None
        return wanted

    def _record_trail(self, safety: Safety) -> None:
        if safety.armed and self.estimate.good and safety.mode is not Mode.SMART_RTL:
            self._trail.add(self.estimate.place)

    def _home_point(self) -> Point | None:
        return None if self.home is None else Point(self.home.north, self.home.east)
