"""The parameter protocol of the vehicle: every question answered, and what must not be set is not."""

from __future__ import annotations

import math

import pytest

from dialects import messages as m
from dialects.enums import ParamErrorCode
from link.core import Outgoing
from link.services.param.server import RUN_PERIOD, check_value
from link.services.param.values import REAL32
from tests.link.param_rig import TABLE, ParamRig, big_table, faults, values
from tests.link.services_world import OTHER_PEER, PEER, from_gcs, messages


def test_a_set_is_answered_to_all_with_the_value_in_force() -> None:
    vehicle = ParamRig()
    [outgoing] = vehicle.server.receive(from_gcs(m.ParamSet(1, 1, b"MAN_DEADBAND", 4.5, REAL32)), 0.0)
    value = outgoing.message
    assert isinstance(value, m.ParamValue)
    assert (value.param_id, value.param_value, value.param_type) == ("MAN_DEADBAND", 4.5, REAL32)
    assert (value.param_count, value.param_index) == (5, 1)
    assert outgoing.peer is None
    assert vehicle.changed == [("MAN_DEADBAND", 4.5)]


def test_setting_the_same_again_is_answered_and_changes_nothing() -> None:
    vehicle = ParamRig()
    assert values(vehicle.set("MAN_TIMEOUT", 0.45)) == [("MAN_TIMEOUT", 0.45)]
    assert vehicle.changed == []


def test_values_are_stored_as_people_write_them() -> None:
    vehicle = ParamRig()
    vehicle.set("MAN_TIMEOUT", 0.3)
    assert vehicle.values["MAN_TIMEOUT"] == 0.3


@pytest.mark.parametrize("value", [0.1, 0.9])
def test_bounds_are_allowed_though_float32_misses_them(value: float) -> None:
    assert faults(ParamRig().set("SIXTEEN_LETTERS_", value)) == []


@pytest.mark.parametrize(
    ("name", "value", "kind", "fault"),
    [
        ("MAN_DEADBAND", math.nan, REAL32, ParamErrorCode.VALUE_OUT_OF_RANGE),
        ("MAN_DEADBAND", math.inf, REAL32, ParamErrorCode.VALUE_OUT_OF_RANGE),
        ("MAN_DEADBAND", -math.inf, REAL32, ParamErrorCode.VALUE_OUT_OF_RANGE),
        ("MAN_DEADBAND", 20.01, REAL32, ParamErrorCode.VALUE_OUT_OF_RANGE),
        ("MAN_DEADBAND", -0.01, REAL32, ParamErrorCode.VALUE_OUT_OF_RANGE),
        ("INITIAL_MODE", 1.5, REAL32, ParamErrorCode.VALUE_OUT_OF_RANGE),
        ("MAN_DEADBAND", 4.0, 6, ParamErrorCode.TYPE_MISMATCH),
        ("MAN_DEADBAND", 4.0, 0, ParamErrorCode.TYPE_MISMATCH),
        ("VERSION", 8.0, REAL32, ParamErrorCode.READ_ONLY),
    ],
)
def test_a_mistake_is_answered_by_its_reason_and_the_old_value(
    name: str, value: float, kind: int, fault: ParamErrorCode
) -> None:
    vehicle = ParamRig()
    before = dict(vehicle.values)
    answers = vehicle.set(name, value, kind)
    assert [type(each) for each in answers] == [m.ParamError, m.ParamValue]
    assert faults(answers) == [fault]
    assert values(answers) == [(name, before[name])]
    assert vehicle.values == before
    assert vehicle.changed == []
    assert len(vehicle.said) == 1


@pytest.mark.parametrize("name", ["NO_SUCH", "MAN_TIMEOUT_LONGER_THAN_16", "\xff\xff", ""])
def test_an_unknown_name_is_answered_by_an_error_that_names_it(name: str) -> None:
    vehicle = ParamRig()
    [error] = vehicle.set(name, 1.0)
    assert isinstance(error, m.ParamError)
    assert (error.error, error.param_index) == (ParamErrorCode.DOES_NOT_EXIST, -1)
    assert error._param_id_raw == name.encode("latin-1")[:16]
    assert (error.target_system, error.target_component) == (255, 190)


def test_safety_settings_wait_until_it_is_disarmed() -> None:
    vehicle = ParamRig(armed=True)
    assert faults(vehicle.set("MAN_TIMEOUT", 1.0)) == [ParamErrorCode.PERMISSION_DENIED]
    assert vehicle.values["MAN_TIMEOUT"] == 0.45
    assert faults(vehicle.set("MAN_DEADBAND", 1.0)) == []
    vehicle.armed = False
    assert values(vehicle.set("MAN_TIMEOUT", 1.0)) == [("MAN_TIMEOUT", 1.0)]


def test_only_who_is_in_control_may_set() -> None:
    vehicle = ParamRig(allowed=False)
    assert faults(vehicle.set("MAN_DEADBAND", 1.0)) == [ParamErrorCode.PERMISSION_DENIED]
    assert vehicle.values["MAN_DEADBAND"] == 3.0


@pytest.mark.parametrize(("system", "component"), [(2, 1), (1, 42), (0, 0)])
def test_what_is_meant_for_others_is_not_answered(system: int, component: int) -> None:
    vehicle = ParamRig()
    for message in (
        m.ParamSet(system, component, b"MAN_DEADBAND", 1.0, REAL32),
        m.ParamRequestRead(system, component, b"MAN_DEADBAND", -1),
        m.ParamRequestList(system, component),
    ):
        assert vehicle.ask(message) == []
    assert vehicle.server.tick(0.1) == []
    assert vehicle.values["MAN_DEADBAND"] == 3.0


def test_strangers_get_nothing() -> None:
    vehicle = ParamRig()
    request = from_gcs(m.ParamRequestList(1, 1), introduced=False)
    assert vehicle.server.receive(request, 0.0) == []
    assert vehicle.server.tick(0.1) == []


# ---- reading ----


@pytest.mark.parametrize(("name", "index"), [(b"SIXTEEN_LETTERS_", -1), (b"", 2), (b"MAN_DEADBAND", 2)])
def test_reading_by_name_and_by_index(name: bytes, index: int) -> None:
    assert values(ParamRig().ask(m.ParamRequestRead(1, 1, name, index))) == [("SIXTEEN_LETTERS_", 0.1)]


@pytest.mark.parametrize(("name", "index"), [(b"", -2), (b"", 5), (b"", 32767), (b"", -32768), (b"NO_SUCH", -1)])
def test_what_cannot_be_read_is_answered_by_an_error(name: bytes, index: int) -> None:
    assert faults(ParamRig().ask(m.ParamRequestRead(1, 1, name, index))) == [ParamErrorCode.DOES_NOT_EXIST]


def test_what_the_vehicle_changes_itself_is_told_to_all() -> None:
    vehicle = ParamRig()
    vehicle.values.set("MAN_DEADBAND", 9.0)
    outgoing = vehicle.server.broadcast(["MAN_DEADBAND"])
    assert values(messages(outgoing)) == [("MAN_DEADBAND", 9.0)]
    assert [each.peer for each in outgoing] == [None]


# ---- lists ----


def collect(vehicle: ParamRig, start: float, seconds: float) -> list[Outgoing]:
    outgoing: list[Outgoing] = []
    for step in range(round(seconds / 0.02)):
        outgoing += vehicle.server.tick(start + step * 0.02)
    return outgoing


def test_a_list_is_paced_by_the_link() -> None:
    vehicle = ParamRig(rate=2000.0, table=big_table(200))
    vehicle.server.receive(from_gcs(m.ParamRequestList(1, 0)), 10.0)
    in_one_second = collect(vehicle, 10.0, 1.0)
    assert 1900 <= len(in_one_second) * 37 <= 2000 + 280
    rest = collect(vehicle, 11.0, 4.0)
    indexes = [each.message.param_index for each in in_one_second + rest]  # type: ignore[attr-defined]
    assert indexes == list(range(200))
    assert {each.peer for each in rest} == {PEER}


def test_a_hundred_requests_a_second_are_one_run_a_second() -> None:
    vehicle = ParamRig(table=big_table(30))
    sent = []
    for hundredth in range(100):
        now = 10.0 + hundredth / 100
        vehicle.server.receive(from_gcs(m.ParamRequestList(1, 1)), now)
        sent += vehicle.server.tick(now)
    assert len(sent) == 30
    assert len(collect(vehicle, 10.0 + RUN_PERIOD, 3.0)) == 30, "the last question is answered in its turn"


def test_two_peers_get_a_list_each() -> None:
    vehicle = ParamRig()
    for peer in (PEER, OTHER_PEER):
        vehicle.server.receive(from_gcs(m.ParamRequestList(1, 1), peer=peer), 0.0)
    sent = collect(vehicle, 0.0, 0.5)
    assert sorted(str(each.peer) for each in sent) == sorted([str(PEER)] * 5 + [str(OTHER_PEER)] * 5)


def test_floods_from_many_addresses_are_bounded() -> None:
    vehicle = ParamRig()
    for number in range(1000):
        vehicle.server.receive(from_gcs(m.ParamRequestList(1, 1), peer=PEER._replace(address=number)), 0.0)
    assert len(collect(vehicle, 0.0, 0.5)) <= 16 * 5


def test_check_says_why() -> None:
    refusal = check_value(TABLE[0], 9.0)
    assert refusal is not None
    assert refusal.reason == "9 is not in 0.2 to 2"
