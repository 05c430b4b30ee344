"""STREAMS: one table of what the vehicle sends periodically, on change or on request.

A receiver counts a message that its dialect lacks as lost: pymavlink sees a gap in the sequence, and the `link` command
of MAVProxy shows packet loss. So each stream names a dialect level, and only the lowest level goes to all peers.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from enum import IntEnum

import msgspec

from dialects import messages as m
from dialects.enums import Command, DataStream
from link.services.pacing import MAVLINK2_OVERHEAD
from vehicle.telemetry import (
    build_computer,
    build_control,
    build_motion,
    build_navigation,
    build_pose,
    build_proximity,
    build_status,
)
from vehicle.telemetry.scaling import parse_message_id
from vehicle.telemetry.view import TelemetryView


class DialectLevel(IntEnum):
    """Which peers understand a message. Each level includes those before it."""

    COMMON = 0
    """All peers: pymavlink's common.xml has the message."""
    NEWER = 1
    """Peers with today's common.xml, such as QGroundControl: sent to peers that have requested one of them."""
    ROVER = 2
    """Peers with the dialect of this project: sent to peers that have requested or sent one of them."""


COMMON, NEWER, ROVER = DialectLevel


class Stream(msgspec.Struct, frozen=True):
    """One message, and when it is sent."""

    message: type[m.Message]
    level: DialectLevel
    rate: float
    """Hz for peers at its level; 0: only on request, and on change."""
    build: Callable[[TelemetryView], m.Message | None]
    """Returns None if there is nothing to send."""
    group: DataStream | None = None
    """The group of REQUEST_DATA_STREAM that it belongs to."""
    change_key: Callable[[TelemetryView], Hashable] | None = None
    """The stream, if enabled, is sent at once when this value changes."""
    follows_demand: bool = False
    """Sent after a demand without waiting for a tick."""
    fixed_rate: bool = False
    """Peers cannot change its rate."""
    steady: bool = False
    """A full link does not lower its rate."""

    @property
    def size(self) -> int:
        """Largest frame in bytes."""
        return int(self.message.unpacker.size) + MAVLINK2_OVERHEAD


STREAMS: tuple[Stream, ...] = (
    Stream(m.Heartbeat, COMMON, 1, build_status.heartbeat, fixed_rate=True, steady=True,
           change_key=lambda view: (view.safety.state, view.safety.mode)),
    # The ground station echoes time_boot_ms of this one (OPR_ECHO_MAX).
    Stream(m.RoverDriveStatus, ROVER, 5, build_status.drive_status, steady=True, follows_demand=True,
           change_key=lambda view: (view.control.demand and (view.control.demand.throttle,
                                                         view.control.demand.steering),
                                view.control.neutral_seen, view.safety.armed)),
    Stream(m.RoverFailsafeStatus, ROVER, 1, build_status.failsafe_status,
           change_key=lambda view: (view.safety.failsafes.active, view.safety.latched)),
    Stream(m.ControlStatus, NEWER, 1, build_control.control_status,
           change_key=lambda view: (view.control.ownership.owner, view.control.ownership.takeover_allowed)),
    Stream(m.RoverControl, ROVER, 1, build_control.rover_control, change_key=build_control.control_key),
    Stream(m.CurrentMode, NEWER, 0.5, build_status.current_mode,
           change_key=lambda view: (view.safety.mode, view.safety.intended)),
    Stream(m.MissionCurrent, COMMON, 1, build_navigation.mission_current, DataStream.EXTENDED_STATUS,
           change_key=lambda view: (view.navigator.mission.current, view.navigator.mission.state, view.safety.mode,
                                view.navigator.plan_ids)),
    Stream(m.AvailableModesMonitor, NEWER, 0.3, build_status.available_modes_monitor),
    Stream(m.SystemTime, COMMON, 1, build_status.system_time),
    Stream(m.SysStatus, COMMON, 1, build_status.sys_status, DataStream.EXTENDED_STATUS),
    Stream(m.BatteryStatus, COMMON, 0.5, build_status.battery_status, DataStream.EXTENDED_STATUS),
    Stream(m.ExtendedSysState, COMMON, 0.5, build_status.extended_sys_state, DataStream.EXTENDED_STATUS),
    Stream(m.GpsRawInt, COMMON, 1, build_motion.gps_raw_int, DataStream.EXTENDED_STATUS),
    Stream(m.Attitude, COMMON, 4, build_motion.attitude, DataStream.EXTRA1),
    Stream(m.VfrHud, COMMON, 4, build_motion.vfr_hud, DataStream.EXTRA2),
    Stream(m.LocalPositionNed, COMMON, 4, build_motion.local_position_ned, DataStream.POSITION),
    Stream(m.GlobalPositionInt, COMMON, 2, build_motion.global_position_int, DataStream.POSITION),
    Stream(m.EstimatorStatus, COMMON, 1, build_motion.estimator_status, DataStream.EXTENDED_STATUS),
    Stream(m.PositionTargetGlobalInt, COMMON, 1, build_navigation.position_target_global, DataStream.POSITION,
           change_key=lambda view: view.navigator.goal(view.safety.mode)),
    Stream(m.PositionTargetLocalNed, COMMON, 1, build_navigation.position_target_local, DataStream.POSITION,
           change_key=lambda view: view.navigator.goal(view.safety.mode)),
    Stream(m.NavControllerOutput, COMMON, 2, build_navigation.nav_controller_output, DataStream.EXTENDED_STATUS),
    Stream(m.FenceStatus, COMMON, 1, build_navigation.fence_status, DataStream.EXTENDED_STATUS,
           change_key=lambda view: (view.navigator.fence_avoidance.fence.enabled,
                                view.navigator.fence_avoidance.breach_distance > 0.0)),
    Stream(m.ServoOutputRaw, COMMON, 2, build_motion.servo_output_raw, DataStream.RC_CHANNELS),
    Stream(m.RcChannels, COMMON, 2, build_motion.rc_channels, DataStream.RC_CHANNELS),
    Stream(m.RelayStatus, COMMON, 0.5, build_motion.relay_status, DataStream.RC_CHANNELS,
           change_key=lambda view: tuple(view.rack.values("relay").items())),
    Stream(m.GpsGlobalOrigin, COMMON, 0, build_motion.gps_global_origin,
           change_key=lambda view: (view.navigator.estimate.origin, view.navigator.origin_altitude)),
    Stream(m.HomePosition, COMMON, 0.5, build_status.home_position, change_key=lambda view: view.home),
    Stream(m.ObstacleDistance, COMMON, 1, build_proximity.obstacle_distance, DataStream.EXTENDED_STATUS),
    Stream(m.DistanceSensor, COMMON, 4, build_proximity.distance_sensor, DataStream.EXTENDED_STATUS),
    Stream(m.OnboardComputerStatus, COMMON, 0.5, build_computer.onboard_computer_status, DataStream.EXTENDED_STATUS),
    Stream(m.AttitudeQuaternion, COMMON, 0, build_pose.attitude_quaternion),
    Stream(m.HighresImu, COMMON, 0, build_pose.highres_imu),
    Stream(m.Odometry, COMMON, 0, build_pose.odometry),
    Stream(m.Altitude, COMMON, 0, build_pose.altitude),
    Stream(m.RoverDriveInfo, ROVER, 0, build_status.drive_info),
    Stream(m.AutopilotVersion, COMMON, 0, build_status.autopilot_version),
    Stream(m.ProtocolVersion, NEWER, 0, build_status.protocol_version),
)  # fmt: skip
"""All streams, the most important first. Messages that are not a stream are built in vehicle/commands/requests.py."""

STREAM_BY_ID: dict[int, Stream] = {stream.message.id: stream for stream in STREAMS}

_LEVELS: dict[int, DialectLevel] = {
    **{stream.message.id: stream.level for stream in STREAMS},
    m.AvailableModes.id: NEWER,
    m.ComponentMetadata.id: NEWER,
    m.RoverLinkStatus.id: ROVER,
}
"""Message -> level, also of messages that are not a stream."""
_COMMANDS: dict[int, DialectLevel] = {Command.REQUEST_OPERATOR_CONTROL: NEWER, Command.DO_SET_STANDARD_MODE: NEWER}
_MESSAGE_REQUESTS = frozenset({Command.REQUEST_MESSAGE, Command.SET_MESSAGE_INTERVAL, Command.GET_MESSAGE_INTERVAL})
"""Commands with a message id as parameter 1."""


def level_of_command(message: m.CommandLong | m.CommandInt) -> DialectLevel:
    """Return the level that the sender of a command has shown to understand."""
    if message.command in _MESSAGE_REQUESTS:
        number = parse_message_id(message.param1)
        return COMMON if number is None else _LEVELS.get(number, COMMON)
    return _COMMANDS.get(message.command, COMMON)
