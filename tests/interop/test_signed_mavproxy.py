"""MAVProxy with a passphrase, against our vehicle that requires signing: refused without it, in control with it."""

from __future__ import annotations

from pathlib import Path

import pytest

from link.signing.key_file import FILE, save_keys
from link.signing.keys import KeyRing, SigningKey, key_from_passphrase
from link.signing.role import SigningRole
from tests.interop import mavproxy as mavproxy_program
from tests.interop.conftest import Rover

pytestmark = [pytest.mark.interop, mavproxy_program.needed]

PASSPHRASE = "six-random-words-of-the-test"


@pytest.fixture
def options(tmp_path: Path) -> tuple[str, ...]:
    """The vehicle has the key that MAVProxy makes of the passphrase, and requires signing."""
    key = SigningKey("mavproxy", SigningRole.DRIVE, key_from_passphrase(PASSPHRASE))
    save_keys(tmp_path / FILE, KeyRing().add(key))
    (tmp_path / "rover.toml").write_text("[signing]\nrequired = true\n")
    return ("--config", str(tmp_path / "rover.toml"), "--state", str(tmp_path))


def test_it_drives_only_with_the_passphrase(rover: Rover, tmp_path: Path) -> None:
    with mavproxy_program.started(rover.port, tmp_path) as mavproxy:
        mavproxy.hear("Detected vehicle 1:1")
        mavproxy.say("module load signing")
        mavproxy.hear("Loaded module signing")
        mavproxy.say("arm throttle")
        mavproxy.say(f"signing key {PASSPHRASE}")
        mavproxy.say("mode HOLD")
        mavproxy.hear("Mode HOLD|HOLD>")
        assert "Armed by" not in rover.vehicle.errors.read_text()
        mavproxy.ask("arm throttle", "ARMED|Arming")
        rover.wait(lambda: "Armed by GCS 255" in rover.vehicle.errors.read_text(), 30.0, "armed")
        mavproxy.say("disarm")
        rover.wait(lambda: "Disarmed" in rover.vehicle.errors.read_text(), 30.0, "disarmed")
