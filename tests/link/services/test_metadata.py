"""Component metadata: what a ground station reads about our parameters is what the table says."""

from __future__ import annotations

import json
import lzma
import re
from dataclasses import dataclass
from typing import Any

from link.services.ftp.files import FileTree, GeneratedFolder
from link.services.ftp.protocol import crc32
from link.services.metadata import GENERAL_FILE, PARAMETER_FILE, Metadata, build_metadata
from tests.link.services_world import through_the_wire


@dataclass(frozen=True)
class Line:
    name: str
    default: float
    low: float
    high: float
    unit: str
    description: str
    whole: bool = False
    safety: bool = False
    needs_reboot: bool = False
    read_only: bool = False


TABLE = (
    Line("MAN_TIMEOUT", 0.45, 0.2, 2.0, "s", "A demand older than this is neutral", safety=True),
    Line("MAV_SYSID", 1, 1, 255, "", "System id", whole=True, needs_reboot=True),
)

PARAMETER_KEYS = {
    *("name", "type", "shortDesc", "longDesc", "units", "default", "decimalPlaces", "min", "max", "increment"),
    *("rebootRequired", "group", "category", "volatile", "values", "bitmask", "readOnly"),
}
"""All that parameter.schema.json allows."""


def made() -> Metadata:
    return build_metadata(TABLE, vendor="mavhelm", model="rover", version="0.1.0")


def unpacked(data: bytes) -> Any:
    return json.loads(lzma.decompress(data, format=lzma.FORMAT_XZ))


def test_the_general_file_leads_to_the_parameter_file() -> None:
    metadata = made()
    general = unpacked(metadata.general)
    assert set(general) <= {"version", "vendorName", "modelName", "firmwareVersion", "hardwareVersion", "metadataTypes"}
    assert general["version"] == 1
    assert re.fullmatch(r"\d+\.\d+\.\d+(\.\d+)?", general["firmwareVersion"])
    assert general["metadataTypes"] == [
        {"type": 1, "uri": "mftp:///parameter.json.xz", "fileCrc": crc32(metadata.parameters)}
    ]


def test_parameters_are_described_as_in_the_table() -> None:
    described = unpacked(made().parameters)
    assert described["version"] == 1
    timeout, system = described["parameters"]
    assert timeout == {
        "name": "MAN_TIMEOUT",
        "type": "Float",
        "shortDesc": "A demand older than this is neutral",
        "longDesc": "A demand older than this is neutral. Not while armed.",
        "units": "s",
        "default": 0.45,
        "min": 0.2,
        "max": 2.0,
        "decimalPlaces": 3,
        "rebootRequired": False,
        "readOnly": False,
        "group": "MAN",
        "category": "Standard",
    }
    assert (system["rebootRequired"], system["decimalPlaces"], system["increment"]) == (True, 0, 1)
    for each in described["parameters"]:
        assert set(each) <= PARAMETER_KEYS


def test_numbered_parameters_are_one_group() -> None:
    names = ("BTN0_FUNCTION", "BTN15_FUNCTION", "MOT1_MIN", "MOT_REV_DELAY")
    table = tuple(Line(name, 0, 0, 1, "", "") for name in names)
    described = unpacked(build_metadata(table, vendor="v", model="m", version="1.2.3").parameters)["parameters"]
    assert [each["group"] for each in described] == ["BTN", "BTN", "MOT", "MOT"]


def test_the_message_names_a_file_that_is_served() -> None:
    metadata = made()
    message: Any = through_the_wire(metadata.message(1234))
    assert (message.time_boot_ms, message.uri) == (1234, "mftp:///general.json.xz")
    assert message.file_crc == crc32(metadata.general)
    makers = {name: (lambda query, data=data: data) for name, data in metadata.files.items()}
    tree = FileTree(GeneratedFolder(makers), {})
    place = tree.find(message.uri.removeprefix("mftp://").encode())
    assert place is not None
    assert place.folder.open(place.name, {}) is not None
    assert set(metadata.files) == {GENERAL_FILE, PARAMETER_FILE}


def test_the_same_table_makes_the_same_files() -> None:
    first = made()
    build_metadata.cache_clear()
    assert made() == first


def test_the_files_are_small_enough_for_a_radio() -> None:
    table = tuple(
        Line(f"PARAMETER_{number}", number, 0, 1000, "m/s", f"What it does, {number}") for number in range(100)
    )
    assert len(build_metadata(table, vendor="v", model="m", version="1.2.3").parameters) < 4000


def test_the_names_of_values_come_from_the_description() -> None:
    lines = (
        Line("A", 0, 0, 2, "", "Lost: 0 no action, 1 HOLD, 2 HOLD except in AUTO; see B", whole=True),
        Line("B", 0, 0, 1, "", "0: from arming until 15 s after disarming, 1: always", whole=True),
        Line("C", 6, 0, 6, "", "Bits: 2 circle around home, 4 uploaded areas", whole=True),
        Line("D", 0, 0, 255, "", "System id of the only station; 0: any", whole=True),
        Line("E", 0, 0, 1, "", "Expo: 0 is linear, 1 is not"),
    )
    found = unpacked(build_metadata(lines, vendor="v", model="m", version="1.0.0").parameters)["parameters"]
    assert [each.get("values", each.get("bitmask")) for each in found] == [
        [
            {"value": 0, "description": "no action"}, {"value": 1, "description": "HOLD"},
            {"value": 2, "description": "HOLD except in AUTO"},
        ],
        [{"value": 0, "description": "from arming until 15 s after disarming"}, {"value": 1, "description": "always"}],
        [{"index": 1, "description": "circle around home"}, {"index": 2, "description": "uploaded areas"}],
        None,
        None,
    ]  # fmt: skip
