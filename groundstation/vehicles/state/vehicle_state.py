"""State of one vehicle, updated by its messages. Sends nothing and decides nothing.

To handle another message, add a method and a row in _HANDLERS.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from dialects import messages as m
from dialects.enums import Autopilot, DriveLimit, Failsafe, LandedState, Sensor, SystemState, VehicleType
from dialects.kinds import find_kind
from dialects.mode_tables import HOLD
from groundstation.geo import LocalFrame, Place, Point
from groundstation.snapshot import OutputView, VehicleView
from groundstation.vehicles.paths.paths import Paths
from groundstation.vehicles.probes.dialect_probe import FOREIGN_AUTOPILOTS
from groundstation.vehicles.readings.foreign_drive import ForeignDrive
from groundstation.vehicles.readings.key_to_motor import KeyTimings
from groundstation.vehicles.readings.latency import LatencyMeter
from groundstation.vehicles.readings.obstacles import ObstacleReadings
from groundstation.vehicles.readings.outputs import drive_names
from groundstation.vehicles.readings.track import Track
from groundstation.vehicles.readings.values import (
    all_finite,
    battery_values,
    drive_demand,
    flag_words,
    slowed_speed,
    vehicle_name,
    within,
)
from groundstation.vehicles.state.control_report import ControlReport
from groundstation.vehicles.state.mode_list import ModeList
from groundstation.vehicles.state.senders import Senders
from link.core import Received
from link.protocol.heartbeat import HeartbeatMonitor

LOST_AFTER = 2.5
"""s without a message after which the link counts as lost: two and a half heartbeats, so that one may get lost."""

FRESH_TIMEOUT = 1.5
"""s for which a reading is preferred to that of a coarser message, and for which a ROVER_DRIVE_STATUS is shown."""

LANDED_FRESH = 1.5
"""s for which a report counts that a vehicle is on the ground; EXTENDED_SYS_STATE comes at 1 Hz or more."""

REPORT_PERIOD = 0.5
"""s up to which a ROVER_DRIVE_STATUS tells the present: it comes at 5 Hz, over a slow radio at 2.5 Hz."""

PREARM_TEXTS = ("PreArm: ", "Preflight Fail: ")
"""What texts start with that say why arming would be refused: those of ArduPilot and our rover, and of PX4."""

UNKNOWN_U16 = 0xFFFF

ESTOP = int(DriveLimit.ESTOP)
"""A number, because `&` with a flag makes another flag, 120 times a second while driving."""
NEUTRAL_FIRST = int(DriveLimit.NEUTRAL_FIRST)
UNREADY = int(DriveLimit.DISARMED | DriveLimit.NEUTRAL_FIRST | DriveLimit.STALE)
"""Limits without which a demand that moves would count."""


FENCE_BOUNDARY = 3
"""FENCE_BREACH_BOUNDARY."""
_BREACHES = {1: "below the lowest altitude of the fence", 2: "above the highest altitude of the fence"}


class VehicleState:
    """One vehicle as reported by its messages. `system` and `component` are those of its HEARTBEAT."""

    def __init__(self, system: int, component: int) -> None:
        self.system = system
        self.fleet_name = ""
        """Its name in the fleet behind the link of its newest message; "" without one."""
        self.monitor = HeartbeatMonitor(LOST_AFTER)
        self.senders = Senders()
        """All that send HEARTBEATs of a vehicle with this system id."""
        self.paths = Paths(component)
        """On which it is heard, and what of them counts."""
        self.change_component(component)

    def change_component(self, component: int) -> None:
        """Begin anew as another component of the same system; what the former one has reported is not of it."""
        self.component = self.paths.component = component
        self.key_timings = KeyTimings()
        self.latency = LatencyMeter(self.key_timings)
        self.foreign = ForeignDrive()
        self.obstacles = ObstacleReadings()
        self.autopilot: int = Autopilot.GENERIC
        self.kind: int = VehicleType.GENERIC
        self.model = find_kind(self.autopilot, self.kind)
        """Its kind, as its newest HEARTBEAT tells."""
        self.listed_modes = ModeList()
        self.mode = "unknown"
        self.custom_mode: int | None = None
        """Of its newest HEARTBEAT."""
        self.armed = False
        self.status: int = SystemState.UNINIT
        self.control = ControlReport()
        self.drive_info: m.RoverDriveInfo | None = None
        self.boot_time: int | None = None  # newest time_boot_ms of the vehicle
        self.boot_time_at = -math.inf  # when it arrived
        self.ready_at: float | None = None
        """When the pre-arm checks were passed; None while they are not, or it is not known."""
        self._times: dict[type[m.Message], float] = {}
        self._drive: m.RoverDriveStatus | None = None
        self._landed: int = LandedState.UNDEFINED
        self._failsafe: m.RoverFailsafeStatus | None = None
        self._breach_type = 0
        """FENCE_BREACH of FENCE_STATUS; 0: none."""
        self._is_breached = False
        self._frame: LocalFrame | None = None
        """Metres around the first place, for a vehicle without LOCAL_POSITION_NED."""
        self.trail = Track()
        self.sea_level: float | None = None
        """Altitude above mean sea level, m."""
        self._velocity: tuple[float, float] | None = None
        self._ground_speed: float | None = None
        self._values: dict[str, Any] = {}
        """Fields of VehicleView that are a reading without further logic."""

    def receive(self, received: Received, now: float) -> bool:
        """Handle a message of this system; return whether it counts, see Paths."""
        self.monitor.update(now)
        self.fleet_name = received.peer.name or self.fleet_name
        message = received.message
        self.senders.receive(received, now)
        counts = self.paths.receive(received, now)
        if type(message) is m.Heartbeat and len(self.paths.live(now)) > 1:
            self.paths.apart = bool(self.senders.describe_duplicates(now))
        if not counts:
            return False
        if received.component != self.component:
            return True
        if (boot_time := getattr(message, "time_boot_ms", None)) is not None:
            newest = boot_time if self.paths.apart else self.paths.boot_time
            self.boot_time_at = now if newest != self.boot_time else self.boot_time_at
            self.boot_time = newest
        method = _HANDLERS.get(type(message))
        if method is not None:
            method(self, message, now)
            self._times[type(message)] = now
        return True

    @property
    def has_rover_dialect(self) -> bool:
        """The vehicle sends the private messages of our dialect (rover.xml)."""
        return self._drive is not None or self.drive_info is not None

    @property
    def heartbeat_at(self) -> float:
        """When the newest HEARTBEAT arrived; -infinity if none has."""
        return self._times.get(m.Heartbeat, -math.inf)

    def sends_drive_status(self, now: float) -> bool:
        """Return whether ROVER_DRIVE_STATUS is arriving."""
        return self._fresh(m.RoverDriveStatus, now)

    @property
    def emergency_stop(self) -> bool:
        """The vehicle reports that its motors are locked. ArduPilot and PX4 mean something else by EMERGENCY."""
        locked = self.status == SystemState.EMERGENCY and self.autopilot not in FOREIGN_AUTOPILOTS
        return locked or bool(self._drive and self._drive.limits & ESTOP)

    @property
    def drives_itself(self) -> bool:
        """Armed in an autonomous mode: the vehicle, or a computer on board, decides where it goes."""
        return self.armed and self.model.moves_itself(self.mode)

    @property
    def may_move(self) -> bool:
        """Armed in a mode in which it may move without demands: HOLD of PX4 drives to the place of a go-to, too."""
        return self.drives_itself or (self.armed and self.model.hold_moves and self.mode == HOLD)

    @property
    def may_fall(self) -> bool:
        """Armed and, as far as is known, in the air: without power it falls."""
        return self.armed and self.model.falls and self._landed != LandedState.ON_GROUND

    def is_landed(self, now: float) -> bool:
        """Return whether it has just reported that it is on the ground: an older report may be of before a take-off."""
        at = self._times.get(m.ExtendedSysState, -math.inf)
        return self._landed == LandedState.ON_GROUND and now - at <= LANDED_FRESH

    @property
    def in_air(self) -> bool:
        """Its newest report says that it is in the air."""
        return self.armed and self._landed in (LandedState.IN_AIR, LandedState.TAKEOFF, LandedState.LANDING)

    @property
    def speed_over_ground(self) -> float | None:
        """m/s in any direction."""
        return None if self._velocity is None else math.hypot(*self._velocity)

    @property
    def failsafes(self) -> tuple[str, ...]:
        """Names of the failsafes that are active."""
        return flag_words(Failsafe, self._failsafe.active) if self._failsafe else ()

    @property
    def breach(self) -> str:
        """That the vehicle reports a breach of its fence; "" if it does not. Our own reports a failsafe."""
        if self.has_rover_dialect or not (self._is_breached or self._breach_type):
            return ""
        return _BREACHES.get(self._breach_type, "outside the fence")

    @property
    def driver(self) -> int | None:
        """System id of the ground station in control, 0: none; None: the vehicle does not tell."""
        return self.control.driver

    @property
    def name(self) -> str:
        """Name for the driver: that in its fleet, else as `kind_name`."""
        return self.fleet_name or self.kind_name

    @property
    def kind_name(self) -> str:
        """Kind and system id, e.g. "Rover 1", "ArduPilot rover 1"."""
        return vehicle_name(self.autopilot, self.model.word, self.system)

    def restart(self) -> None:
        """Forget where the vehicle was: it has restarted, and its origin and home may be others."""
        self._frame, self.trail, self._velocity = None, Track(), None
        for name in ("position", "home", "prearm", "prearm_reason"):
            self._values.pop(name, None)
        self.ready_at = None

    def handle_text(self, text: str) -> None:
        """Keep the reason why the vehicle cannot be armed."""
        if text.startswith(PREARM_TEXTS) and self.ready_at is None:
            self._values["prearm_reason"] = text

    def build_view(self, now: float, **station: Any) -> VehicleView:
        """Build the vehicle's part of the snapshot; `station` are the fields that only the station knows."""
        drive = self._drive if self._fresh(m.RoverDriveStatus, now) else None
        return VehicleView(
            system=self.system,
            name=self.name,
            autopilot=self.autopilot,
            mode=self.mode,
            armed=self.armed,
            drivable=self.mode in self.model.keys,
            drives_itself=self.drives_itself,
            undriven=self.model.refusal,
            may_fall=self.may_fall,
            flies=self.model.flies,
            speed_over_ground=self.speed_over_ground,
            keys_mode=self.model.drive_mode,
            status=self.status,
            alive=self.monitor.is_alive(now),
            silence=self.monitor.silence(now),
            driver=self.control.driver,
            speed=self.speed,
            demand=self.demand(now),
            outputs=self.foreign.outputs(now) if drive is None else self._outputs(drive),
            limits=flag_words(DriveLimit, drive.limits) if drive else (),
            slowed=slowed_speed(drive),
            nearest=self.obstacles.nearest(now, newest=self.has_rover_dialect),
            obstacles=self.obstacles.around(now),
            latency=self.latency.latest,
            key_to_motor=self.key_timings.build_view(),
            failsafes=self.failsafes,
            failsafe_in=self._failsafe_in(now),
            breach=self.breach,
            **self._values,
            **station,
        )

    # ---- one method for each message ----

    def _heartbeat(self, message: m.Heartbeat, now: float) -> None:
        self.autopilot = message.autopilot
        self.kind = message.type
        self.status = message.system_status
        self.armed = self.senders.is_armed(self.component, now)
        self.model = find_kind(message.autopilot, message.type)
        self.custom_mode = message.custom_mode
        self.mode = self.model.modes.get(message.custom_mode) or self.listed_modes.name_of(message.custom_mode)

    def _extended_state(self, message: m.ExtendedSysState, now: float) -> None:
        self._landed = message.landed_state

    def _drive_status(self, message: m.RoverDriveStatus, now: float) -> None:
        self._drive = message

    def _failsafe_status(self, message: m.RoverFailsafeStatus, now: float) -> None:
        self._failsafe = message

    def _drive_information(self, message: m.RoverDriveInfo, now: float) -> None:
        self.drive_info = message

    def _attitude(self, message: m.Attitude, now: float) -> None:
        self._read(roll=message.roll, pitch=message.pitch, heading=message.yaw % (2 * math.pi))

    def _hud(self, message: m.VfrHud, now: float) -> None:
        self._ground_speed = message.groundspeed if math.isfinite(message.groundspeed) else None
        if not self._fresh(m.Attitude, now):
            self._read(heading=math.radians(message.heading % 360))

    def _local_position(self, message: m.LocalPositionNed, now: float) -> None:
        if all_finite(message.x, message.y, message.vx, message.vy):
            self._velocity = (message.vx, message.vy)
            self._move(message.x, message.y)

    def _global_position(self, message: m.GlobalPositionInt, now: float) -> None:
        if self._fresh(m.LocalPositionNed, now) or (message.lat == 0 and message.lon == 0):  # 0, 0: no fix yet
            return
        self._velocity = (message.vx / 100, message.vy / 100)
        self._values["altitude"], self._values["climb"] = message.relative_alt / 1000, -message.vz / 100
        self.sea_level = message.alt / 1000
        self._move(*self._to_local(Place(message.lat / 1e7, message.lon / 1e7)))

    def _home(self, message: m.HomePosition, now: float) -> None:
        if m.LocalPositionNed in self._times and all_finite(message.x, message.y):
            self._values["home"] = (message.x, message.y)
        else:
            self._values["home"] = self._to_local(Place(message.latitude / 1e7, message.longitude / 1e7))

    def _gps(self, message: m.GpsRawInt, now: float) -> None:
        self._values["gps_fix"] = message.fix_type
        self._values["gps_satellites"] = None if message.satellites_visible == 255 else message.satellites_visible

    def _system(self, message: m.SysStatus, now: float) -> None:
        if message.onboard_control_sensors_present & Sensor.PREARM:
            self._prearm(bool(message.onboard_control_sensors_health & Sensor.PREARM), now)
        in_use = message.onboard_control_sensors_present & message.onboard_control_sensors_enabled
        self._is_breached = bool(in_use & ~message.onboard_control_sensors_health & Sensor.GEOFENCE)
        if not self._is_breached:
            self._breach_type = 0
        if m.BatteryStatus not in self._times:
            volts = None if message.voltage_battery == UNKNOWN_U16 else message.voltage_battery / 1000
            self._battery(volts, message.current_battery, message.battery_remaining)

    def _fence_status(self, message: m.FenceStatus, now: float) -> None:
        self._breach_type = (message.breach_type or FENCE_BOUNDARY) if message.breach_status else 0
        self._is_breached = bool(message.breach_status)

    def _battery_status(self, message: m.BatteryStatus, now: float) -> None:
        if message.id == 0:
            cells = [cell / 1000 for cell in message.voltages if cell != UNKNOWN_U16]
            self._battery(sum(cells) if cells else None, message.current_battery, message.battery_remaining)

    # ---- readings ----

    def demand(self, now: float) -> tuple[float, float] | None:
        """Return throttle and steering that the vehicle obeys, -1..1; None where they are not known."""
        drive = self._drive if self._fresh(m.RoverDriveStatus, now) else None
        return self.foreign.demand(now) if drive is None else drive_demand(drive)

    @property
    def needs_neutral(self) -> bool:
        """Whether ROVER_DRIVE_STATUS says that no demand counts before a neutral one."""
        return bool(self._drive and self._drive.limits & NEUTRAL_FIRST)

    def has_taken_neutral(self, system: int, since: float) -> bool:
        """Return whether ROVER_DRIVE_STATUS says that motion may follow: a neutral demand of `system` counts.

        It has taken that demand `since` then, as far as its own time tells: it may have been on its way before.
        """
        drive = self._drive
        if drive is None or drive.limits & UNREADY or drive.source_system != system:
            return False
        neutral = drive.demand_throttle == drive.demand_steering == 0
        return bool(neutral and drive.demand_age_ms / 1000 <= self._times[m.RoverDriveStatus] - since)

    def command_age(self, now: float) -> float | None:
        """Return the age of the newest demand as ROVER_DRIVE_STATUS reports it, s. An old report adds its own age."""
        drive = self._drive
        if drive is None or drive.demand_age_ms == UNKNOWN_U16:
            return None
        reported_for = now - self._times[m.RoverDriveStatus]
        return float(drive.demand_age_ms) / 1000 + (reported_for if reported_for > REPORT_PERIOD else 0.0)

    def reading(self, name: str) -> Any:
        """Return a reading by its field in VehicleView; None where it is not known."""
        return self._values.get(name)

    def _outputs(self, drive: m.RoverDriveStatus) -> tuple[OutputView, ...]:
        count = min(4, self.drive_info.motor_count) if self.drive_info else 2
        names = drive_names(self.drive_info, count)
        return tuple(
            OutputView(name=name, value=within(value / 10_000))
            for name, value in zip(names, drive.output, strict=False)
        )

    def _read(self, **values: float) -> None:
        self._values.update({name: value for name, value in values.items() if math.isfinite(value)})

    def _prearm(self, ready: bool, now: float) -> None:
        self._values["prearm"] = ready
        if not ready:
            self.ready_at = None
        elif self.ready_at is None:
            self.ready_at = now
            self._values.pop("prearm_reason", None)

    def _battery(self, volts: float | None, centiamperes: int, percent: int) -> None:
        self._values |= battery_values(volts, centiamperes, percent)

    def _to_local(self, place: Place) -> Point:
        self._frame = self._frame or LocalFrame(place)
        return self._frame.to_point(place)

    def _move(self, north: float, east: float) -> None:
        self._values["position"] = (north, east)
        self.trail.add((north, east))

    def _fresh(self, kind: type[m.Message], now: float) -> bool:
        at = self._times.get(kind)
        return at is not None and now - at <= FRESH_TIMEOUT

    @property
    def speed(self) -> float | None:
        """Along the nose where known, else over ground; m/s."""
        heading = self._values.get("heading")
        if self._velocity is None or heading is None:
            return self._ground_speed
        north, east = self._velocity
        return float(north * math.cos(heading) + east * math.sin(heading))

    def _failsafe_in(self, now: float) -> float | None:
        status = self._failsafe
        if status is None or status.action_in_ms == UNKNOWN_U16:
            return None
        return max(0.0, status.action_in_ms / 1000 - (now - self._times[m.RoverFailsafeStatus]))


_HANDLERS: dict[type[m.Message], Callable[[VehicleState, Any, float], None]] = {
    m.Heartbeat: VehicleState._heartbeat,
    m.ExtendedSysState: VehicleState._extended_state,
    m.AvailableModes: lambda state, message, now: state.listed_modes.add(message),
    m.AvailableModesMonitor: lambda state, message, now: state.listed_modes.note_change(message),
    m.ControlStatus: lambda state, message, now: state.control.handle_control_status(message),
    m.RoverControl: lambda state, message, now: state.control.handle_rover_control(message),
    m.RoverDriveStatus: VehicleState._drive_status,
    m.RoverFailsafeStatus: VehicleState._failsafe_status,
    m.RoverDriveInfo: VehicleState._drive_information,
    m.Attitude: VehicleState._attitude,
    m.VfrHud: VehicleState._hud,
    m.LocalPositionNed: VehicleState._local_position,
    m.GlobalPositionInt: VehicleState._global_position,
    m.HomePosition: VehicleState._home,
    m.GpsRawInt: VehicleState._gps,
    m.SysStatus: VehicleState._system,
    m.BatteryStatus: VehicleState._battery_status,
    m.FenceStatus: VehicleState._fence_status,
    m.ObstacleDistance: lambda state, message, now: state.obstacles.handle_around(
        message, state._values.get("heading"), now
    ),
    m.DistanceSensor: lambda state, message, now: state.obstacles.handle_sensor(message, now),
    m.ServoOutputRaw: lambda state, message, now: state.foreign.handle_servos(message, now),
    m.ActuatorOutputStatus: lambda state, message, now: state.foreign.handle_actuators(message, now),
    m.RcChannels: lambda state, message, now: state.foreign.handle_rc(message, now),
}
"""Message -> the method that handles it."""
