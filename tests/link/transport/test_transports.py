"""Opening transports: all or none, and one line says why not."""

from __future__ import annotations

import socket
from collections.abc import Iterator

import pytest

from link.links import open_links
from link.transport.transport import LinkError
from tests.ports import free_port


@pytest.fixture
def ground() -> Iterator[socket.socket]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.bind(("127.0.0.1", 0))
        yield sock


async def test_one_line_says_why_a_port_cannot_be_opened(ground: socket.socket) -> None:
    port = ground.getsockname()[1]
    wrong = {
        f"udpin:127.0.0.1:{port}": f"port {port} is in use",
        "udpout:no-such-host.invalid:14550": "host 'no-such-host.invalid' is not known",
        "udpin:203.0.113.7:14550": "203.0.113.7 is not an address of this machine",
        f"udpout:{'x' * 70}.invalid:14550": "is not known",
    }
    for endpoint, told in wrong.items():
        with pytest.raises(LinkError) as caught:
            open_links([endpoint], system=1, component=1)
        assert told in str(caught.value)
        assert "\n" not in str(caught.value)


async def test_a_failed_endpoint_leaves_none_open() -> None:
    port = free_port()
    with pytest.raises(LinkError):
        open_links([f"udpin:127.0.0.1:{port}", "udpin:203.0.113.7:14550"], system=1, component=1)
    for link in open_links([f"udpin:127.0.0.1:{port}"], system=1, component=1):
        link.close()
