"""One definition file: what is read, and one clear line for what cannot be used."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from dialects.extra.definition_file import DEPTH_MAX, FILE_MAX, read_definitions
from dialects.extra.definitions import DefinitionFile
from dialects.extra.errors import DialectError
from tests.dialects.extra.xml_texts import GRIPPER, mutated, with_entries, with_message

FIELD = '<field type="uint8_t" name="a">b</field>\n'
LAUGHS = """<!DOCTYPE mavlink [<!ENTITY a "ha"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">]>
<mavlink><messages><message id="1" name="&b;"/></messages></mavlink>"""

OUTSIDE = '<!DOCTYPE a SYSTEM "/etc/passwd"><mavlink/>'


def parse(text: str | bytes, folder: Path) -> DefinitionFile:
    file = folder / "my.xml"
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_definitions(file, "my.xml")


def refusal(text: str | bytes, folder: Path) -> str:
    with pytest.raises(DialectError) as caught:
        parse(text, folder)
    return str(caught.value)


def test_messages_and_enums_are_read(tmp_path: Path) -> None:
    file = parse(GRIPPER, tmp_path)
    status, command = file.messages
    assert [include for include, _ in file.includes] == ["minimal.xml"]
    assert (status.id, status.name, status.size, status.base_size) == (51000, "GRIPPER_STATUS", 30, 26)
    assert [each.name for each in status.wire_order] == ["force", "supply", "mode", "flags", "label", "time_boot_ms"]
    assert (status.fields[1].units, status.fields[0].enum) == ("mV", "GRIPPER_MODE")
    assert str(command.place) == "my.xml:27"
    assert [(each.name, each.value) for each in file.enums[0].entries] == [
        ("GRIPPER_MODE_OPEN", 0), ("GRIPPER_MODE_SHUT", 1)
    ]  # fmt: skip
    assert [each.value for each in file.enums[1].entries] == [1, 2]


@pytest.mark.parametrize(
    ("value", "number"),
    [("7", 7), ("-1", -1), ("0x1F", 31), ("0b101", 5), ("2**63", 1 << 63), (str(2**64 - 1), 2**64 - 1)],
)
def test_values_have_the_forms_of_mavlink(value: str, number: int, tmp_path: Path) -> None:
    file = parse(with_entries(f'<enum name="E"><entry name="A" value="{value}"/></enum>'), tmp_path)
    assert file.enums[0].entries[0].value == number


NAME = "use at most 100 letters, digits and _, no digit first"
VALUE = "use up to 64 bits: a number, 0x..., 0b... or 2**n"
IDS = "use a number from 0 to 16777215"
TYPES = (
    "use char, int8_t, uint8_t, int16_t, uint16_t, int32_t, uint32_t, int64_t, uint64_t, float, double, "
    "or an array such as char[16]"
)


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("", "my.xml:1: not XML (no element found): correct it or name another file"),
        ("# a README\n", "my.xml:1: not XML (not well-formed (invalid token)): correct it or name another file"),
        ("<mavlink>\n<enums>\n</mavlink>", "my.xml:3: not XML (mismatched tag): correct it or name another file"),
        ('<?xml version="1.0" encoding="klingon"?><a/>', "my.xml:1: unknown encoding: save the file as UTF-8"),
        ('<?xml version="1.0" encoding="shift-jis"?><a/>', "my.xml:1: unknown encoding: save the file as UTF-8"),
        ("<html/>", "my.xml:1: <html> is not known here: a MAVLink definition begins with <mavlink>"),
        (LAUGHS, "my.xml:1: a DOCTYPE, which MAVLink definitions do not have: delete it"),
        (OUTSIDE, "my.xml:1: a DOCTYPE, which MAVLink definitions do not have: delete it"),
        (
            "<mavlink>" + "<a>" * 50,
            "my.xml:1: <a> is not known here: <mavlink> has dialect, enums, include, messages, version",
        ),
        (
            f"<mavlink><version>{'<a>' * 50}",
            f"my.xml:1: more than {DEPTH_MAX} elements inside each other: no MAVLink definition",
        ),
        (
            with_message('<feild type="uint8_t" name="a"/>'),
            "my.xml:3: <feild> is not known here: "
            "<message> has deprecated, description, extensions, field, superseded, wip",
        ),
    ],
)
def test_a_document_that_is_no_definition(text: str, line: str, tmp_path: Path) -> None:
    assert refusal(text, tmp_path) == line


@pytest.mark.parametrize(
    ("head", "what"),
    [
        ('name="A"', '<message> has no id: add id="..."'),
        ('id="1"', '<message> has no name: add name="..."'),
        ('id="16777216" name="A"', f"'16777216' is not a message id: {IDS}"),
        ('id="-1" name="A"', f"'-1' is not a message id: {IDS}"),
        ('id="1_0" name="A"', f"'1_0' is not a message id: {IDS}"),
        ('id="1" name="A B"', f"'A B' is not a valid message name: {NAME}"),
        ('id="1" name="A\N{LATIN SMALL LETTER E WITH ACUTE}"', f"'A\\xe9' is not a valid message name: {NAME}"),
        ('id="1" name="1A"', f"'1A' is not a valid message name: {NAME}"),
    ],
)
def test_a_message_without_a_usable_id_or_name(head: str, what: str, tmp_path: Path) -> None:
    assert refusal(with_message(FIELD, head=head), tmp_path) == f"my.xml:2: {what}"


@pytest.mark.parametrize(
    ("attributes", "what"),
    [
        ('type="char" name="a;import os"', f"'a;import os' is not a valid field name: {NAME}"),
        ('name="a"', '<field> has no type: add type="..."'),
        ('type="uint8" name="a"', "field a: unknown type 'uint8': did you mean uint8_t?"),
        ('type="bool" name="a"', f"field a: unknown type 'bool': {TYPES}"),
        ('type="char[x]" name="a"', "field a: unknown type 'char[x]': did you mean char?"),
        ('type="char[0]" name="a"', "field a: an array has 1 to 255 items, not 0"),
        ('type="char[256]" name="a"', "field a: an array has 1 to 255 items, not 256"),
        ('type="char" name="a" units="\x9b"', "field a: units '\\x9b': use at most 20 printable characters"),
    ],
)
def test_a_field_that_cannot_be_decoded_or_shown(attributes: str, what: str, tmp_path: Path) -> None:
    assert refusal(with_message(f"<field {attributes}/>"), tmp_path) == f"my.xml:3: {what}"


@pytest.mark.parametrize(
    ("fields", "line"),
    [
        (FIELD * 2, "my.xml:4: A has a field a already: rename one of them"),
        (
            "".join(f'<field type="char" name="a{number}"/>\n' for number in range(65)),
            "my.xml:67: A has more than 64 fields: MAVLink allows no more",
        ),
        ("", "my.xml:2: A has no fields: add one, at least one before the extensions"),
        (f"<extensions/>{FIELD}", "my.xml:2: A has no fields: add one, at least one before the extensions"),
        (f"{FIELD}<extensions/>\n<extensions/>", "my.xml:5: A has <extensions> twice: keep the first"),
        (
            '<field type="double[32]" name="a"/>',
            "my.xml:2: A has 256 bytes of payload: MAVLink carries 255, shorten an array",
        ),
    ],
)
def test_a_message_that_mavlink_cannot_carry(fields: str, line: str, tmp_path: Path) -> None:
    assert refusal(with_message(fields), tmp_path) == line


@pytest.mark.parametrize("value", ["f()", str(2**64), "-9223372036854775809", "010", "2**64", "", "1 "])
def test_an_entry_without_a_usable_value(value: str, tmp_path: Path) -> None:
    text = with_entries(f'<enum name="E"><entry name="A" value="{value}"/></enum>')
    assert refusal(text, tmp_path) == f"my.xml:3: entry A: {value!a} is not a value: {VALUE}"


def test_what_is_no_file_or_too_large_is_not_read(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    for path in (tmp_path, tmp_path / "pipe", Path("/dev/zero")):
        with pytest.raises(DialectError, match=r"^it: not a file: name the XML file of the dialect$"):
            read_definitions(path, "it")
    assert refusal(b" " * (FILE_MAX + 1), tmp_path) == "my.xml: larger than 4 MiB: this is not a MAVLink definition"


def test_no_expression_of_a_file_is_executed(tmp_path: Path) -> None:
    """mavparse evaluates the value of an entry as Python."""
    evil = f"__import__('pathlib').Path('{tmp_path}/made').touch()"
    entry = f'<enum name="E"><entry name="A" value="{evil}"/></enum>'
    assert "is not a value" in refusal(with_entries(entry), tmp_path)
    assert not (tmp_path / "made").exists()


@given(st.one_of(mutated(), st.binary(max_size=80)))
@example(b"\xff\xfe<\0")
@example(b'<?xml version="1.0" encoding="utf-7"?><mavlink/>')
@example(b'<?xml version="1.0" encoding="base64"?><mavlink/>')
def test_any_text_is_a_definition_or_one_clear_line(tmp_path_factory: pytest.TempPathFactory, text: bytes) -> None:
    file = tmp_path_factory.getbasetemp() / "mutated.xml"
    file.write_bytes(text)
    try:
        found = read_definitions(file, "my.xml")
    except DialectError as error:
        line = str(error)
        assert line.startswith("my.xml:")
        assert line.isprintable()
        assert len(line) < 400
    else:
        assert all(0 < each.size <= 255 and each.name.isidentifier() for each in found.messages)
