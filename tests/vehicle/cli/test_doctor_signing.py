"""The row `signing` of `mavhelm vehicle doctor`: keys, open links, and what to do."""

from __future__ import annotations

from typing import Any

import pytest

from link.runtime.diagnosis import Health
from vehicle.cli.check import CheckResult
from vehicle.cli.doctor.facts import Clock, VehicleDoctorFacts
from vehicle.cli.doctor.signing_row import CLOSE, NEW_KEY, signing
from vehicle.config.signing import SigningSettings
from vehicle.readings import ComputerReadings

NETWORK = ("udpin:0.0.0.0:14550",)
KEYS = ("laptop (setup, 01234567)",)


@pytest.mark.parametrize(
    ("facts", "health", "said", "advice"),
    [
        ({}, Health.OK, "no key; no link is open to a network", ""),
        ({"open_links": NETWORK}, Health.WARNING, "nobody may drive over the network", NEW_KEY),
        ({"open_links": NETWORK, "keys": KEYS}, Health.OK, "others may watch and stop", ""),
        (
            {"open_links": NETWORK, "keys": KEYS, "signing": SigningSettings(allow_unsigned=True)},
            Health.WARNING,
            "everybody in the network may drive",
            CLOSE,
        ),
        ({"keys": KEYS, "signing": SigningSettings(required=True)}, Health.OK, "nothing unsigned is obeyed", ""),
        ({"signing": SigningSettings(required=True)}, Health.FAULT, "required, but no key", NEW_KEY),
        ({"key_problem": "keys.toml: others can read it; chmod 600"}, Health.FAULT, "others can read it", "chmod 600"),
    ],
)
def test_what_it_says(facts: dict[str, Any], health: Health, said: str, advice: str) -> None:
    found = signing(
        VehicleDoctorFacts(
            path="rover.toml",
            user="pi",
            checks=(CheckResult("settings", True, ""),),
            health=ComputerReadings(),
            clock=Clock(2026, True),
            **facts,
        )
    )
    assert found.health is health
    assert said in found.evidence
    assert found.advice == advice
