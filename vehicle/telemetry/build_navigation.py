"""Builds messages about targets, path, mission and fence; most are None outside of autonomous modes."""

from __future__ import annotations

import math

from dialects import messages as m
from dialects.modes import Mode
from vehicle.autonomy.mission.executor import MissionState
from vehicle.autonomy.navigator import Navigator
from vehicle.autonomy.setpoints import BODY_NED, LOCAL_NED
from vehicle.modes import MODES
from vehicle.navigation.geo import Point, wrap_angle
from vehicle.telemetry.build_motion import above_origin
from vehicle.telemetry.scaling import INT16, INT32, UINT16, scale_to_int, to_float32
from vehicle.telemetry.view import TelemetryView

NO_MISSION = m.UINT16_MAX
"""`total` of MISSION_CURRENT without a mission; 0 would mean that the vehicle does not report it."""
ABSOLUTE = 0
"""MAV_FRAME_GLOBAL"""
ONLY_POSITION = 0xDF8
"""POSITION_TARGET_TYPEMASK: ignore everything but the position."""
TURNING, HEADED = 0x5C7, 0x9C7
"""POSITION_TARGET_TYPEMASK: ignore everything but a velocity with a yaw rate, or with a yaw."""
NO_BREACH, BOUNDARY = 0, 3
"""FENCE_BREACH; a rover has no altitude limits."""


def position_target_global(view: TelemetryView) -> m.Message | None:
    """Build POSITION_TARGET_GLOBAL_INT: the position that the mode drives to."""
    goal, origin = _goal(view), view.estimate.origin
    if goal is None or origin is None:
        return None
    latitude, longitude = origin.to_global(goal)
    return m.PositionTargetGlobalInt(
        time_boot_ms=view.boot_ms, coordinate_frame=ABSOLUTE, type_mask=ONLY_POSITION,
        lat_int=scale_to_int(latitude, INT32, 1e7), lon_int=scale_to_int(longitude, INT32, 1e7),
        alt=to_float32(view.readings.altitude),
        vx=0.0, vy=0.0, vz=0.0, afx=0.0, afy=0.0, afz=0.0, yaw=0.0, yaw_rate=0.0,
    )  # fmt: skip


def position_target_local(view: TelemetryView) -> m.Message | None:
    """Build POSITION_TARGET_LOCAL_NED: the position that the mode drives to, or the velocity target of GUIDED."""
    goal = _goal(view)
    if goal is not None:
        return _local(view, LOCAL_NED, ONLY_POSITION, x=goal.north, y=goal.east, z=-above_origin(view))
    course = view.navigator.velocity_target(view.safety.mode)
    if course is None:
        return None
    if course.heading is None:
        return _local(view, BODY_NED, TURNING, vx=course.speed, yaw_rate=course.turn_rate or 0.0)
    north, east = course.speed * math.cos(course.heading), course.speed * math.sin(course.heading)
    return _local(view, LOCAL_NED, HEADED, vx=north, vy=east, yaw=wrap_angle(course.heading))


def nav_controller_output(view: TelemetryView) -> m.Message | None:
    """Build NAV_CONTROLLER_OUTPUT: course, distance to go in m, and cross-track error in m."""
    navigator, estimate = view.navigator, view.estimate
    if not MODES[view.safety.mode].autonomous or estimate.yaw is None:
        return None
    goal, leg = _goal(view), navigator.guide.leg
    course = estimate.yaw if navigator.guide.course is None else navigator.guide.course
    target = course if goal is None else estimate.place.bearing(goal)
    wanted = navigator.desired_motion.speed if navigator.desired_motion else 0.0
    return m.NavControllerOutput(
        nav_roll=0.0,
        nav_pitch=0.0,
        nav_bearing=_degrees(course),
        target_bearing=_degrees(target),
        wp_dist=scale_to_int(None if goal is None else estimate.place.distance(goal), UINT16),
        alt_error=0.0,
        aspd_error=wanted - to_float32(estimate.speed),
        xtrack_error=0.0 if leg is None or goal is None else leg.along_and_cross_track(estimate.place)[1],
    )


def mission_current(view: TelemetryView) -> m.MissionCurrent:
    """Build MISSION_CURRENT: the item, how many there are, and the mission state."""
    return mission_state(view.navigator, view.safety.mode)


def mission_state(navigator: Navigator, mode: Mode) -> m.MissionCurrent:
    """Build MISSION_CURRENT without a view, for the mission service."""
    mission = navigator.mission
    paused = mission.state is MissionState.ACTIVE and (navigator.paused or mode is not Mode.AUTO)
    state = m.MISSION_PAUSED if paused else mission.state
    total = len(mission.items) or NO_MISSION
    return m.MissionCurrent(mission.current, total, state, 1 if mode is Mode.AUTO else 2, *navigator.plan_ids)


def fence_status(view: TelemetryView) -> m.Message | None:
    """Build FENCE_STATUS; None while the fence is disabled, as in ArduPilot."""
    boundary = view.navigator.fence_avoidance
    if not boundary.fence.enabled:
        return None
    outside, at = boundary.breach_distance > 0.0, boundary.breached_at
    return m.FenceStatus(
        breach_status=int(outside),
        breach_count=scale_to_int(boundary.breach_count, UINT16),
        breach_type=BOUNDARY if outside else NO_BREACH,
        breach_time=0 if at is None else m.boot_ms(view.since_boot - (view.now - at)),
    )


def _goal(view: TelemetryView) -> Point | None:
    return view.navigator.goal(view.safety.mode)


def _local(view: TelemetryView, frame: int, mask: int, **values: float) -> m.Message:
    zeros = dict.fromkeys(("x", "y", "z", "vx", "vy", "vz", "afx", "afy", "afz", "yaw", "yaw_rate"), 0.0)
    return m.PositionTargetLocalNed(view.boot_ms, frame, mask, **{**zeros, **values})


def _degrees(angle: float) -> int:
    return scale_to_int(math.degrees(wrap_angle(angle)), INT16)
