"""A stop for vehicles that were not heard."""

from __future__ import annotations

from typing import Any

from dialects import messages as m
from groundstation.vehicles.demand.blind_stop import LATER, BlindStop
from groundstation.vehicles.demand.stop_commands import StopKind
from link.core import Peer, Received

IDS = (254, 190)


def ack(system: int, command: int, result: int, target: int = 254) -> Received:
    return Received(m.CommandAck(command, result, target_system=target), system, 1, 0, Peer(0, "x"), introduced=False)


def shown(messages: list[Any]) -> list[tuple[str, int, float, float, float]]:
    return [(type(each).__name__, each.command, each.param1, each.param2, each.param3) for each in messages]


def test_it_goes_at_once_and_again_in_both_forms() -> None:
    stop = BlindStop(StopKind.EMERGENCY, 7, IDS, 1.0)
    first: list[Any] = list(stop.tick(1.0))
    assert {(each.target_system, each.target_component) for each in first} == {(7, 0)}
    assert [each[1:] for each in shown(first)] == [(400, 0, 0, 0)]
    assert stop.tick(1.1) == []
    assert [[type(each) for each in stop.tick(1.0 + at)] for at in (0.25, 0.5)] == [
        [m.CommandInt],
        [m.CommandLong],
    ]


def test_hold_by_a_number_waits_until_no_vehicle_was_heard() -> None:
    """The number of HOLD is another mode of a copter, and without a sub mode it is the mission of PX4."""
    stop = BlindStop(StopKind.HOLD, 0, IDS, 1.0)
    assert [each[1] for each in shown(stop.tick(1.0))] == [193]
    assert [each[1:] for each in shown(stop.tick(1.0 + LATER + 0.1))] == [(193, 0, 0, 0), (176, 1, 4, 3)]
    assert [each[1] for each in shown(stop.tick(9.0, heard=True))] == [193]


def test_only_a_cut_ends_the_power_of_what_may_fly() -> None:
    later = 1.0 + LATER + 0.1
    stop, cut = (BlindStop(kind, 0, IDS, 1.0) for kind in (StopKind.EMERGENCY, StopKind.CUT))
    assert [each[1:] for each in shown(stop.tick(later))] == [(400, 0, 0, 0), (21, 0, 0, 0)]
    assert [each[1:] for each in shown(cut.tick(later))] == [(400, 0, 0, 0), (5300, 0, 0, 0), (400, 0, 21196, 0)]
    assert [each[1] for each in shown(cut.tick(later + 1, heard=True))] == [400]


def test_it_says_what_is_known() -> None:
    stop = BlindStop(StopKind.DISARM, 0, IDS, 1.0)
    stop.tick(1.0)
    assert stop.describe() == "sent 1 times to all vehicles (system 0), no answer: not known whether it has arrived"
    stop.receive(ack(3, 400, 0, target=253))
    stop.receive(ack(3, 176, 0))
    assert stop.answers == {}
    stop.receive(ack(3, 400, 0))
    stop.receive(ack(4, 400, 4))
    assert stop.describe().endswith(
        "; vehicle 3 has accepted, vehicle 4 has answered failed, but no heartbeat tells whether it is done"
    )
