"""Builds messages about state: heartbeat, health, mode, control, demand, failsafes, version."""

from __future__ import annotations

import math

from dialects import messages as m
from dialects.enums import Autopilot, Capability, DriveLimit, Failsafe, Sensor, SystemState, VehicleType
from dialects.modes import Mode, base_mode
from vehicle.modes import MODES, ModeRequirement, ModeSpec
from vehicle.safety import states
from vehicle.safety.failsafe import FailsafeAction
from vehicle.telemetry.build_motion import home_above_origin
from vehicle.telemetry.scaling import INT8, INT16, INT32, UINT16, scale_to_int, to_float32
from vehicle.telemetry.view import TelemetryView

VERSION = (0, 1, 0)
"""Version of this program, for AUTOPILOT_VERSION."""
X_AXIS, R_AXIS = 0, 3
"""ROVER_AXIS of throttle and steering, as in the specification (dialects/axes.py, Autopilot.GENERIC)."""
NOT_USER_SELECTABLE, AUTO_MODE = 2, 4
"""MAV_MODE_PROPERTY."""
UNKNOWN_VOLTAGES = [m.UINT16_MAX] * 9
CHARGE_OK, CHARGE_LOW, CHARGE_CRITICAL = 1, 2, 3
"""MAV_BATTERY_CHARGE_STATE."""


def heartbeat(view: TelemetryView) -> m.Message:
    """Build HEARTBEAT: armed, mode and MAV_STATE."""
    return m.Heartbeat(
        type=VehicleType.GROUND_ROVER,
        autopilot=Autopilot.GENERIC,
        base_mode=base_mode(_mode(view), armed=view.safety.armed),
        custom_mode=_mode(view),
        system_status=_system_status(view),
        mavlink_version=3,
    )


def _system_status(view: TelemetryView) -> SystemState:
    safety = view.safety
    if safety.terminated:
        return SystemState.FLIGHT_TERMINATION
    if safety.armed and (safety.failsafes.active or safety.latched):
        return SystemState.CRITICAL
    return {
        states.SafetyState.BOOT: SystemState.BOOT,
        states.SafetyState.SAFE: SystemState.STANDBY,
        states.SafetyState.ARMED: SystemState.ACTIVE,
        states.SafetyState.ESTOP: SystemState.EMERGENCY,
        states.SafetyState.FAULT: SystemState.CRITICAL,
        states.SafetyState.OFF: SystemState.POWEROFF,
    }[safety.state]


def sys_status(view: TelemetryView) -> m.Message:
    """Build SYS_STATUS: sensors present, enabled and healthy; battery and load."""
    readings, battery, fence = view.readings, view.safety.battery, view.navigator.fence_avoidance.fence
    has = {
        Sensor.MOTOR_OUTPUTS: True,
        Sensor.PREARM: True,
        Sensor.GEOFENCE: fence.is_present,
        Sensor.BATTERY: battery.present,
        Sensor.GPS: readings.gps_fix is not None or "gps" in readings.configured,
        Sensor.GYRO: readings.yaw_rate is not None,
        Sensor.ACCELEROMETER: readings.roll is not None,  # only an accelerometer measures level
        Sensor.COMPASS: readings.yaw is not None,
        Sensor.AHRS: view.estimate.yaw is not None,
        Sensor.LOGGING: view.logs is not None,
    }
    faulty = {
        Sensor.MOTOR_OUTPUTS: view.safety.motor_fault is not None,
        Sensor.GEOFENCE: view.navigator.fence_avoidance.breach_distance > 0.0,
        Sensor.PREARM: not view.safety.armed
        and bool(view.safety.prearm_problems(view.now)),  # a deflected stick forbids to arm
        Sensor.BATTERY: battery.is_silent(view.now) or battery.low_since(view.now) is not None,
        Sensor.GPS: (readings.gps_fix or 0) < 3,
        Sensor.AHRS: readings.gps_fix is not None and not view.estimate.good,
        Sensor.LOGGING: view.logs is False,
    }
    present = sum(sensor for sensor, exists in has.items() if exists)
    # MAVProxy shows a disabled fence as breached if its health bit is 0.
    off = 0 if fence.enabled else Sensor.GEOFENCE
    health = off | sum(sensor for sensor, exists in has.items() if exists and not faulty.get(sensor))
    return m.SysStatus(
        onboard_control_sensors_present=present,
        onboard_control_sensors_enabled=present & ~off,
        onboard_control_sensors_health=health,
        load=scale_to_int(view.host.load, (0, 1000), 1000),
        voltage_battery=scale_to_int(readings.battery_voltage, UINT16, 1000, unknown=m.UINT16_MAX),
        current_battery=scale_to_int(readings.battery_current, INT16, 100, unknown=-1),
        battery_remaining=scale_to_int(readings.battery_remaining, (0, 100), 100, unknown=-1),
        drop_rate_comm=0, errors_comm=0, errors_count1=0, errors_count2=0, errors_count3=0, errors_count4=0,
    )  # fmt: skip


def battery_status(view: TelemetryView) -> m.Message | None:
    """Build BATTERY_STATUS of the one battery; None without a sensor."""
    readings, battery = view.readings, view.safety.battery
    if readings.battery_voltage is None:
        return None
    critical, low = battery.critical_since(view.now) is not None, battery.low_since(view.now) is not None
    return m.BatteryStatus(
        id=0,
        battery_function=0,
        type=0,
        temperature=INT16[1],
        voltages=[scale_to_int(readings.battery_voltage, (0, 65534), 1000), *UNKNOWN_VOLTAGES],
        current_battery=scale_to_int(readings.battery_current, INT16, 100, unknown=-1),
        current_consumed=-1,
        energy_consumed=-1,
        battery_remaining=scale_to_int(readings.battery_remaining, (0, INT8[1]), 100, unknown=-1),
        charge_state=CHARGE_CRITICAL if critical else CHARGE_LOW if low else CHARGE_OK,
    )


def current_mode(view: TelemetryView) -> m.Message:
    """Build CURRENT_MODE: the mode, and the one that the driver chose last."""
    mode = _mode(view)
    return m.CurrentMode(MODES[mode].standard, custom_mode=mode, intended_custom_mode=view.safety.intended)


def _mode(view: TelemetryView) -> Mode:
    return Mode.INITIALISING if view.safety.state is states.SafetyState.BOOT else view.safety.mode


def system_time(view: TelemetryView) -> m.Message:
    """Build SYSTEM_TIME; 0 if the Unix time is unknown."""
    seconds = view.host.unix_time(view.now)
    unix = 0 if seconds is None else scale_to_int(seconds, (0, 2**63), 1e6)
    return m.SystemTime(time_unix_usec=unix, time_boot_ms=view.boot_ms)


def limits(view: TelemetryView) -> DriveLimit:
    """Return why the outputs differ from the demand."""
    safety, control = view.safety, view.control
    reasons = {
        DriveLimit.DISARMED: not safety.armed,
        DriveLimit.ESTOP: safety.state is states.SafetyState.ESTOP,
        DriveLimit.FAILSAFE: safety.failsafes.lasting_action(view.now) >= FailsafeAction.NEUTRAL
        or bool(safety.failsafes.latched),
        DriveLimit.FENCE: bool(safety.failsafes.active & Failsafe.FENCE) or view.navigator.fence_avoidance.is_limiting,
        DriveLimit.BATTERY: bool(safety.failsafes.active & (Failsafe.BATTERY_LOW | Failsafe.BATTERY_CRITICAL)),
        DriveLimit.STALE: control.is_demand_stale(view.now),
        DriveLimit.NEUTRAL_FIRST: safety.armed and not control.neutral_seen,
    }
    return view.drive.limits | DriveLimit(sum(limit for limit, holds in reasons.items() if holds))


def _speed_limit(view: TelemetryView) -> int:
    speed = min(view.fresh_speed, view.drive.avoiding_speed)
    return scale_to_int(speed, UINT16, 100) if math.isfinite(speed) else 0


def drive_status(view: TelemetryView) -> m.Message:
    """Build ROVER_DRIVE_STATUS: the demand while it is fresh, the wheels, and why they differ."""
    control = view.control
    demand = None if control.is_demand_stale(view.now) else control.demand
    output = [scale_to_int(value, INT16, 10000) for value in view.drive.wheels]
    return m.RoverDriveStatus(
        time_boot_ms=view.boot_ms,
        demand_age_ms=scale_to_int(control.demand_age(view.now), UINT16, 1000, unknown=m.UINT16_MAX),
        demand_throttle=scale_to_int(demand.throttle, INT16, 10000) if demand else 0,
        demand_steering=scale_to_int(demand.steering, INT16, 10000) if demand else 0,
        output=(output + [0] * 4)[:4],
        limits=limits(view),
        speed_limit=_speed_limit(view),
        source_system=control.demand.system if control.demand else 0,
        source_seq=control.demand.sequence if control.demand else 0,
    )


def failsafe_status(view: TelemetryView) -> m.Message:
    """Build ROVER_FAILSAFE_STATUS: active conditions, and the next action with its time."""
    safety = view.safety
    step = safety.failsafes.next_step(view.now)
    return m.RoverFailsafeStatus(
        time_boot_ms=view.boot_ms,
        active=safety.failsafes.active | (safety.latched & (Failsafe.ESTOP | Failsafe.MOTOR_DRIVER)),
        latched=safety.latched,
        action_in_ms=scale_to_int(step.delay if step else None, UINT16, 1000, unknown=m.UINT16_MAX),
        custom_mode_after=Mode.HOLD if step and step.action is FailsafeAction.HOLD else safety.mode,
        will_disarm=step is not None and step.action is FailsafeAction.DISARM,
    )


def drive_info(view: TelemetryView) -> m.Message:
    """Build ROVER_DRIVE_INFO: what the axes of MANUAL_CONTROL mean."""
    params = view.params
    return m.RoverDriveInfo(
        speed_max=params["SPEED_MAX"],
        turn_rate_max=2 * params["SPEED_MAX"] / params["TRACK_WIDTH"],
        track_width=params["TRACK_WIDTH"],
        wheelbase=params["WHEELBASE"],
        manual_timeout_ms=scale_to_int(params["MAN_TIMEOUT"], UINT16, 1000),
        drive_type=view.drive.kind,
        throttle_axis=X_AXIS,
        steering_axis=R_AXIS,
        throttle_neutral=0,
        motor_count=len(view.drive.wheels),
    )


def extended_sys_state(view: TelemetryView) -> m.Message:
    """Build EXTENDED_SYS_STATE: a rover is always on the ground."""
    return m.ExtendedSysState(vtol_state=0, landed_state=1)


def home_position(view: TelemetryView) -> m.Message | None:
    """Build HOME_POSITION; None until home is known."""
    home = view.home
    if home is None:
        return None
    return m.HomePosition(
        latitude=scale_to_int(home.latitude, INT32, 1e7),
        longitude=scale_to_int(home.longitude, INT32, 1e7),
        altitude=scale_to_int(home.altitude, INT32, 1000),
        x=to_float32(home.north), y=to_float32(home.east), z=-home_above_origin(view), q=[1.0, 0.0, 0.0, 0.0],
        approach_x=0.0, approach_y=0.0, approach_z=0.0, time_usec=view.boot_us,
    )  # fmt: skip


def autopilot_version(view: TelemetryView) -> m.Message:
    """Build AUTOPILOT_VERSION: capabilities, version and unique id."""
    major, minor, patch = VERSION
    unset = [0] * 8
    capabilities = Capability.MISSION_INT | Capability.MISSION_FENCE | Capability.MISSION_RALLY | Capability.FTP
    capabilities |= Capability.SET_POSITION_TARGET_LOCAL | Capability.SET_POSITION_TARGET_GLOBAL
    capabilities |= Capability.SET_ATTITUDE_TARGET | Capability.COMMAND_INT | Capability.FLIGHT_TERMINATION
    capabilities |= Capability.MAVLINK2 | Capability.PARAM_C_CAST
    return m.AutopilotVersion(
        capabilities=capabilities,
        flight_sw_version=major << 24 | minor << 16 | patch << 8,
        middleware_sw_version=0, os_sw_version=0, board_version=0, flight_custom_version=unset,
        middleware_custom_version=unset, os_custom_version=unset, vendor_id=0, product_id=0,
        uid=int.from_bytes(view.host.uid[:8], "big"), uid2=list(view.host.uid.ljust(18, b"\0")),
    )  # fmt: skip


def protocol_version(view: TelemetryView) -> m.Message:
    """Build PROTOCOL_VERSION: MAVLink 2; version 1 is understood."""
    return m.ProtocolVersion(200, 100, 200, spec_version_hash=[0] * 8, library_version_hash=[0] * 8)


def available_modes(view: TelemetryView) -> list[m.Message]:
    """Build AVAILABLE_MODES, one message for each mode. A mode that lacks a sensor is not selectable."""
    return [
        m.AvailableModes(
            number_modes=len(MODES), mode_index=index, standard_mode=spec.standard, custom_mode=mode,
            properties=_properties(spec, view), mode_name=mode.name.encode(),
        )
        for index, (mode, spec) in enumerate(MODES.items(), start=1)
    ]  # fmt: skip


def _properties(spec: ModeSpec, view: TelemetryView) -> int:
    selectable = spec.selectable and view.navigator.has_sensor_for(spec.requirement)
    automatic = AUTO_MODE if spec.autonomous and spec.requirement is ModeRequirement.POSITION else 0
    return automatic | (0 if selectable else NOT_USER_SELECTABLE)


def available_modes_monitor(view: TelemetryView) -> m.Message:
    """Build AVAILABLE_MODES_MONITOR: its number changes with the set of selectable modes."""
    return m.AvailableModesMonitor(
        sum(1 << index for index, need in enumerate(ModeRequirement) if view.navigator.has_sensor_for(need))
    )
