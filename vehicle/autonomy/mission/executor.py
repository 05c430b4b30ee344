"""AUTO: runs a mission item by item.

As in ArduPilot, NAV items run one after another. The DO and CONDITION items between two NAV items run while the rover
drives to the second one: a condition delays the DO items behind it, and items that are left when the second one is
reached are skipped. Items behind the last NAV item run when it is done, up to a condition that does not hold yet.
CONDITION_YAW is the exception: turning on the spot occupies the whole rover, so that it runs as a NAV item here.
link/services/mission/server.py handles the upload. Protocol: https://mavlink.io/en/services/mission.html
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from enum import IntEnum

from dialects.enums import Command
from link.services.mission.items import Items, MissionItem
from vehicle.autonomy.mission.nav_items import ConditionYaw, NavDelay, NavLoiterTurns, NavTask, NavWaypoint
from vehicle.autonomy.mission.rules import DoItem
from vehicle.autonomy.mode import ModeFinished
from vehicle.navigation.estimate import Estimate
from vehicle.navigation.geo import Point
from vehicle.navigation.guidance import STOP_RADIUS, Leg, PathFollower
from vehicle.navigation.rally import ReturnPoint
from vehicle.navigation.speed_control import DesiredMotion
from vehicle.params import Params

ITEM_SEARCH_MAX = 100
"""Items searched for the next NAV item; more are an endless loop of DO_JUMP."""
CONDITION_COMMANDS = (Command.CONDITION_DELAY, Command.CONDITION_DISTANCE)


class MissionState(IntEnum):
    """MISSION_STATE of MISSION_CURRENT, as far as it follows from the mission."""

    NONE = 1
    NOT_STARTED = 2
    ACTIVE = 3
    COMPLETE = 5


class MissionExecutor:
    """The mission in use, and its progress."""

    def __init__(
        self,
        params: Params,
        guide: PathFollower,
        find_return_point: Callable[[Estimate], ReturnPoint | None],
        rejection: Callable[[Point], str | None] = lambda place: None,
    ) -> None:
        """Create an executor without a mission.

        `find_return_point` returns the nearest return point, and `rejection` why a place may not be driven to, or None.
        """
        self.items: Items = ()
        self.current = 0
        """Index of the item in progress, or of the first one to run."""
        self.state = MissionState.NONE
        self._reached_items: list[int] = []
        """Items reached and not yet taken by `pop_reached_items`."""
        self._do_items: Mapping[int, DoItem] = {}
        self._params = params
        self._guide = guide
        self._find_return_point = find_return_point
        self._rejection = rejection
        self._rejection_reason: str | None = None
        self._task: NavTask | None = None
        self._waiting: list[tuple[int, MissionItem]] = []
        self._held_since: float | None = None
        self._jumped: dict[int, int] = {}
        self._ending: str | None = None
        self._damage: str | None = None

    @property
    def goal(self) -> Point | None:
        """The place that the current item drives to."""
        return self._task.goal if self._task else None

    @property
    def missing_reason(self) -> str:
        """Why there is no mission."""
        return self._damage or "there is no mission"

    def set_do_items(self, do_items: Mapping[int, DoItem]) -> None:
        """Set what runs the DO items, by MAV_CMD."""
        self._do_items = do_items

    def pop_reached_items(self) -> list[int]:
        """Return the items reached since the last call."""
        reached, self._reached_items = self._reached_items, []
        return reached

    def load(self, items: Items, damage: str | None = None) -> None:
        """Use another mission from its first item. `damage`: why the stored mission is lost."""
        self.items, self._damage = items, damage
        self.set_current(0)

    def set_current(self, index: int, *, anew: bool = True) -> None:
        """Continue with this item; `anew` resets the counters of DO_JUMP."""
        self.current = index
        self.state = MissionState.NOT_STARTED if self.items else MissionState.NONE
        self._task = self._ending = None
        self._waiting.clear()
        if anew:
            self._jumped.clear()

    def unready(self, estimate: Estimate) -> str | None:
        """Return why AUTO cannot begin, or None."""
        return None if self.items else self.missing_reason

    def begin(self, estimate: Estimate, now: float) -> None:
        """Continue with the current item on a new line from here; a completed mission begins anew."""
        if self.state is MissionState.COMPLETE:
            self.set_current(0)
        self._task = None

    def step(self, estimate: Estimate, speed: float, now: float) -> DesiredMotion | ModeFinished:
        """Return the motion of the current item, or of the next one if it is done."""
        start = estimate.place
        for _ in range(ITEM_SEARCH_MAX):
            if self._task is None:
                self._begin_next(self.current, estimate, start)
            if self._task is None:
                if self._rejection_reason is None and self._ending is None:  # no NAV item left
                    self._run_waiting(estimate, now)
                return self._end()
            motion = self._task.step(self._guide, estimate, speed, now)
            if motion is not None:
                self._run_waiting(estimate, now)
                return motion
            start = self._finish(estimate)
        return self._end()

    def _finish(self, estimate: Estimate) -> Point:
        """Finish the current task; return where the next leg begins."""
        self._reached_items.append(self.current)
        task, self._task = self._task, None
        self.current += 1
        return task.leg.end if isinstance(task, NavWaypoint) else estimate.place

    def _end(self) -> ModeFinished:
        if self._rejection_reason is not None:  # not complete: the fence or the current item may be changed
            reason, self._rejection_reason = self._rejection_reason, None
            return ModeFinished(reason)
        self.state, self.current = MissionState.COMPLETE, 0
        return ModeFinished(self._ending or "mission complete")

    def _begin_next(self, index: int, estimate: Estimate, start: Point) -> None:
        """Begin the next NAV item from `index` on; the DO items before it run beside it."""
        self._waiting, self._held_since = [], None
        for _ in range(ITEM_SEARCH_MAX):
            if not index < len(self.items) or self._ending:
                return
            item = self.items[index]
            if item.command == Command.DO_JUMP:
                index = self._jump(index, item, count=True)
            elif item.command in CONDITION_COMMANDS or item.command in self._do_items:
                self._waiting.append((index, item))
                index += 1
            else:
                self.current, self.state = index, MissionState.ACTIVE
                self._guide.reset()
                self._begin_task(item, index, estimate, start)
                return
        self._ending = "endless loop of DO_JUMP"

    def _begin_task(self, item: MissionItem, index: int, estimate: Estimate, start: Point) -> None:
        task = self._build_task(item, index, estimate, start)
        reason = None if task.goal is None or self._ending else self._rejection(task.goal)
        if reason is None:
            self._task = task
        else:
            self._rejection_reason = f"item {index}: {reason}"

    def _jump(self, index: int, item: MissionItem, *, count: bool) -> int:
        done, repeats = self._jumped.get(index, 0), item.params[1]
        if 0 <= repeats <= done:
            return index + 1
        if count:
            self._jumped[index] = done + 1
        return int(item.params[0])

    def _build_task(self, item: MissionItem, index: int, estimate: Estimate, start: Point) -> NavTask:
        first = _number(item.params[0])
        match item.command:
            case Command.NAV_DELAY:
                return NavDelay(first)
            case Command.CONDITION_YAW:
                turn = math.radians(first) * (-1.0 if item.params[2] < 0.0 else 1.0)
                return ConditionYaw((estimate.yaw or 0.0) + turn if item.params[3] else math.radians(first))
            case Command.NAV_LOITER_TURNS:
                radius = _number(item.params[2]) or self._params["LOIT_RADIUS"]
                return NavLoiterTurns(self._place(item, estimate), radius, first)
            case Command.NAV_RETURN_TO_LAUNCH:
                target = self._find_return_point(estimate) or ReturnPoint(start, "the end")
                self._ending = f"{target.name} is reached"
                return NavWaypoint(Leg(start, target.point), STOP_RADIUS)
        return self._leg(item, index, estimate, start)

    def _leg(self, item: MissionItem, index: int, estimate: Estimate, start: Point) -> NavTask:
        leg = Leg(start, self._place(item, estimate))
        stay = math.inf if item.command == Command.NAV_LOITER_UNLIM else _number(item.params[0])
        end_speed = 0.0 if stay else self._corner(leg, index, estimate)
        radius = self._params["WP_RADIUS"] if end_speed else STOP_RADIUS
        return NavWaypoint(leg, radius, end_speed, stay)

    def _corner(self, leg: Leg, index: int, estimate: Estimate) -> float:
        """Return the m/s at which the end of a leg may be passed."""
        onward = self._following_nav_item(index + 1)
        if onward is None or onward.command != Command.NAV_WAYPOINT:
            return 0.0
        turn = Leg(leg.end, self._place(onward, estimate)).bearing - leg.bearing
        return self._guide.corner_speed(math.remainder(turn, math.tau), self._params["WP_SPEED"])

    def _following_nav_item(self, index: int) -> MissionItem | None:
        """Return the NAV item that follows, or None."""
        for _ in range(ITEM_SEARCH_MAX):
            if index >= len(self.items):
                return None
            item = self.items[index]
            if item.command == Command.DO_JUMP:
                index = self._jump(index, item, count=False)
            elif item.command in CONDITION_COMMANDS or item.command in self._do_items:
                index += 1
            else:
                return item
        return None

    def _place(self, item: MissionItem, estimate: Estimate) -> Point:
        if estimate.origin is None or (item.x, item.y) == (0, 0) or abs(item.latitude) > 90.0:
            return estimate.place
        return estimate.origin.to_local(item.latitude, item.longitude)

    def _run_waiting(self, estimate: Estimate, now: float) -> None:
        """Run the DO items up to the next condition that does not hold.

        Each counts as reached, as in ArduPilot: MAVSDK takes the last item of a mission as its end.
        """
        while self._waiting and self._may_run(self._waiting[0][1], estimate, now):
            number, item = self._waiting.pop(0)
            self._reached_items.append(number)
            self._held_since = None
            if item.command in self._do_items:
                self._do_items[item.command].run(item, now)

    def _may_run(self, item: MissionItem, estimate: Estimate, now: float) -> bool:
        if item.command == Command.CONDITION_DELAY:
            self._held_since = now if self._held_since is None else self._held_since
            return now - self._held_since >= item.params[0]
        if item.command == Command.CONDITION_DISTANCE:
            return self.goal is None or self.goal.distance(estimate.place) <= item.params[0]
        return True


def _number(value: float) -> float:
    """Return 0 for NaN, which means the default in a mission."""
    return 0.0 if math.isnan(value) else value
