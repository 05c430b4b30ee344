"""MISSION_ITEM(_INT) that is not part of a plan: drives to its position in GUIDED, as ArduRover does.

It follows the rules of a position setpoint: the ground station in control, in GUIDED, armed. It changes no mode;
DO_REPOSITION can.
"""

from __future__ import annotations

from collections.abc import Callable

from dialects import messages as m
from dialects.enums import Command, MissionResult, Severity
from link.core import Received
from link.services.mission.items import ItemRequest, ItemRule, MissionItem, PositionRule, item_fault
from vehicle.commands.context import Context

RULES = {int(Command.NAV_WAYPOINT): ItemRule(PositionRule.NEEDED)}
"""The item that ground stations send. Its parameters and its altitude are not used."""
POSITION_ONLY = 8 | 16 | 32 | 64 | 128 | 256 | 1024 | 2048
"""POSITION_TARGET_TYPEMASK that ignores velocity, acceleration, yaw and yaw rate."""

DriveTo = Callable[[m.SetPositionTargetGlobalInt, Received, float], str | None]
"""Puts a position setpoint in force; returns why it is refused, or None."""


class GoToItems:
    """Answers `link.services.mission.items.ItemRequest`."""

    def __init__(self, context: Context, drive_to: DriveTo) -> None:
        self._control = context.control
        self._texts = context.statustext
        self._drive_to = drive_to

    def handle(self, request: ItemRequest, item: MissionItem, received: Received, now: float) -> MissionResult:
        """Start to drive, or refuse; return the result for MISSION_ACK."""
        if request is ItemRequest.CHANGE_ALTITUDE:
            return self._refuse(MissionResult.UNSUPPORTED, "altitude change refused: a rover has none", received, now)
        fault = item_fault(item, RULES)
        if fault is not None:
            return self._refuse(fault, f"go-to refused: {_describe(fault, item)}", received, now)
        reason = self._drive_to(_setpoint(item), received, now)
        if reason is None:
            return MissionResult.ACCEPTED
        is_driver = self._control.ownership.is_driver(received, now)
        verdict = MissionResult.ERROR if is_driver else MissionResult.DENIED
        return self._refuse(verdict, f"go-to refused: {reason}", received, now)

    def _refuse(self, verdict: MissionResult, text: str, received: Received, now: float) -> MissionResult:
        """Send the reason as STATUSTEXT: a MAV_MISSION_RESULT says little."""
        self._texts.reply(received, Severity.WARNING, f"GCS {received.system}: {text}", now)
        return verdict


def _describe(fault: MissionResult, item: MissionItem) -> str:
    match fault:
        case MissionResult.UNSUPPORTED:
            return f"command {item.command} not offered"
        case MissionResult.UNSUPPORTED_FRAME:
            return f"frame {item.frame} not offered"
    return fault.name.lower().replace("_", " ")


def _setpoint(item: MissionItem) -> m.SetPositionTargetGlobalInt:
    """Return the setpoint that requests the same; the sender of an item has no clock in it."""
    return m.SetPositionTargetGlobalInt(0, 0, 0, item.frame, POSITION_ONLY, item.x, item.y, 0, 0, 0, 0, 0, 0, 0, 0, 0)
