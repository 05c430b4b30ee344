"""What docs/pi.md shows is what the program takes and says."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import msgspec
import pytest

from tests.ports import free_port
from tests.rows import each_row
from vehicle.accessories.drivers import DRIVERS as ACCESSORY_DRIVERS
from vehicle.accessories.settings import Accessories, build_specs
from vehicle.config.config import Config, parse_config
from vehicle.config.template import build_template
from vehicle.motors.drivers import DRIVERS
from vehicle.params import Params

pytestmark = pytest.mark.xdist_group("motor drivers")  # each driver can be used by one vehicle at a time

GUIDE = (Path(__file__).parents[3] / "docs" / "pi.md").read_text()
TEXTS = re.findall(r"```toml\n(.*?)```", GUIDE, re.DOTALL)
TABLES = [tomllib.loads(text) for text in TEXTS]


@each_row("text", TEXTS, ids=lambda text: text.split("\n")[1])
def test_a_file_of_nothing_but_a_table_of_the_guide_is_right(text: str) -> None:
    assert isinstance(parse_config(text, "rover.toml"), Config)


def test_a_table_of_parameters_is_right() -> None:
    tables = [table["params"] for table in TABLES if "params" in table]
    assert tables
    for table in tables:
        Params(table)


def test_every_driver_has_its_wiring() -> None:
    names = {*DRIVERS, *(name for drivers in ACCESSORY_DRIVERS.values() for name in drivers)}
    missing = [name for name in names if name != "simulated" and f"(`{name}`)" not in GUIDE]
    assert missing == []


def test_check_says_what_the_guide_shows(tmp_path: Path) -> None:
    shown = re.findall(r"^ {3}(ok    .*)$", GUIDE, re.MULTILINE)
    endpoint = f"udpin:127.0.0.1:{free_port()}"
    file = tmp_path / "rover.toml"
    file.write_text(
        build_template().replace('"udpin:0.0.0.0:14550"', f'"{endpoint}"').replace('"simulated"', '"article-car"', 1)
    )
    (tmp_path / ".local/state/mavhelm").mkdir(parents=True)  # by the motor test, the step before
    pins = {"GPIOZERO_PIN_FACTORY": "mock", "GPIOZERO_MOCK_PIN_CLASS": "mockpwmpin"}
    check = subprocess.run(
        [sys.executable, "-m", "vehicle", "check", file],
        env={"PATH": os.environ["PATH"], "HOME": str(tmp_path), **pins},
        capture_output=True, text=True, timeout=60, check=False,
    )  # fmt: skip
    said = check.stdout.replace(str(tmp_path), "/home/pi").replace(endpoint, "udpin:0.0.0.0:14550").splitlines()
    assert said[:-1] == shown[:-1]
    assert said[-1].split(": ")[0] == shown[-1].split(": ")[0] == "ok    sensors.computer"


def test_accessories_have_tables_that_are_right() -> None:
    [table] = [table["accessories"] for table in TABLES if "accessories" in table]
    outputs = build_specs(msgspec.convert(table, Accessories))
    assert [output.name for output in outputs] == ["relay 0", "servo 9"]
