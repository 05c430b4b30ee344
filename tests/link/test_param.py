"""The parameter protocol: every question answered, what must not be set is not, and a lossy link ends complete."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pymavlink import mavftp

from dialects import messages as m
from dialects.enums import ParamFault
from link.core import Outgoing
from link.services.pacing import Pacer
from link.services.param import RUN_PERIOD, ParamServer, check
from link.services.param_client import TRIES, ParamClient, ParamOutcome
from link.services.param_pack import pack
from link.services.param_values import REAL32, from_wire, shortest, to_wire
from tests.link.services_world import OTHER_PEER, PEER, Pair, from_gcs, from_vehicle, messages


@dataclass(frozen=True)
class Line:
    name: str
    default: float
    low: float = 0.0
    high: float = 100.0
    unit: str = ""
    description: str = ""
    whole: bool = False
    safety: bool = False
    needs_reboot: bool = False
    read_only: bool = False


TABLE = (
    Line("MAN_TIMEOUT", 0.45, 0.2, 2.0, safety=True),
    Line("MAN_DEADBAND", 3.0, 0.0, 20.0),
    Line("SIXTEEN_LETTERS_", 0.1, 0.1, 0.9),
    Line("INITIAL_MODE", 0, 0, 4, whole=True),
    Line("VERSION", 7, read_only=True),
)


class Memory(dict[str, float]):
    def set(self, name: str, value: float) -> None:
        self[name] = value


@dataclass
class Vehicle:
    """A server, and what it told its vehicle."""

    rate: float = 1e6
    table: tuple[Line, ...] = TABLE
    armed: bool = False
    allowed: bool = True
    changed: list[tuple[str, float]] = field(default_factory=list)
    said: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.values = Memory({line.name: line.default for line in self.table})
        self.server = ParamServer(
            self.table,
            self.values,
            system=1,
            component=1,
            pacer=Pacer(lambda peer: self.rate),
            allowed=lambda received: self.allowed,
            armed=lambda: self.armed,
            changed=lambda name, value: self.changed.append((name, value)),
            say=lambda text, now: self.said.append(text),
        )

    def ask(self, message: m.Message, now: float = 0.0) -> list[m.Message]:
        return messages(self.server.receive(from_gcs(message), now))

    def set(self, name: str, value: float, kind: int = REAL32) -> list[m.Message]:
        return self.ask(m.ParamSet(1, 1, name.encode("latin-1"), value, kind))


def values(answers: list[m.Message]) -> list[tuple[str, float]]:
    return [(each.param_id, shortest(each.param_value)) for each in answers if isinstance(each, m.ParamValue)]


def faults(answers: list[m.Message]) -> list[int]:
    return [each.error for each in answers if isinstance(each, m.ParamError)]


def test_a_set_is_answered_to_all_with_the_value_that_is_in_force() -> None:
    vehicle = Vehicle()
    [outgoing] = vehicle.server.receive(from_gcs(m.ParamSet(1, 1, b"MAN_DEADBAND", 4.5, REAL32)), 0.0)
    value = outgoing.message
    assert isinstance(value, m.ParamValue)
    assert (value.param_id, value.param_value, value.param_type) == ("MAN_DEADBAND", 4.5, REAL32)
    assert (value.param_count, value.param_index) == (5, 1)
    assert outgoing.peer is None
    assert vehicle.changed == [("MAN_DEADBAND", 4.5)]


def test_setting_the_same_again_is_answered_and_changes_nothing() -> None:
    vehicle = Vehicle()
    assert values(vehicle.set("MAN_TIMEOUT", 0.45)) == [("MAN_TIMEOUT", 0.45)]
    assert vehicle.changed == []


def test_values_are_stored_as_people_write_them() -> None:
    vehicle = Vehicle()
    vehicle.set("MAN_TIMEOUT", 0.3)
    assert vehicle.values["MAN_TIMEOUT"] == 0.3


@pytest.mark.parametrize("value", [0.1, 0.9])
def test_bounds_themselves_are_allowed_though_float32_misses_them(value: float) -> None:
    assert faults(Vehicle().set("SIXTEEN_LETTERS_", value)) == []


@pytest.mark.parametrize(
    ("name", "value", "kind", "fault"),
    [
        ("MAN_DEADBAND", math.nan, REAL32, ParamFault.VALUE_OUT_OF_RANGE),
        ("MAN_DEADBAND", math.inf, REAL32, ParamFault.VALUE_OUT_OF_RANGE),
        ("MAN_DEADBAND", -math.inf, REAL32, ParamFault.VALUE_OUT_OF_RANGE),
        ("MAN_DEADBAND", 20.01, REAL32, ParamFault.VALUE_OUT_OF_RANGE),
        ("MAN_DEADBAND", -0.01, REAL32, ParamFault.VALUE_OUT_OF_RANGE),
        ("INITIAL_MODE", 1.5, REAL32, ParamFault.VALUE_OUT_OF_RANGE),
        ("MAN_DEADBAND", 4.0, 6, ParamFault.TYPE_MISMATCH),
        ("MAN_DEADBAND", 4.0, 0, ParamFault.TYPE_MISMATCH),
        ("VERSION", 8.0, REAL32, ParamFault.READ_ONLY),
    ],
)
def test_what_is_wrong_is_answered_by_the_reason_and_then_the_old_value(
    name: str, value: float, kind: int, fault: ParamFault
) -> None:
    vehicle = Vehicle()
    before = dict(vehicle.values)
    answers = vehicle.set(name, value, kind)
    assert [type(each) for each in answers] == [m.ParamError, m.ParamValue]
    assert faults(answers) == [fault]
    assert values(answers) == [(name, before[name])]
    assert vehicle.values == before
    assert vehicle.changed == []
    assert len(vehicle.said) == 1


@pytest.mark.parametrize("name", ["NO_SUCH", "MAN_TIMEOUT_LONGER_THAN_16", "\xff\xff", ""])
def test_a_name_that_does_not_exist_is_answered_by_an_error_that_names_it(name: str) -> None:
    vehicle = Vehicle()
    [error] = vehicle.set(name, 1.0)
    assert isinstance(error, m.ParamError)
    assert (error.error, error.param_index) == (ParamFault.DOES_NOT_EXIST, -1)
    assert error._param_id_raw == name.encode("latin-1")[:16]
    assert (error.target_system, error.target_component) == (255, 190)


def test_safety_settings_wait_until_it_is_disarmed() -> None:
    vehicle = Vehicle(armed=True)
    assert faults(vehicle.set("MAN_TIMEOUT", 1.0)) == [ParamFault.PERMISSION_DENIED]
    assert vehicle.values["MAN_TIMEOUT"] == 0.45
    assert faults(vehicle.set("MAN_DEADBAND", 1.0)) == []
    vehicle.armed = False
    assert values(vehicle.set("MAN_TIMEOUT", 1.0)) == [("MAN_TIMEOUT", 1.0)]


def test_only_who_is_in_control_may_set() -> None:
    vehicle = Vehicle(allowed=False)
    assert faults(vehicle.set("MAN_DEADBAND", 1.0)) == [ParamFault.PERMISSION_DENIED]
    assert vehicle.values["MAN_DEADBAND"] == 3.0


@pytest.mark.parametrize(("system", "component"), [(2, 1), (1, 42), (0, 0)])
def test_what_is_meant_for_others_is_not_answered(system: int, component: int) -> None:
    vehicle = Vehicle()
    for message in (
        m.ParamSet(system, component, b"MAN_DEADBAND", 1.0, REAL32),
        m.ParamRequestRead(system, component, b"MAN_DEADBAND", -1),
        m.ParamRequestList(system, component),
    ):
        assert vehicle.ask(message) == []
    assert vehicle.server.tick(0.1) == []
    assert vehicle.values["MAN_DEADBAND"] == 3.0


def test_strangers_get_nothing() -> None:
    vehicle = Vehicle()
    request = from_gcs(m.ParamRequestList(1, 1), introduced=False)
    assert vehicle.server.receive(request, 0.0) == []
    assert vehicle.server.tick(0.1) == []


# ---- reading ----


@pytest.mark.parametrize(("name", "index"), [(b"SIXTEEN_LETTERS_", -1), (b"", 2), (b"MAN_DEADBAND", 2)])
def test_reading_by_name_and_by_index(name: bytes, index: int) -> None:
    assert values(Vehicle().ask(m.ParamRequestRead(1, 1, name, index))) == [("SIXTEEN_LETTERS_", 0.1)]


@pytest.mark.parametrize(("name", "index"), [(b"", -2), (b"", 5), (b"", 32767), (b"", -32768), (b"NO_SUCH", -1)])
def test_what_cannot_be_read_is_answered_by_an_error(name: bytes, index: int) -> None:
    assert faults(Vehicle().ask(m.ParamRequestRead(1, 1, name, index))) == [ParamFault.DOES_NOT_EXIST]


# ---- lists ----


def big_table(count: int) -> tuple[Line, ...]:
    return tuple(Line(f"P{number:03}", float(number), high=1000) for number in range(count))


def collect(vehicle: Vehicle, start: float, seconds: float) -> list[Outgoing]:
    outgoing: list[Outgoing] = []
    for step in range(round(seconds / 0.02)):
        outgoing += vehicle.server.tick(start + step * 0.02)
    return outgoing


def test_a_list_is_paced_by_the_link() -> None:
    vehicle = Vehicle(rate=2000.0, table=big_table(200))
    vehicle.server.receive(from_gcs(m.ParamRequestList(1, 0)), 10.0)
    in_one_second = collect(vehicle, 10.0, 1.0)
    assert 1900 <= len(in_one_second) * 37 <= 2000 + 280
    rest = collect(vehicle, 11.0, 4.0)
    indexes = [each.message.param_index for each in in_one_second + rest]  # type: ignore[attr-defined]
    assert indexes == list(range(200))
    assert {each.peer for each in rest} == {PEER}


def test_a_hundred_requests_a_second_are_one_run_a_second() -> None:
    vehicle = Vehicle(table=big_table(30))
    sent = []
    for hundredth in range(100):
        now = 10.0 + hundredth / 100
        vehicle.server.receive(from_gcs(m.ParamRequestList(1, 1)), now)
        sent += vehicle.server.tick(now)
    assert len(sent) == 30
    assert len(collect(vehicle, 10.0 + RUN_PERIOD, 3.0)) == 30, "the last question is answered in its turn"


def test_two_peers_get_a_list_each() -> None:
    vehicle = Vehicle()
    for peer in (PEER, OTHER_PEER):
        vehicle.server.receive(from_gcs(m.ParamRequestList(1, 1), peer=peer), 0.0)
    sent = collect(vehicle, 0.0, 0.5)
    assert sorted(str(each.peer) for each in sent) == sorted([str(PEER)] * 5 + [str(OTHER_PEER)] * 5)


def test_floods_from_many_addresses_are_bounded() -> None:
    vehicle = Vehicle()
    for number in range(1000):
        vehicle.server.receive(from_gcs(m.ParamRequestList(1, 1), peer=PEER._replace(address=number)), 0.0)
    assert len(collect(vehicle, 0.0, 0.5)) <= 16 * 5


# ---- the file ----


def unpack(data: bytes | None) -> Any:
    """What pymavlink's decoder makes of it."""
    assert data is not None
    decoded = mavftp.MAVFTP.ftp_param_decode(data)
    assert decoded is not None
    return decoded


def test_the_packed_file_reads_as_pymavlink_reads_it() -> None:
    values = Memory({line.name: line.default for line in TABLE})
    values["MAN_DEADBAND"] = 7.25
    plain = unpack(pack(TABLE, values))
    assert [(name.decode(), kind) for name, _, kind in plain.params] == [(line.name, 4) for line in TABLE]
    assert [shortest(value) for _, value, _ in plain.params] == [0.45, 7.25, 0.1, 0, 7]
    with_defaults = unpack(pack(TABLE, values, {"withdefaults": "1"}))
    assert [shortest(value) for _, value, _ in with_defaults.defaults] == [line.default for line in TABLE]
    assert [shortest(value) for _, value, _ in with_defaults.params] == [0.45, 7.25, 0.1, 0, 7]


@pytest.mark.parametrize(
    ("query", "names"), [({"start": "3"}, ["INITIAL_MODE", "VERSION"]), ({"count": "1"}, ["MAN_TIMEOUT"])]
)
def test_a_part_of_the_packed_file(query: dict[str, str], names: list[str]) -> None:
    values = Memory({line.name: line.default for line in TABLE})
    decoded = unpack(pack(TABLE, values, query))
    assert [name.decode() for name, _, _ in decoded.params] == names


@pytest.mark.parametrize("query", [{"start": "-1"}, {"start": "99"}, {"withdefaults": "x"}, {"withdefaults": "2"}])
def test_a_bad_query_is_no_file(query: dict[str, str]) -> None:
    assert pack(TABLE, Memory({line.name: 0.0 for line in TABLE}), query) is None


NAMES = st.text("ABCDEF_", min_size=1, max_size=16)


@given(st.lists(NAMES, min_size=1, max_size=40, unique=True))
def test_any_names_survive_packing(names: list[str]) -> None:
    table = tuple(Line(name, 1.0) for name in names)
    decoded = unpack(pack(table, Memory(dict.fromkeys(names, 2.0)), {"withdefaults": "1"}))
    assert [name.decode() for name, _, _ in decoded.params] == names


# ---- client ----


@settings(deadline=None, max_examples=25)
@given(st.integers(0, 10_000), st.sampled_from([0.0, 0.1, 0.3]))
def test_all_parameters_arrive_whatever_is_lost(seed: int, loss: float) -> None:
    vehicle = Vehicle(table=big_table(120))
    client = ParamClient(255, 190, target_system=1)
    pair = Pair(vehicle.server, client, loss=loss, seed=seed)
    client.fetch(pair.now)
    pair.run_until(lambda: not client.fetching, within=60.0)
    assert client.complete
    assert {param.name: param.value for param in client.params.values()} == dict(vehicle.values)


def test_a_whole_list_takes_one_question() -> None:
    vehicle = Vehicle(table=big_table(300))
    client = ParamClient(255, 190, target_system=1)
    pair = Pair(vehicle.server, client)
    client.fetch(pair.now)
    assert pair.run_until(lambda: client.complete, within=3.0) < 0.3
    assert pair.sent_by_client == 1


@settings(deadline=None, max_examples=25)
@given(st.integers(0, 10_000))
def test_a_set_over_a_lossy_link_ends_as_wanted(seed: int) -> None:
    vehicle = Vehicle()
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
    vehicle = Vehicle(armed=True)
    client = ParamClient(255, 190, target_system=1)
    client.set("MAN_TIMEOUT", 1.0, 100.0)
    refused = ending(client, Pair(vehicle.server, client))
    assert (refused.done, refused.fault) == (False, ParamFault.PERMISSION_DENIED)
    client.read("NO_SUCH", 100.0)
    unknown = ending(client, Pair(vehicle.server, client))
    assert (unknown.done, unknown.fault) == (False, ParamFault.DOES_NOT_EXIST)


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


# ---- numbers ----


@pytest.mark.parametrize("kind", [1, 2, 3, 4, 5, 6])
@pytest.mark.parametrize("bytewise", [True, False])
def test_whole_numbers_survive_both_ways_of_sending_them(kind: int, bytewise: bool) -> None:
    for value in (0, 1, 100, 127):
        assert from_wire(to_wire(value, kind, bytewise=bytewise), kind, bytewise=bytewise) == value
    if kind in (2, 4, 6):
        assert from_wire(to_wire(-5, kind, bytewise=bytewise), kind, bytewise=bytewise) == -5


@given(st.floats(width=32, allow_nan=False))
def test_the_shortest_number_is_the_same_float32(value: float) -> None:
    assert through_float32(shortest(value)) == value


def through_float32(value: float) -> float:
    return m.ParamValue.unpacker.unpack(m.ParamValue.unpacker.pack(value, 1, 0, b"A", REAL32))[0]  # type: ignore[no-any-return]


def test_check_says_why() -> None:
    refusal = check(TABLE[0], 9.0)
    assert refusal is not None
    assert refusal.reason == "9 is not in 0.2 to 2"
