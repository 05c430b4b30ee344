"""LinkGuards: which link is guarded, what is said at the start, and keys that come and go while the vehicle runs."""

from __future__ import annotations

from pathlib import Path

import pytest

from link.links import open_links
from link.signing.key_actions import make_key
from link.signing.key_file import FILE
from link.signing.memory_file import load_memory
from link.signing.role import SigningRole
from tests.link.frames import heartbeat
from tests.link.signing.signed import ARM, HERE, STRANGER, signed
from tests.ports import free_port
from vehicle.cli.main import main
from vehicle.config.config import RoverConfigError, parse_config
from vehicle.config.run_settings import SettingsError
from vehicle.config.signing import SigningSettings, build_policy
from vehicle.runtime.link_guards import NO_STATE, NOBODY, LinkGuards
from vehicle.runtime.vehicle_keys import VehicleKeys


def guards(settings: SigningSettings, endpoint: str, keys: VehicleKeys | None = None) -> LinkGuards:
    return LinkGuards(settings, [endpoint], keys, None, 0.0)


def test_the_start_says_what_to_do_in_one_line() -> None:
    place = "udpin:0.0.0.0:14550"
    assert guards(SigningSettings(), place).warning == f"{place}: {NOBODY.format(NO_STATE)}"
    assert "everybody in the network may drive" in str(guards(SigningSettings(allow_unsigned=True), place).warning)
    assert guards(SigningSettings(allow_unsigned=True), place).arming_note is not None
    for settings in (SigningSettings(), SigningSettings(allow_unsigned=True)):
        assert guards(settings, "udpin:127.0.0.1:14550").warning is None
        assert guards(settings, "udpin:127.0.0.1:14550").arming_note is None


def test_the_start_says_which_endpoint_is_trusted_and_why() -> None:
    made = LinkGuards(
        SigningSettings(private=("wg9",)),
        ["serial:/dev/ttyS0:57600", "udpin:127.0.0.1:1", "udpin:0.0.0.0:2"],
        None,
        None,
        0,
    )
    assert made.notes == [
        "serial:/dev/ttyS0:57600: needs no key, a cable",
        "udpin:127.0.0.1:1: needs no key, only this computer",
        "signing.private: there is no interface wg9 now; when it has come, restart the vehicle to trust it",
    ]
    assert str(made.warning).startswith("udpin:0.0.0.0:2: ")


def test_signing_that_is_required_without_a_key_does_not_start() -> None:
    with pytest.raises(SettingsError, match="there is no key; run the simulation with `--state FOLDER`"):
        guards(SigningSettings(required=True), "udpin:127.0.0.1:14550")


def test_what_it_says_to_do_closes_the_network(tmp_path: Path) -> None:
    """The key of the advice is one that this vehicle reads; with allow_unsigned a key alone closes nothing."""
    place = "udpin:0.0.0.0:14550"
    keys = VehicleKeys(tmp_path / FILE)
    try:
        advice = f"make a key with `mavhelm vehicle key new NAME --state {tmp_path}`"
        assert f"nobody may drive: {advice}" in str(guards(SigningSettings(), place, keys).warning)
        allowed = guards(SigningSettings(allow_unsigned=True), place, keys)
        assert str(allowed.warning).endswith(f"to close it, {advice} and remove allow_unsigned")
    finally:
        keys.close()
    assert main(["key", "new", "NAME", "--state", str(tmp_path)]) == 0
    keys = VehicleKeys(tmp_path / FILE)
    try:
        assert guards(SigningSettings(), place, keys).warning is None
        allowed = guards(SigningSettings(allow_unsigned=True), place, keys)
        assert str(allowed.warning).endswith("to close it, remove allow_unsigned")
        assert [
            build_policy(SigningSettings(allow_unsigned=each), private=False).unsigned for each in (True, False)
        ] == [
            SigningRole.SET_UP,
            SigningRole.WATCH,
        ]
    finally:
        keys.close()


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("required = true\nallow_unsigned = true", "required and allow_unsigned contradict each other"),
        ("open_stops = false", "false needs required = true"),
        ("open = true", "unknown key"),
        ('private = ["wg*"]', "signing.private: 'wg.' is not a name of a network interface"),
        ('private = ["wg0", "a/b"]', "'a/b' is not a name"),
        ('private = [""]', "'' is not a name"),
        ('private = ["tailscale0-too-long"]', "write each as `ip link` shows it"),
        ('private = "wg0"', "private"),
        ("required = 1", "required"),
    ],
)
def test_a_section_that_cannot_hold_is_one_line(text: str, problem: str) -> None:
    with pytest.raises(RoverConfigError, match=problem):
        parse_config(f"[signing]\n{text}\n", "rover.toml")


def test_a_trusted_link_is_free_until_the_first_key_guards_it(tmp_path: Path) -> None:
    endpoint = f"udpin:127.0.0.1:{free_port()}"
    keys = VehicleKeys(tmp_path / FILE)
    made = LinkGuards(SigningSettings(), [endpoint], keys, tmp_path / "signing.json", 0.0)
    links = open_links([endpoint], system=1, component=1)
    try:
        made.attach(links)
        channel = links[0].channel
        assert channel.guard is None
        key = make_key(tmp_path / FILE, "laptop", SigningRole.DRIVE)
        keys.listeners[0](keys.ring.add(key))
        assert channel.guard is not None
        assert channel.receive(heartbeat(0), HERE, 0.0), "this computer needs no key"
        stamp = made._link_signing.signing.clock.stamp(0.0)
        assert channel.receive(signed(ARM, STRANGER, stamp), HERE, 0.0) == []
        assert channel.receive(signed(ARM, key, stamp), HERE, 0.0)[0].role is SigningRole.DRIVE
        made.close(1.0)
        assert load_memory(tmp_path / "signing.json").newest
    finally:
        for link in links:
            link.close()
        keys.close()
