"""What the page without a vehicle says of each kind of link."""

from __future__ import annotations

from typing import Any

import pytest

from groundstation.snapshot import LinkView, Snapshot
from groundstation.ui.drive.waiting_advice import AdviceKind, advise, describe_link
from link.endpoint import SCHEMES, parse_endpoint
from tests.groundstation.ui.examples import waiting
from tests.groundstation.ui.pilots import console

HOST = "192.168.1.5"


def commands(*endpoints: str, addresses: tuple[str, ...] = (HOST, "10.0.0.2", "172.17.0.1")) -> list[str]:
    lines = advise(Snapshot(endpoints=endpoints, addresses=addresses), "^q")
    return [line.text for line in lines if line.kind is AdviceKind.COMMAND]


def words(endpoint: str, **changes: Any) -> str:
    return " ".join(line.text for line in advise(Snapshot(endpoints=(endpoint,), **changes), "^q"))


def described(name: str = "udpin:0.0.0.0:14550", **changes: Any) -> tuple[bool, str]:
    """Return whether it is a warning, and the text."""
    advice = describe_link(LinkView(name=name, **changes))
    return advice.kind is AdviceKind.WARNING, advice.text


@pytest.mark.parametrize(
    ("endpoint", "expected"),
    [
        (
            "udpin:127.0.0.1:24999",
            ["mavhelm vehicle --sim udpout:127.0.0.1:24999", "mavhelm udpin:0.0.0.0:24999"],
        ),
        ("udpin:localhost:1", ["mavhelm vehicle --sim udpout:localhost:1", "mavhelm udpin:0.0.0.0:1"]),
        (
            "udpin:0.0.0.0:24999",
            [
                "mavhelm vehicle --config rover.toml udpout:192.168.1.5:24999",
                "mavhelm vehicle --config rover.toml udpout:10.0.0.2:24999",
                "mavhelm vehicle --sim udpout:192.168.1.5:24999",
            ],
        ),
        (
            "tcpin:10.0.0.2:5760",
            ["mavhelm vehicle --config rover.toml tcpout:10.0.0.2:5760", "mavhelm vehicle --sim tcpout:10.0.0.2:5760"],
        ),
        ("udpout:127.0.0.1:24999", ["mavhelm vehicle --sim udpin:127.0.0.1:24999"]),
        ("udpout:[::1]:24999", ["mavhelm vehicle --sim udpin:[::1]:24999"]),
        ("udpout:rover.local:24999", ["mavhelm vehicle --config rover.toml udpin:0.0.0.0:24999"]),
        ("tcpout:rover.local:5760", ["mavhelm vehicle --config rover.toml tcpin:0.0.0.0:5760"]),
        ("serial:/dev/ttyUSB0:57600", []),
        ("zenoh:alice.json5/farm", ["mavhelm vehicle --config rover.toml zenoh:rover1.json5/farm/rover1"]),
        (
            "zenoh:tcp/10.0.0.2:7447/farm/rover9",
            ["mavhelm vehicle --config rover.toml zenoh:tcp/10.0.0.2:7447/farm/rover9"],
        ),
    ],
)
def test_commands_have_the_real_address_and_port(endpoint: str, expected: list[str]) -> None:
    assert commands(endpoint) == expected
    for command in expected:
        parse_endpoint(command.split()[-1])


def test_every_link_type_has_advice() -> None:
    for scheme in SCHEMES:
        rest = {"serial": "/dev/ttyUSB0:57600", "zenoh": "alice.json5/farm"}.get(scheme, "127.0.0.1:14550")
        assert words(f"{scheme}:{rest}")


def test_a_machine_without_a_network_says_so() -> None:
    assert commands("udpin:0.0.0.0:14550", addresses=()) == []
    assert "no network address yet" in words("udpin:0.0.0.0:14550")


def test_a_serial_port_names_its_baud_rate_and_the_cable() -> None:
    text = words("serial:/dev/ttyUSB0:115200")
    assert "TX goes to RX" in text
    assert "both ends use 115200 baud" in text


@pytest.mark.parametrize(
    ("link", "warns", "text"),
    [
        ({}, False, "udpin:0.0.0.0:14550: 0 bytes received"),
        (
            {"name": "udpout:127.0.0.1:1", "dropped": 7},
            True,
            "udpout:127.0.0.1:1: 0 bytes received, 7 refused: nothing listens there",
        ),
        ({"dropped": 7}, False, "udpin:0.0.0.0:14550: 0 bytes received"),
        (
            {"bytes_received": 300, "crc_errors": 9},
            True,
            "udpin:0.0.0.0:14550: 300 bytes received, no MAVLink frame, 9 bad checksums",
        ),
        (
            {"bytes_received": 300, "frames": 12, "systems": (2, 254)},
            True,
            "udpin:0.0.0.0:14550: 12 frames received from system 2, 254, no HEARTBEAT of a vehicle",
        ),
        (
            {"bytes_received": 300, "frames": 12, "systems": tuple(range(1, 200))},
            True,
            "udpin:0.0.0.0:14550: 12 frames received from system 1, 2, 3, 4, 5 ..., no HEARTBEAT of a vehicle",
        ),
    ],
)
def test_a_link_tells_what_it_has_received(link: dict[str, Any], warns: bool, text: str) -> None:
    assert described(**link) == (warns, text)


async def test_the_page_shows_problem_traffic_and_wraps_long_lines() -> None:
    links = (
        LinkView(name="udpin:0.0.0.0:24999", bytes_received=40_000, frames=700, systems=(2, 3, 254), crc_errors=31),
        LinkView(name="tcpout:10.0.0.9:5760", problem="not connected (Connection refused); trying again"),
    )
    picture = waiting(links=links, addresses=(HOST,), endpoints=("udpin:0.0.0.0:24999", "tcpout:10.0.0.9:5760"))
    async with console(picture=picture) as screen:
        text = " ".join(screen.text.replace("│", " ").split())
        assert "700 frames received from system 2, 3, 254, no HEARTBEAT of a vehicle, 31 bad checksums" in text
        assert "tcpout:10.0.0.9:5760: not connected (Connection refused); trying again" in text
        assert "mavhelm vehicle --config rover.toml udpout:192.168.1.5:24999" in text
        assert "0 bytes" not in text
        assert "ENTER starts a simulated rover" in text
        await screen.show(waiting(endpoints=("tcpout:10.0.0.9:5760",)))
        assert "ENTER starts a simulated rover, ^g c connects to another vehicle" in screen.text
