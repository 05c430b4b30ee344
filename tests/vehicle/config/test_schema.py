"""The JSON schema is built from the tables in the code and agrees with the template."""

from __future__ import annotations

import json
import re
from pathlib import Path

import vehicle
from tests.vehicle.config.test_template import BLOCKS, live
from tests.vehicle.words import said_by
from vehicle.config.config import Config
from vehicle.config.schema import build_schema
from vehicle.motors.drivers import DRIVERS
from vehicle.params import TABLE


def test_the_schema_knows_every_key_with_its_help() -> None:
    whole = json.loads(build_schema())
    assert set(whole["properties"]) == set(Config.__struct_fields__)
    assert whole["additionalProperties"] is False
    *drivers, own = whole["properties"]["motors"]["oneOf"]
    assert [driver["properties"]["driver"]["const"] for driver in drivers] == list(DRIVERS)
    assert all(driver["additionalProperties"] is False for driver in drivers)
    assert own["properties"]["driver"]["pattern"] == ":"
    roboclaw = drivers[list(DRIVERS).index("roboclaw")]
    assert roboclaw["required"] == ["driver", "port"]
    assert roboclaw["properties"]["timeout"]["description"].startswith("s without a frame until the controller stops")
    assert set(whole["properties"]["params"]["properties"]) == {parameter.name for parameter in TABLE}
    assert said_by("schema") == (0, build_schema(), "")


def test_the_shipped_schema_is_the_codes() -> None:
    shipped = Path(vehicle.__file__).with_name("config") / "rover.schema.json"
    assert shipped.read_text() == build_schema(), (
        "run: .venv/bin/mavhelm vehicle schema > vehicle/config/rover.schema.json"
    )


def test_every_reference_in_the_schema_leads_somewhere() -> None:
    text = build_schema()
    for name in re.findall(r'"#/\$defs/(\w+)"', text):
        assert name in json.loads(text)["$defs"]


def test_schema_and_sample_agree() -> None:
    """Each key of the sample stands in the schema."""
    properties = json.loads(build_schema())["properties"]
    for name in live(BLOCKS[-1])["params"]:
        assert name in properties["params"]["properties"]
