"""DO_FENCE_ENABLE, as a command and as a mission item."""

from __future__ import annotations

from dialects.enums import Command, Result, Severity
from link.services.command.request import CommandRequest
from link.services.mission.items import ItemRule, MissionItem
from link.signing.role import SigningRole
from vehicle.autonomy.mission.rules import DoItem
from vehicle.commands.access import Access
from vehicle.commands.command_table import CommandSpec, CommandTable
from vehicle.commands.context import Context

DISABLE, ENABLE, FLOOR_ONLY = 0, 1, 2
"""Parameter 1 of DO_FENCE_ENABLE; a rover has no floor."""


class FenceCommands:
    """Enables and disables the fence for the driver."""

    def __init__(self, context: Context) -> None:
        self._safety = context.safety
        self._access = context.access
        self._texts = context.statustext
        self._navigator = context.navigator
        self._fence = context.navigator.fence_avoidance.fence

    def commands(self) -> CommandTable:
        """Return the rows of the commands handled here."""
        return (
            CommandSpec(Command.DO_FENCE_ENABLE, self._enable, Access.DRIVER_OR_UNCLAIMED,
                        "1: 1 on, 0 off (key: setup); not off while armed, nor what the configuration file forbids",
                        item=DoItem(ItemRule(ranges={1: (0.0, 1.0)}), self._run_item)),
        )  # fmt: skip

    def _enable(self, request: CommandRequest, now: float) -> Result:
        """Parameter 1: 0 off, 1 on. An armed vehicle keeps its fence. Off needs setup, as FENCE_ENABLE does."""
        action = request.params[0]
        if action == FLOOR_ONLY:
            return Result.UNSUPPORTED
        if action not in (DISABLE, ENABLE):
            return Result.DENIED
        if action == ENABLE and self._fence.damage:
            return self._access.reject(request, self._fence.damage, now)
        if action == DISABLE and self._safety.armed and self._fence.enabled:
            return self._access.reject(request, "disarm first", now)
        if action == DISABLE and (denied := self._access.deny_role(SigningRole.SET_UP, request, now)):
            return denied
        before = self._fence.enabled
        denial = self._fence.set_enabled(action == ENABLE)
        if denial:
            return self._access.reject(request, denial, now)
        if self._fence.enabled != before:
            text = f"GCS {request.system}: fence {'enabled' if self._fence.enabled else 'disabled'}"
            self._texts.send_change(Severity.NOTICE, text, now)
        return Result.ACCEPTED

    def _run_item(self, item: MissionItem, now: float) -> None:
        """Enable the fence; the mission ends if that fails. A mission never disables it."""
        if not item.params[0]:
            return
        denial = self._fence.set_enabled(True) or self._fence.unavailable_reason
        if denial:
            self._navigator.end_mode(denial)
