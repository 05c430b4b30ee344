"""Target offsets of raw frames against the generated codec."""

from __future__ import annotations

from dialects import codec
from dialects.messages import (
    MESSAGES,
    ManualControl,
)
from dialects.targets import TARGETS, target_of


def test_offsets_of_targets_are_those_of_the_generated_codec() -> None:
    for number, (system, component) in TARGETS.items():
        payload = bytearray(MESSAGES[number].unpacker.size)
        payload[system] = 77
        if component is not None:
            payload[component] = 88
        message = codec.decode(number, bytes(payload))
        assert getattr(message, "target_system", getattr(message, "target", None)) == 77
        assert getattr(message, "target_component", 88) == 88
        raw = codec.frame(number, bytes(payload).rstrip(b"\0"), 0, 1, 1)
        assert target_of(number, raw) == (77, 0 if component is None else 88)
    fields = {number for number, message in MESSAGES.items() if "target_system" in message.fieldnames}
    assert fields | {ManualControl.id} == TARGETS.keys()
