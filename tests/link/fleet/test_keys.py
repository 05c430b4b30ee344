"""A frame counts only under the key of its own message, role and sender."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects import rover
from link.fleet.keys import MAX_KEYS, FleetKeys, KeyReader, read_frame
from tests.link.frames import demand, frame, heartbeat
from tests.rows import each_row

ALICE = FleetKeys("farm", "", "alice/1")
ROVER = FleetKeys("farm", "rover1", None)
TO_ALICE, TO_ROVER = KeyReader(ALICE), KeyReader(ROVER)
ARM = frame(m.CommandLong(1, 1, rover.MAV_CMD_COMPONENT_ARM_DISARM, 0, 1, 0, 0, 0, 0, 0, 0))
DISARM = frame(m.CommandLong(1, 1, rover.MAV_CMD_COMPONENT_ARM_DISARM, 0, 0, 0, 0, 0, 0, 0, 0))
BASE = "fleet/farm/rover1/down/alice/1"


def key(data: bytes, keys: FleetKeys = ALICE, address: str = "rover1") -> str:
    found = read_frame(data)
    assert found is not None
    return keys.place(found, address)


@pytest.mark.parametrize(
    ("data", "tail"),
    [
        (heartbeat(0), "watch/ctl/HEARTBEAT"),
        (demand(0), "drive/ctl/MANUAL_CONTROL"),
        (ARM, "drive/cmd/COMMAND_LONG"),
        (DISARM, "watch/cmd/COMMAND_LONG"),
        (frame(m.ParamSet(1, 1, b"A", 1.0, 9)), "setup/rel/PARAM_SET"),
        (frame(m.RequestDataStream(1, 1, 0, 4, 1)), "drive/tlm/REQUEST_DATA_STREAM"),
    ],
)
def test_a_frame_to_a_vehicle_and_back_from_its_key(data: bytes, tail: str) -> None:
    assert key(data) == f"{BASE}/{tail}"
    for _ in range(2):  # the second time from its memory
        found = TO_ROVER.read(key(data), data)
        assert found is not None
        assert (found[0].sender, found[1]) == ("alice/1", read_frame(data))


def test_a_frame_to_a_ground_station() -> None:
    beat = heartbeat(0, system=1, component=1)
    assert key(beat, ROVER, "alice/1") == "fleet/farm/rover1/up/alice/1/ctl/HEARTBEAT"
    found = TO_ALICE.read(key(beat, ROVER, "alice/1"), beat)
    assert found is not None
    assert (found[0].sender, found[0].is_telemetry) == ("rover1", False)


@pytest.mark.parametrize(
    ("name", "data"),
    [
        ("a command as a heartbeat", ARM),
        ("a demand as a heartbeat", demand(0)),
        ("two frames", heartbeat(0) + demand(1)),
        ("a frame in the bytes of a damaged one", heartbeat(0)[:-1] + b"\xff" + demand(1)),
        ("half a frame", heartbeat(0)[:-3]),
        ("a byte before it", b"\0" + heartbeat(0)),
        ("nothing", b""),
    ],
)
def test_what_hides_under_the_key_of_a_heartbeat_is_refused(name: str, data: bytes) -> None:
    assert TO_ROVER.read(f"{BASE}/watch/ctl/HEARTBEAT", heartbeat(0)) is not None
    assert TO_ROVER.read(f"{BASE}/watch/ctl/HEARTBEAT", data) is None, name


@pytest.mark.parametrize(
    "wrong",
    [
        f"{BASE}/watch/cmd/COMMAND_LONG",  # arming needs drive
        f"{BASE}/setup/cmd/COMMAND_LONG",
        f"{BASE}/drive/ctl/COMMAND_LONG",
        f"{BASE}/drive/cmd/COMMAND_INT",
        f"{BASE}/drive/cmd",
        "fleet/farm/rover1/down/alice",
        "",
    ],
)
def test_a_command_counts_only_under_its_role_and_class(wrong: str) -> None:
    assert TO_ROVER.read(f"{BASE}/drive/cmd/COMMAND_LONG", ARM) is not None
    assert TO_ROVER.read(wrong, ARM) is None


@pytest.mark.parametrize("role", ["drive", "setup"])
def test_a_lesser_frame_does_not_count_under_a_higher_role(role: str) -> None:
    assert TO_ROVER.read(f"{BASE}/watch/cmd/COMMAND_LONG", DISARM) is not None
    assert TO_ROVER.read(f"{BASE}/{role}/cmd/COMMAND_LONG", DISARM) is None


HOLD = frame(m.SetMode(1, 1, 4))
MODE_0 = frame(m.SetMode(1, 1, 0))


def test_a_hold_may_come_under_watch_where_its_use_is_checked() -> None:
    for role, conditional in (("drive", False), ("watch", True)):
        found = TO_ROVER.read(f"{BASE}/{role}/cmd/SET_MODE", HOLD)
        assert found is not None
        assert found[0].is_conditional(found[1]) is conditional
    assert TO_ROVER.read(f"{BASE}/setup/cmd/SET_MODE", HOLD) is None
    assert TO_ROVER.read(f"{BASE}/watch/cmd/SET_MODE", MODE_0) is None


def test_tokens() -> None:
    assert ALICE.read_token(ROVER.token("")) == "rover1"
    assert ROVER.read_token(ALICE.token("rover1")) == "alice/1"
    assert (ALICE.others, ROVER.others) == ("fleet/farm/*/alive", "fleet/farm/rover1/gcs/**")
    assert ALICE.read_token(ALICE.token("rover1")) is None
    brief = ALICE.brief_token("rover1")
    assert brief == "fleet/farm/rover1/gcs/alice/1/brief"
    assert (ROVER.read_brief(brief), ROVER.read_token(brief)) == ("alice/1", None)
    assert (ROVER.read_brief(ALICE.token("rover1")), ALICE.read_brief(brief)) == (None, None)
    assert ROVER.read_token("fleet/farm/rover1/alive") is None
    assert FleetKeys("farm", "rover1", "alice/1").others == "fleet/farm/rover1/alive"


def test_an_unknown_message_is_under_its_number() -> None:
    unknown = bytes([0xFD, 1, 0, 0, 7, 1, 1, 0x48, 0xEE, 0, 5, 1, 2])
    assert key(unknown).endswith("/setup/tlm/ID61000")
    assert TO_ROVER.read(key(unknown), unknown) is not None


def test_keys_that_nobody_uses_again_are_bounded() -> None:
    reader = KeyReader(ALICE)
    for number in range(MAX_KEYS + 10):
        reader.find(f"fleet/farm/v{number}/up/alice/1/ctl/HEARTBEAT")
    assert len(reader._places) == 10
    place = reader.find("fleet/farm/v1/up/alice/1/ctl/HEARTBEAT")
    assert place is not None
    assert place.sender == "v1"


@each_row(
    "word",
    [
        *("ID0", "ID061000", "ID", "IDx", "heartbeat", "ID²", "ID\u0666\u0661\u0660\u0660\u0660", "XX61000", "IDNone"),
        *("ID100000000", "ID" + "1" * 5000),
    ],
)
def test_a_message_has_one_name(word: str) -> None:
    assert ALICE.parse(f"fleet/farm/v1/up/alice/1/tlm/{word}") is None


def test_the_largest_id_has_a_name() -> None:
    place = ALICE.parse("fleet/farm/v1/up/alice/1/tlm/ID16777215")
    assert place is not None
    assert (place.message_id, place.is_telemetry) == (0xFFFFFF, True)


@pytest.mark.parametrize("middle", ["", "alice/", "alice/1/2/", "alice/1/2/3/"])
def test_a_key_to_a_station_has_eight_chunks(middle: str) -> None:
    assert ALICE.parse("fleet/farm/v1/up/alice/1/ctl/HEARTBEAT") is not None
    assert ALICE.parse(f"fleet/farm/v1/up/{middle}ctl/HEARTBEAT") is None


@pytest.mark.parametrize("role", ["", "watch/watch/", "watch/watch/watch/"])
def test_a_key_to_a_vehicle_has_one_role(role: str) -> None:
    assert ROVER.parse(f"{BASE}/watch/ctl/HEARTBEAT") is not None
    assert ROVER.parse(f"{BASE}/{role}ctl/HEARTBEAT") is None


def test_frames_arrive_under_the_own_name_only() -> None:
    assert ALICE.frames == "fleet/farm/*/up/alice/1/**"
    assert ROVER.frames == "fleet/farm/rover1/down/*/*/**"


@pytest.mark.parametrize("key", ["fleet/farm/rover1/other", "fleet/farm/rover1/alive/more", "fleet/farm", ""])
def test_what_is_no_token_of_a_vehicle_names_none(key: str) -> None:
    assert ALICE.read_token(key) is None


@pytest.mark.parametrize("key", ["fleet/farm/rover1/up/alice/1", "fleet/farm/rover1/gcs/alice/1/2", "fleet/farm", ""])
def test_what_is_no_token_of_a_station_names_none(key: str) -> None:
    assert ROVER.read_token(key) is None


def test_what_is_no_token_of_a_brief_station_names_none() -> None:
    assert ROVER.read_brief("fleet/farm/rover1/gcs/alice/1/other") is None
    assert ALICE.read_brief("fleet/farm/rover1/alive/brief") is None


def test_a_header_without_its_frame_holds_up_no_other() -> None:
    reader = KeyReader(ROVER)
    assert reader.read(f"{BASE}/watch/ctl/HEARTBEAT", b"\xfd\xff\0\0\0\1\1\0\0\0") is None
    assert reader.read(f"{BASE}/watch/ctl/HEARTBEAT", heartbeat(0)) is not None
