"""Messages about motion: attitude, position, speed, GPS, servos, channels. Builders only; None without the sensor.

Where the rover is comes from the estimate, what one sensor says (GPS_RAW_INT) from the readings.
"""

from __future__ import annotations

import math

from dialects import messages as m
from dialects.enums import Estimated
from vehicle.drive.demand import STEERING_CHANNEL, THROTTLE_CHANNEL, Override, pulse
from vehicle.navigation.estimate import Estimate
from vehicle.telemetry.scaling import INT16, INT32, UINT8, UINT16, real, whole
from vehicle.telemetry.view import View

RSSI_UNKNOWN = 255


def attitude(view: View) -> m.Message | None:
    """ATTITUDE."""
    readings, estimate = view.readings, view.estimate
    if estimate.yaw is None:
        return None
    return m.Attitude(
        time_boot_ms=view.boot_ms,
        roll=real(readings.roll),
        pitch=real(readings.pitch),
        yaw=estimate.yaw,
        rollspeed=0.0,
        pitchspeed=0.0,
        yawspeed=real(estimate.yaw_rate),
    )


def vfr_hud(view: View) -> m.Message:
    """VFR_HUD: speed over ground, heading and throttle, also where only the throttle is known."""
    readings, driving = view.readings, view.drive.driving
    speed = view.estimate.ground_speed
    return m.VfrHud(
        airspeed=speed,
        groundspeed=speed,
        heading=_heading(view.estimate, 1.0, unknown=0) % 360,
        throttle=whole(max(abs(value) for value in driving), UINT16, 100),
        alt=real(readings.altitude),
        climb=0.0,
    )


def local_position_ned(view: View) -> m.Message | None:
    """LOCAL_POSITION_NED."""
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


def global_position_int(view: View) -> m.Message | None:
    """GLOBAL_POSITION_INT."""
    globe, velocity = view.estimate.globe, view.estimate.velocity
    if globe is None:
        return None
    return m.GlobalPositionInt(
        time_boot_ms=view.boot_ms,
        lat=whole(globe[0], INT32, 1e7),
        lon=whole(globe[1], INT32, 1e7),
        alt=whole(view.readings.altitude, INT32, 1000),
        relative_alt=whole(above_home(view), INT32, 1000),
        vx=whole(velocity.north, INT16, 100),
        vy=whole(velocity.east, INT16, 100),
        vz=0,
        hdg=_heading(view.estimate, 100.0, unknown=m.UINT16_MAX),
    )


def gps_global_origin(view: View) -> m.Message | None:
    """GPS_GLOBAL_ORIGIN: where 0/0 of LOCAL_POSITION_NED is. The first fix decides it, until somebody sets it."""
    origin = view.estimate.origin
    if origin is None:
        return None
    altitude = view.navigator.origin_altitude
    if altitude is None and view.home:
        altitude = view.home.altitude
    return m.GpsGlobalOrigin(
        latitude=whole(origin.latitude, INT32, 1e7),
        longitude=whole(origin.longitude, INT32, 1e7),
        altitude=whole(altitude, INT32, 1000),
        time_usec=view.boot_us,
    )


def estimator_status(view: View) -> m.Message:
    """ESTIMATOR_STATUS: which parts of the estimate may be believed. Test ratios are not kept: 0."""
    estimate = view.estimate
    holds = {
        Estimated.ATTITUDE: estimate.yaw is not None,
        Estimated.VELOCITY: estimate.yaw is not None and estimate.speed is not None,
        Estimated.POSITION_RELATIVE: estimate.moving_place,
        Estimated.POSITION_ABSOLUTE: estimate.good,
    }
    return m.EstimatorStatus(
        time_usec=view.boot_us,
        flags=sum(flag for flag, there in holds.items() if there),
        vel_ratio=0.0, pos_horiz_ratio=0.0, pos_vert_ratio=0.0, mag_ratio=0.0, hagl_ratio=0.0, tas_ratio=0.0,
        pos_horiz_accuracy=real(estimate.accuracy, math.nan), pos_vert_accuracy=math.nan,
    )  # fmt: skip


def gps_raw_int(view: View) -> m.Message | None:
    """GPS_RAW_INT."""
    readings = view.readings
    if readings.gps_fix is None:
        return None
    north, east = real(readings.velocity_north), real(readings.velocity_east)
    course = math.degrees(math.atan2(east, north)) % 360
    return m.GpsRawInt(
        time_usec=view.boot_us,
        fix_type=whole(readings.gps_fix, UINT8),
        lat=whole(readings.latitude, INT32, 1e7),
        lon=whole(readings.longitude, INT32, 1e7),
        alt=whole(readings.altitude, INT32, 1000),
        eph=whole(readings.gps_hdop, UINT16, 100, unknown=m.UINT16_MAX),
        epv=m.UINT16_MAX,
        vel=whole(math.hypot(north, east), UINT16, 100),
        cog=whole(course, UINT16, 100),
        satellites_visible=whole(readings.gps_satellites, UINT8, unknown=255),
    )


def servo_output_raw(view: View) -> m.Message:
    """SERVO_OUTPUT_RAW: what each motor gets, as a pulse, at the servo numbers of ArduRover's default wiring; beside
    them the servos that are accessories. 0: no pulses, or nothing there."""
    pulses = [0] * 16
    for servo, width in view.rack.values("servo").items():
        pulses[servo - 1] = width
    for servo, value in zip(view.drive.mixer.servos, view.drive.outputs.throttles, strict=True):
        pulses[servo - 1] = pulse(value)
    return m.ServoOutputRaw(view.boot_us & m.UINT32_MASK, 0, *pulses)


def relay_status(view: View) -> m.Message | None:
    """RELAY_STATUS: a bit for each relay, as the hardware has it; nothing where there is none."""
    relays = view.rack.values("relay")
    if not relays:
        return None
    on = sum(1 << number for number, value in relays.items() if value)
    return m.RelayStatus(time_boot_ms=view.boot_ms, on=on, present=sum(1 << number for number in relays))


def rc_channels(view: View) -> m.Message:
    """RC_CHANNELS: what overrides hold, and the demand in use at the throttle and steering channels."""
    control = view.control
    pulses = [m.UINT16_MAX] * Override.COUNT
    for number, channel in control.override.channels.items():
        pulses[number - 1] = channel.pulse
    if control.demand and not control.stale(view.now):
        pulses[THROTTLE_CHANNEL - 1] = pulse(control.demand.throttle or 0.0)
        pulses[STEERING_CHANNEL - 1] = pulse(control.demand.steering or 0.0)
    channels = {f"chan{number}_raw": value for number, value in enumerate(pulses, start=1)}
    count = max((number for number, value in enumerate(pulses, start=1) if value != m.UINT16_MAX), default=0)
    return m.RcChannels(time_boot_ms=view.boot_ms, chancount=count, rssi=RSSI_UNKNOWN, **channels)


def above_home(view: View) -> float:
    """m; 0 where one of both is not known."""
    altitude = view.navigator.altitude
    return 0.0 if altitude is None or view.home is None else real(altitude) - view.home.altitude


def above_origin(view: View) -> float:
    """m; as home where it is not known."""
    return above_home(view) + home_above_origin(view)


def home_above_origin(view: View) -> float:
    """m; 0 until somebody gives the origin a height of its own."""
    altitude = view.navigator.origin_altitude
    return 0.0 if altitude is None or view.home is None else view.home.altitude - altitude


def _heading(estimate: Estimate, scale: float, unknown: int) -> int:
    """Yaw as 0..360 degrees x `scale`."""
    if estimate.yaw is None:
        return unknown
    return whole(math.degrees(estimate.yaw) % 360, UINT16, scale, unknown)
