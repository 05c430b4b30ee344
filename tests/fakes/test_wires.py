"""Messages that pymavlink frames for a fake vehicle arrive as the project's own codec has them."""

from __future__ import annotations

from pymavlink.dialects.v20 import ardupilotmega as mav

from dialects import codec
from dialects import messages as m
from link.core import Outgoing
from tests.fakes.wires import ChannelWire, PymavlinkWire
from tests.rows import each_row

EXTENDED = {"MISSION_CURRENT", "MISSION_COUNT", "MISSION_ACK", "SET_ATTITUDE_TARGET", "TIMESYNC"}
"""Have extension fields that only one of the two dialects knows."""
SAME = [number for number, kind in m.MESSAGES.items() if number in mav.mavlink_map and kind.msgname not in EXTENDED]


@each_row("number", SAME, ids=lambda number: str(m.MESSAGES[number].msgname))
def test_pymavlink_carries_every_message_unchanged(number: int) -> None:
    sent = codec.decode(number, bytes([1]) * m.MESSAGES[number].unpacker.size)
    near, far = PymavlinkWire(), PymavlinkWire()
    near.open(1, 1, stream=False)
    far.open(255, 190, stream=False)
    [received] = far.receive(b"".join(near.frames(Outgoing(sent), 0.0)), 0.0)
    assert (received.system, received.component, type(received.message)) == (1, 1, type(sent))
    assert codec.encode_payload(received.message) == codec.encode_payload(sent)


def test_a_wire_sends_mavlink_1_on_request() -> None:
    wire = PymavlinkWire(mavlink1=True)
    wire.open(1, 1, stream=False)
    [frame] = wire.frames(Outgoing(m.Heartbeat(10, 3, 81, 0, 3, 3)), 0.0)
    assert frame[0] == codec.MAGIC_V1


def test_a_key_signs_until_it_is_switched_off() -> None:
    wire = PymavlinkWire(key=bytes(range(32)))
    wire.open(1, 1, stream=False)
    beat = Outgoing(m.Heartbeat(10, 3, 81, 0, 3, 3))
    [signed] = wire.frames(beat, 0.0)
    wire.signs = False
    [plain] = wire.frames(beat, 0.0)
    assert (signed[2], plain[2]) == (codec.INCOMPAT_SIGNED, 0)


def test_a_message_of_our_dialect_alone_is_carried() -> None:
    wire, far = PymavlinkWire(), ChannelWire()
    wire.open(1, 1, stream=False)
    far.open(255, 190, stream=False)
    sent = m.ControlStatus(1, 255, [0] * 10)
    [received] = far.receive(b"".join(wire.frames(Outgoing(sent), 0.0)), 0.0)
    assert codec.encode_payload(received.message) == codec.encode_payload(sent)
