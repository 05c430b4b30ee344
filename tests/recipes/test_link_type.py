"""Recipe: a link type, in two files: its module and its row in SCHEMES."""

from __future__ import annotations

import pytest

from tests.recipes.tree import Tree

pytestmark = pytest.mark.e2e

TOY = '''"""UDP under the name of a toy."""

from __future__ import annotations

from msgspec.structs import replace

from link.endpoint import Endpoint
from link.transport.transport import Transport
from link.transport.udp import open_udp


def open_toy(endpoint: Endpoint) -> Transport:
    """Open a UDP socket for the toy. Raises LinkError."""
    return open_udp(replace(endpoint, scheme="udpin"))
'''

ROW = """    "toy": Scheme(
        "toy:HOST:PORT", "listen on this address for toys", _parse_host_port, "link.transport.toy:open_toy"
    ),"""

CALL_IT = """
import asyncio, socket, subprocess, sys
from dialects import codec
from dialects import messages as m

vehicle = subprocess.Popen(
    [sys.executable, "-m", "vehicle", "--sim", "toy:127.0.0.1:{port}"], stdout=subprocess.PIPE, text=True,
    stderr=subprocess.STDOUT,
)
try:
    assert vehicle.stdout is not None
    while "ready" not in vehicle.stdout.readline():
        assert vehicle.poll() is None
    beat = m.Heartbeat(6, 8, 0, 0, 4, 3)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as station:
        station.settimeout(20.0)
        station.sendto(codec.frame(beat.id, codec.encode_payload(beat), 0, 255, 190), ("127.0.0.1", {port}))
        assert len(station.recv(65536)) > 8
finally:
    vehicle.terminate()
    vehicle.communicate()
assert vehicle.returncode == 0, vehicle.returncode
"""


def test_a_link_type(tree: Tree) -> None:
    tree.write("link/transport/toy.py", TOY)
    tree.insert_after("link/endpoint.py", "SCHEMES: dict[str, Scheme] = {", ROW)
    tree.check_recipe("a link type")
    for program in ("vehicle", "groundstation", "link.bridge"):
        assert "toy:HOST:PORT" in tree.run(program, "--help")
    tree.run_script(CALL_IT.replace("{port}", str(tree.port)))
