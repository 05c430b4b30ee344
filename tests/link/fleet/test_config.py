"""What an endpoint becomes in Zenoh, and one line for what cannot be used."""

from __future__ import annotations

import json
import os
import re
from pathlib import Path
from typing import Any

import pytest
from msgspec.structs import replace

from link.endpoint import Side, parse_endpoint
from link.fleet.config import LEASE, THREADS, THREADS_VARIABLE, load_config, load_zenoh
from link.fleet.transport import open_fleet
from link.runtime.install_hint import install_command
from link.signing.role import SigningRole
from link.transport.reach import find_trust
from link.transport.transport import LinkError

TLS = dict.fromkeys(
    ("root_ca_certificate_base64", "connect_certificate_base64", "connect_private_key_base64"), "bm90aGluZw=="
)
ROUTER = "tls/fleet.example.org:7447"


def write(folder: Path, **content: Any) -> str:
    """Write a file as `mavhelm bridge fleet add` does; return its path."""
    whose = {"fleet": "farm", "name": "alice", "role": "drive"} | content.pop("whose", {})
    content = {
        "connect": {"endpoints": [content.pop("router", ROUTER)]},
        "metadata": {"mavhelm": whose},
        "transport": {"link": {"tls": content.pop("tls", TLS)}},
    } | content
    path = folder / "member.json5"
    path.write_text(f"// whose it is\n{json.dumps(content)}")
    return str(path)


def test_a_bare_router_gets_the_settings_of_a_fleet() -> None:
    config = load_config(parse_endpoint("zenoh:tcp/192.168.1.2:7447/farm"))
    assert config.routers == ("tcp/192.168.1.2:7447",)
    assert (config.role, config.operator_role, config.is_proven) == (None, None, False)
    expected = {
        "mode": "client",
        "transport/shared_memory/enabled": False,
        "transport/link/tx/lease": LEASE,
        "scouting/multicast/enabled": False,
        "listen/endpoints": [],
    }
    assert {key: json.loads(config.zenoh.get_json(key)) for key in expected} == expected


def test_a_file_says_who_and_what(tmp_path: Path) -> None:
    config = load_config(parse_endpoint(f"zenoh:{write(tmp_path)}/farm"))
    assert (config.name, config.operator_role, config.routers) == ("alice", SigningRole.DRIVE, (ROUTER,))


@pytest.mark.parametrize(
    ("content", "private"),
    [
        ({}, True),
        ({"router": "quic/fleet.example.org:7447?mixed_rel=1"}, True),
        ({"router": "tcp/127.0.0.1:7447"}, False),
        ({"tls": {}}, False),
        ({"tls": {key: value for key, value in TLS.items() if "root" not in key}}, False),
        ({"mode": 3}, False),
    ],
)
def test_only_a_router_with_certificates_is_trusted_without_keys(
    tmp_path: Path, content: dict[str, Any], private: bool
) -> None:
    trust = find_trust(parse_endpoint(f"zenoh:{write(tmp_path, **content)}/farm/rover1"))
    assert (trust is not None) is private


def test_a_bare_router_is_a_network_also_on_this_computer() -> None:
    assert not find_trust(parse_endpoint("zenoh:tcp/127.0.0.1:7447/farm/rover1"))


@pytest.mark.parametrize(
    ("content", "rest", "side", "told"),
    [
        ({}, "barn", None, "is of the fleet farm, not barn"),
        ({}, "farm/rover1", Side.VEHICLE, "is the file of an operator; make one for this vehicle"),
        ({"whose": {"role": "vehicle"}}, "farm", Side.GROUND_STATION, "is the file of a vehicle; make one"),
        ({"whose": {"role": "vehicle", "name": "rover2"}}, "farm/rover1", Side.VEHICLE, "is the file of rover2; write"),
        ({"connect": {"endpoints": []}}, "farm", None, "names no router; add it to connect/endpoints"),
        ({"modus": 1}, "farm", None, "is not a Zenoh configuration: "),
        ({"whose": {"role": None}}, "farm", Side.VEHICLE, "name this vehicle, for example zenoh:"),
    ],
)
def test_a_file_that_does_not_fit_is_named_in_one_line(
    tmp_path: Path, content: dict[str, Any], rest: str, side: Side | None, told: str
) -> None:
    endpoint = replace(parse_endpoint(f"zenoh:{write(tmp_path, **content)}/{rest}"), side=side)
    with pytest.raises(LinkError) as caught:
        open_fleet(endpoint)
    assert told in str(caught.value)
    assert str(caught.value).startswith(endpoint.text)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(("role", "is_vehicle"), [("watch", False), ("vehicle", True), (None, True)])
def test_at_a_bridge_the_file_says_which_end_it_is(tmp_path: Path, role: str | None, is_vehicle: bool) -> None:
    path = write(tmp_path, whose={"role": role, "name": "rover1"})
    transport = open_fleet(parse_endpoint(f"zenoh:{path}/farm/rover1"))
    assert (transport._keys.me is None) is is_vehicle


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(LinkError, match=r"nobody\.json5: No such file or directory$"):
        open_fleet(parse_endpoint(f"zenoh:{tmp_path}/nobody.json5/farm"))


def test_without_the_package_one_line_says_how_to_install_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "zenoh", None)
    expected = f"fleets need the package eclipse-zenoh: {install_command('fleet')}"
    with pytest.raises(LinkError, match=f"^{re.escape(expected)}$"):
        open_fleet(parse_endpoint("zenoh:tcp/127.0.0.1:7447/farm"))
    assert not find_trust(parse_endpoint("zenoh:tcp/127.0.0.1:7447/farm"))


def test_an_end_has_one_thread_pool_unless_the_user_sets_more(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(THREADS_VARIABLE, "(rx: (worker_threads: 3))")
    endpoint = parse_endpoint("zenoh:tcp/127.0.0.1:7447/farm")
    load_config(endpoint)
    assert os.environ[THREADS_VARIABLE] == "(rx: (worker_threads: 3))"
    monkeypatch.delenv(THREADS_VARIABLE)
    load_zenoh()
    assert THREADS_VARIABLE not in os.environ, "a router needs the pools of Zenoh"
    load_config(endpoint)
    assert os.environ[THREADS_VARIABLE] == THREADS
