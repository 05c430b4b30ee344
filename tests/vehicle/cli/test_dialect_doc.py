"""docs/dialect.md is what `mavhelm vehicle dialect` prints, and leaves nothing out."""

from __future__ import annotations

from pathlib import Path

from dialects import messages as m
from dialects.definition import private_enums, private_messages
from dialects.enums import command_name
from tests.vehicle.words import said_by
from vehicle.cli.dialect_doc import build_document
from vehicle.modes import MODES
from vehicle.params import PARAMETERS, Params
from vehicle.rover import Rover
from vehicle.telemetry.streams import STREAMS

ROVER = Rover(Params(), now=0.0)
FILE = Path(__file__).parents[3] / "docs" / "dialect.md"


def test_the_file_is_what_the_tables_say() -> None:
    code, out, error = said_by("dialect")
    assert (code, error) == (0, "")
    assert FILE.read_text() == out, "a table has changed: vehicle dialect > docs/dialect.md"


def test_every_command_and_message_is_described() -> None:
    assert [row.command for row in ROVER.commands if not row.help] == []
    assert [row.message for row in ROVER.messages if not row.description] == []


def test_nothing_is_left_out() -> None:
    text = build_document()
    names = [stream.message.msgname for stream in STREAMS] + [row.message.msgname for row in ROVER.messages]
    names += [*PARAMETERS, *(mode.name for mode in MODES), *(command_name(row.command) for row in ROVER.commands)]
    assert [name for name in names if f"| {name} |" not in text] == []
    assert [each.name for each in private_messages() if f"### {each.name} (" not in text] == []


def test_private_messages_are_those_of_the_codec() -> None:
    found = private_messages()
    assert {each.id for each in found} == {number for number in m.MESSAGES if 46000 <= number < 46100}
    for each in found:
        kind = m.MESSAGES[each.id]
        assert kind.msgname == each.name
        assert [field.name for field in each.fields] == kind.fieldnames
        assert all(field.description for field in each.fields)
    assert set(private_enums()) >= {field.enum for each in found for field in each.fields
                                    if field.enum.startswith("ROVER_")}  # fmt: skip


def test_rows_have_the_columns_of_their_heads() -> None:
    columns = 0
    for line in build_document().splitlines():
        if not line.startswith("|"):
            columns = 0
            continue
        found = line.replace("\\|", "").count("|")
        assert columns in (0, found), line
        columns = found
