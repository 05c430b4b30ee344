"""The parameter protocol of the ground station: whatever is lost, the list ends complete and a set ends certain."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dialects import messages as m
from dialects.enums import ParamErrorCode
from link.core import Outgoing
from link.services.param.client import TRIES, ParamClient, ParamOutcome
from link.services.param.values import REAL32
from tests.link.param_rig import ParamRig, big_table
from tests.link.services_world import Pair, from_vehicle


@settings(max_examples=25)
@given(st.integers(0, 10_000), st.sampled_from([0.0, 0.1, 0.3]))
def test_all_parameters_arrive_whatever_is_lost(seed: int, loss: float) -> None:
    vehicle = ParamRig(table=big_table(120))
    client = ParamClient(255, 190, target_system=1)
    pair = Pair(vehicle.server, client, loss=loss, seed=seed)
    client.fetch(pair.now)
    pair.run_until(lambda: not client.fetching, within=60.0)
    assert client.complete
    assert {param.name: param.value for param in client.params.values()} == dict(vehicle.values)


def test_a_whole_list_takes_one_question() -> None:
    vehicle = ParamRig(table=big_table(300))
    client = ParamClient(255, 190, target_system=1)
    pair = Pair(vehicle.server, client)
    client.fetch(pair.now)
    assert pair.run_until(lambda: client.complete, within=3.0) < 0.3
    assert pair.sent_by_client == 1


@settings(max_examples=25)
@given(st.integers(0, 10_000))
def test_a_set_over_a_lossy_link_ends_as_wanted(seed: int) -> None:
    vehicle = ParamRig()
    client = ParamClient(255, 190, target_system=1)
    pair = Pair(vehicle.server, client, loss=0.2, seed=seed)
    client.set("MAN_DEADBAND", 12.5, pair.now)
    assert ending(client, pair).done
    assert vehicle.values["MAN_DEADBAND"] == 12.5


def ending(client: ParamClient, pair: Pair) -> ParamOutcome:
    """How the one thing that was asked ended."""
    outcomes: list[ParamOutcome] = []

    def ended() -> bool:
        outcomes.extend(client.outcomes())
        return bool(outcomes)

    pair.run_until(ended, within=10.0)
    [outcome] = outcomes
    return outcome


def test_a_refusal_and_an_unknown_name_end_at_once() -> None:
    vehicle = ParamRig(armed=True)
    client = ParamClient(255, 190, target_system=1)
    client.set("MAN_TIMEOUT", 1.0, 100.0)
    refused = ending(client, Pair(vehicle.server, client))
    assert (refused.done, refused.fault) == (False, ParamErrorCode.PERMISSION_DENIED)
    client.read("NO_SUCH", 100.0)
    unknown = ending(client, Pair(vehicle.server, client))
    assert (unknown.done, unknown.fault) == (False, ParamErrorCode.DOES_NOT_EXIST)


def test_a_value_that_was_under_way_is_no_refusal() -> None:
    client = ParamClient(255, 190, target_system=1)
    client.set("SPEED", 2.0, 0.0)
    client.receive(from_vehicle(m.ParamValue(b"SPEED", 1.0, REAL32, 9, 3)), 0.1)
    assert client.outcomes() == []
    client.receive(from_vehicle(m.ParamValue(b"SPEED", 2.0, REAL32, 9, 65535)), 0.2)
    assert [each.done for each in client.outcomes()] == [True]


def test_a_vehicle_that_answers_with_another_value_has_refused() -> None:
    client = ParamClient(255, 190, target_system=1)
    client.set("SPEED", 2.0, 0.0)
    for at in (0.1, 0.9):
        client.receive(from_vehicle(m.ParamValue(b"SPEED", 1.0, REAL32, 9, 3)), at)
    [outcome] = client.outcomes()
    assert (outcome.done, outcome.value, outcome.fault) == (False, 1.0, None)


@pytest.mark.parametrize("value", [math.nan, math.inf, 1e39])
def test_what_is_no_float32_is_refused_before_it_is_sent(value: float) -> None:
    client = ParamClient(255, 190, target_system=1)
    client.set("SPEED", value, 0.0)
    assert [outcome.fault for outcome in client.outcomes()] == [ParamErrorCode.VALUE_OUT_OF_RANGE]
    assert client.messages_to_send() == []


@pytest.mark.parametrize("name", ["SEVENTEEN_LETTERS", "GRÖSSE", ""])
def test_a_name_that_would_become_anothers_is_not_sent(name: str) -> None:
    client = ParamClient(255, 190, target_system=1)
    client.set(name, 1.0, 0.0)
    client.read(name, 0.0)
    assert [outcome.fault for outcome in client.outcomes()] == [ParamErrorCode.DOES_NOT_EXIST] * 2
    assert client.messages_to_send() == []


def test_silence_ends_too() -> None:
    client = ParamClient(255, 190, target_system=1)
    client.set("SPEED", 2.0, 0.0)
    client.fetch(0.0)
    sent: list[Outgoing] = []
    for tenth in range(300):
        client.tick(tenth / 10)
        sent += client.messages_to_send()
    [outcome] = client.outcomes()
    assert (outcome.done, outcome.value) == (False, None)
    assert not client.fetching
    assert sum(isinstance(each.message, m.ParamSet) for each in sent) == TRIES
    assert sum(isinstance(each.message, m.ParamRequestList) for each in sent) == TRIES


def test_values_of_other_vehicles_do_not_count() -> None:
    client = ParamClient(255, 190, target_system=1)
    client.fetch(0.0)
    client.receive(from_vehicle(m.ParamValue(b"A", 1.0, REAL32, 1, 0), system=2), 0.1)
    assert client.params == {}


def test_version_grows_with_each_change_of_parameters_only() -> None:
    client = ParamClient(255, 190, target_system=1)
    versions = []
    for value in (1.0, 1.0, 2.0):
        client.receive(from_vehicle(m.ParamValue(b"A", value, REAL32, 1, 0)), 0.1)
        versions.append(client.version)
    client.load([*client.params.values()])
    client.forget()
    assert [*versions, client.version] == [1, 1, 2, 4]
