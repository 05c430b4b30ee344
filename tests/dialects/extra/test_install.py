"""A user's dialect beside the built-in one: decoded as pymavlink decodes it, and nothing built in changes."""

from __future__ import annotations

import importlib
import struct
from collections.abc import Iterator
from pathlib import Path
from random import Random
from typing import Any

import pytest
from hypothesis import given

from dialects import codec, targets
from dialects import messages as m
from dialects.enum_names import enum_names, flag_names
from dialects.enums import Severity
from dialects.extra.errors import DialectError
from dialects.extra.notes import Note
from dialects.extra.option import use_dialect, used_dialect
from tests.dialects.extra.xml_texts import GRIPPER, TABLES, mutated, scope, with_message

DEBUG_VECT = 250
FIELD = '<field type="uint8_t" name="a"/>\n'


@pytest.fixture(autouse=True)
def restored() -> Iterator[None]:
    with scope():
        yield


def use(folder: Path, text: str) -> tuple[Note, ...]:
    (folder / "my.xml").write_text(text)
    return use_dialect(str(folder / "my.xml"))


def decoded(number: int, payload: bytes) -> dict[str, Any]:
    message = codec.decode(number, payload)
    assert isinstance(message, m.ExtraMessage)
    return message.values


def test_a_fingerprint_is_that_of_the_definitions(tmp_path: Path) -> None:
    assert used_dialect() == ""
    use(tmp_path, GRIPPER)
    first = used_dialect()
    (elsewhere := tmp_path / "elsewhere").mkdir()
    use(elsewhere, GRIPPER)
    assert used_dialect() == first != ""
    use(elsewhere, with_message(FIELD))
    assert used_dialect() != first


def test_messages_are_added_with_their_fields(tmp_path: Path) -> None:
    (note,) = use(tmp_path, GRIPPER)
    assert note == Note(
        f"dialect {tmp_path}/my.xml: 3 messages, 2 of them added: GRIPPER_STATUS, GRIPPER_COMMAND", Severity.INFO
    )
    payload = struct.pack("<3fHBB10sI", 1.5, -2.0, 0.25, 12100, 1, 3, b"left", 77)
    assert decoded(51000, payload) == {
        "force": [1.5, -2.0, 0.25], "supply": 12100, "mode": 1, "flags": 3, "label": b"left", "time_boot_ms": 77,
    }  # fmt: skip
    assert codec.encode_payload(codec.decode(51000, payload)) == payload.rstrip(b"\0")
    assert decoded(51000, payload[:14])["label"] == b""
    assert enum_names("GRIPPER_MODE") == {0: "OPEN", 1: "SHUT"}
    assert flag_names("GRIPPER_FLAGS", 3) == ("HOT", "HOLDS")
    kind = m.MESSAGES[51000]
    assert kind.fieldnames == ["mode", "supply", "flags", "label", "force", "time_boot_ms"]
    assert kind.fielddisplays_by_name == {"flags": "bitmask"}


def test_code_that_reads_any_field_finds_none_of_a_user(tmp_path: Path) -> None:
    use(tmp_path, GRIPPER)
    for number in (51000, 51001):
        message = codec.decode(number, b"\1")
        for name in ("time_boot_ms", "target_system", "target_component"):
            assert not hasattr(message, name)


def test_a_message_for_one_vehicle_is_routed_to_it(tmp_path: Path) -> None:
    use(tmp_path, GRIPPER)
    raw = codec.frame(51001, struct.pack("<HBB", 40, 7, 9), 0, 255, 190)
    assert targets.target_of(51001, raw) == (7, 9)
    assert 51000 not in targets.TARGETS


def test_a_message_with_the_built_in_definition_stays_built_in(tmp_path: Path) -> None:
    before = dict(m.MESSAGES)
    use_dialect("common.xml")
    assert before == m.MESSAGES
    assert type(codec.decode(0, b"\1")) is m.Heartbeat


def test_definition_replaces_built_in_message_that_nothing_reads(tmp_path: Path) -> None:
    number = DEBUG_VECT
    _, note = use(tmp_path, with_message(FIELD, head=f'id="{number}" name="MY_VECTOR"'))
    assert note.text == f"dialect {tmp_path}/my.xml replaces built-in definitions: MY_VECTOR"
    assert decoded(number, b"\7") == {"a": 7}
    assert codec.BASE_SIZE[number] == 1


def test_built_in_message_in_use_stays_and_a_warning_names_both(tmp_path: Path) -> None:
    ours = m.RoverControl.id
    text = with_message(FIELD, head=f'id="{ours}" name="MINE"').replace(
        "</messages>", f'<message id="50000" name="FREE">{FIELD}</message></messages>'
    )
    first, warning = use(tmp_path, text)
    assert first.text.endswith("2 messages, 1 of them added: FREE")
    assert warning.severity is Severity.WARNING
    assert warning.text == (
        f"{tmp_path}/my.xml:2: MINE (id {ours}) is not the built-in ROVER_CONTROL, which this program needs and keeps: "
        "messages of the other definition are dropped"
    )
    assert m.MESSAGES[ours] is m.RoverControl
    assert decoded(50000, b"\7") == {"a": 7}


def test_an_enum_of_nobody_is_refused_and_nothing_changes(tmp_path: Path) -> None:
    before = [dict(table) for table in TABLES]
    with pytest.raises(DialectError) as caught:
        use(tmp_path, with_message('<field type="uint8_t" name="a" enum="NO_ENUM"/>'))
    assert str(caught.value) == f"{tmp_path}/my.xml:3: field a: no enum 'NO_ENUM': include the file that has it"
    assert before == [dict(table) for table in TABLES]
    use(tmp_path, with_message('<field type="uint8_t" name="a" enum="MAV_TYPE"/>'))


def test_entries_are_added_to_a_built_in_enum_whose_names_stay(tmp_path: Path) -> None:
    entries = '<entry name="MAV_TYPE_MINE" value="199"/><entry name="MAV_TYPE_OTHER" value="6"/>'
    use(tmp_path, f'<mavlink><enums><enum name="MAV_TYPE">{entries}</enum></enums></mavlink>')
    assert (enum_names("MAV_TYPE")[199], enum_names("MAV_TYPE")[6]) == ("MINE", "GCS")


def test_without_a_file_nothing_is_said() -> None:
    assert use_dialect(None) == ()


def test_payloads_are_decoded_as_pymavlink_decodes_them() -> None:
    theirs = importlib.import_module("pymavlink.dialects.v20.storm32")
    use_dialect("storm32.xml")
    extra = sorted(number for number, kind in m.MESSAGES.items() if issubclass(kind, m.ExtraMessage))
    assert len(extra) > 50
    for number in extra:
        kind = theirs.mavlink_map[number]
        noise = Random(number).randbytes(kind.unpacker.size - 1)
        payload = bytes(each & 0x3F for each in noise) + b"\1"  # no NaN, which changes its bits when it is unpacked
        reference = theirs.MAVLink(None).decode(bytearray(codec.frame(number, payload, 1, 2, 3)))
        values = decoded(number, payload)
        assert list(values) == kind.ordered_fieldnames
        for name, value in values.items():
            assert repr(value) == repr(raw_value(reference, name)), (kind.msgname, name)
        assert codec.encode_payload(codec.decode(number, payload)) == payload


def raw_value(message: Any, name: str) -> Any:
    """Return a value as our decoder gives it: pymavlink makes str of texts."""
    raw = getattr(message, f"_{name}_raw", None)
    return getattr(message, name) if raw is None else raw.rstrip(b"\0")


@given(mutated())
def test_any_file_is_used_or_refused_in_one_clear_line(tmp_path_factory: pytest.TempPathFactory, text: bytes) -> None:
    file = tmp_path_factory.getbasetemp() / "any.xml"
    file.write_bytes(text)
    with scope():
        try:
            notes = use_dialect(str(file))
        except DialectError as error:
            line = str(error)
            assert line.startswith(f"{file}:")
            assert line.isprintable()
        else:
            assert all(note.text.isprintable() for note in notes)
            for number, kind in m.MESSAGES.items():
                if issubclass(kind, m.ExtraMessage):
                    assert codec.encode_payload(codec.decode(number, b"\1")) == b"\1"
