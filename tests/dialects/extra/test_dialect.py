"""A definition file with its includes, beside what pymavlink's generator makes of the same files."""

from __future__ import annotations

import importlib
from pathlib import Path

import pytest

from dialects.extra.dialect import FILES_MAX, SHIPPED, Dialect, load
from dialects.extra.errors import DialectError
from tests.dialects.extra.peers import generate
from tests.dialects.extra.xml_texts import GRIPPER, with_entries, with_message

FIELD = '<field type="uint8_t" name="a"/>'


def write(folder: Path, **files: str) -> str:
    """Write NAME.xml for each file, and return the path of the first."""
    for name, text in files.items():
        (folder / f"{name}.xml").write_text(text)
    return str(folder / f"{next(iter(files))}.xml")


def refusal(file: str) -> str:
    with pytest.raises(DialectError) as caught:
        load(file)
    return str(caught.value)


def names(dialect: Dialect) -> list[str]:
    return [each.name for each in dialect.messages]


@pytest.mark.parametrize("file", sorted(each.stem for each in SHIPPED.glob("*.xml")))
def test_every_pymavlink_definition_matches_its_generator(file: str) -> None:
    dialect = load(f"{file}.xml")
    theirs = importlib.import_module(f"pymavlink.dialects.v20.{file}")
    for each in dialect.messages:
        kind = theirs.mavlink_map[each.id]
        assert (each.name, each.crc_extra, each.size) == (kind.msgname, kind.crc_extra, kind.unpacker.size)
        assert [field.name for field in each.wire_order] == kind.ordered_fieldnames
    assert len(dialect.messages) == len(theirs.mavlink_map)
    for enum in dialect.enums.values():
        entries = {value: entry.name for value, entry in theirs.enums[enum.name].items()}
        assert dict(enum.names).items() <= entries.items()
        assert len(entries) == len(enum.names) + 1  # ENUM_END


def test_include_is_found_beside_its_file_or_first_or_pymavlinks(tmp_path: Path) -> None:
    (tmp_path / "sub").mkdir()
    write(tmp_path / "sub", deep=with_message(FIELD, head='id="51001" name="DEEP"', include="beside.xml"))
    write(tmp_path, beside=with_message(FIELD, head='id="51002" name="BESIDE"', include="minimal.xml"))
    assert names(load(write(tmp_path, my=with_message(FIELD, include="sub/deep.xml")))) == [
        "A", "DEEP", "BESIDE", "HEARTBEAT"
    ]  # fmt: skip


def test_copy_beside_file_replaces_pymavlinks_in_all_includes(tmp_path: Path) -> None:
    copy = with_message(FIELD, head='id="51003" name="COPY"')
    text = "<mavlink><include>standard.xml</include><include>minimal.xml</include></mavlink>"
    found = names(load(write(tmp_path, my=text, minimal=copy)))
    assert "COPY" in found
    assert "GLOBAL_POSITION_INT" in found
    assert "HEARTBEAT" not in found


def test_a_file_that_two_others_include_is_read_once(tmp_path: Path) -> None:
    part = "<mavlink><include>minimal.xml</include></mavlink>"
    text = "<mavlink><include>one.xml</include><include>two.xml</include></mavlink>"
    assert names(load(write(tmp_path, my=text, one=part, two=part))) == ["HEARTBEAT"]


def test_includes_in_a_circle_or_without_end_are_refused(tmp_path: Path) -> None:
    one, two = "<mavlink>\n<include>two.xml</include></mavlink>", "<mavlink>\n\n<include>one.xml</include></mavlink>"
    file = write(tmp_path, one=one, two=two)
    assert refusal(file) == f"{tmp_path}/two.xml:3: one.xml includes itself, over 2 files: delete one <include>"
    itself = write(tmp_path, one="<mavlink><include>one.xml</include></mavlink>")
    assert refusal(itself) == f"{itself}:1: one.xml includes itself, over 1 files: delete one <include>"
    many = {f"f{n}": f"<mavlink><include>f{n + 1}.xml</include></mavlink>" for n in range(FILES_MAX + 2)}
    assert f"more than {FILES_MAX} files in one dialect: delete some <include>" in refusal(write(tmp_path, **many))


@pytest.mark.parametrize("include", ["nowhere.xml", "", "x" * 300])
def test_an_include_that_is_missing_is_named_with_its_line(include: str, tmp_path: Path) -> None:
    file = write(tmp_path, my=f"<mavlink>\n<include>{include}</include></mavlink>")
    where = "is neither beside this file nor among pymavlink's: copy it there"
    assert refusal(file) == f"{file}:2: include {include[:80]!a} {where}"


def test_a_file_that_is_missing_may_be_one_of_pymavlinks() -> None:
    assert refusal("nowhere.xml") == "nowhere.xml: no such file: name the XML file of the dialect"
    assert refusal("ardupilotmega") == "ardupilotmega: no such file: did you mean ardupilotmega.xml?"
    assert refusal("a\nb") == "a\N{REPLACEMENT CHARACTER}b: no such file: name the XML file of the dialect"
    assert refusal("x" * 300) == f"{'x' * 300}: no such file: name the XML file of the dialect"
    assert refusal("") == ": no such file: name the XML file of the dialect"
    assert "HEARTBEAT" in names(load("ardupilotmega.xml"))


def test_two_messages_of_one_id_or_name_name_their_places(tmp_path: Path) -> None:
    other = with_message(FIELD, head='id="51000" name="B"')
    file = write(tmp_path, my=with_message(FIELD, include="other.xml"), other=other)
    assert refusal(file) == f"{tmp_path}/other.xml:2: B has the id 51000 of A ({file}:2): change one"
    file = write(
        tmp_path, my=with_message(FIELD, include="other.xml"), other=with_message(FIELD, head='id="7" name="A"')
    )
    assert refusal(file) == f"{tmp_path}/other.xml:2: the name of A ({file}:2) again: rename one"


def test_two_entries_of_one_value_or_name_name_their_places(tmp_path: Path) -> None:
    file = write(
        tmp_path, my=with_entries('<enum name="E"><entry name="A" value="1"/>\n<entry name="B" value="1"/></enum>')
    )
    assert refusal(file) == f"{file}:4: B has the value 1 of A ({file}:3): change one"
    file = write(
        tmp_path, my=with_entries('<enum name="E"><entry name="A" value="1"/>\n<entry name="A" value="2"/></enum>')
    )
    assert refusal(file) == f"{file}:4: A is in E already ({file}:3): rename one"


@pytest.mark.parametrize("further", ['<entry name="B"/><entry name="C" value="5"/>', '<entry name="B" value="40"/>'])
def test_automatic_values_are_those_of_the_generator(further: str, tmp_path: Path) -> None:
    enum = '<enum name="E"><description/><entry name="A0"/><entry name="A1"/><entry name="A9" value="9"/></enum>'
    more = with_entries(f'<enum name="E">{further}</enum>')
    text = with_entries(enum).replace("<mavlink>", "<mavlink><include>more.xml</include>")
    file = write(tmp_path, my=text, more=more)
    theirs = generate(Path(file), tmp_path / "generated.py").enums["E"]
    assert dict(load(file).enums["E"].names).items() <= {n: entry.name for n, entry in theirs.items()}.items()


def test_messages_of_a_user_are_those_that_the_generator_makes(tmp_path: Path) -> None:
    (tmp_path / "minimal.xml").write_bytes((SHIPPED / "minimal.xml").read_bytes())  # mavgen looks only there
    file = write(tmp_path, gripper=GRIPPER)
    theirs = generate(Path(file), tmp_path / "generated.py").mavlink_map
    ours = load(file).messages
    assert {each.id: each.crc_extra for each in ours} == {number: kind.crc_extra for number, kind in theirs.items()}
    assert {each.id: each.size for each in ours} == {number: kind.unpacker.size for number, kind in theirs.items()}
