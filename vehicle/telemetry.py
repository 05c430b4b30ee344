"""Message -> rate: one table of what the vehicle tells unasked, and the clock that keeps to it."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass

from dialects import messages as m
from dialects.codec import MAX_FRAME
from dialects.enums import DataStream
from link.rate import TokenBucket
from link.services.pacing import OVERHEAD
from vehicle import computer, goals, motion, status
from vehicle.view import View

FASTEST = 0.02
"""s: a stream cannot be faster than the control cycle."""
CHANGE_GAP = 0.05
"""s between two messages of a stream that tells changes at once: 20 Hz."""
BUDGET, BURST = 200.0, 60.0
"""Streamed messages a second, and at once: about 60 kbit/s of 40-byte frames, whatever somebody asks for."""
PHASE = 0.02
"""s between the first messages of neighbouring streams, so that they do not come in one burst."""
SLOWEST = 8.0
"""Largest factor by which a full radio stretches the intervals."""
BYTES_BURST = 0.05
"""s of a limit in bytes that may go at once, though always the longest message: on a slow link bursts are delays."""
LEAST_ROOM = 0.1
"""Share of the limit by which ordinary streams are slowed down where steady ones fill nearly all of it."""


@dataclass(frozen=True, slots=True)
class Stream:
    """One message and when it is told."""

    message: type[m.Message]
    rate: float
    """Hz at start; 0: only on request."""
    build: Callable[[View], m.Message | None]
    """None where there is nothing to tell."""
    group: DataStream | None = None
    """The group of REQUEST_DATA_STREAM that it belongs to."""
    change: Callable[[View], Hashable] | None = None
    """What it tells at once when it changes."""
    fixed: bool = False
    """Its rate is not for others to choose."""
    steady: bool = False
    """A full radio does not slow it down."""

    @property
    def size(self) -> int:
        """Bytes on the wire, at most."""
        return int(self.message.unpacker.size) + OVERHEAD


STREAMS: tuple[Stream, ...] = (
    Stream(m.Heartbeat, 1, status.heartbeat, fixed=True, steady=True,
           change=lambda view: (view.safety.state, view.safety.mode)),
    Stream(m.RoverDriveStatus, 5, status.drive_status, steady=True,  # the driver echoes its time (OPR_ECHO_MAX)
           change=lambda view: (view.control.demand and (view.control.demand.throttle, view.control.demand.steering),
                                view.control.neutral_seen, view.safety.armed)),
    Stream(m.RoverFailsafeStatus, 1, status.failsafe_status,
           change=lambda view: (view.safety.failsafes.active, view.safety.latched)),
    Stream(m.ControlStatus, 1, status.control_status,
           change=lambda view: (view.control.owner, view.control.takeover_allowed)),
    Stream(m.CurrentMode, 0.5, status.current_mode,
           change=lambda view: (view.safety.mode, view.safety.intended)),
    Stream(m.MissionCurrent, 1, status.mission_current, DataStream.EXTENDED_STATUS,
           change=lambda view: (view.navigator.mission.current, view.navigator.mission.progress, view.safety.mode,
                                view.navigator.plan_ids)),
    Stream(m.AvailableModesMonitor, 0.3, status.available_modes_monitor),
    Stream(m.SystemTime, 1, status.system_time),
    Stream(m.SysStatus, 1, status.sys_status, DataStream.EXTENDED_STATUS),
    Stream(m.BatteryStatus, 0.5, status.battery_status, DataStream.EXTENDED_STATUS),
    Stream(m.ExtendedSysState, 0.5, status.extended_sys_state, DataStream.EXTENDED_STATUS),
    Stream(m.GpsRawInt, 1, motion.gps_raw_int, DataStream.EXTENDED_STATUS),
    Stream(m.Attitude, 4, motion.attitude, DataStream.EXTRA1),
    Stream(m.VfrHud, 4, motion.vfr_hud, DataStream.EXTRA2),
    Stream(m.LocalPositionNed, 4, motion.local_position_ned, DataStream.POSITION),
    Stream(m.GlobalPositionInt, 2, motion.global_position_int, DataStream.POSITION),
    Stream(m.EstimatorStatus, 1, motion.estimator_status, DataStream.EXTENDED_STATUS),
    Stream(m.PositionTargetGlobalInt, 1, goals.position_target_global, DataStream.POSITION,
           change=lambda view: view.navigator.goal(view.safety.mode)),
    Stream(m.PositionTargetLocalNed, 1, goals.position_target_local, DataStream.POSITION,
           change=lambda view: view.navigator.goal(view.safety.mode)),
    Stream(m.NavControllerOutput, 2, goals.nav_controller_output, DataStream.EXTENDED_STATUS),
    Stream(m.FenceStatus, 1, goals.fence_status, DataStream.EXTENDED_STATUS,
           change=lambda view: (view.navigator.boundary.fence.enabled, view.navigator.boundary.beyond > 0.0)),
    Stream(m.ServoOutputRaw, 2, motion.servo_output_raw, DataStream.RC_CHANNELS),
    Stream(m.RcChannels, 2, motion.rc_channels, DataStream.RC_CHANNELS),
    Stream(m.GpsGlobalOrigin, 0, motion.gps_global_origin, change=lambda view: view.navigator.estimate.origin),
    Stream(m.HomePosition, 0.5, status.home_position, change=lambda view: view.home),
    Stream(m.OnboardComputerStatus, 0.5, computer.onboard_computer_status, DataStream.EXTENDED_STATUS),
    Stream(m.RoverDriveInfo, 0, status.drive_info),
    Stream(m.AutopilotVersion, 0, status.autopilot_version),
    Stream(m.ProtocolVersion, 0, status.protocol_version),
)  # fmt: skip
"""Stream by stream, the most important first. What only one asks for is in vehicle/requests.py."""

BY_ID: dict[int, Stream] = {stream.message.id: stream for stream in STREAMS}


@dataclass(slots=True)
class _Clock:
    """When one stream is due."""

    interval: float | None
    due: float
    sent: float = float("-inf")
    told: Hashable = None


class Telemetry:
    """Which streams run how fast, and what is due."""

    def __init__(self, now: float) -> None:
        self._clocks = {
            stream.message.id: _Clock(_interval(stream.rate), now + index * PHASE)
            for index, stream in enumerate(STREAMS)
        }
        self._streams = tuple((stream, self._clocks[stream.message.id]) for stream in STREAMS)
        self._bucket = TokenBucket(BUDGET, BURST)
        self._bytes: TokenBucket | None = None
        self._limit: float | None = None
        self._stretch = 1.0
        self._narrow = 1.0
        """Factor on the intervals for a slow link."""

    def due(self, view: View) -> list[m.Message]:
        """The messages that are due at the time of `view`."""
        now = view.now
        found = [
            self._next(stream, clock, view)
            for stream, clock in self._streams
            if stream.change is not None or now >= clock.due  # most are neither, in most cycles
        ]
        return [message for message in found if message is not None]

    def interval(self, message_id: int) -> float | None:
        """s between two of a stream, None where it is off. Raises KeyError for a message that is no stream."""
        return self._clocks[message_id].interval

    def set_interval(self, message_id: int, interval: float | None, now: float) -> None:
        """Change a stream; None turns it off. Too fast is made slower, a fixed one stays."""
        if BY_ID[message_id].fixed:
            return
        clock = self._clocks[message_id]
        clock.interval = None if interval is None else max(FASTEST, interval)
        clock.due = now
        self._narrow = self._narrowed()

    def set_default(self, message_id: int, now: float) -> None:
        """Back to the table's rate."""
        self.set_interval(message_id, _interval(BY_ID[message_id].rate), now)

    def set_group(self, group: int, rate: float, now: float) -> None:
        """REQUEST_DATA_STREAM: all streams of a group, 0 turns them off."""
        for stream in STREAMS:
            if stream.group is not None and group in (DataStream.ALL, stream.group):
                self.set_interval(stream.message.id, _interval(rate), now)

    def limit(self, rate: float | None) -> None:
        """Bytes/s that all streams together may take; None for no limit. They slow down alike, steady ones last."""
        if rate != self._limit:
            self._limit = rate
            self._bytes = None if rate is None else _bytes_bucket(rate)
            self._narrow = self._narrowed()

    def radio(self, free: int) -> None:
        """RADIO_STATUS: `free` percent of the radio's buffer. Slower when it fills, faster again when it is empty."""
        if free < 50:
            self._stretch = min(SLOWEST, self._stretch * 2)
        elif free > 90:
            self._stretch = max(1.0, self._stretch / 2)

    def _next(self, stream: Stream, clock: _Clock, view: View) -> m.Message | None:
        on_time = clock.interval is not None and view.now >= clock.due
        key = stream.change(view) if stream.change else clock.told
        changed = key != clock.told and view.now - clock.sent >= CHANGE_GAP
        if not (on_time or changed) or not (stream.fixed or self._room(stream, view.now)):
            return None
        clock.sent, clock.told = view.now, key
        if on_time and clock.interval is not None:
            step = clock.interval if stream.steady else clock.interval * max(self._stretch, self._narrow)
            # After a pause the missed ones are left out.
            clock.due = max(clock.due + step, view.now + FASTEST)
        return stream.build(view)

    def _room(self, stream: Stream, now: float) -> bool:
        return self._bucket.take(now) and (self._bytes is None or self._bytes.take(now, stream.size))

    def _narrowed(self) -> float:
        if self._limit is None:
            return 1.0
        steady = sum(self._load(stream) for stream in STREAMS if stream.steady)
        others = sum(self._load(stream) for stream in STREAMS if not stream.steady)
        return max(1.0, others / max(self._limit - steady, self._limit * LEAST_ROOM))

    def _load(self, stream: Stream) -> float:
        """Bytes/s of a stream at its own interval."""
        interval = self._clocks[stream.message.id].interval
        return 0.0 if interval is None else stream.size / interval


def _bytes_bucket(rate: float) -> TokenBucket:
    """What fixed streams leave of `rate`: they do not ask."""
    fixed = sum(stream.size * stream.rate for stream in STREAMS if stream.fixed)
    return TokenBucket(max(0.0, rate - fixed), max(rate * BYTES_BURST, MAX_FRAME))


def _interval(rate: float) -> float | None:
    return 1.0 / rate if rate > 0 else None
