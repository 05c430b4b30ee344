"""Deeds: what the rover and its driver did since a step of a lesson began, measured in snapshots and views.

Nothing here knows what a lesson asks for. Distances are in m, times in s of the station's clock, angles in degrees.
"""

from __future__ import annotations

import math

from groundstation.snapshot import Snapshot, VehicleView
from groundstation.views.base import View
from groundstation.views.messages import MessageView
from groundstation.views.params import ParamPage

MOVING, STANDING = 0.1, 0.05
"""m/s above which the rover drives, and below which it stands."""
ROLLED_OUT = 1.5
"""s after the last key after which motion has another cause: the longest ramp down from full speed."""
JUMP = 5.0
"""m between two snapshots that no rover drives: the position was set anew, or a log was moved in."""
SILENT = 0.8
"""s without a message after which the link counts as lost; telemetry comes several times a second."""


class Deeds:
    """What was seen since the beginning."""

    def __init__(self) -> None:
        self.now = Snapshot()
        self.screen = ""
        """Id of the screen that is shown."""
        self.began: float | None = None
        """Clock of the first snapshot."""
        self.forward = self.backward = self.left = self.right = 0.0
        """m and degrees, with a key held."""
        self.itself = 0.0
        """m in an autonomous mode."""
        self.without_key = 0.0
        """m by the demand of somebody else, such as a program."""
        self.turned_without_key = 0.0
        self.top_speed = 0.0
        self.stop_time: float | None = None
        """s from the release of the last key until the rover stood, the shortest."""
        self.shortest_hold: float | None = None
        """s for which a drive key was held while the rover was armed, the shortest."""
        self.late = 0
        """Snapshots in which the rover refused demands as too old."""
        self.silence = 0.0
        """The longest without a message while a key was held, s."""
        self.cut_stop: float | None = None
        """m from where the rover was last heard while it drove to where it stood when it was heard again."""
        self.driven: dict[int, float] = {}
        """System id -> m with a key held."""
        self.messages: set[str] = set()
        self.params: dict[str, tuple[float, bool]] = {}
        """Name -> value, and whether that is not the default."""
        self.found_params: tuple[str, ...] = ()
        """Names that the screen lists now."""
        self.texts: list[str] = []
        """What the vehicles said."""
        self.held_disarmed = False
        self.recorded = 0.0
        self.paused_at_stop = False
        self._line = -1
        self._keyed_at = -math.inf
        self._held_since: float | None = None
        self._released_at: float | None = None
        self._lost_at: tuple[float, float] | None = None

    @property
    def waited(self) -> float:
        """S since the beginning."""
        return 0.0 if self.began is None else self.now.uptime - self.began

    def see_view(self, view: View) -> None:
        """Note what a screen shows."""
        if isinstance(view, MessageView):
            self.messages.add(view.name)
        elif isinstance(view, ParamPage):
            self.found_params = tuple(row.name for row in view.rows)
            self.params |= {row.name: (row.value, row.changed) for row in view.rows}

    def see(self, now: Snapshot, screen: str) -> None:
        """Note a snapshot. Two of one moment count once."""
        before, self.now, self.screen = self.now, now, screen
        if self.began is None:
            self.began = now.uptime
            self._line = max((line.number for line in now.texts), default=-1)
        self._see_texts(now)
        self.recorded = 0.0 if now.recording is None else now.recording.seconds
        vehicle, old = now.vehicle, before.vehicle
        if vehicle is None:
            return
        if now.replay is not None:
            self._see_replay(now, vehicle)
            return
        if old is not None and old.system == vehicle.system and now.uptime > before.uptime:
            self._see_motion(now, vehicle, old, now.uptime - before.uptime)
        self._see_link(now, vehicle)

    def _see_texts(self, now: Snapshot) -> None:
        for line in now.texts:
            if line.number > self._line:
                self._line = line.number
                self.texts.append(line.text)

    def _see_motion(self, now: Snapshot, vehicle: VehicleView, old: VehicleView, seconds: float) -> None:
        keyed = bool(now.operator.held) and vehicle.armed and now.operator.gate_open
        self.held_disarmed |= bool(now.operator.held) and not vehicle.armed
        speed = abs(vehicle.speed or 0.0)
        path, turn = _path(old, vehicle), _turn(old, vehicle)
        if keyed:
            self._keyed_at = now.uptime
            self._see_keys(now, vehicle, path, turn)
        elif vehicle.armed and vehicle.drives_itself:
            self.itself += path if speed > MOVING else 0.0
        elif vehicle.armed and now.uptime - self._keyed_at > ROLLED_OUT and _demanded(vehicle):
            self.without_key += path if speed > MOVING else 0.0
            self.turned_without_key += abs(turn)
        if vehicle.armed:
            self.top_speed = max(self.top_speed, speed if keyed else 0.0)
        self._see_release(now, keyed, speed)
        self._see_hold(now.uptime, keyed)
        self.late += "stale" in vehicle.limits and bool(now.operator.held)

    def _see_keys(self, now: Snapshot, vehicle: VehicleView, path: float, turn: float) -> None:
        throttle = now.operator.throttle
        if abs(vehicle.speed or 0.0) > MOVING:
            self.forward += path if throttle > 0 else 0.0
            self.backward += path if throttle < 0 else 0.0
            self.driven[vehicle.system] = self.driven.get(vehicle.system, 0.0) + path
        if now.operator.steering:
            self.left += max(0.0, -turn)
            self.right += max(0.0, turn)

    def _see_release(self, now: Snapshot, keyed: bool, speed: float) -> None:
        if keyed:
            self._released_at = math.nan if speed > MOVING else self._released_at
        elif self._released_at is not None:
            if math.isnan(self._released_at):
                self._released_at = now.uptime
            if speed < STANDING:
                took = now.uptime - self._released_at
                self.stop_time = took if self.stop_time is None else min(self.stop_time, took)
                self._released_at = None

    def _see_hold(self, at: float, keyed: bool) -> None:
        if keyed:
            self._held_since = at if self._held_since is None else self._held_since
        elif self._held_since is not None:
            took, self._held_since = at - self._held_since, None
            self.shortest_hold = took if self.shortest_hold is None else min(self.shortest_hold, took)

    def _see_link(self, now: Snapshot, vehicle: VehicleView) -> None:
        """Note what a rover did that was not heard."""
        if vehicle.silence >= SILENT:
            if now.operator.held and vehicle.armed:
                self.silence = max(self.silence, vehicle.silence)
            if self._lost_at is None and abs(vehicle.speed or 0.0) > MOVING and vehicle.position is not None:
                self._lost_at = vehicle.position
        elif self._lost_at is not None and abs(vehicle.speed or 0.0) < STANDING and vehicle.position is not None:
            self.cut_stop = math.dist(self._lost_at, vehicle.position)
            self._lost_at = None

    def _see_replay(self, now: Snapshot, vehicle: VehicleView) -> None:
        """Note whether the replay stands where the rover still rolls, and nothing is demanded of it any more."""
        replay = now.replay
        assert replay is not None
        rolls = abs(vehicle.speed or 0.0) > STANDING and vehicle.armed and not _demanded(vehicle)
        self.paused_at_stop |= rolls and not replay.playing


def _demanded(vehicle: VehicleView) -> bool:
    return vehicle.demand is not None and any(abs(each) > 0.01 for each in vehicle.demand)


def _path(old: VehicleView, new: VehicleView) -> float:
    if old.position is None or new.position is None:
        return 0.0
    path = math.dist(old.position, new.position)
    return path if path < JUMP else 0.0


def _turn(old: VehicleView, new: VehicleView) -> float:
    """Return the turn to the right, degrees."""
    if old.heading is None or new.heading is None:
        return 0.0
    return math.degrees(math.remainder(new.heading - old.heading, math.tau))
