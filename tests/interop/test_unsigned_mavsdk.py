"""MAVSDK, which cannot sign, against our vehicle with a key in a network: it watches, and is told why not more."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path

import pytest

from link.signing.key_actions import make_key
from link.signing.key_file import FILE
from link.signing.role import SigningRole
from tests.e2e.programs import Vehicle
from tests.interop import mavsdk_process
from tests.interop.mavsdk_process import Client
from tests.ports import free_port

pytestmark = [pytest.mark.interop, mavsdk_process.needed]


def test_it_watches_and_is_told_why_it_may_not_arm(tmp_path: Path) -> None:
    make_key(tmp_path / FILE, "laptop", SigningRole.SET_UP)
    port = free_port()
    with ExitStack() as stack:
        vehicle = Vehicle(tmp_path, f"udpin:0.0.0.0:{port}", "--state", str(tmp_path))
        stack.callback(vehicle.end)
        client = Client(f"udpout://127.0.0.1:{port}", "outsider", tmp_path)
        stack.callback(client.end)
        client.good("place")
        client.good("denied")
        assert "COMPONENT_ARM_DISARM refused: not signed" in str(client.good("reason").value)
        assert "Armed" not in vehicle.errors.read_text()
        assert not any(each.turning for each in vehicle.outputs())
