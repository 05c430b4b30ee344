"""Endpoints: one table, and errors that say what to do."""

from __future__ import annotations

import pytest

from link.endpoint import SCHEMES, Endpoint, EndpointError, endpoint_help, parse_endpoint
from link.transport.transports import TRANSPORTS


@pytest.mark.parametrize(
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
    ],
)
def test_what_is_understood(text: str, endpoint: Endpoint) -> None:
    assert parse_endpoint(text) == endpoint


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "must be one of udpin:HOST:PORT"),
        ("14550", "must be one of"),
        ("udpinn:127.0.0.1:14550", "did you mean udpin:"),
        ("bluetooth:1:2", "must be one of"),
        ("tcp:127.0.0.1:5760", "did you mean tcpout:?"),
        ("udp:127.0.0.1:14550", "did you mean udpin:?"),
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
        assert scheme.form in endpoint_help()
    assert SCHEMES.keys() == TRANSPORTS.keys()
