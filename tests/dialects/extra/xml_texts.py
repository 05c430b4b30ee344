"""Texts of definition files, and a scope for a dialect: the tables of the process are as before at its end."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from hypothesis import strategies as st

from dialects import codec, enum_names, messages, targets
from dialects.extra import option

TABLES: tuple[dict[Any, Any], ...] = (
    messages.MESSAGES, codec.CRC_EXTRA, codec.BASE_SIZE, codec._CHECKED, codec._DECODERS, codec._ENCODERS,
    targets.TARGETS, enum_names._added, option.USED,
)  # fmt: skip
"""Those that a dialect changes."""

GRIPPER = """<?xml version="1.0"?>
<mavlink>
  <include>minimal.xml</include>
  <dialect>7</dialect>
  <enums>
    <enum name="GRIPPER_MODE">
      <description>What it does.</description>
      <entry name="GRIPPER_MODE_OPEN" value="0"><description>Open.</description></entry>
      <entry name="GRIPPER_MODE_SHUT"/>
    </enum>
    <enum name="GRIPPER_FLAGS" bitmask="true">
      <entry name="GRIPPER_FLAGS_HOT" value="0b1"/>
      <entry name="GRIPPER_FLAGS_HOLDS" value="2**1"/>
    </enum>
  </enums>
  <messages>
    <message id="51000" name="GRIPPER_STATUS">
      <description>State of the gripper.</description>
      <field type="uint8_t" name="mode" enum="GRIPPER_MODE">Mode.</field>
      <field type="uint16_t" name="supply" units="mV">Voltage.</field>
      <field type="uint8_t" name="flags" enum="GRIPPER_FLAGS">Flags.</field>
      <field type="char[10]" name="label">Label.</field>
      <field type="float[3]" name="force">Force.</field>
      <extensions/>
      <field type="uint32_t" name="time_boot_ms" units="ms">Time.</field>
    </message>
    <message id="51001" name="GRIPPER_COMMAND">
      <description>To one vehicle.</description>
      <field type="uint16_t" name="width" units="mm">Width.</field>
      <field type="uint8_t" name="target_system">System.</field>
      <field type="uint8_t" name="target_component">Component.</field>
    </message>
  </messages>
</mavlink>
"""
"""A dialect as a user writes it. `time_boot_ms` has the name of a field of other messages."""


def with_message(fields: str, *, head: str = 'id="51000" name="A"', include: str = "") -> str:
    """Return a definition with one message; its fields begin in line 3."""
    before = f"<include>{include}</include>" if include else ""
    return f"<mavlink>{before}<messages>\n<message {head}>\n{fields}</message></messages></mavlink>"


def with_entries(*enums: str) -> str:
    """Return a definition of enums, each from line 3 on in a line of its own."""
    return "<mavlink><enums>\n\n" + "\n".join(enums) + "</enums><messages/></mavlink>"


PIECES = (
    "<message ", "</message>", "<field ", "<enum>", "</enums>", "<include>a</include>", "<extensions/>", "&a;", "<!--",
    'id="', 'type="uint64_t[255]"', 'name="', 'value="', "\0", "\x9b", "<!DOCTYPE a>", "9" * 30, "char[", "\udcff",
    "]]>", ">", '"',
)  # fmt: skip


@st.composite
def mutated(draw: st.DrawFn) -> bytes:
    """Return GRIPPER with some parts left out, doubled, or replaced."""
    text = GRIPPER
    for _ in range(draw(st.integers(1, 4))):
        start = draw(st.integers(0, len(text)))
        end = min(len(text), start + draw(st.integers(0, 60)))
        new = draw(st.one_of(st.sampled_from(PIECES), st.just(text[start:end] * 2), st.text(max_size=5)))
        text = text[:start] + new + text[end:]
    return text.encode("utf-8", "surrogateescape")


@contextmanager
def scope() -> Iterator[None]:
    """Restore the built-in dialect at the end."""
    before = [dict(table) for table in TABLES]
    try:
        yield
    finally:
        for table, content in zip(TABLES, before, strict=True):
            table.clear()
            table.update(content)
        enum_names.enum_names.cache_clear()
