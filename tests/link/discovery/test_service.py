"""What is announced, and what is read from anybody's announcements."""

from __future__ import annotations

import pytest

from link.discovery.service import TYPES, MavlinkService, ServiceRole, announces_here_only, can_announce, read_service
from link.endpoint import parse_endpoint

UDP = TYPES["udp"]


def read(addresses: tuple[str, ...] = ("10.0.0.7",), port: int | None = 14550, **txt: bytes) -> MavlinkService | None:
    return read_service(UDP, f"Rover on pi 14550.{UDP}", addresses, port, {k.encode(): v for k, v in txt.items()})


def test_what_is_announced_is_read_back() -> None:
    rover = MavlinkService("Rover 7", "10.0.0.7", 14550, system=7, role=ServiceRole.VEHICLE)
    txt: dict[bytes, bytes | None] = {key.encode(): value.encode() for key, value in rover.txt.items()}
    assert read_service(UDP, f"x.{UDP}", ("10.0.0.7",), 14550, txt) == rover
    assert rover.endpoint == "udpout:10.0.0.7:14550"


def test_a_service_without_texts_has_the_name_of_its_instance() -> None:
    service = read()
    assert service == MavlinkService("Rover on pi 14550", "10.0.0.7", 14550)


@pytest.mark.parametrize(
    ("addresses", "port"), [((), 14550), (("10.0.0.7",), 0), (("10.0.0.7",), None), (("a",), 99999)]
)
def test_what_cannot_be_connected_to_is_not_listed(addresses: tuple[str, ...], port: int | None) -> None:
    assert read(addresses, port) is None
    assert read_service("_http._tcp.local.", "x._http._tcp.local.", ("10.0.0.7",), 80, {}) is None


def test_an_ipv4_address_comes_first() -> None:
    service, only = read(("fe80::1", "10.0.0.7")), read(("fe80::1",))
    assert service is not None
    assert only is not None
    assert (service.host, only.endpoint) == ("10.0.0.7", "udpout:[fe80::1]:14550")


@pytest.mark.parametrize("text", [b"\xff\xfe", b"300", b"-1", "٣".encode(), b"9" * 5000, b""])
def test_a_system_id_that_is_none_is_not_known(text: bytes) -> None:
    service = read(sysid=text)
    assert service is not None
    assert service.system == 0


def test_texts_of_others_are_cut_and_cleaned() -> None:
    service = read(name=b"\x1b[2J" + b"x" * 300, role=b"admin")
    assert service is not None
    assert service.name.isprintable()
    assert len(service.name) == 40
    assert service.role is ServiceRole.UNKNOWN


def test_listening_endpoints_are_announced_where_reachable() -> None:
    endpoints = [parse_endpoint(text) for text in ("udpin:0.0.0.0:1", "udpin:127.0.0.1:1", "tcpin:10.0.0.7:1")]
    assert all(map(can_announce, endpoints))
    assert [announces_here_only(each) for each in endpoints] == [False, True, False]
    assert not can_announce(parse_endpoint("udpout:10.0.0.7:14550"))
    assert not can_announce(parse_endpoint("serial:/dev/ttyUSB0:57600"))
