"""The driver by itself: what is from it, when another may succeed it, and when its demands do not count."""

from __future__ import annotations

import pytest

from tests.vehicle.conversations import conversation
from vehicle.drive.driver import CLASH_PAUSE, SUCCESSION_TIME, Driver
from vehicle.drive.operator_session import PROOF_VALID, DrivingSession, Proof

GCS = conversation(255, numbering=1)
TWINS = [
    GCS._replace(system=254),
    GCS._replace(component=1),
    GCS._replace(numbering=2),
    GCS._replace(peer=GCS.peer._replace(address="elsewhere")),
]
FOREIGN, SESSION = False, True


def driver(session: bool, *, demand_at: float = 10.0) -> Driver:
    proof = Proof(session=7, clock=1, age=0.1)
    return Driver(GCS, DrivingSession.begin(GCS, proof, 10.0) if session else None, 10.0, demand_at=demand_at)


def test_bounds() -> None:
    assert (SUCCESSION_TIME, CLASH_PAUSE) == (0.7, 0.7)
    assert driver(FOREIGN).name == "255/190"


@pytest.mark.parametrize("session", [FOREIGN, SESSION])
def test_only_its_own_conversation_is_the_driver(session: bool) -> None:
    assert driver(session).is_sender(GCS, 10.0)
    assert not any(driver(session).is_sender(twin, 10.0) for twin in TWINS)


def test_a_session_must_have_been_proven_lately() -> None:
    assert driver(SESSION).is_sender(GCS, 10.0 + PROOF_VALID)
    assert not driver(SESSION).is_sender(GCS, 10.1 + PROOF_VALID)
    assert driver(FOREIGN).is_sender(GCS, 100.0)


@pytest.mark.parametrize(
    ("session", "demand_at", "by_session", "after"),
    [(SESSION, 10.0, True, 0.7), (SESSION, 10.0, False, 5.0), (FOREIGN, 10.0, True, 0.7), (FOREIGN, 10.0, False, 0.7),
     (FOREIGN, 9.3, False, 0.7), (FOREIGN, 9.29, False, 5.0), (FOREIGN, 9.29, True, 5.0)],
)  # fmt: skip
def test_when_it_may_be_succeeded(session: bool, demand_at: float, by_session: bool, after: float) -> None:
    silent = driver(session, demand_at=demand_at)
    assert not silent.may_be_succeeded(10.0 + after, by_session=by_session, timeout=5.0)
    assert silent.may_be_succeeded(10.01 + after, by_session=by_session, timeout=5.0)


def test_after_a_silence_it_says_something_new_before_it_drives() -> None:
    present = driver(FOREIGN)
    assert not present.is_copy
    present.hear(10.7, is_demand=True, repeated=True)
    assert not present.is_copy
    present.hear(11.41, is_demand=True, repeated=True)
    assert present.is_copy
    present.hear(11.5, is_demand=False, repeated=False)
    assert not present.is_copy
    present.hear(11.6, is_demand=False, repeated=True)
    assert not present.is_copy
    assert (present.last_heard, present.demand_at) == (11.6, 11.41)


def test_after_a_silence_something_new_counts_at_once() -> None:
    present = driver(FOREIGN)
    present.hear(20.0, is_demand=True, repeated=False)
    assert not present.is_copy


def test_it_is_barred_for_a_time() -> None:
    present = driver(FOREIGN)
    assert not present.is_barred(10.0)
    present.barred_until = 10.7
    assert present.is_barred(10.69)
    assert not present.is_barred(10.7)
