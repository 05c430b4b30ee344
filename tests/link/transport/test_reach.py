"""Which endpoints are trusted: by the kind of their interface for WireGuard, by name for all others."""

from __future__ import annotations

import socket
from pathlib import Path

import pytest

from link.endpoint import parse_endpoint
from link.transport.reach import Trust, find_trust, is_interface_name, missing_interfaces
from tests.rows import each_row


@each_row(
    ("endpoint", "reason"),
    [
        ("serial:/dev/ttyAMA0:57600", "a cable"),
        ("udpin:127.0.0.1:14550", "only this computer"),
        ("tcpin:[::1]:5760", "only this computer"),
        ("udpout:127.3.0.1:14550", "only this computer"),
        ("udpout:localhost:14550", "only this computer"),
        ("udpin:0.0.0.0:14550", None),
        ("tcpin:[::]:5760", None),
        ("udpin:192.0.2.7:14550", None),
        ("udpout:no-such-host.invalid:14550", None),
        ("udpout:\udcff:14550", None),
    ],
)
def test_what_a_network_reaches(endpoint: str, reason: str | None) -> None:
    trust = find_trust(parse_endpoint(endpoint))
    assert (trust and trust.reason) == reason


UEVENTS = {
    "wireguard": "DEVTYPE=wireguard\nINTERFACE=lo\n",
    "wwan": "DEVTYPE=wwan\nINTERFACE=lo\n",
    "none": "INTERFACE=lo\n",
}


@pytest.fixture
def tunnel(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """The computer's loopback interface, which counts as any other one, with the kind of the test."""
    folder = tmp_path / "lo"
    folder.mkdir()
    (folder / "type").write_text("65534\n")
    (folder / "uevent").write_text(UEVENTS[request.param])
    monkeypatch.setattr("link.transport.reach.INTERFACES", tmp_path)
    monkeypatch.setattr("link.transport.reach.LOOPBACK", "another")
    monkeypatch.setattr("link.transport.reach.is_loopback", lambda host: False)


@pytest.mark.parametrize(
    ("tunnel", "private", "reason"),
    [
        ("wireguard", (), "lo is WireGuard"),
        ("wwan", (), None),
        ("none", (), None),
        ("none", ("wg0", "lo"), "lo is named in private under [signing]"),
        ("wwan", ("l*", "LO", "l"), None),
    ],
    indirect=["tunnel"],
)
@pytest.mark.usefixtures("tunnel")
@pytest.mark.parametrize("scheme", ["udpin", "udpout", "tcpin", "tcpout"])
def test_a_tunnel_is_trusted_by_its_kind_or_name(scheme: str, private: tuple[str, ...], reason: str | None) -> None:
    """An endpoint that sends is trusted by the address from which it would send."""
    expected = reason and Trust(reason, "lo")
    assert find_trust(parse_endpoint(f"{scheme}:127.0.0.1:14550"), private) == expected
    assert find_trust(parse_endpoint(f"{scheme}:192.0.2.7:14550"), private) is None
    if scheme.endswith("in"):
        assert find_trust(parse_endpoint(f"{scheme}:0.0.0.0:14550"), private) is None


def test_a_host_name_that_means_this_computer_is_bound_to_it() -> None:
    """Another answer to the same name must not open a link to somebody else."""
    host = socket.gethostname()
    try:
        here = socket.gethostbyname(host).startswith("127.")
    except OSError:
        here = False
    if not here:
        pytest.skip("this computer's own name is not a loopback address")
    assert find_trust(parse_endpoint(f"udpout:{host}:14550")) == Trust("only this computer", "lo")


@each_row("name", ["", ".", "..", "wg*", "wg?", "[wg0]", "wg 0", "a/b", "a:b", "sixteen-letters-", "wg0\n"])
def test_no_pattern_is_the_name_of_an_interface(name: str) -> None:
    assert not is_interface_name(name)
    assert all(map(is_interface_name, ("wg0", "tailscale0", "wlan0.10", "br-lan", "lo")))


def test_missing_interfaces_are_named() -> None:
    assert missing_interfaces(["lo", "no-such-if0"]) == ["no-such-if0"]
