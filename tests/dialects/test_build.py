"""The build: the dialect is generated, complete and byte-compiled, in a wheel as in an editable install."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import pytest

pytest.importorskip("hatchling", reason="hatchling is not installed: pip install -e '.[dev]' has it")

from dialects import rover
from dialects.build import MODULE, add_fields, drop_texts, generate, strip_unused

ROOT = Path(__file__).parents[2]


def test_generating_twice_gives_the_same_module(tmp_path: Path) -> None:
    byte_code = generate(tmp_path / "rover.py")
    assert byte_code.exists()
    assert (tmp_path / "rover.py").read_bytes() == MODULE.read_bytes()
    assert sorted(each.name for each in tmp_path.iterdir()) == ["__pycache__", "rover.py"]


def test_a_wheel_has_the_dialect_with_its_byte_code(tmp_path: Path) -> None:
    from hatchling.builders.wheel import WheelBuilder

    [wheel] = WheelBuilder(str(ROOT)).build(directory=str(tmp_path), versions=["standard"])
    names = zipfile.ZipFile(wheel).namelist()
    assert "dialects/rover.py" in names
    assert any(name.startswith("dialects/__pycache__/rover.cpython-") for name in names)
    assert {"dialects", "link", "vehicle", "groundstation"} == {
        name.split("/")[0] for name in names if "dist-info" not in name
    }
    plan = "groundstation/ui/map/plan/mission_commands.json"
    for data in ("dialects/rover.xml", "dialects/additions.xml", "groundstation/ui/drive/screen.tcss", plan):
        assert data in names
    packages = ("dialects", "link", "vehicle", "groundstation")
    assert {f"{package}/py.typed" for package in packages} <= set(names)
    assert not any(name.startswith("tests/") for name in names)


def build_copy(folder: Path) -> str:
    """Build the wheel from a copy of the sources in `folder`; return its SHA-256."""
    copied = shutil.copytree(
        ROOT, folder, ignore=lambda here, names: {each for each in names if each.startswith((".", "tests", "docs"))}
    )
    shutil.copy(ROOT / ".gitignore", copied)
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", "dist"]
    environment = {**os.environ, "SOURCE_DATE_EPOCH": "1767225600"}
    subprocess.run(command, cwd=copied, env=environment, check=True, capture_output=True)
    [wheel] = (copied / "dist").iterdir()
    return hashlib.sha256(wheel.read_bytes()).hexdigest()


def test_two_builds_in_different_folders_are_the_same_file(tmp_path: Path) -> None:
    """The second one has newer files, in a folder with a longer name."""
    assert build_copy(tmp_path / "a") == build_copy(tmp_path / "another folder")


DEFINITIONS = """<mavlink><messages>
<message id="1" name="ONE"><field type="uint8_t" name="a">a</field></message>
<message id="2" name="TWO"><field type="uint8_t" name="a">a</field><extensions/><field type="uint8_t" name="b">b</field>
</message></messages></mavlink>"""


def added(folder: Path, message: str, field: str) -> str:
    """DEFINITIONS after one addition."""
    additions, definitions = folder / "additions.xml", folder / "common.xml"
    field_xml = f'<field type="uint8_t" name="{field}">new</field>'
    additions.write_text(f'<additions><message name="{message}">{field_xml}</message></additions>')
    definitions.write_text(DEFINITIONS)
    add_fields(additions, [definitions])
    return definitions.read_text()


@pytest.mark.parametrize(("message", "before"), [("ONE", 'name="a"'), ("TWO", 'name="b"')])
def test_a_field_is_added_as_the_last_extension(tmp_path: Path, message: str, before: str) -> None:
    definition = added(tmp_path, message, "new").partition(f'name="{message}"')[2].partition("</message>")[0]
    assert definition.count("<extensions") == 1
    assert definition.index(before) < definition.index('name="new"')
    assert definition.index("<extensions") < definition.index('name="new"')


def test_a_field_that_a_newer_definition_has_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"additions.xml: TWO has b already"):
        added(tmp_path, "TWO", "b")


def test_a_field_of_an_unknown_message_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="there is no message THREE"):
        added(tmp_path, "THREE", "new")


MODULE_OF_MAVGEN = '''enums: Dict[str, Enum] = {}

# MAV_CMD
enums["MAV_CMD"] = Enum()
enums["MAV_CMD"].bitmask = False
MAV_CMD_NAV_WAYPOINT = 16
enums["MAV_CMD"][16] = EnumEntry("MAV_CMD_NAV_WAYPOINT", """""")
enums["MAV_CMD"][16].param[1] = """"""
enums["MAV_TYPE"] = Enum()
MAV_TYPE_GCS = 6
enums["MAV_TYPE"][6] = EnumEntry("MAV_TYPE_GCS", """""")


class MAVLink(object):
    def __init__(self) -> None:
        self.seq = 0

    def heartbeat_encode(self, type: int) -> MAVLink_heartbeat_message:
        """

        """
        return MAVLink_heartbeat_message(type)

    def heartbeat_send(self, type: int) -> None:
        self.send(self.heartbeat_encode(type))

    def send(self, message: object) -> None:
        self.seq += 1

    def last_encode(self, type: int) -> None:
        pass


mavlink_map = {}'''

LIGHTENED = '''enums: Dict[str, Enum] = {}

# MAV_CMD
enums["MAV_CMD"] = Enum()
MAV_CMD_NAV_WAYPOINT = 16
enums["MAV_CMD"][16] = EnumEntry("MAV_CMD_NAV_WAYPOINT", """""")
MAV_TYPE_GCS = 6


class MAVLink(object):
    def __init__(self) -> None:
        self.seq = 0

    def send(self, message: object) -> None:
        self.seq += 1

mavlink_map = {}'''


def test_unused_tables_and_methods_are_left_out_and_rest_stays() -> None:
    assert strip_unused(MODULE_OF_MAVGEN) == LIGHTENED


def test_the_module_has_all_numbers_and_the_names_that_are_shown() -> None:
    assert list(rover.enums) == ["MAV_CMD", "MAV_RESULT"]
    assert rover.enums["MAV_CMD"][400].name == "MAV_CMD_COMPONENT_ARM_DISARM"
    assert rover.MAV_TYPE_GROUND_ROVER == 10
    assert not [name for name in vars(rover.MAVLink) if name.endswith(("_encode", "_send"))]
    assert {"parse_buffer", "send", "decode"} <= vars(rover.MAVLink).keys()


def test_explanations_go_and_definitions_stay(tmp_path: Path) -> None:
    definitions = tmp_path / "common.xml"
    definitions.write_text(
        '<mavlink><enums><enum name="E"><description>e</description><entry value="1" name="E_ONE">'
        '<description>one</description><param index="1" label="L">p</param></entry></enum></enums>'
        '<messages><message id="1" name="ONE"><description>d</description>'
        '<field type="uint8_t" name="a" units="s">a</field></message></messages></mavlink>'
    )
    drop_texts([definitions])
    root = ElementTree.parse(definitions).getroot()
    assert not "".join(root.itertext())
    assert [each.attrib for each in root.iter("field")] == [{"type": "uint8_t", "name": "a", "units": "s"}]
    assert [each.attrib for each in root.iter("param")] == [{"index": "1", "label": "L"}]
