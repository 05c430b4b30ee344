"""Errors of socket addresses: one line that names the endpoint and the remedy."""

from __future__ import annotations

import errno
import os

import pytest

from link.endpoint import parse_endpoint
from link.transport.address import bind_error_text


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
    line = bind_error_text(parse_endpoint("udpin:10.0.0.1:80"), OSError(number, os.strerror(number)))
    assert line.startswith(text)
    assert "\n" not in line
