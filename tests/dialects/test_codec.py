"""Our encoder and decoder against pymavlink's own, message by message, and golden bytes of every message we send."""

from __future__ import annotations

import ast
import json
import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from dialects import codec, messages, rover
from dialects.messages import (
    MESSAGES,
    CommandInt,
    CommandLong,
    Heartbeat,
    ManualControl,
    Message,
    RoverDriveStatus,
    StatusText,
    boot_ms,
    decode_text,
    is_stop,
    printable,
)

GOLDEN = Path(__file__).with_name("golden_frames.json")
"""Message name -> [frame in hex, fields]. Nobody may edit a line: vehicles in the field were built with these bytes."""


def plain_decode(data: bytes) -> rover.MAVLink_message:
    """What bare pymavlink makes of one frame."""
    parser = rover.MAVLink(None)
    messages = parser.parse_buffer(data)
    assert messages is not None
    assert len(messages) == 1
    return messages[0]


@pytest.mark.parametrize("name", sorted(json.loads(GOLDEN.read_text())))
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


@pytest.mark.parametrize("number", sorted(MESSAGES))
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


def test_text_is_utf8_and_harmless_to_a_terminal() -> None:
    raw = "Akku schwach: 9,8 V \x1b[2J\N{HEAVY BLACK HEART}".encode()
    message = codec.decode(StatusText.id, codec.encode_payload(StatusText(severity=4, text=raw)))
    assert isinstance(message, StatusText)
    assert decode_text(message) == "Akku schwach: 9,8 V \ufffd[2J\N{HEAVY BLACK HEART}"
    assert printable("a\nb\x7f\x9b") == "a\ufffdb\ufffd\ufffd"


def test_boot_time_wraps_instead_of_raising() -> None:
    assert boot_ms(0.0) == 0
    assert boot_ms(2**32 / 1000 + 1.5) == 1500


@pytest.mark.parametrize(
    ("command", "param1", "stops"),
    [
        *((400, 0.0, True), (400, 1.0, False), (5300, 0.0, True), (5300, 1.0, False), (176, 0.0, False)),
        *((185, 1.0, True), (185, 0.0, False), (185, math.nan, False)),
    ],
)
def test_what_counts_as_a_stop(command: int, param1: float, stops: bool) -> None:
    assert is_stop(CommandLong(1, 1, command, 0, param1, 0, 0, 0, 0, 0, 0)) is stops
    assert is_stop(CommandInt(1, 1, 0, command, 0, 0, param1, 0, 0, 0, 0, 0, 0)) is stops
