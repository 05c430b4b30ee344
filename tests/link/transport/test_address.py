"""Errors of socket addresses: one line that names the endpoint and the remedy."""

from __future__ import annotations

import errno
import os

import pytest

from link.endpoint import parse_endpoint
from link.transport.address import bind_error
from link.transport.transport import LinkError
from link.transport.udp import open_udp


def test_an_error_is_no_cause_that_does_not_fit() -> None:
    refused = OSError(errno.EACCES, os.strerror(errno.EACCES))
    high = str(bind_error(parse_endpoint("udpin:10.0.0.1:14550"), refused))
    assert high == "udpin:10.0.0.1:14550: this system does not allow it; a firewall or a sandbox may forbid it"


@pytest.mark.parametrize("address", ["127.255.255.255", "255.255.255.255"])
def test_a_broadcast_address_is_named(address: str) -> None:
    with pytest.raises(LinkError, match=f"{address} is a broadcast address; name one machine, or listen with udpin"):
        open_udp(parse_endpoint(f"udpout:{address}:31590"))


@pytest.mark.parametrize(
    ("number", "text"),
    [
        (errno.EADDRINUSE, "udpin:10.0.0.1:80: port 80 is in use; stop the other program"),
        (errno.EADDRNOTAVAIL, "udpin:10.0.0.1:80: 10.0.0.1 is not an address of this machine; use one of its own"),
        (errno.EACCES, "udpin:10.0.0.1:80: not allowed; ports below 1024 need root"),
        (errno.ENETUNREACH, f"udpin:10.0.0.1:80: {os.strerror(errno.ENETUNREACH)}"),
    ],
)
def test_an_error_names_the_endpoint_and_the_remedy(number: int, text: str) -> None:
    line = str(bind_error(parse_endpoint("udpin:10.0.0.1:80"), OSError(number, os.strerror(number))))
    assert line.startswith(text)
    assert "\n" not in line
