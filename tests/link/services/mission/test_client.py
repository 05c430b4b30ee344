"""The mission protocol of the ground station: whatever is lost, a plan goes up and comes down whole."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dialects import messages as m
from dialects.enums import MissionResult, MissionType
from link.services.mission.client import TRIES, MissionClient, MissionOperation, MissionOutcome
from tests.link.mission_rig import (
    MissionRig,
    plain,
    waypoint,
)
from tests.link.services_world import Pair, from_vehicle


def ending(client: MissionClient, pair: Pair, within: float) -> MissionOutcome:
    outcomes: list[MissionOutcome] = []

    def ended() -> bool:
        outcomes.extend(client.outcomes())
        return bool(outcomes)

    pair.run_until(ended, within)
    [outcome] = outcomes
    return outcome


@settings(max_examples=25)
@given(st.integers(0, 10_000), st.sampled_from([0.0, 0.1, 0.3]), st.integers(0, 40))
def test_a_plan_goes_up_and_down_whatever_is_lost(seed: int, loss: float, length: int) -> None:
    vehicle = MissionRig()
    client = MissionClient(255, 190, target_system=1)
    pair = Pair(vehicle.server, client, loss=loss, seed=seed)
    items = [waypoint(number) for number in range(length)]
    client.upload(items, MissionType.MISSION, pair.now)
    uploaded = ending(client, pair, within=200.0)
    assert uploaded.done
    assert plain(vehicle.plan) == plain(tuple(items))
    client.download(MissionType.MISSION, pair.now)
    outcome = ending(client, pair, within=200.0)
    assert outcome.done
    assert plain(outcome.items) == plain(tuple(items))
    assert uploaded.plan_id == outcome.plan_id == vehicle.server.plan_id(MissionType.MISSION)
    client.clear(MissionType.MISSION, pair.now)
    assert ending(client, pair, within=30.0).done
    assert vehicle.plan == ()


def test_two_hundred_items_take_a_round_trip_each() -> None:
    vehicle = MissionRig()
    client = MissionClient(255, 190, target_system=1)
    pair = Pair(vehicle.server, client)
    client.upload([waypoint(number) for number in range(200)], MissionType.MISSION, pair.now)
    assert pair.run_until(lambda: not client.busy, within=20.0) < 201 * 0.06
    assert (pair.sent_by_client, pair.sent_by_server) == (201, 201)


def test_a_refusal_is_told_with_its_reason() -> None:
    vehicle = MissionRig()
    client = MissionClient(255, 190, target_system=1)
    client.upload([waypoint(command=22)], MissionType.MISSION, 100.0)
    outcome = ending(client, Pair(vehicle.server, client), within=5.0)
    assert (outcome.job, outcome.done, outcome.result) == (MissionOperation.UPLOAD, False, MissionResult.UNSUPPORTED)


def test_an_old_answer_said_again_ends_no_new_job() -> None:
    client = MissionClient(255, 190, target_system=1)
    accepted = from_vehicle(m.MissionAck(255, 190, MissionResult.ACCEPTED, 0))
    client.upload([waypoint(0), waypoint(1)], MissionType.MISSION, 0.0)
    client.receive(accepted, 0.1)
    assert client.outcomes() == []
    client.download(MissionType.MISSION, 0.2)
    client.receive(accepted, 0.3)
    assert client.outcomes() == []


def test_silence_ends_too() -> None:
    client = MissionClient(255, 190, target_system=1)
    client.download(MissionType.RALLY, 0.0)
    sent = []
    for tenth in range(300):
        client.tick(tenth / 10)
        sent += client.messages_to_send()
    assert len(sent) == TRIES
    assert [(outcome.result, outcome.kind) for outcome in client.outcomes()] == [(None, MissionType.RALLY)]


def test_words_of_other_vehicles_and_to_others_do_not_count() -> None:
    client = MissionClient(255, 190, target_system=1)
    client.clear(MissionType.MISSION, 0.0)
    client.receive(from_vehicle(m.MissionAck(255, 190, 0, 0), system=2), 0.1)
    client.receive(from_vehicle(m.MissionAck(254, 190, 0, 0)), 0.1)
    client.receive(from_vehicle(m.MissionAck(255, 190, 0, 1)), 0.1)
    assert client.outcomes() == []
    client.receive(from_vehicle(m.MissionAck(255, 190, 0, 0)), 0.1)
    assert len(client.outcomes()) == 1


def uploading(count: int) -> MissionClient:
    client = MissionClient(255, 190, target_system=1)
    client.upload([waypoint(number) for number in range(count)], MissionType.MISSION, 0.0)
    return client


def request(client: MissionClient, sequence: int) -> None:
    client.receive(from_vehicle(m.MissionRequest(255, 190, sequence, 0)), 0.1)


@pytest.mark.parametrize(
    ("count", "requested", "result", "item"),
    [
        (12, 8, MissionResult.INVALID_X, 8),
        (12, 11, MissionResult.INVALID_X, None),  # all were sent: it may be any
        (1, 0, MissionResult.INVALID_X, 0),
        (12, 8, MissionResult.NO_SPACE, None),
        (12, 8, MissionResult.DENIED, None),
        (12, None, MissionResult.UNSUPPORTED, None),
    ],
)
def test_the_item_that_was_refused_is_named(count: int, requested: int | None, result: int, item: int | None) -> None:
    client = uploading(count)
    if requested is not None:
        request(client, requested)
    client.receive(from_vehicle(m.MissionAck(255, 190, result, 0)), 0.2)
    [outcome] = client.outcomes()
    assert (outcome.done, outcome.result, outcome.item) == (False, result, item)


@pytest.mark.parametrize("changed", [False, True])
def test_a_download_is_resumed_unless_the_plan_has_changed(changed: bool) -> None:
    vehicle = MissionRig()
    vehicle.upload([waypoint(number) for number in range(30)])
    client = MissionClient(255, 190, target_system=1)
    pair = Pair(vehicle.server, client)
    client.download(MissionType.MISSION, pair.now)
    pair.run_until(lambda: client.progress[0] == 20, within=5.0)
    for second in range(60):
        client.tick(pair.now + second)
    [failed] = client.outcomes()
    assert (failed.done, len(failed.items), failed.count, failed.tries) == (False, 20, 30, TRIES)
    client.messages_to_send()
    if changed:
        vehicle.upload([waypoint(number + 5) for number in range(30)])
    sent = pair.sent_by_client
    client.download(MissionType.MISSION, pair.now, failed)
    outcome = ending(client, pair, within=60.0)
    assert outcome.done
    assert plain(outcome.items) == plain(vehicle.plan)
    assert pair.sent_by_client - sent == (32 if changed else 12)


def test_a_cancelled_upload_is_cancelled_on_the_vehicle() -> None:
    vehicle = MissionRig()
    client = MissionClient(255, 190, target_system=1)
    pair = Pair(vehicle.server, client)
    client.upload([waypoint(number) for number in range(30)], MissionType.MISSION, pair.now)
    pair.run_until(lambda: client.progress[0] == 10, within=5.0)
    client.cancel()
    for _ in range(100):
        pair.step()
    assert client.outcomes() == []
    assert vehicle.plan == ()
    client.upload([waypoint()], MissionType.MISSION, pair.now)
    assert ending(client, pair, within=5.0).done
