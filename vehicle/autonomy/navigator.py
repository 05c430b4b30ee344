"""Autonomous driving: feeds the estimator, runs the mode, and turns its motion into a demand.

The navigator does not decide whether the rover may move: vehicle/safety/state_machine.py knows the mode and whether it
was requested after arming, and the last gate (vehicle/drive/gate.py) passes an autonomous demand only while it is as
fresh as the control cycle.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

from dialects.enums import DriveType, Failsafe
from dialects.modes import Mode
from vehicle.autonomy.mission.executor import MissionExecutor
from vehicle.autonomy.mode import AutonomousMode, ModeContext, ModeFinished
from vehicle.autonomy.modes.guided import GuidedMode
from vehicle.autonomy.modes.loiter import LoiterMode
from vehicle.autonomy.modes.rtl import RtlMode
from vehicle.autonomy.modes.smart_rtl import SmartRtlMode
from vehicle.autonomy.setpoints import Target, VelocityTarget
from vehicle.autonomy.trail import Trail
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
from vehicle.safety.failsafe_inputs import MotionInputs
from vehicle.safety.state_machine import Safety

MODE_CLASSES: dict[Mode, Callable[[ModeContext], AutonomousMode]] = {
    Mode.LOITER: LoiterMode,
    Mode.RTL: RtlMode,
    Mode.SMART_RTL: SmartRtlMode,
}
"""The autonomous modes besides AUTO and GUIDED, which also take commands. To add a mode, write its class and a row here
and in vehicle/modes.py; a number that ArduRover has not assigned also needs a row in dialects/modes.py."""


class PlanIds(NamedTuple):
    """The ids of the plans in use, 0 for an empty plan (link/services/mission/plans.py)."""

    mission: int = 0
    fence: int = 0
    rally: int = 0


class Navigator:
    """Call `sense` and then `step` in each cycle; call `step` also after a setpoint."""

    def __init__(self, params: Params, kind: DriveType) -> None:
        self.home: Home | None = None
        self.origin_altitude: float | None = None
        """m above sea level of the local origin; None for the altitude of home, unless a command set it."""
        self.demand: Demand | None = None
        """The demand of the mode; None if the mode is not autonomous or requests nothing."""
        self.end_reason: str | None = None
        """Why the mode has finished, or None."""
        self.desired_motion: DesiredMotion | None = None
        """The motion that the mode requests, before the controllers."""
        self.paused = False
        self.speed_override: float | None = None
        """m/s that a command or a mission requests instead of WP_SPEED."""
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
        self._trail = Trail()
        context = ModeContext(params, self.guide, self.return_points.nearest, self._trail)
        self._modes: dict[Mode, AutonomousMode] = {mode: build(context) for mode, build in MODE_CLASSES.items()}
        self._modes |= {Mode.AUTO: self.mission, Mode.GUIDED: self.guided}
        self._mode_generation = -1

    @property
    def estimate(self) -> Estimate:
        """The position estimate."""
        return self._estimator.estimate

    @property
    def altitude(self) -> float | None:
        """Altitude in m above sea level; None if no sensor measures it."""
        altitude = self._readings.altitude
        return altitude if altitude is not None and math.isfinite(altitude) else None

    @property
    def turn_rate(self) -> float | None:
        """Turn rate of the gyro in rad/s, its bias included; None without a gyro."""
        return valid_yaw_rate(self._readings)

    def set_gyro_bias(self, bias: float) -> bool:
        """Set the gyro bias in rad/s; return False if the value cannot be a bias."""
        return self._estimator.set_gyro_bias(bias)

    def cruise_speed(self) -> float:
        """Return the m/s to drive at."""
        return min(
            self._params["WP_SPEED"] if self.speed_override is None else self.speed_override, self._params["SPEED_MAX"]
        )

    def goal(self, mode: Mode) -> Point | None:
        """Return the place that a mode drives to, or None."""
        active = self._modes.get(mode)
        return active.goal if active else None

    def velocity_target(self, mode: Mode) -> VelocityTarget | None:
        """Return the velocity setpoint of GUIDED while it is valid, or None."""
        target = self.guided.target if mode is Mode.GUIDED and self.desired_motion is not None else None
        return target if isinstance(target, VelocityTarget) else None

    def sense(self, readings: Readings, now: float) -> None:
        """Update the estimate with the readings of this cycle; the first global position becomes home."""
        self._readings = readings
        estimate = self._estimator.update(readings, now)
        if self.home is None and estimate.lat_lon is not None:
            self.home = Home(*estimate.lat_lon, self.altitude or 0.0, *estimate.place)
        self.fence_avoidance.update(estimate, now)

    def set_origin(self, origin: Origin, altitude: float | None, safety: Safety, now: float) -> None:
        """Move the origin of local coordinates. Only while disarmed: the modes begin anew."""
        self.restart_mode(safety, now)
        self.origin_altitude = altitude
        self._estimator.set_origin(origin)
        if self.home is not None:
            point = origin.to_local(self.home.latitude, self.home.longitude)
            self.home = self.home._replace(north=point.north, east=point.east)
        self.guide.reset()
        active = self._modes.get(safety.mode)
        if active:
            active.begin(self.estimate, now)
        self.fence_avoidance.update(self.estimate, now)

    def has_sensor_for(self, need: ModeRequirement) -> bool:
        """Return True if the vehicle has the sensor. A short failure does not count: menus should not flicker."""
        has = {
            ModeRequirement.GYRO: self._readings.yaw_rate is not None,
            ModeRequirement.POSITION: self.estimate.origin is not None,
        }
        return has.get(need, True)

    def unready_reason(self, mode: Mode) -> str | None:
        """Return why a mode cannot be chosen now, or None."""
        need, estimate = MODES[mode].requirement, self.estimate
        if need is ModeRequirement.GYRO and estimate.yaw_rate is None:
            return "there is no gyro"
        if need is ModeRequirement.POSITION and not estimate.good:
            return "position is not known"
        active = self._modes.get(mode)
        if active is None:
            return None
        homeward = MODES[mode].leads_home
        return self.fence_avoidance.block_reason(homeward=homeward) or active.unready(estimate)

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
        """Set the target of GUIDED; a pause ends."""
        self.resume()
        self.guided.set_target(target, self.estimate, now)

    def build_failsafe_inputs(self, safety: Safety, throttles: Sequence[float]) -> MotionInputs:
        """Return the inputs of the failsafes.

        A condition that has changed the mode stays relevant in the mode that follows.
        """
        guided = safety.mode is Mode.GUIDED and safety.autonomy_confirmed
        placed = MODES[safety.mode].requirement is ModeRequirement.POSITION or (guided and self.guided.goal is not None)
        latched = safety.failsafes.latched
        return MotionInputs(
            readings=self._readings,
            estimate=self.estimate,
            throttles=throttles,
            needs_position=placed or bool(latched & Failsafe.POSITION),
            setpoint_expires=self.guided.expires_at() if guided or latched & Failsafe.GUIDED_LOSS else None,
            outside_fence=self.fence_avoidance.breach_distance > 0.0,
        )

    def step(self, safety: Safety, now: float) -> None:
        """Update the demand of the mode."""
        self.restart_mode(safety, now)
        active = self._modes.get(safety.mode)
        self._record_trail(safety)
        self.desired_motion = self._motion(active, now) if active and safety.autonomy_confirmed else None
        if self.desired_motion is None:
            self.demand = None
            self.fence_avoidance.reset()
            return
        self.desired_motion = self.fence_avoidance.limit_speed(self.desired_motion, now)
        if self.fence_avoidance.is_stuck(now) and self.velocity_target(safety.mode) is None:
            self.end_reason = "blocked by the fence"
        throttle, steering = self._controller.step(self.desired_motion, self.estimate, now)
        self.demand = Demand(throttle, steering, now, 0, 0, direct=True)

    def acro_demand(self, demand: Demand | None, now: float) -> Demand | None:
        """Return the demand of ACRO: steering is a turn rate, held by the gyro; throttle is as in MANUAL."""
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
        """Reset the controllers' ramps and integrals: the motors may not follow them."""
        self._controller.reset()

    def restart_mode(self, safety: Safety, now: float) -> None:
        """Begin the mode anew after a mode choice, an arming or a stop; later requests are kept."""
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
        active = self._modes.get(safety.mode)
        if active:
            active.begin(self.estimate, now)

    def _motion(self, active: AutonomousMode, now: float) -> DesiredMotion | None:
        if self.paused:
            return STATIONARY
        wanted = active.step(self.estimate, self.cruise_speed(), now)
        if isinstance(wanted, ModeFinished):
            self.end_reason = self.end_reason or wanted.reason  # the last item may have set a reason itself
            return None
        return wanted

    def _record_trail(self, safety: Safety) -> None:
        if safety.armed and self.estimate.good and safety.mode is not Mode.SMART_RTL:
            self._trail.add(self.estimate.place)

    def _home_point(self) -> Point | None:
        return None if self.home is None else Point(self.home.north, self.home.east)
