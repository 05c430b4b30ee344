"""The table of message traits: complete, without contradiction, and what the sets that are built from it hold."""

from __future__ import annotations

import math

from dialects import messages as m
from dialects import traits
from dialects.messages import CommandInt, CommandLong, Message
from dialects.traits import TRAITS, Trait, ids_with, is_stop
from tests.rows import each_row

NAMED = sorted(
    (each for each in vars(m).values() if isinstance(each, type) and issubclass(each, Message) and each is not Message),
    key=lambda each: each.id,
)
"""Every message that dialects/messages.py names."""
SETS = ("ACKED", "URGENT", "NEWEST_ONLY", "DEMANDS", "COMMANDS", "LOCAL", "UNLOGGED", "SECRET", "LOG_ONLY")


def test_every_row_is_a_named_message_of_the_dialect() -> None:
    assert set(TRAITS) <= set(NAMED)
    assert len({message.id for message in TRAITS}) == len(TRAITS)


@each_row("message", NAMED, ids=lambda message: message.msgname)
def test_each_message_is_state_or_acknowledged_and_not_both(message: type[Message]) -> None:
    each = TRAITS.get(message, Trait.STATE)
    assert (Trait.STATE in each) != (Trait.ACKED in each)


@each_row("message", TRAITS, ids=lambda message: message.msgname)
def test_traits_do_not_contradict_each_other(message: type[Message]) -> None:
    each = TRAITS[message]
    assert not (Trait.DEMAND in each and Trait.COMMAND in each)
    if Trait.DEMAND in each:  # an old demand is a wrong one
        assert Trait.STATE | Trait.URGENT in each
    if Trait.COMMAND in each:
        assert Trait.ACKED | Trait.URGENT in each
    if Trait.SECRET in each:
        assert Trait.LOCAL | Trait.UNLOGGED in each
    if Trait.LOG_ONLY in each:  # forwarded by nobody, recorded, and each of them
        assert Trait.LOCAL | Trait.ACKED in each
        assert not each & (Trait.UNLOGGED | Trait.URGENT | Trait.SECRET)


def test_a_message_without_a_row_is_state() -> None:
    assert m.Attitude not in TRAITS
    assert not any(m.Attitude.id in getattr(traits, name) for name in SETS)


def test_the_sets_hold_what_the_table_says() -> None:
    for name in ("ACKED", "URGENT", "LOCAL", "UNLOGGED", "SECRET", "LOG_ONLY"):
        assert getattr(traits, name) == ids_with(Trait[name]) != frozenset()
    assert {m.ManualControl.id, m.RcChannelsOverride.id, m.RoverOperatorPresence.id} == traits.DEMANDS
    assert {m.CommandLong.id, m.CommandInt.id, m.SetMode.id} == traits.COMMANDS
    assert traits.NEWEST_ONLY == traits.URGENT - traits.ACKED
    assert {m.SetupSigning.id} == traits.SECRET
    assert {m.RoverStationEvent.id} == traits.LOG_ONLY
    assert {m.SetupSigning.id, m.RadioStatus.id, m.RoverStationEvent.id} == traits.LOCAL
    assert {m.SetupSigning.id, m.FileTransferProtocol.id, m.LogData.id, m.LogEntry.id} == traits.UNLOGGED


@each_row(
    ("command", "param1", "stops"),
    [
        *((400, 0.0, True), (400, 1.0, False), (5300, 0.0, True), (5300, 1.0, False), (176, 0.0, False)),
        *((185, 1.0, True), (185, 0.0, False), (185, math.nan, False)),
        *((193, 0.0, True), (193, 1.0, False), (193, math.nan, False)),
    ],
)
def test_what_counts_as_a_stop(command: int, param1: float, stops: bool) -> None:
    assert is_stop(CommandLong(1, 1, command, 0, param1, 0, 0, 0, 0, 0, 0)) is stops
    assert is_stop(CommandInt(1, 1, 0, command, 0, 0, param1, 0, 0, 0, 0, 0, 0)) is stops


@each_row(
    ("base", "custom", "sub", "holds"),
    [
        *((1.0, 4.0, 0.0, True), (217.0, 4.0, 0.0, True), (1.0, 4.0, math.nan, True)),
        *((0.0, 4.0, 0.0, False), (1.0, 0.0, 0.0, False), (1.0, 10.0, 0.0, False), (1.0, 4.0, 4.0, False)),
        *((math.nan, 4.0, 0.0, False), (math.inf, 4.0, 0.0, False), (1.0, math.nan, 0.0, False)),
    ],
)
def test_hold_is_a_stop_and_other_modes_are_not(base: float, custom: float, sub: float, holds: bool) -> None:
    assert is_stop(CommandLong(1, 1, 176, 0, base, custom, sub, 0, 0, 0, 0)) is holds
    assert is_stop(CommandInt(1, 1, 0, 176, 0, 0, base, custom, sub, 0, 0, 0, 0)) is holds


def test_the_old_set_mode_stops_with_hold_only() -> None:
    assert is_stop(m.SetMode(1, 1, 4))
    assert not is_stop(m.SetMode(1, 0, 4))
    assert not is_stop(m.SetMode(1, 1, 0))
