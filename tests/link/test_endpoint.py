"""Endpoints: one table, and errors that say what to do."""

from __future__ import annotations

import pytest

from link.endpoint import SCHEMES, Endpoint, EndpointError, endpoint_help, parse_endpoint, parse_endpoints
from link.transport.transports import load_factory
from tests.rows import each_row


@each_row(
    ("text", "endpoint"),
    [
        ("udpin:127.0.0.1:14550", Endpoint("udpin:127.0.0.1:14550", "udpin", "127.0.0.1", 14550)),
        ("udpout://rover.local:14550", Endpoint("udpout:rover.local:14550", "udpout", "rover.local", 14550)),
        (" UDPIN:0.0.0.0:1/ ", Endpoint("udpin:0.0.0.0:1", "udpin", "0.0.0.0", 1)),
        ("udpout:[::1]:14550", Endpoint("udpout:[::1]:14550", "udpout", "::1", 14550)),
        ("tcpin:0.0.0.0:5760", Endpoint("tcpin:0.0.0.0:5760", "tcpin", "0.0.0.0", 5760)),
        (
            "serial:/dev/ttyAMA0:57600",
            Endpoint("serial:/dev/ttyAMA0:57600", "serial", path="/dev/ttyAMA0", baud=57600),
        ),
        (
            "serial:///dev/serial/by-path/usb-0:1.2:1.0-port0:921600",
            Endpoint(
                "serial:/dev/serial/by-path/usb-0:1.2:1.0-port0:921600",
                "serial",
                path="/dev/serial/by-path/usb-0:1.2:1.0-port0",
                baud=921600,
            ),
        ),
        ("zenoh:alice.json5/farm", Endpoint("zenoh:alice.json5/farm", "zenoh", locator="alice.json5", fleet="farm")),
        (
            "zenoh:///etc/mavhelm/rover1.json5/farm/rover1/",
            Endpoint(
                "zenoh:/etc/mavhelm/rover1.json5/farm/rover1",
                "zenoh",
                locator="/etc/mavhelm/rover1.json5",
                fleet="farm",
                vehicle="rover1",
            ),
        ),
        (
            "zenoh:quic/[::1]:7447?mixed_rel=1/farm/rover-1.a",
            Endpoint(
                "zenoh:quic/[::1]:7447?mixed_rel=1/farm/rover-1.a",
                "zenoh",
                locator="quic/[::1]:7447?mixed_rel=1",
                fleet="farm",
                vehicle="rover-1.a",
            ),
        ),
    ],
)
def test_what_is_understood(text: str, endpoint: Endpoint) -> None:
    assert parse_endpoint(text) == endpoint


@each_row(
    ("text", "told"),
    [
        ("", "must be one of udpin:HOST:PORT"),
        ("14550", "must be one of"),
        ("udpinn:127.0.0.1:14550", "did you mean udpin:"),
        ("bluetooth:1:2", "must be one of"),
        ("udpbcast:127.255.255.255:14550", "broadcasts are not sent: name one machine with udpout:HOST:PORT"),
        ("127.0.0.1:14550", "did you mean udpin:127.0.0.1:14550? it must be one of"),
        ("0.0.0.0:14550", "did you mean udpin:0.0.0.0:14550?"),
        ("localhost:14550", "did you mean udpin:localhost:14550?"),
        ("[::1]:14550", "did you mean udpin:[::1]:14550?"),
        ("192.168.1.20:14550", "did you mean udpout:192.168.1.20:14550?"),
        ("rover.local:14550", "did you mean udpout:rover.local:14550?"),
        (
            "udpout:0.0.0.0:14550",
            "0.0.0.0 is not an address to send to; name the other end, or write udpin:0.0.0.0:14550",
        ),
        ("udpout:[::]:14550", "write udpin:[::]:14550 to wait for it"),
        ("tcpout:0.0.0.0:5760", "write tcpin:0.0.0.0:5760 to wait for it"),
        ("tcp:127.0.0.1:5760", "did you mean tcpout:127.0.0.1:5760?"),
        ("udp:127.0.0.1:14550", "did you mean udpin:127.0.0.1:14550?"),
        ("udp://127.0.0.1:14550", "did you mean udpin:127.0.0.1:14550?"),
        ("/dev/ttyUSB0", "did you mean serial:/dev/ttyUSB0:57600?"),
        ("/dev/ttyACM0,115200", "did you mean serial:/dev/ttyACM0:115200?"),
        (
            "/dev/serial/by-path/usb-0:1.2:1.0-port0",
            "did you mean serial:/dev/serial/by-path/usb-0:1.2:1.0-port0:57600?",
        ),
        ("udpin:14550", "for example udpin:127.0.0.1:14550"),
        ("udpin::14550", "write udpin:HOST:PORT"),
        ("udpin:127.0.0.1:", "port '' is not a number from 1 to 65535"),
        ("udpin:127.0.0.1:0", "port '0'"),
        ("udpin:127.0.0.1:65536", "port '65536'"),
        ("udpin:127.0.0.1:-1", "port '-1'"),
        ("udpin:127.0.0.1:\u0661", "is not a number"),
        ("udpin:127.0.0.1:" + "1" * 5000, "is not a number from 1 to 65535"),
        ("serial:/dev/ttyAMA0:" + "1" * 5000, "is not a number from 300"),
        ("serial:/dev/ttyAMA0", "for example serial:/dev/ttyAMA0:57600"),
        ("serial:/dev/ttyAMA0:", "for example serial:/dev/ttyAMA0:57600"),
        ("serial:ttyAMA0:57600", "write serial:/dev/ttyAMA0:57600"),
        ("serial:/dev/ttyAMA0:fast", "baud rate 'fast' is not a number"),
        ("serial:/dev/ttyAMA0:0", "baud rate '0' is not a number from 300"),
        ("serial:/dev/ttyAMA0:99999999", "baud rate '99999999'"),
        ("zenoh:", "write zenoh:FILE_OR_ROUTER/FLEET[/VEHICLE], for example"),
        ("zenoh:farm/rover1", "for example zenoh:alice.json5/farm"),
        ("zenoh:127.0.0.1:7447/farm", "or zenoh:tcp/192.168.1.2:7447/farm/rover1"),
        ("zenoh:alice.json5", "name the fleet behind alice.json5"),
        ("zenoh:tcp/127.0.0.1:7447", "name the fleet behind tcp/127.0.0.1:7447"),
        ("zenoh:tcp/127.0.0.1/farm", "'tcp/127.0.0.1' is not an address of a router"),
        ("zenoh:tls/host:99999/farm", "'tls/host:99999' is not an address of a router"),
        ("zenoh:alice.json5/farm/rover1/x", "one vehicle at most"),
        ("zenoh:alice.json5/fa*m", "'fa*m' is not a name; it has 1 to 24 letters"),
        ("zenoh:alice.json5/farm/**", "'**' is not a name"),
    ],
)
def test_what_is_not_understood_is_explained(text: str, told: str) -> None:
    with pytest.raises(EndpointError) as caught:
        parse_endpoint(text)
    assert told in str(caught.value)
    assert repr(text) in str(caught.value) or text in str(caught.value)
    assert "\n" not in str(caught.value)


def test_the_table_is_the_help_and_every_scheme_can_be_opened() -> None:
    for scheme in SCHEMES.values():
        assert f"  {scheme.syntax} " in endpoint_help()
        assert scheme.help in endpoint_help()
        assert callable(load_factory(scheme))


@pytest.mark.parametrize(
    "texts",
    [
        ("udpin:127.0.0.1:14550", "udpin:127.0.0.1:14550"),
        ("udpout:rover.local:14550", "tcpin:0.0.0.0:5760", "UDPOUT://rover.local:14550"),
        ("serial:/dev/ttyAMA0:57600", "serial:/dev/ttyAMA0:115200"),
        ("udpin:localhost:14550", "udpin:127.0.0.1:14550"),
        ("zenoh:a.json5/farm/rover1", "zenoh://a.json5/farm/rover1"),
    ],
)
def test_an_endpoint_that_is_given_twice_is_refused(texts: tuple[str, ...]) -> None:
    with pytest.raises(EndpointError, match=r"^endpoint '\S+' is given twice$"):
        parse_endpoints(texts)


@pytest.mark.parametrize(
    "texts",
    [
        ("udpin:0.0.0.0:14550", "udpin:127.0.0.1:14550"),
        ("udpin:127.0.0.1:14550", "udpin:0.0.0.0:14550"),
        ("tcpin:192.168.1.2:5760", "tcpin:[::]:5760"),
        ("udpin:0.0.0.0:14550", "udpin:[::]:14550"),
    ],
)
def test_two_endpoints_that_listen_on_the_same_port_are_refused(texts: tuple[str, ...]) -> None:
    """The second could not be opened, and the error would blame another program."""
    with pytest.raises(EndpointError, match="listen on the same port; leave one of them out") as caught:
        parse_endpoints(texts)
    assert all(f"'{text}'" in str(caught.value) for text in texts)


def test_one_port_of_two_addresses_or_protocols_is_not_doubled() -> None:
    texts = (
        "udpin:127.0.0.1:14550",
        "udpin:192.168.1.2:14550",
        "tcpin:127.0.0.1:14550",
        "udpout:127.0.0.1:14550",
        "tcpin:0.0.0.0:1",
    )
    assert [each.text for each in parse_endpoints(texts)] == list(texts)
