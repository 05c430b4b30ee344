"""The build: the dialect is generated, complete and byte-compiled, in a wheel as in an editable install."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

pytest.importorskip("hatchling", reason="hatchling is not installed: pip install -e '.[dev]' has it")

from dialects.build import MODULE, generate

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
    for data in ("dialects/rover.xml", "groundstation/ui/screens/drive.tcss"):
        assert data in names
    assert not any(name.startswith("tests/") for name in names)
