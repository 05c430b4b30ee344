"""Rows of the command table: access checks, broadcasts, and DO items of missions."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from dialects.enums import Command, Result
from dialects.messages import CommandLong
from link.services.command.request import CommandRequest
from link.services.mission.items import ItemRule, MissionItem
from tests.vehicle.bench import Bench
from tests.vehicle.commands.test_access import OTHER, Denials, request
from vehicle.autonomy.mission.rules import MISSION_RULES, DoItem
from vehicle.commands.access import Access
from vehicle.commands.command_table import CommandSpec, build_handlers, do_items


def accept(request: CommandRequest, now: float) -> Result:
    return Result.ACCEPTED


def stops(params: Sequence[float]) -> bool:
    return params[0] == 0


def run_item(item: MissionItem, now: float) -> None:
    """Do nothing."""


TOY = CommandSpec(31010, accept, Access.DRIVER_OR_UNCLAIMED, "a command that no enum of ours names")
STOP = CommandSpec(31011, accept, Access.DRIVER_OR_UNCLAIMED, "1: 0 stops", stops=stops, broadcast=True)
OPEN = CommandSpec(31012, accept, Access.ANYONE, "none", broadcast=True)


def test_a_row_denies_before_its_handler_runs() -> None:
    handlers = build_handlers((TOY, STOP, OPEN), Denials().access)
    assert handlers[TOY.command].run(request(), 1.0) is Result.ACCEPTED
    assert handlers[TOY.command].run(request(OTHER), 1.0) is Result.FAILED
    assert handlers[OPEN.command].run(request(OTHER, introduced=False, may_ask=False), 1.0) is Result.ACCEPTED


def test_anyone_may_stop() -> None:
    run = build_handlers((STOP,), Denials().access)[STOP.command].run
    assert run(request(OTHER, introduced=False), 1.0) is Result.ACCEPTED


@pytest.mark.parametrize(
    ("row", "first", "accepted"), [(TOY, 0, False), (STOP, 0, True), (STOP, 1, False), (OPEN, 1, True)]
)
def test_broadcast_is_accepted_by_rows_that_stop_or_harm_nothing(
    row: CommandSpec, first: float, accepted: bool
) -> None:
    message = CommandLong(0, 1, row.command, 0, first, 0, 0, 0, 0, 0, 0)
    assert row.accepts_broadcast(message) is accepted


def test_only_rows_with_an_item_are_do_items_of_missions() -> None:
    item = DoItem(ItemRule(), run_item)
    assert do_items((TOY, CommandSpec(31013, accept, Access.ANYONE, "none", item=item))) == {31013: item}


def test_the_do_items_of_the_vehicle() -> None:
    found = do_items(Bench().rover.commands)
    assert set(found) == {
        Command.DO_CHANGE_SPEED, Command.DO_SET_REVERSE, Command.DO_FENCE_ENABLE, Command.DO_SET_SERVO,
        Command.DO_REPEAT_SERVO, Command.DO_SET_RELAY, Command.DO_REPEAT_RELAY,
    }  # fmt: skip
    assert not set(found) & set(MISSION_RULES)
