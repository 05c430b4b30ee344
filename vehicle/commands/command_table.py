"""One row for each MAV_CMD: who may send it, its parameters, its handler, and whether a mission may hold it.

The rows of a subject are in the `commands()` of its class. docs/dialect.md, the access checks, the broadcast rule and
the rules of DO_ items all come from these rows. A MAV_CMD without a row is answered UNSUPPORTED.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import msgspec

from dialects.messages import CommandInt, CommandLong
from link.services.command.request import CommandRequest
from link.services.command.server import CommandHandler, RunCommand
from link.signing.role import SigningRole
from vehicle.autonomy.mission.rules import DoItem
from vehicle.commands.access import NEEDED_ROLES, Access, CommandAccess, CommandResult


class CommandSpec(msgspec.Struct, frozen=True):
    """One MAV_CMD that the vehicle answers."""

    command: int
    """A `dialects.enums.Command`, or any other MAV_CMD number."""
    run: RunCommand
    access: Access
    help: str
    """What its parameters mean, for docs/dialect.md."""
    stops: Callable[[Sequence[float]], bool] | None = None
    """True for parameters that stop the vehicle: then anyone may send it."""
    broadcast: bool = False
    """Accepted when sent to system 0; where `stops` is given only what stops, so that a broadcast never arms."""
    item: DoItem | None = None
    """The DO item of a mission; None if a mission does not hold this command as a DO item."""
    role: SigningRole | None = None
    """What the key of its sender must allow; None: what `access` needs."""

    @property
    def who(self) -> str:
        """Who may send it, for docs/dialect.md."""
        role = f", key: {self.needed_role.word}" if self.role is not None else ""
        return f"{self._who}{role}"

    @property
    def needed_role(self) -> SigningRole:
        """What the key of its sender must allow, unless it only stops."""
        return NEEDED_ROLES[self.access] if self.role is None else self.role

    @property
    def _who(self) -> str:
        return self.access.value if self.stops is None else f"{self.access.value}; to stop: {Access.ANYONE.value}"

    def accepts_broadcast(self, message: CommandLong | CommandInt) -> bool:
        """Return whether a command to system 0 is run."""
        params = (message.param1, message.param2, message.param3)
        return self.broadcast and (self.stops is None or self.stops(params))


CommandTable = tuple[CommandSpec, ...]


def build_handlers(table: Iterable[CommandSpec], access: CommandAccess) -> dict[int, CommandHandler]:
    """Return the handlers for link.services.command.server.CommandServer, with the access checks of the rows."""
    return {row.command: CommandHandler(_checked(row, access), broadcast=row.broadcast) for row in table}


def do_items(table: Iterable[CommandSpec]) -> dict[int, DoItem]:
    """Return the DO items of missions, by MAV_CMD."""
    return {row.command: row.item for row in table if row.item is not None}


def _checked(row: CommandSpec, access: CommandAccess) -> RunCommand:
    """Return the handler of a row behind its access check."""
    if row.access is Access.ANYONE:
        return row.run

    def run(request: CommandRequest, now: float) -> CommandResult:
        if row.stops is None or not row.stops(request.params):
            denial = access.deny_role(row.needed_role, request, now) or access.deny(row.access, request, now)
            if denial is not None:
                return access.soften(denial, request, now)
        return access.soften(row.run(request, now), request, now)

    return run
