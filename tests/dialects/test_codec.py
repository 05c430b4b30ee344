"""Our encoder and decoder against pymavlink's own, message by message, and golden bytes of every message we send."""

from __future__ import annotations

import ast
import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from dialects import codec, messages, rover
from dialects.messages import (
    MESSAGES,
    Heartbeat,
    ManualControl,
    Message,
    RoverDriveStatus,
)
from tests.rows import each_row

GOLDEN = Path(__file__).with_name("golden_frames.json")
"""Message name -> [frame in hex, fields]. Nobody may edit a line: vehicles in the field were built with these bytes."""


def plain_decode(data: bytes) -> rover.MAVLink_message:
    """What bare pymavlink makes of one frame."""
    parser = rover.MAVLink(None)
    messages = parser.parse_buffer(data)
    assert messages is not None
    assert len(messages) == 1
    return messages[0]


@each_row("name", sorted(json.loads(GOLDEN.read_text())))
def test_golden_bytes_are_what_we_send_and_what_pymavlink_reads(name: str) -> None:
    frame_hex, fields = json.loads(GOLDEN.read_text())[name]
    data = bytes.fromhex(frame_hex)
    message = plain_decode(data)
    assert message.get_type() == name
    for field, value in fields.items():
        assert getattr(message, field) == pytest.approx(value), field
    ours = codec.decode(message.get_msgId(), data[10 : 10 + data[1]])
    assert codec.frame(type(ours).id, codec.encode_payload(ours), data[4], data[5], data[6]) == data


def made_in(source: Path) -> set[str]:
    """Names of the messages that a file of ours makes."""
    classes = {
        name: each.msgname
        for name, each in vars(messages).items()
        if isinstance(each, type) and issubclass(each, Message)
    }
    calls = (node.func for node in ast.walk(ast.parse(source.read_text())) if isinstance(node, ast.Call))
    called = {each.attr if isinstance(each, ast.Attribute) else getattr(each, "id", "") for each in calls}
    return {classes[name] for name in called & classes.keys()}


def test_every_message_that_we_make_has_golden_bytes() -> None:
    root = Path(__file__).parents[2]
    sources = [
        path for folder in ("dialects", "link", "vehicle", "groundstation") for path in root.glob(f"{folder}/**/*.py")
    ]
    made = set().union(*(made_in(path) for path in sources if path.name != "rover.py" or path.parent.name == "vehicle"))
    assert len(made) > 40
    assert made <= json.loads(GOLDEN.read_text()).keys()


@each_row("number", sorted(MESSAGES))
def test_every_message_survives_the_way_there_and_back(number: int) -> None:
    size = MESSAGES[number].unpacker.size
    payload = bytes(1 + each % 120 for each in range(size))
    message = codec.decode(number, payload)
    assert codec.encode_payload(message) == payload
    assert plain_decode(codec.frame(number, payload, 7, 1, 1)).to_dict() == message.to_dict()


def test_trailing_zeros_are_cut_but_one_byte_stays() -> None:
    silent = ManualControl(target=0, x=0, y=0, z=0, r=0, buttons=0)
    assert codec.encode_payload(silent) == b"\0"
    assert codec.decode(ManualControl.id, b"\0").to_dict() == silent.to_dict()


def test_bytes_of_a_newer_definition_are_dropped() -> None:
    payload = codec.encode_payload(Heartbeat(10, 0, 1, 2, 3, 3)) + b"new"
    assert codec.decode(Heartbeat.id, payload).to_dict()["custom_mode"] == 2


@pytest.mark.parametrize("value", [40000, -40000, 12.7, None])
def test_a_field_that_does_not_fit_is_our_error(value: int) -> None:
    with pytest.raises(codec.EncodeError, match="MANUAL_CONTROL"):
        codec.encode_payload(ManualControl(target=1, x=value, y=0, z=0, r=0, buttons=0))


@given(st.sampled_from(sorted(MESSAGES)), st.binary(max_size=255))
def test_no_payload_raises(number: int, payload: bytes) -> None:
    codec.decode(number, payload)


def test_arrays_are_lists() -> None:
    status = codec.decode(46001, codec.encode_payload(RoverDriveStatus(1, 2, 3, 4, [5, 6, 7, 8], 9, 1, 2)))
    assert isinstance(status, RoverDriveStatus)
    assert status.output == [5, 6, 7, 8]
