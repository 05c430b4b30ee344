"""The endpoints used before: their order, what is pushed out, and what a damaged text leads to."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.recent.recent import LIMIT, MAX_TEXT, RecentEndpoints, RecentError, decode, encode

ENDPOINTS = [f"udpin:127.0.0.1:{14550 + number}" for number in range(LIMIT + 5)]


def used(*endpoints: str) -> RecentEndpoints:
    recent = RecentEndpoints()
    for number, endpoint in enumerate(endpoints):
        recent = recent.add(endpoint, 1000.0 + number)
    return recent


def names(recent: RecentEndpoints) -> list[str]:
    return [each.endpoint for each in recent.entries]


def test_the_last_one_used_comes_first_and_none_comes_twice() -> None:
    a, b, c = ENDPOINTS[:3]
    recent = used(a, b, c, a)
    assert names(recent) == [a, c, b]
    assert recent.last == a
    assert RecentEndpoints().last is None


def test_the_order_does_not_depend_on_the_clock() -> None:
    a, b = ENDPOINTS[:2]
    recent = RecentEndpoints().add(a, 2000.0).add(b, 10.0)
    assert recent.last == b


def test_a_name_stays_until_another_one_is_heard() -> None:
    recent = RecentEndpoints().add(ENDPOINTS[0], 1.0, "Rover 1").add(ENDPOINTS[0], 2.0)
    assert (recent.entries[0].vehicle, recent.entries[0].used) == ("Rover 1", 2.0)
    assert recent.add(ENDPOINTS[0], 3.0, "Rover 2").entries[0].vehicle == "Rover 2"


def test_name_from_wire_is_cut_and_without_control_characters() -> None:
    name = RecentEndpoints().add(ENDPOINTS[0], 1.0, "\x1b[31mRover\n" + "x" * 999).entries[0].vehicle
    assert name.startswith("[31mRoverx")
    assert len(name) == MAX_TEXT


def test_beyond_the_limit_the_oldest_not_pinned_is_forgotten() -> None:
    recent = used(*ENDPOINTS[:LIMIT]).pin(ENDPOINTS[0])
    recent = recent.add(ENDPOINTS[LIMIT], 5000.0)
    assert len(recent.entries) == LIMIT
    assert recent.last == ENDPOINTS[LIMIT]
    assert ENDPOINTS[0] in names(recent)
    assert ENDPOINTS[1] not in names(recent)


def test_if_all_are_pinned_a_new_one_pushes_the_oldest_out() -> None:
    recent = used(*ENDPOINTS[:LIMIT])
    for endpoint in ENDPOINTS[:LIMIT]:
        recent = recent.pin(endpoint)
    recent = recent.add(ENDPOINTS[LIMIT], 5000.0)
    assert names(recent) == [ENDPOINTS[LIMIT], *reversed(ENDPOINTS[1:LIMIT])]


def test_pinned_ones_come_first_and_can_be_unpinned() -> None:
    a, b, c = ENDPOINTS[:3]
    recent = used(a, b, c).pin(a)
    assert [each.endpoint for each in recent.listed] == [a, c, b]
    assert recent.last == c
    assert [each.endpoint for each in recent.pin(a, False).listed] == [c, b, a]
    assert names(recent.forget(a)) == [c, b]
    assert recent.forget("udpin:127.0.0.1:1") == recent.pin("udpin:127.0.0.1:1") == recent


def test_what_is_no_endpoint_is_not_added() -> None:
    with pytest.raises(ValueError, match="it must be one of"):
        RecentEndpoints().add("carrier:pigeon", 1.0)


@given(
    st.lists(st.tuples(st.sampled_from(ENDPOINTS), st.floats(0, 1e10), st.text(max_size=300), st.booleans()))
)  # fmt: skip
def test_what_is_encoded_is_decoded(steps: list[tuple[str, float, str, bool]]) -> None:
    recent = RecentEndpoints()
    for endpoint, now, vehicle, pinned in steps:
        recent = recent.add(endpoint, now, vehicle).pin(endpoint, pinned)
    assert decode(encode(recent)) == recent


@pytest.mark.parametrize(
    "text",
    [
        "", "[]", "null", "{", "\xff", '{"entries": 3}', '{"entries": [], "more": 1}', "[" * 100_000,
        '{"entries": [{"endpoint": "udpin:127.0.0.1:1"}]}',
        '{"entries": [{"endpoint": "carrier:pigeon", "used": 1}]}',
        '{"entries": [{"endpoint": "udpin:127.0.0.1:1", "used": 1e999}]}',
        '{"entries": [{"endpoint": "udpin:127.0.0.1:1", "used": -1}]}',
        '{"entries": [{"endpoint": "udpin:127.0.0.1:1", "used": 1, "vehicle": "\\u001b[2J"}]}',
        '{"entries": [{"endpoint": "udpin:127.0.0.1:1", "used": 1}, {"endpoint": "udpin:127.0.0.1:1", "used": 1}]}',
    ],
)  # fmt: skip
def test_a_text_of_another_origin_is_an_error_of_one_line(text: str) -> None:
    with pytest.raises(RecentError) as error:
        decode(text.encode("latin-1"))
    assert "\n" not in str(error.value)


@given(st.binary(max_size=200))
def test_no_bytes_do_more_than_be_refused(data: bytes) -> None:
    with pytest.raises(RecentError):
        decode(data)
