"""The tables in docs/pi.md are settings that the drivers and sensors take."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

from vehicle.config import Config, parsed
from vehicle.motors import DRIVERS
from vehicle.params import Params

GUIDE = (Path(__file__).parents[2] / "docs" / "pi.md").read_text()
TEXTS = re.findall(r"```toml\n(.*?)```", GUIDE, re.DOTALL)
TABLES = [tomllib.loads(text) for text in TEXTS]


@pytest.mark.parametrize("text", TEXTS, ids=lambda text: text.split("\n")[1])
def test_a_file_of_nothing_but_a_table_of_the_guide_is_right(text: str) -> None:
    assert isinstance(parsed(text, "rover.toml"), Config)


def test_a_table_of_parameters_is_right() -> None:
    tables = [table["params"] for table in TABLES if "params" in table]
    assert tables
    for table in tables:
        Params(table)


def test_every_driver_has_its_wiring() -> None:
    missing = [name for name in DRIVERS if name != "simulated" and f"(`{name}`)" not in GUIDE]
    assert missing == []
