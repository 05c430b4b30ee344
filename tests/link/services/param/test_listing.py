"""The list of parameters: whatever a vehicle sends, it ends, complete or with what is missing."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable

import pytest

from dialects import messages as m
from link.services.param.client import MAX_PARAMS, Param, ParamClient
from link.services.param.listing import LIST_AGAIN, MAX_COUNT_CHANGES, TRIES, WINDOW
from link.services.param.values import REAL32
from tests.link.services_world import from_vehicle

Answer = Callable[[m.Message], Iterable[m.ParamValue]]
"""What the vehicle sends to a request."""


def value(index: int, total: int, name: bytes = b"") -> m.ParamValue:
    return m.ParamValue(name or f"P{index:04}".encode(), float(index), REAL32, total, index)


def fetch(answer: Answer, within: float = 300.0) -> tuple[ParamClient, list[m.Message], float]:
    """Fetch the list of a vehicle in steps of 0.1 s; return the client, its requests, and how long it took."""
    client, sent, now = ParamClient(255, 190, target_system=1), list[m.Message](), 0.0
    client.fetch(now)
    while client.fetching:
        assert now < within, "the list does not end"
        now += 0.1
        client.tick(now)
        requests = [each.message for each in client.messages_to_send()]
        sent += requests
        for request in requests:
            for message in answer(request):
                client.receive(from_vehicle(message), now)
    return client, sent, now


class Lossy:
    """A vehicle with `total` parameters that loses some values of each list."""

    def __init__(self, total: int, lost: Iterable[int], never: Iterable[int] = ()) -> None:
        self.total, self.lost, self.never = total, set(lost), set(never)

    def __call__(self, request: m.Message) -> Iterable[m.ParamValue]:
        if isinstance(request, m.ParamRequestList):
            numbers = [number for number in range(self.total) if number not in self.lost | self.never]
        else:
            assert isinstance(request, m.ParamRequestRead)
            numbers = [request.param_index] if request.param_index not in self.never else []
        return [value(number, self.total) for number in numbers]


def test_gaps_are_filled_a_window_at_a_time_without_waiting() -> None:
    client, sent, took = fetch(Lossy(200, range(50, 90)))
    assert client.complete
    assert [type(each) for each in sent] == [m.ParamRequestList] + [m.ParamRequestRead] * 40
    assert took < 3.0, "the next window is requested as soon as the last has arrived"


def test_many_gaps_are_filled_by_the_whole_list() -> None:
    lost = set(range(0, 1000, 2))
    vehicle = Lossy(1000, lost)

    def answer(request: m.Message) -> Iterable[m.ParamValue]:
        messages = list(vehicle(request))
        vehicle.lost.clear()
        return messages

    client, sent, _ = fetch(answer)
    assert client.complete
    assert [type(each) for each in sent] == [m.ParamRequestList] * 2


def test_gaps_that_never_come_hold_up_no_others() -> None:
    never = range(3 * WINDOW)
    client, sent, _ = fetch(Lossy(200, range(WINDOW * 8), never))
    assert not client.complete
    assert client.problem == f"{3 * WINDOW} of 200 parameters missing after {TRIES} tries"
    assert {f"P{number:04}" for number in range(3 * WINDOW, 200)} == set(client.params)
    assert len(sent) < 200


def test_silence_ends() -> None:
    client, sent, _ = fetch(lambda request: [])
    assert client.problem == f"no list after {TRIES} tries"
    assert len(sent) == TRIES


def test_order_and_duplicates_do_not_matter() -> None:
    numbers = [*range(100), *range(0, 100, 3)]
    random.Random(4).shuffle(numbers)
    client, sent, _ = fetch(lambda request: [value(number, 100) for number in numbers])
    assert client.complete
    assert client.progress == (100, 100)
    assert len(sent) == 1


def test_a_count_that_changes_on_the_way_begins_anew() -> None:
    """A feature that is switched on adds a parameter in front: the indexes of all others move."""

    def answer(request: m.Message) -> Iterable[m.ParamValue]:
        names = [f"N{number:03}".encode() for number in range(151)]
        if isinstance(request, m.ParamRequestList) and not lists:
            lists.append(1)
            old = [value(number, 150, names[number + 1]) for number in range(80)]
            return [*old, *(value(number, 151, names[number]) for number in range(80, 151))]
        numbers = range(151) if isinstance(request, m.ParamRequestList) else [request.param_index]  # type: ignore[attr-defined]
        return [value(number, 151, names[number]) for number in numbers]

    lists: list[int] = []
    client, _, _ = fetch(answer)
    assert client.complete
    assert client.progress == (151, 151)
    assert len(client.params) == 151


def test_a_count_that_never_settles_ends() -> None:
    counts = iter(range(10, 10_000))
    client, sent, _ = fetch(lambda request: [value(0, next(counts))])
    assert client.problem == "the number of parameters keeps changing"
    assert len(sent) <= MAX_COUNT_CHANGES + 2


def test_an_endless_flood_of_names_is_bounded() -> None:
    client = ParamClient(255, 190, target_system=1)
    client.fetch(0.0)
    for number in range(MAX_PARAMS + 100):
        client.receive(from_vehicle(m.ParamValue(f"X{number}".encode(), 1.0, REAL32, 65535, 65535)), 0.1)
    assert len(client.params) == MAX_PARAMS


def test_indexes_beyond_the_count_are_not_counted() -> None:
    client = ParamClient(255, 190, target_system=1)
    client.fetch(0.0)
    client.receive(from_vehicle(value(5, 5)), 0.1)
    client.receive(from_vehicle(m.ParamValue(b"_HASH_CHECK", 1.0, 5, 5, 65535)), 0.1)
    assert client.progress == (0, None)
    assert "_HASH_CHECK" not in client.params


def test_names_of_16_bytes_that_are_not_ascii_stay_apart() -> None:
    one, other = b"\xff\xfe" * 8, b"\xff\xfd" * 8
    client = ParamClient(255, 190, target_system=1)
    client.fetch(0.0)
    for index, raw in enumerate((one, other)):
        client.receive(from_vehicle(value(index, 2, raw)), 0.1)
    assert client.complete
    assert list(client.params) == ["\\xff\\xfe" * 8, "\\xff\\xfd" * 8]
    client.messages_to_send()
    client.set("\\xff\\xfd" * 8, 7.0, 0.2)
    [outgoing] = client.messages_to_send()
    assert isinstance(outgoing.message, m.ParamSet)
    assert outgoing.message._param_id_raw == other
    client.receive(from_vehicle(m.ParamValue(other, 7.0, REAL32, 2, 1)), 0.3)
    assert [outcome.done for outcome in client.outcomes()] == [True]


def test_another_component_has_parameters_of_its_own() -> None:
    client = ParamClient(255, 190, target_system=1)
    client.fetch(0.0)
    client.receive(from_vehicle(value(0, 1), component=100), 0.1)
    assert client.params == {}


def test_values_loaded_from_file_are_complete_and_keep_defaults() -> None:
    client = ParamClient(255, 190, target_system=1)
    client.load([Param("A", 1.0, REAL32, None, default=2.0), Param("B", 3.0, REAL32, None)])
    assert client.complete
    client.receive(from_vehicle(m.ParamValue(b"A", 5.0, REAL32, 2, 0)), 0.1)
    assert client.params["A"] == Param("A", 5.0, REAL32, 0, default=2.0)


@pytest.mark.parametrize("gaps", [LIST_AGAIN, LIST_AGAIN + 1])
def test_where_single_reads_end_and_lists_begin(gaps: int) -> None:
    _, sent, _ = fetch(Lossy(500, range(gaps)))
    assert isinstance(sent[1], m.ParamRequestRead if gaps <= LIST_AGAIN else m.ParamRequestList)


def test_only_what_is_missing_is_requested_again() -> None:
    vehicle = Lossy(200, range(50, 60), never=range(50, 60))
    client, _, now = fetch(vehicle)
    assert client.missing == tuple(range(50, 60))
    vehicle.never.clear()
    client.fetch_missing(now)
    assert client.missing == (), "they are being fetched"
    sent: list[m.Message] = []
    while client.fetching:
        now += 0.1
        client.tick(now)
        for request in [each.message for each in client.messages_to_send()]:
            sent.append(request)
            for message in vehicle(request):
                client.receive(from_vehicle(message), now)
    assert client.complete
    assert [each.param_index for each in sent if isinstance(each, m.ParamRequestRead)] == list(range(50, 60))
    assert len(sent) == 10, "not the whole list"
