"""Builds messages about motion: attitude, position, speed, GPS, servos, channels; None without the sensor.

Position and motion come from the estimate; GPS_RAW_INT comes from the readings of the receiver.
"""

from __future__ import annotations

import math

from dialects import messages as m
from dialects.enums import EstimatorFlag
from vehicle.drive.demand import STEERING_CHANNEL, THROTTLE_CHANNEL, RcOverride, pulse
from vehicle.navigation.estimate import Estimate
from vehicle.telemetry.scaling import INT16, INT32, UINT8, UINT16, scale_to_int, to_float32
from vehicle.telemetry.view import TelemetryView

RSSI_UNKNOWN = 255


def attitude(view: TelemetryView) -> m.Message | None:
    """Build ATTITUDE."""
    readings, estimate = view.readings, view.estimate
    if estimate.yaw is None:
        return None
    return m.Attitude(
        time_boot_ms=view.boot_ms,
        roll=to_float32(readings.roll),
        pitch=to_float32(readings.pitch),
        yaw=estimate.yaw,
        rollspeed=0.0,
        pitchspeed=0.0,
        yawspeed=to_float32(estimate.yaw_rate),
    )


def vfr_hud(view: TelemetryView) -> m.Message:
    """Build VFR_HUD: ground speed, heading and throttle, also if only the throttle is known."""
    readings, driving = view.readings, view.drive.driven_wheels
    speed = view.estimate.ground_speed
    return m.VfrHud(
        airspeed=speed,
        groundspeed=speed,
        heading=_heading(view.estimate, 1.0, unknown=0) % 360,
        throttle=scale_to_int(max(abs(value) for value in driving), UINT16, 100),
        alt=to_float32(readings.altitude),
        climb=0.0,
    )


def local_position_ned(view: TelemetryView) -> m.Message | None:
    """Build LOCAL_POSITION_NED."""
    estimate = view.estimate
    if not estimate.moving_place:
        return None
    velocity = estimate.velocity
    return m.LocalPositionNed(
        time_boot_ms=view.boot_ms,
        x=estimate.place.north,
        y=estimate.place.east,
        z=-above_origin(view),
        vx=velocity.north,
        vy=velocity.east,
        vz=0.0,
    )


def global_position_int(view: TelemetryView) -> m.Message | None:
    """Build GLOBAL_POSITION_INT."""
    globe, velocity = view.estimate.lat_lon, view.estimate.velocity
    if globe is None:
        return None
    return m.GlobalPositionInt(
        time_boot_ms=view.boot_ms,
        lat=scale_to_int(globe[0], INT32, 1e7),
        lon=scale_to_int(globe[1], INT32, 1e7),
        alt=scale_to_int(view.readings.altitude, INT32, 1000),
        relative_alt=scale_to_int(above_home(view), INT32, 1000),
        vx=scale_to_int(velocity.north, INT16, 100),
        vy=scale_to_int(velocity.east, INT16, 100),
        vz=0,
        hdg=_heading(view.estimate, 100.0, unknown=m.UINT16_MAX),
    )


def gps_global_origin(view: TelemetryView) -> m.Message | None:
    """Build GPS_GLOBAL_ORIGIN: 0/0 of LOCAL_POSITION_NED, from the first fix or DO_SET_GLOBAL_ORIGIN."""
    origin = view.estimate.origin
    if origin is None:
        return None
    altitude = view.navigator.origin_altitude
    if altitude is None and view.home:
        altitude = view.home.altitude
    return m.GpsGlobalOrigin(
        latitude=scale_to_int(origin.latitude, INT32, 1e7),
        longitude=scale_to_int(origin.longitude, INT32, 1e7),
        altitude=scale_to_int(altitude, INT32, 1000),
        time_usec=view.boot_us,
    )


def estimator_status(view: TelemetryView) -> m.Message:
    """Build ESTIMATOR_STATUS: which parts of the estimate are valid. Test ratios are not computed: 0."""
    estimate = view.estimate
    holds = {
        EstimatorFlag.ATTITUDE: estimate.yaw is not None,
        EstimatorFlag.VELOCITY: estimate.yaw is not None and estimate.speed is not None,
        EstimatorFlag.POSITION_RELATIVE: estimate.moving_place,
        EstimatorFlag.POSITION_ABSOLUTE: estimate.good,
    }
    return m.EstimatorStatus(
        time_usec=view.boot_us,
        flags=sum(flag for flag, valid in holds.items() if valid),
        vel_ratio=0.0, pos_horiz_ratio=0.0, pos_vert_ratio=0.0, mag_ratio=0.0, hagl_ratio=0.0, tas_ratio=0.0,
        pos_horiz_accuracy=to_float32(estimate.accuracy, math.nan), pos_vert_accuracy=math.nan,
    )  # fmt: skip


def gps_raw_int(view: TelemetryView) -> m.Message | None:
    """Build GPS_RAW_INT."""
    readings = view.readings
    if readings.gps_fix is None:
        return None
    north, east = to_float32(readings.velocity_north), to_float32(readings.velocity_east)
    course = math.degrees(math.atan2(east, north)) % 360
    return m.GpsRawInt(
        time_usec=view.boot_us,
        fix_type=scale_to_int(readings.gps_fix, UINT8),
        lat=scale_to_int(readings.latitude, INT32, 1e7),
        lon=scale_to_int(readings.longitude, INT32, 1e7),
        alt=scale_to_int(readings.altitude, INT32, 1000),
        eph=scale_to_int(readings.gps_hdop, UINT16, 100, unknown=m.UINT16_MAX),
        epv=m.UINT16_MAX,
        vel=scale_to_int(math.hypot(north, east), UINT16, 100),
        cog=scale_to_int(course, UINT16, 100),
        satellites_visible=scale_to_int(readings.gps_satellites, UINT8, unknown=255),
    )


def servo_output_raw(view: TelemetryView) -> m.Message:
    """Build SERVO_OUTPUT_RAW: motors as pulses at the outputs of ArduRover's default wiring, and servo accessories.

    0: no pulses, or no output.
    """
    pulses = [0] * 16
    for servo, width in view.rack.values("servo").items():
        pulses[servo - 1] = width
    for servo, value in zip(view.drive.mixer.servos, view.drive.outputs.throttles, strict=True):
        pulses[servo - 1] = pulse(value)
    return m.ServoOutputRaw(view.boot_us & m.UINT32_MASK, 0, *pulses)


def relay_status(view: TelemetryView) -> m.Message | None:
    """Build RELAY_STATUS: a bit for each relay, as written to the hardware; None without relays."""
    relays = view.rack.values("relay")
    if not relays:
        return None
    on = sum(1 << number for number, value in relays.items() if value)
    return m.RelayStatus(time_boot_ms=view.boot_ms, on=on, present=sum(1 << number for number in relays))


def rc_channels(view: TelemetryView) -> m.Message:
    """Build RC_CHANNELS: the overrides, and the demand in use on the throttle and steering channels."""
    control = view.control
    pulses = [m.UINT16_MAX] * RcOverride.COUNT
    for number, channel in control.override.channels.items():
        pulses[number - 1] = channel.pulse
    if control.demand and not control.is_demand_stale(view.now):
        pulses[THROTTLE_CHANNEL - 1] = pulse(control.demand.throttle or 0.0)
        pulses[STEERING_CHANNEL - 1] = pulse(control.demand.steering or 0.0)
    channels = {f"chan{number}_raw": value for number, value in enumerate(pulses, start=1)}
    count = max((number for number, value in enumerate(pulses, start=1) if value != m.UINT16_MAX), default=0)
    return m.RcChannels(time_boot_ms=view.boot_ms, chancount=count, rssi=RSSI_UNKNOWN, **channels)


def above_home(view: TelemetryView) -> float:
    """Return the altitude above home in m; 0 if either is unknown."""
    altitude = view.navigator.altitude
    return 0.0 if altitude is None or view.home is None else to_float32(altitude) - view.home.altitude


def above_origin(view: TelemetryView) -> float:
    """Return the altitude above the origin in m; that of home if the altitude is unknown."""
    return above_home(view) + home_above_origin(view)


def home_above_origin(view: TelemetryView) -> float:
    """Return the altitude of home above the origin in m; 0 until the origin is given an altitude."""
    altitude = view.navigator.origin_altitude
    return 0.0 if altitude is None or view.home is None else view.home.altitude - altitude


def _heading(estimate: Estimate, scale: float, unknown: int) -> int:
    """Return yaw as 0..360 degrees x `scale`."""
    if estimate.yaw is None:
        return unknown
    return scale_to_int(math.degrees(estimate.yaw) % 360, UINT16, scale, unknown)
